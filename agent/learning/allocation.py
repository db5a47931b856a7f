"""Memory from one update of a network to the next."""

import ctypes

TRIM, MAPPED = -1, -3
"""Options of glibc's mallopt: see its manual, M_TRIM_THRESHOLD and M_MMAP_THRESHOLD."""

LARGEST = 1 << 25
"""Bytes of the largest block that is kept: the most that glibc takes on all its versions."""


def keep_freed_memory() -> None:
    """Let the process keep what it frees, for blocks to come; nothing where its C library is not glibc.

    An update takes blocks of megabytes and frees them all. glibc gives these back to the system, which must
    find and clear every page again for the next update.
    """
    if mallopt := getattr(ctypes.CDLL(None), "mallopt", None):
        mallopt(MAPPED, LARGEST)
        mallopt(TRIM, (1 << 31) - 1)
