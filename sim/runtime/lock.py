"""Lock of the compiler's cache of kernels, which a killed process leaves behind."""

import contextlib
import time
from pathlib import Path

from vitruvius.sim.tracing import compiler

LOCK_AGE = 60.0
"""Age of a lock that counts as stale, in seconds. Writing the kernels of a process takes less than one
second."""


def drop_stale_lock(folder: Path) -> None:
    """Remove the lock of Taichi's kernel cache in a folder, if it is older than ``LOCK_AGE``.

    A process that is killed while it writes its kernels leaves the lock behind. While the lock exists, no
    process reads or writes the cache, so each process compiles all kernels.
    """
    lock = folder / compiler.LOCK
    with contextlib.suppress(FileNotFoundError):
        if time.time() - lock.stat().st_mtime > LOCK_AGE:
            lock.unlink()
