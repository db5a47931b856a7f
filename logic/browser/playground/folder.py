"""The playground as a folder: the page, the solvers for WebAssembly, and the rules."""

import json
import os
import shutil
import tempfile
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path

from logic.browser.playground.npm import installed
from logic.drawing.palettes import PALETTES
from logic.errors import RequestError
from logic.generation.tiling import NO_PLAN
from logic.grammar import LENGTHS, RULES, SHIPPED, find, shipped
from logic.house.looks import folder_looks
from logic.house.promises import PASSAGE
from logic.layout.messages import SYNTAX
from logic.layout.relaxed import ABSENT, left_out_facts

HERE = Path(__file__).parent
PAGE = HERE.parent / "watch" / "page"

PACKAGES = {
    "clingo": ("clingo-wasm", ("dist/clingo.js", "dist/clingo.wasm", "LICENSE")),
    "swipl": (
        "swipl-wasm",
        ("dist/swipl/swipl-web.js", "dist/swipl/swipl-web.wasm", "dist/swipl/swipl-web.data", "LICENSE.txt"),
    ),
}
"""Folders of the page, each with the package and the files of it that the page needs."""


def write(folder: Path) -> None:
    """Write the playground into a folder, which appears whole or not at all.

    Raises ``RequestError`` where something is in the folder, ``MissingProgram`` where npm is needed and
    missing, ``VitruviusError`` where it cannot fetch the packages.
    """
    if folder.is_file() or (folder.is_dir() and any(folder.iterdir())):
        raise RequestError(f"--out {folder}: is there already and not empty: name a new folder")
    packages = solvers()
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder.parent, prefix=f".{folder.name}-") as beside:
            made = Path(beside, "page")
            _fill(made, packages)
            made.chmod(0o755)
            os.replace(made, folder)
    except OSError as error:
        raise RequestError(f"--out {folder}: cannot be written: {error.strerror}") from None


def size(folder: Path) -> int:
    """Bytes of all files of a folder."""
    return sum(file.stat().st_size for file in folder.rglob("*") if file.is_file())


def _fill(folder: Path, packages: Path) -> None:
    shutil.copytree(PAGE, folder)
    shutil.copytree(HERE / "solver", folder / "solver")
    for script in ("engine.js", "packing.js", "worker.js"):
        shutil.copy(HERE / script, folder)
    for name, (package, files) in PACKAGES.items():
        (folder / name).mkdir()
        for file in files:
            shutil.copy(packages / package / file, folder / name)
    (folder / "rules.json").write_text(json.dumps(_rules()), encoding="utf-8")


def _rules() -> dict[str, object]:
    """The core's rule files by path, the shipped grammars' by name, and what Python knows beside them.

    Grammars of houses of units are left out: the page does not make those.
    """
    names = [name for name in shipped() if find(name).topology_name != "building"]
    return {
        "version": version("vitruvius"),
        "rules": {file.relative_to(RULES).as_posix(): _text(file) for file in _rule_files(RULES)},
        "grammars": {
            name: {file.name: _text(file) for file in _rule_files(SHIPPED / name)} for name in names
        },
        "others": {name: _others(SHIPPED / name) for name in names},
        "lengths": LENGTHS,
        "hints": list(SYNTAX.items()),
        "leftOut": sorted(f"{name}/{arity}" for name, arity in left_out_facts()),
        "absent": ABSENT,
        "passage": PASSAGE,
        "noPlan": NO_PLAN,
        "looks": {name: asdict(folder_looks(SHIPPED / name)) for name in names},
        "colours": PALETTES["colour"].new,
    }


def _rule_files(folder: Path) -> list[Path]:
    files = (file for file in folder.rglob("*") if file.suffix in {".lp", ".pl"})
    return sorted(files, key=lambda file: file.name)  # as a grammar's hash takes them


def _others(folder: Path) -> dict[str, str]:
    """What else a grammar has, by name: how its types look."""
    return {file.name: _text(file) for file in sorted(folder.glob("*.json"))}


def _text(file: Path) -> str:
    return file.read_text(encoding="utf-8")


def solvers() -> Path:
    """The folder ``node_modules`` with the packages of the page. Raises as ``write``."""
    return installed(HERE, "the solvers for browsers")
