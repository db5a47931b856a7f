"""Forks of a process in which the compiler ran, which lack its threads, and the lock for compiling."""

import os
import threading

from vitruvius.sim.tracing import compiler

stranded = threading.Event()
"""Set in a fork of a process in which Taichi ran, because a fork lacks Taichi's threads."""

if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=lambda: stranded.set() if compiler.program() else None)


def require_threads() -> None:
    """Raise ``RuntimeError`` in a fork of a process in which Taichi ran."""
    if stranded.is_set():
        raise RuntimeError(
            f"{compiler.NAME} ran before this process was forked and cannot run in a forked process: start "
            f'processes by \'spawn\', as in vector_kwargs={{"context": "spawn"}}; or make one '
            "HouseVectorEnv for all environments"
        )


compiling = threading.RLock()
"""Lock for compiling: Taichi compiles for one thread at a time. Compiled kernels run in any thread, under
Python's own lock."""
