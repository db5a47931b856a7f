"""Core of SWI-Prolog, compiled into the user's cache: reading its sources takes 0.2 s at each start.

A compiled file is loaded if the folder is the user's alone, and if the file has the hash in its name. The
name also has a hash of the sources and of SWI-Prolog's build. Otherwise the sources are loaded.
"""

import hashlib
import os
import shutil
import tempfile
from functools import cache as once
from pathlib import Path

from vitruvius.logic.files.cache import cache
from vitruvius.logic.grammar import RULES
from vitruvius.logic.opener import content_of
from vitruvius.logic.placement import prolog

CORE = RULES / "core.pl"

MAX_BYTES = 1 << 24
"""Largest size of a compiled file, in bytes. It has 220 kB."""

MAX_FILES = 8
"""Number of compiled files that are kept, the newest ones: each version of the sources has its own."""


def load_core() -> None:
    """Load the core, compiled if the cache has it."""
    prolog.load(CORE, compiled())


def provide() -> None:
    """Compile the core into the cache, unless the cache has it or cannot take it.

    A child process compiles, because the code that a compiling process runs differs from what it writes.
    Several processes may compile at once, each into a file of its own.
    """
    folder = _folder()
    if folder is None or compiled():
        return
    child = os.fork()
    if child:
        os.waitpid(child, 0)
        return
    try:
        _compile(folder)
    finally:
        os._exit(0)


def compiled() -> Path | None:
    """Return the compiled core in the cache, or None if there is none that is whole."""
    folder = _folder()
    files = sorted(folder.glob(f"{_key()}-*.qlf")) if folder else []
    return next((file for file in files if _is_whole(file)), None)


def _folder() -> Path | None:
    """Return the folder of compiled files, made if need be; None if another user may write there."""
    try:
        folder = cache() / "core"
        if not folder.is_absolute():
            return None
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        about = folder.stat()
    except (OSError, RuntimeError):
        return None
    return folder if about.st_uid == os.getuid() and not about.st_mode & 0o022 else None


@once
def _key() -> str:
    """Return the hash of all that decides what the compiler writes."""
    found = hashlib.sha256()
    for name in ("version", "arch", "compiled_at"):
        found.update(f"{prolog.flag(name)}\n".encode())
    for file in sorted(RULES.rglob("*.pl")):
        content = file.read_bytes()
        found.update(f"{file.relative_to(RULES)} {len(content)}\n".encode() + content)
    return found.hexdigest()[:32]


def _is_whole(file: Path) -> bool:
    """Return True if a file has the hash in its name."""
    try:
        content = content_of(file, MAX_BYTES, unpack=False)
    except OSError:
        return False
    return file.stem.endswith(f"-{hashlib.sha256(content).hexdigest()}")


def _compile(folder: Path) -> None:
    """Compile a copy of the sources, and keep the result under its hash."""
    with tempfile.TemporaryDirectory(dir=folder) as beside:
        copy = shutil.copytree(RULES, Path(beside, "rules"))
        prolog.run("qcompile", str(copy / CORE.name), [prolog.Term("include", "user")], module="system")
        made = (copy / CORE.name).with_suffix(".qlf")
        digest = hashlib.sha256(made.read_bytes()).hexdigest()
        os.replace(made, folder / f"{_key()}-{digest}.qlf")
    newest = sorted(folder.glob("*.qlf"), key=lambda file: file.stat().st_mtime, reverse=True)
    for file in newest[MAX_FILES:]:
        file.unlink(missing_ok=True)
