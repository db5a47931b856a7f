"""Reuse of memory from one update of a network to the next."""

import ctypes

TRIM, MAPPED = -1, -3
"""Options of glibc's mallopt: see its manual, M_TRIM_THRESHOLD and M_MMAP_THRESHOLD."""

MAX_BLOCK_BYTES = 1 << 25
"""Size of the largest block that the process keeps, in bytes: the largest that all versions of glibc
accept."""


def keep_freed_memory() -> None:
    """Let the process keep freed memory for later blocks; do nothing if its C library is not glibc.

    An update allocates blocks of megabytes and frees them all. glibc returns them to the system, which must
    find and clear every page again for the next update.
    """
    if mallopt := getattr(ctypes.CDLL(None), "mallopt", None):
        mallopt(MAPPED, MAX_BLOCK_BYTES)
        mallopt(TRIM, (1 << 31) - 1)
