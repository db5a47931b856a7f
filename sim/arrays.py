"""Rows of the table of arrays, and records of arrays for kernels.

``sim.world.arrays`` has the table. Overlays have rows of their own (``sim.backends.overlay``).
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from types import FunctionType
from typing import Any, NamedTuple

from vitruvius.sim.runtime import Array, element, ti

Of = Callable[[Any], Any]
"""Function of a ``sim.world.kind.WorldKind``."""


@dataclass(frozen=True)
class ArrayRow:
    """An array of a world."""

    name: str

    kind: Any
    """Type of its numbers, or a function of the kind of a world that returns the type."""

    shape: tuple[str | int, ...]
    """Sizes whose product is the number of elements. A letter is a key of ``sim.world.arrays.SIZES``; ``n``
    is a length that depends on the houses."""

    width: int | str = 1
    """Number of components of an element: 1 for a number, more for a short vector."""

    meaning: str = ""

    unit: str = ""

    written: str = ""
    """Writers of the array."""

    read: str = ""
    """Readers of the array."""

    asked: Of = lambda kind: True
    """True for the kinds of worlds that have the array. Fewer arrays make each launch faster."""

    saved: bool = False
    """True if a saved state has the array."""

    def type_of(self, kind: Any) -> Any:
        """Return the compiler's type of the numbers."""
        return self.kind(kind) if isinstance(self.kind, FunctionType) else self.kind

    def width_of(self, sizes: Mapping[str, int]) -> int:
        """Return the number of components of an element."""
        return sizes[self.width] if isinstance(self.width, str) else self.width

    def array(self, kind: Any, sizes: Mapping[str, int]) -> Array:
        """Return the array, initially zero."""
        length = 1
        for size in self.shape:
            length *= sizes[size] if isinstance(size, str) else size
        return Array(self.type_of(kind), length, self.width_of(sizes))


@cache
def annotation(kind: Any, width: int) -> Any:
    """Return the annotation of a kernel's array: one object for equal arrays, so that records are equal."""
    return ti.types.ndarray(element(kind, width), 1)


@cache
def _record(names: tuple[str, ...], annotations: tuple[Any, ...], state: Any) -> Any:
    made: Any = NamedTuple("Arrays", list(zip(names, annotations, strict=True)))  # pyright: ignore
    made.State = state
    return made


def record(rows: Iterable[ArrayRow], kind: Any, sizes: Mapping[str, int], state: Any) -> Any:
    """Return a record type with the arrays of some rows, for ``sim.tracing.kernel``.

    Its attribute ``State`` is the type of the states that the arrays hold.
    """
    rows = tuple(rows)
    kinds = tuple(annotation(row.type_of(kind), row.width_of(sizes)) for row in rows)
    return _record(tuple(row.name for row in rows), kinds, state)
