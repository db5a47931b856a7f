"""Large arrays in pages of 2 MiB, where Linux has them.

Environments look up tables all over. Where these take hundreds of MiB, a tenth of a step is spent to find
pages of 4 KiB (``benchmarks/simulator``, by houses).
"""

import ctypes
import sys

import numpy as np

HUGE_PAGE = 2 << 20
"""Bytes."""

ADVICE = 14, 25
"""``MADV_HUGEPAGE`` for pages that are not there yet, ``MADV_COLLAPSE`` for those that are: of Linux 6.1."""


def ask_for_huge_pages(memory: np.ndarray) -> None:
    """Ask for them for all of an array that such pages can hold. It is advice: where there are none, nothing
    changes but the time that steps take.
    """
    first, end = -(-memory.ctypes.data // HUGE_PAGE), (memory.ctypes.data + memory.nbytes) // HUGE_PAGE
    if first < end and sys.platform == "linux":
        begin, length = ctypes.c_void_p(first * HUGE_PAGE), ctypes.c_size_t((end - first) * HUGE_PAGE)
        for advice in ADVICE:
            ctypes.CDLL(None).madvise(begin, length, advice)
