"""Where Taichi keeps compiled kernels: a folder that can be written, also without a home."""

import os
import tempfile
from pathlib import Path

VARIABLE = "XDG_CACHE_HOME"
"""Where programs keep what they can make again; without it ``.cache`` in the home."""


def provide() -> bool:
    """Leave the variable as it is where its folder, or the home's, can be written. Else let it name one of
    this user's among the temporary files, and if there is none say so: nothing is to be kept then.

    Taichi aborts the process without a home, and as it ends where it cannot write its kernels. Containers and
    services are like that.
    """
    named = os.environ.get(VARIABLE)
    home = os.environ.get("HOME")
    usual = Path(named) if named else Path(home) / ".cache" if home else None
    keeps = bool(usual and usual.is_absolute() and _writable(usual))
    try:
        temporary = tempfile.gettempdir()
    except FileNotFoundError:  # There is none. Taichi's libraries ask for its name as they are imported.
        tempfile.tempdir = str(usual) if keeps else os.path.abspath(os.sep)
        if not keeps:
            os.environ[VARIABLE] = tempfile.tempdir
        return keeps
    if keeps:
        return True
    own = Path(temporary) / f"vitruvius-{os.getuid() if hasattr(os, 'getuid') else 0}"
    os.environ[VARIABLE] = str(own)
    return _writable(own) and own.stat().st_uid == os.getuid()


def _writable(folder: Path) -> bool:
    """Whether files can be written in a folder, which is made if it is not there."""
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder, buffering=0) as file:  # permissions do not say it all
            file.write(b".")
    except OSError:
        return False
    return True
