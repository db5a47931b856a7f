"""Running kernels: the start of the compiler in a process, arrays and constants, and launches."""

from vitruvius.sim.runtime.arrays import Array, Bytes, Floats, Ints, Longs, Shorts, Words, element
from vitruvius.sim.runtime.constants import constants
from vitruvius.sim.runtime.launch import Launch
from vitruvius.sim.runtime.process import has_cuda, start
from vitruvius.sim.tracing import kernel, ti

__all__ = [
    "Array",
    "Bytes",
    "Floats",
    "Ints",
    "Launch",
    "Longs",
    "Shorts",
    "Words",
    "constants",
    "element",
    "has_cuda",
    "kernel",
    "start",
    "ti",
]
