"""Optional parts of the installation, the extras of ``pyproject.toml``, and commands that add the rest."""

import json
import os
import platform
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from urllib.parse import unquote, urlsplit

NAME = "vitruvius"
"""Name of the distribution."""

EXTRAS = {
    "bench": ("cpuinfo", "pytest", "pytest_benchmark", "scipy"),
    "sim": ("gymnasium", "taichi"),
    "quadrants": ("quadrants",),
    "agent": ("rich", "safetensors", "scipy", "tensorboard", "tomli_w", "torch"),
    "export": ("pxr", "trimesh"),
    "play": ("pygame",),
    "pdf": ("matplotlib",),
    "film": ("imageio_ffmpeg",),
    "ifc": ("ifcopenshell",),
    "data": ("pyarrow",),
    "cluster": ("ray",),
    "minigrid": ("minigrid",),
}
"""Modules that the base does not install, by the extras that do."""

OLD_UBUNTU = {"bionic", "focal", "jammy"}
"""Code names of Ubuntu before 24.04, whose SWI-Prolog is too old. Derivatives name them, too."""

INSTALLERS = {"debian": "apt-get install", "fedora": "dnf install", "arch": "pacman -S"}
"""Commands that install packages of a system, by the name of the system or of its family."""

PROLOG = {"debian": "swi-prolog-nox", "fedora": "pl", "arch": "swi-prolog", "conda": "swi-prolog"}
X11 = {"debian": "libx11-6", "fedora": "libX11", "arch": "libx11", "conda": "xorg-libx11"}
"""Names of packages, by system."""


def prolog_command() -> str:
    """Return the command that installs SWI-Prolog on this system, and one that needs no root."""
    if sys.platform == "darwin":
        return "brew install swi-prolog"
    if sys.platform == "win32":
        return "winget install SWI-Prolog.SWI-Prolog"
    return linux_command(PROLOG)


def linux_command(packages: dict[str, str]) -> str:
    """Return the command that installs a package on this Linux, and one that needs no root."""
    try:
        system = platform.freedesktop_os_release()
    except OSError:
        system = {}
    names = [system.get("ID", ""), *system.get("ID_LIKE", "").split()]
    commands = [f"{INSTALLERS[name]} {packages[name]}" for name in names if name in INSTALLERS][:1]
    if packages is PROLOG and system.get("UBUNTU_CODENAME") in OLD_UBUNTU:
        commands = ["add-apt-repository ppa:swi-prolog/stable", "apt-get update", *commands]
    elif packages is PROLOG and system.get("VERSION_CODENAME") == "bullseye":  # It has 8.2, and no PPA.
        commands = []
    sudo = "" if os.geteuid() == 0 else "sudo "
    by_root = " && ".join(f"{sudo}{command}" for command in commands)
    return " or ".join(filter(None, [by_root, f"conda install -c conda-forge {packages['conda']}"]))


def extra_of(module: str | None) -> str | None:
    """Return the first extra that installs a module, given by its full name; None for other modules."""
    top = (module or "").partition(".")[0]
    return next((extra for extra, modules in EXTRAS.items() if top in modules), None)


def install_command(extra: str) -> str:
    """Return the command that adds an extra, from the file, folder or address of this installation.

    pip and uv record the origin of a distribution (https://packaging.python.org/specifications/direct-url).
    A distribution without a record is from the package index.
    """
    try:
        record = distribution(NAME).read_text("direct_url.json")
    except PackageNotFoundError:
        record = None
    origin = json.loads(record) if record else {}
    address, editable = origin.get("url", ""), origin.get("dir_info", {}).get("editable", False)
    if "vcs_info" in origin:
        address = f"{origin['vcs_info']['vcs']}+{address}"
    if editable and Path(path := unquote(urlsplit(address).path), "run").is_file():
        return f"{path}/run setup {extra}"
    if address.startswith("file:"):
        wanted = f"{unquote(urlsplit(address).path)}[{extra}]"
    else:
        wanted = f"{NAME}[{extra}]" + (f" @ {address}" if address else "")
    return f'pip install {"-e " if editable else ""}"{wanted}"'


@contextmanager
def required_by(module: str) -> Iterator[None]:
    """Add the command to the error of an import that an extra would install, for a ``module`` of ours."""
    try:
        yield
    except ModuleNotFoundError as error:
        if extra := extra_of(error.name):
            error.msg = f"{module} needs {error.name}: {install_command(extra)}"
        raise
