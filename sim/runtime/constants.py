"""Tables of constants that kernels read: fields of the compiler, whose number in a process is limited."""

from collections import Counter
from functools import cache
from typing import Any

import numpy as np

from vitruvius.sim.runtime.arrays import TYPES
from vitruvius.sim.runtime.forks import compiling
from vitruvius.sim.runtime.process import by_owner
from vitruvius.sim.tracing import compiler, ti

MOST_FIELDS = 500
"""Largest number of fields of a process. Taichi has room for 512, and crashes at the next one."""

_fields = Counter[Any]()
"""Number of fields that each program of the compiler has allocated."""


def constants(values: np.ndarray) -> Any:
    """Return a field with these numbers (n,), or vectors (n, width), for kernels.

    Equal values share one field.

    Raises ``RuntimeError`` for more than ``MOST_FIELDS`` different fields, and on a GPU in any thread other
    than the first that called ``start``.
    """
    with compiling:
        return _field(compiler.program(), values.dtype.type, values.shape, values.tobytes())


@cache
def _field(program: Any, kind: type[np.generic], shape: tuple[int, ...], content: bytes) -> Any:
    if _fields[program] == MOST_FIELDS:
        raise RuntimeError(
            f"this process has created environments with so many sensors that {compiler.NAME} cannot "
            f"allocate more ({MOST_FIELDS} tables of rays and headings): create these in another process"
        )
    _fields[program] += 1

    def make() -> Any:
        if len(shape) == 1:
            field = ti.field(TYPES[kind], shape=shape[0])
        else:
            field = ti.Vector.field(shape[1], TYPES[kind], shape=shape[0])
        field.from_numpy(np.frombuffer(content, kind).reshape(shape).copy())
        return field

    return by_owner(program, make)
