"""Packages of npm, pinned by the hashes of a lock file."""

import hashlib
import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

from vitruvius.logic.errors import MissingProgram, VitruviusError
from vitruvius.logic.files.cache import cache

LOCK = ("package.json", "package-lock.json")
"""Files that list the packages to install, with their hashes."""

SECONDS = 600
"""Timeout of npm, in seconds."""


def installed(folder: Path, what: str) -> Path:
    """Return the folder ``node_modules`` with the packages of a folder's lock file, which npm fetches once.

    ``what`` names the packages in errors. Raises ``MissingProgram`` if npm is needed and missing, and
    ``VitruviusError`` if npm cannot fetch the packages.
    """
    lock = [(folder / name).read_bytes() for name in LOCK]
    kept = cache() / f"{folder.name}-{hashlib.sha256(b''.join(lock)).hexdigest()[:16]}"
    if not kept.is_dir():
        npm = shutil.which("npm")
        if npm is None:
            raise MissingProgram(
                f"npm, which fetches {what}, is missing: install it (sudo apt-get install npm, brew install "
                "node), then run this again"
            )
        try:
            cache().mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryDirectory(dir=cache()) as beside:
                made = Path(beside, "packages")
                made.mkdir()
                for name, content in zip(LOCK, lock, strict=True):
                    (made / name).write_bytes(content)
                _install(npm, made, what)
                if not kept.is_dir():  # Another process may have been faster.
                    os.replace(made, kept)
        except OSError as error:
            raise VitruviusError(f"{cache()}: cannot be written: {error.strerror}") from None
    return kept / "node_modules"


def _install(npm: str, folder: Path, what: str) -> None:
    """Install the packages of the lock file, without running their scripts."""
    command = [npm, "ci", "--ignore-scripts", "--omit=dev", "--no-audit", "--no-fund", "--loglevel=error"]
    try:
        done = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, timeout=SECONDS, check=False
        )
    except subprocess.TimeoutExpired:
        raise VitruviusError(f"npm has not fetched {what} in {SECONDS} s: try again") from None
    if done.returncode:
        said = [line for line in done.stderr.splitlines() if line.startswith(("npm error", "npm ERR!"))]
        why = re.sub(r"^npm (error|ERR!) ", "", said[0]) if said else f"exit code {done.returncode}"
        raise VitruviusError(f"npm cannot fetch {what}: {why}: is there a network?")
