"""Command ``vitruvius doctor``: it checks the programs and libraries that Vitruvius uses."""

import os
import platform
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Literal

import msgspec

from vitruvius.commands.common import print_answer, print_line
from vitruvius.logic.errors import MissingProgram, VitruviusError
from vitruvius.logic.installation import EXTRAS, install_command


class Finding(msgspec.Struct, frozen=True):
    """Finding about a part: it works, it is missing, or it is optional and absent."""

    part: str
    status: Literal["ok", "missing", "optional"]
    text: str
    """Version, or the reason and the command that installs the part."""


class Findings(msgspec.Struct, frozen=True):
    """Answer of ``doctor``."""

    found: list[Finding]


@dataclass(frozen=True)
class Doctor:
    """Check the programs and libraries that Vitruvius uses, and print commands that install the missing ones.

    The exit code is 69 if a part is missing that generation needs.
    """

    json: bool = False
    """Print one answer as JSON: what was found, and what is missing."""

    def run(self) -> int:
        """Print the findings."""
        found = list(findings())
        code = MissingProgram.exit_code if any(each.status == "missing" for each in found) else 0
        if self.json:
            print_answer("doctor", Findings(found), code)
        else:
            for each in found:
                print_line(f"{each.status:<10}{each.part:<12}{each.text}")
        return code


def findings() -> Iterator[Finding]:
    """Yield a finding about each part."""
    yield Finding("Python", "ok", f"{platform.python_version()}, {platform.platform(terse=True)}")
    yield from _solvers()
    yield from _simulator()
    for extra, modules in EXTRAS.items():
        if extra not in {"sim", "quadrants"}:
            absent = [module for module in modules if find_spec(module) is None]
            text = f"{', '.join(absent)} not installed: {install_command(extra)}" if absent else "installed"
            yield Finding(extra, "optional" if absent else "ok", text)
    npm = shutil.which("npm")
    yield Finding("npm", "ok" if npm else "optional", npm or "not installed: the playground needs it")


def _solvers() -> Iterator[Finding]:
    """Load a grammar in a solver process, as generation does."""
    from vitruvius.logic.grammar import find
    from vitruvius.logic.workers import confinement
    from vitruvius.logic.workers.messages import Loaded, Open
    from vitruvius.logic.workers.solver import Solver

    solver = Solver(Open(str(find("family").directory)))
    try:
        loaded = solver.loaded()
        assert isinstance(loaded, Loaded)
        for name, version in loaded.versions.items():
            yield Finding(name, "ok", version)
    except VitruviusError as error:
        yield Finding("solvers", "missing", str(error))
    finally:
        solver.end()
    yield Finding("processes", "ok", confinement.summary())


def _simulator() -> Iterator[Finding]:
    """Import the simulator, and look for the folder that keeps its compiled kernels."""
    try:
        from vitruvius.sim import cache, tracing
    except (ModuleNotFoundError, MissingProgram) as error:
        yield Finding("sim", "optional", str(error))
        return
    yield Finding("sim", "ok", f"installed, {tracing.compiler.NAME}")
    folder = os.environ.get(cache.VARIABLE, "~/.cache")
    text = folder if tracing.KEEPS_KERNELS else f"{folder} is not writable, so each start compiles kernels: "
    text += "" if tracing.KEEPS_KERNELS else f"set {cache.VARIABLE} to a folder of yours"
    yield Finding("cache", "ok" if tracing.KEEPS_KERNELS else "optional", text)
