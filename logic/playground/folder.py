"""The playground as a folder: the page, the solvers for WebAssembly, and the rules."""

import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path

from logic.errors import MissingProgram, RequestError, VitruviusError
from logic.grammar import RULES, SHIPPED, find, shipped
from logic.looks import folder_looks
from logic.messages import SYNTAX
from logic.palettes import PALETTES
from logic.vocabulary import LENGTHS

HERE = Path(__file__).parent
PAGE = HERE.parent / "watch" / "page"

LOCK = ("package.json", "package-lock.json")
"""What npm installs, by their hashes."""

PACKAGES = {
    "clingo": ("clingo-wasm", ("dist/clingo.js", "dist/clingo.wasm", "LICENSE")),
    "swipl": (
        "swipl-wasm",
        ("dist/swipl/swipl-web.js", "dist/swipl/swipl-web.wasm", "dist/swipl/swipl-web.data", "LICENSE.txt"),
    ),
}
"""Folders of the page, each with the package and the files of it that the page needs."""

SECONDS = 600
"""For npm."""


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
    for script in ("engine.js", "worker.js"):
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
        "lengths": LENGTHS,
        "hints": list(SYNTAX.items()),
        "looks": {name: asdict(folder_looks(SHIPPED / name)) for name in names},
        "colours": PALETTES["colour"].new,
    }


def _rule_files(folder: Path) -> list[Path]:
    return sorted(file for file in folder.rglob("*") if file.suffix in {".lp", ".pl"})


def _text(file: Path) -> str:
    return file.read_text(encoding="utf-8")


def solvers() -> Path:
    """The folder ``node_modules`` with the packages of the lock: npm fetches them once, and checks hashes.

    Raises as ``write``.
    """
    lock = [(HERE / name).read_bytes() for name in LOCK]
    kept = _cache() / f"playground-{hashlib.sha256(b''.join(lock)).hexdigest()[:16]}"
    if not kept.is_dir():
        npm = shutil.which("npm")
        if npm is None:
            raise MissingProgram(
                "npm, which fetches the solvers for browsers, is missing: install it (sudo apt-get install "
                "npm, brew install node), then run this again"
            )
        try:
            _cache().mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryDirectory(dir=_cache()) as beside:
                made = Path(beside, "packages")
                made.mkdir()
                for name, content in zip(LOCK, lock, strict=True):
                    (made / name).write_bytes(content)
                _install(npm, made)
                if not kept.is_dir():  # Another process may have been faster.
                    os.replace(made, kept)
        except OSError as error:
            raise VitruviusError(f"{_cache()}: cannot be written: {error.strerror}") from None
    return kept / "node_modules"


def _install(npm: str, folder: Path) -> None:
    """Install what the lock says; scripts of packages are not run."""
    command = [npm, "ci", "--ignore-scripts", "--omit=dev", "--no-audit", "--no-fund", "--loglevel=error"]
    try:
        done = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, timeout=SECONDS, check=False
        )
    except subprocess.TimeoutExpired:
        late = f"npm has not fetched the solvers for browsers in {SECONDS} s: try again"
        raise VitruviusError(late) from None
    if done.returncode:
        said = [line for line in done.stderr.splitlines() if line.startswith(("npm error", "npm ERR!"))]
        why = re.sub(r"^npm (error|ERR!) ", "", said[0]) if said else f"exit code {done.returncode}"
        raise VitruviusError(f"npm cannot fetch the solvers for browsers: {why}: is there a network?")


def _cache() -> Path:
    """The folder of this user for what can be fetched again."""
    home = Path.home()
    if os.name == "nt":
        default = home / "AppData" / "Local"
    else:
        default = home / ("Library/Caches" if sys.platform == "darwin" else ".cache")
    return Path(os.environ.get("XDG_CACHE_HOME") or default) / "vitruvius"
