"""Running kernels: the start of the compiler in a process, arrays and constants, and launches."""

from vitruvius.sim.runtime.arrays import (
    Array,
    Bytes,
    Floats,
    Ints,
    Longs,
    Shorts,
    Words,
    element,
)
from vitruvius.sim.runtime.constants import MOST_FIELDS, constants
from vitruvius.sim.runtime.launch import Launch
from vitruvius.sim.runtime.lock import LOCK_AGE, drop_stale_lock
from vitruvius.sim.runtime.process import has_cuda, start
from vitruvius.sim.tracing import KEEPS_KERNELS, compiler, impl, kernel, ti

__all__ = [
    "KEEPS_KERNELS",
    "LOCK_AGE",
    "MOST_FIELDS",
    "Array",
    "Bytes",
    "Floats",
    "Ints",
    "Launch",
    "Longs",
    "Shorts",
    "Words",
    "compiler",
    "constants",
    "drop_stale_lock",
    "element",
    "has_cuda",
    "impl",
    "kernel",
    "start",
    "ti",
]
