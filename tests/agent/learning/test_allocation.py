"""The process keeps the memory that it frees."""

import ctypes
import subprocess
import sys

import pytest

PROGRAM = """
import sys
from pathlib import Path

import numpy as np

from vitruvius.agent.learning.allocation import keep_freed_memory


def pages():
    return int(Path("/proc/self/statm").read_text().split()[1])


if sys.argv[1] == "keep":
    keep_freed_memory()
before = pages()
block = np.ones(1 << 21)  # 16 MiB
del block
print(pages() - before)
"""
"""Program that prints how many more pages of 4 KiB a process has after it allocated and freed a block."""


@pytest.mark.skipif(not hasattr(ctypes.CDLL(None), "mallopt"), reason="the C library is not glibc")
@pytest.mark.parametrize(("how", "kept"), [("keep", True), ("by default", False)])
def test_a_large_block_that_is_freed_is_kept(how: str, kept: bool) -> None:
    done = subprocess.run([sys.executable, "-c", PROGRAM, how], capture_output=True, text=True, check=True)
    assert (int(done.stdout) > 4000) is kept
