"""Memory pages of 2 MiB for large arrays, if Linux has such pages.

Environments look up values all over their tables. If the tables take hundreds of MiB, a tenth of a step is
spent on finding pages of 4 KiB (``benchmarks/simulator``, by houses).
"""

import ctypes
import sys

import numpy as np

HUGE_PAGE = 2 << 20
"""Size of a huge page, in bytes."""

ADVICE = 14, 25
"""``MADV_HUGEPAGE`` for pages that do not exist yet, ``MADV_COLLAPSE`` (Linux 6.1) for existing pages."""


def ask_for_huge_pages(memory: np.ndarray) -> None:
    """Ask for huge pages for all parts of an array that such pages can hold.

    The request is advice: without huge pages, only the time of steps changes.
    """
    first, end = -(-memory.ctypes.data // HUGE_PAGE), (memory.ctypes.data + memory.nbytes) // HUGE_PAGE
    if first < end and sys.platform == "linux":
        begin, length = ctypes.c_void_p(first * HUGE_PAGE), ctypes.c_size_t((end - first) * HUGE_PAGE)
        for advice in ADVICE:
            ctypes.CDLL(None).madvise(begin, length, advice)
