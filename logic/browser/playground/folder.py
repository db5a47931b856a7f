"""The playground as a folder: the page, the solvers for WebAssembly, and the rules."""

import json
import os
import shutil
import tempfile
from pathlib import Path

from vitruvius.logic.browser.playground.bundle import bundle
from vitruvius.logic.browser.playground.npm import installed
from vitruvius.logic.errors import RequestError

HERE = Path(__file__).parent
PAGE = HERE.parent / "watch" / "page"

SOLVERS = ("clingo/clingo.wasm", "swipl/swipl-web.wasm", "swipl/swipl-web.data")
"""Large files of the page: clingo, SWI-Prolog and its library. The page shows how much of them is loaded."""

PACKAGES = {
    "clingo": ("clingo-wasm", ("dist/clingo.js", "dist/clingo.wasm", "LICENSE")),
    "swipl": (
        "swipl-wasm",
        ("dist/swipl/swipl-web.js", "dist/swipl/swipl-web.wasm", "dist/swipl/swipl-web.data", "LICENSE.txt"),
    ),
}
"""Folders of the page, each with a package and the files of the package that the page needs."""


def write(folder: Path) -> None:
    """Write the playground into a folder, which appears complete or not at all.

    Raises ``RequestError`` if the folder is not empty, ``MissingProgram`` if npm is needed and missing, and
    ``VitruviusError`` if npm cannot fetch the packages.
    """
    if folder.is_file() or (folder.is_dir() and any(folder.iterdir())):
        raise RequestError(f"--out {folder}: already exists and is not empty: choose a new folder")
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
    """Return the size of all files of a folder, in bytes."""
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
    data = bundle() | {"bytes": {name: (folder / name).stat().st_size for name in SOLVERS}}
    (folder / "rules.json").write_text(json.dumps(data), encoding="utf-8")


def solvers() -> Path:
    """Return the folder ``node_modules`` with the packages of the page. Raises as ``write`` does."""
    return installed(HERE, "the solvers for browsers")
