"""Large arrays are requested in huge pages, and keep their contents."""

from pathlib import Path

import numpy as np

from vitruvius.sim.huge_pages import HUGE_PAGE
from vitruvius.sim.runtime import Array, start, ti


def flags(address: int) -> list[str]:
    """Return Linux's flags of the memory at an address: VmFlags of its mapping."""
    lines, here = Path("/proc/self/smaps").read_text().splitlines(), False
    for line in lines:
        first = line.split()[0]
        if "-" in first and not first.endswith(":"):
            begin, end = (int(each, 16) for each in first.split("-"))
            here = begin <= address < end
        elif here and first == "VmFlags:":
            return line.split()[1:]
    return []


def test_a_large_array_is_in_huge_pages_where_linux_has_them():
    start()
    array = Array(ti.i32, 4 * HUGE_PAGE)
    values = np.arange(4 * HUGE_PAGE, dtype=np.int32)
    array.fill(values)
    assert np.array_equal(array.numpy(), values)
    middle = array.view().ctypes.data + 8 * HUGE_PAGE
    has = Path("/sys/kernel/mm/transparent_hugepage/enabled").exists()
    assert ("hg" in flags(middle)) == has
