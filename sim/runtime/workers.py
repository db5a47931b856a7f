"""Worker threads of the compiler, each on a processor of its own."""

import os
from pathlib import Path


def threads_now() -> set[int]:
    """Return the ids of this process's threads, or an empty set on a system without ``/proc``."""
    return {int(task.name) for task in Path("/proc/self/task").glob("*")}


def spread(started: list[int], workers: int | None) -> None:
    """Pin each of Taichi's workers, the last threads that it starts, to its own processor.

    Launches are so short that Linux otherwise leaves all workers on the processor that wakes them. Workers
    are pinned only if there is one for each processor; otherwise programs would crowd on the first
    processors.
    """
    if not started or not hasattr(os, "sched_setaffinity"):
        return
    processors = sorted(os.sched_getaffinity(0))
    if 1 < len(processors) == (workers or os.cpu_count()):
        for thread, processor in zip(started[-len(processors) :], processors, strict=False):
            os.sched_setaffinity(thread, {processor})
