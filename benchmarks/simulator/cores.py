"""Temporary restriction of this process, with the threads that Taichi started, to some processors."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


def processors() -> int:
    """Return the number of processors that this process may use."""
    return len(os.sched_getaffinity(0))


@contextmanager
def confined(count: int) -> Iterator[None]:
    """Restrict the process to the last ``count`` processors, because the first serves most interrupts."""
    threads = [int(task.name) for task in Path("/proc/self/task").iterdir()]
    before = {thread: os.sched_getaffinity(thread) for thread in threads}
    if count == len(before[os.getpid()]):
        yield  # each where it is
        return
    chosen = sorted(before[os.getpid()])[-count:]
    for thread in threads:
        os.sched_setaffinity(thread, chosen)
    try:
        yield
    finally:
        for thread, mask in before.items():
            os.sched_setaffinity(thread, mask)
