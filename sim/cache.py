"""Folder in which Taichi keeps compiled kernels; it must be writable even without a home directory."""

import os
import tempfile
from pathlib import Path

VARIABLE = "XDG_CACHE_HOME"
"""Environment variable with the folder of files that programs can recreate. The default is ``.cache`` in the
home."""


def provide() -> bool:
    """Provide a writable cache folder, and return True if Taichi can keep kernels in it.

    If the folder that ``VARIABLE`` or the home names is writable, the variable stays as it is. Otherwise the
    variable is set to this user's folder among the temporary files. Without a temporary folder the function
    returns False. Taichi aborts the process if there is no home, and at exit if it cannot write its kernels.
    This happens in containers and services.
    """
    named = os.environ.get(VARIABLE)
    home = os.environ.get("HOME")
    usual = Path(named) if named else Path(home) / ".cache" if home else None
    keeps = bool(usual and usual.is_absolute() and _writable(usual))
    try:
        temporary = tempfile.gettempdir()
    except FileNotFoundError:  # There is no such folder. Taichi's libraries ask for its name on import.
        tempfile.tempdir = str(usual) if keeps else os.path.abspath(os.sep)
        if not keeps:
            os.environ[VARIABLE] = tempfile.tempdir
        return keeps
    if keeps:
        return True
    own = Path(temporary) / f"vitruvius-{os.getuid() if hasattr(os, 'getuid') else 0}"
    os.environ[VARIABLE] = str(own)
    return _writable(own) and (not hasattr(os, "getuid") or own.stat().st_uid == os.getuid())


def _writable(folder: Path) -> bool:
    """Return True if files can be written in a folder, which is created if it does not exist."""
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder, buffering=0) as file:  # permissions alone are not enough
            file.write(b".")
    except OSError:
        return False
    return True
