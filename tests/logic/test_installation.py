"""Commands that install parts: extras from the origin of the installation, SWI-Prolog for each system."""

import platform
import sys
from types import SimpleNamespace

import pytest

from tests.programs import finished
from vitruvius.logic import installation

CONDA = "conda install -c conda-forge swi-prolog"
APT = "sudo apt-get install swi-prolog-nox"
PPA = f"sudo add-apt-repository ppa:swi-prolog/stable && sudo apt-get update && {APT}"
JAMMY = {"ID_LIKE": "ubuntu debian", "UBUNTU_CODENAME": "jammy"}


@pytest.mark.parametrize(
    ("origin", "command"),
    [
        (None, 'pip install "vitruvius[sim]"'),
        ('{"url": "file:///a%20b/v.whl", "archive_info": {}}', 'pip install "/a b/v.whl[sim]"'),
        ('{"url": "file:///code", "dir_info": {"editable": true}}', 'pip install -e "/code[sim]"'),
        (
            '{"url": "https://x.org/v", "vcs_info": {"vcs": "git", "commit_id": "0"}}',
            'pip install "vitruvius[sim] @ git+https://x.org/v"',
        ),
        (
            '{"url": "https://x.org/v.whl", "archive_info": {}}',
            'pip install "vitruvius[sim] @ https://x.org/v.whl"',
        ),
    ],
)
def test_the_command_that_adds_an_extra_names_the_origin_of_the_installation(
    origin: str | None, command: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(installation, "distribution", lambda _: SimpleNamespace(read_text=lambda _: origin))
    assert installation.install_command("sim") == command


@pytest.mark.parametrize(
    ("system", "release", "command"),
    [
        ("linux", {"ID": "debian", "VERSION_CODENAME": "bookworm"}, f"{APT} or {CONDA}"),
        ("linux", {"ID": "debian", "VERSION_CODENAME": "bullseye"}, CONDA),
        ("linux", {"ID": "ubuntu", "ID_LIKE": "debian", "UBUNTU_CODENAME": "noble"}, f"{APT} or {CONDA}"),
        ("linux", {"ID": "ubuntu", "ID_LIKE": "debian", "UBUNTU_CODENAME": "jammy"}, f"{PPA} or {CONDA}"),
        ("linux", {"ID": "linuxmint", **JAMMY}, f"{PPA} or {CONDA}"),
        ("linux", {"ID": "fedora"}, f"sudo dnf install pl or {CONDA}"),
        ("linux", {"ID": "manjaro", "ID_LIKE": "arch"}, f"sudo pacman -S swi-prolog or {CONDA}"),
        ("linux", {"ID": "alpine"}, CONDA),
        ("darwin", {}, "brew install swi-prolog"),
        ("win32", {}, "winget install SWI-Prolog.SWI-Prolog"),
    ],
)
def test_each_system_gets_its_own_command_for_swi_prolog(
    system: str, release: dict[str, str], command: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "platform", system)
    monkeypatch.setattr(platform, "freedesktop_os_release", lambda: release)
    monkeypatch.setattr(installation.os, "geteuid", lambda: 1000)
    assert installation.prolog_command() == command


UNUSABLE = """
from vitruvius.logic.placement import prolog
prolog.prolog_command = lambda: "COMMAND"
def lacks(*arguments, **named):
    raise prolog.PrologError("source_sink does not exist")
for prolog.swi.PL_version, prolog.run in (lambda _: 80402, prolog.run), (lambda _: 90004, lacks):
    try:
        prolog.require()
    except prolog.MissingProgram as error:
        print(error)
"""


def test_an_old_prolog_and_one_without_clpr_are_named_with_the_command() -> None:
    assert finished([sys.executable, "-c", UNUSABLE]).stdout.splitlines() == [
        "SWI-Prolog 8.4.2 is too old, 9.0 or later is needed: COMMAND",
        "SWI-Prolog 9.0.4 lacks library(clpr): COMMAND",
    ]
