"""Optional parts of the installation, the extras of ``pyproject.toml``, and the command that adds one."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.metadata import PackageNotFoundError, distribution
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
