"""Source code of kernels, as the compiler reads it."""

# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false

import inspect
from typing import NamedTuple

from vitruvius.sim.runtime import ti
from vitruvius.sim.tracing import _source, kernel

Numbers = ti.types.ndarray(ti.f32, 1)


class Sides(NamedTuple):
    wide: Numbers
    high: Numbers


def areas(scale: Numbers, sides: Sides, found: Numbers):
    for k in range(found.shape[0]):
        found[k] = scale[0] * sides.wide[k]


def plain(found: Numbers):
    found[0] = 1.0


def test_each_array_of_a_record_is_an_argument_and_the_record_is_made_of_them():
    first = inspect.getsourcelines(areas)[1]
    kernel(areas)
    assert _source(areas) == (
        [
            "def areas(scale, wide, high, found):\n",
            "    sides = ti.static(Sides(wide, high))\n",
            "    for k in range(found.shape[0]):\n",
            "        found[k] = scale[0] * sides.wide[k]",
        ],
        first,
    )
    arguments = inspect.signature(areas).parameters
    assert [*arguments] == ["scale", "wide", "high", "found"]
    assert all(each.annotation is Numbers for each in arguments.values())


def test_a_kernel_without_records_is_read_as_it_is_written():
    kernel(plain)
    assert _source(plain) == inspect.getsourcelines(plain)
