"""Interface of a backend, which packs houses, and places and moves bodies and casts rays in them.

A pose is a place on a lattice through the body's first position. So a body's place depends on its steps but
not on their order, and poses can be counted. A pose has an ``origin`` (x, y) in metres, and a ``cell`` (i, j,
heading): i and j steps east and south of the origin, and heading times 45 degrees counter-clockwise from
east. Rewards, resets, targets and random numbers belong to the world.

A backend is created once for a configuration and holds no house. Houses are in banks, whose arrays are
arguments of the backend's functions. So another bank needs no compilation.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from vitruvius.logic import House
from vitruvius.sim.backends.body import Body
from vitruvius.sim.config import Config
from vitruvius.sim.geometry import Geometry
from vitruvius.sim.runtime import Array

WALL, PIECE, TARGET, DOOR = 1, 2, 3, 4
"""Kinds of things that a ray hits; 0 is nothing. Backends never return ``DOOR``: ``sim.backends.doors`` adds
closed doors. If kinds of furniture are distinguished, the first kind is ``NAMED``, the second ``NAMED + 1``,
and so on."""

NAMED = 16


@dataclass(frozen=True)
class Bank:
    """H houses, packed by a backend. Only that backend knows the layout of the two arrays."""

    geometries: list[Geometry]
    numbers: Array
    """(n,) float32."""
    indices: Array
    """(m,) int32."""


@dataclass(frozen=True)
class Lattice:
    """Places that a body reaches from one place: origin + pitch * (i, j), for i and j from ``first`` on."""

    origin: np.ndarray
    """(2,) float32, metres: the place (0, 0)."""
    pitch: float
    """Distance between neighbours along an axis, in metres: one ``forward``."""
    shape: tuple[int, int]
    """Number of places east and south."""
    first: tuple[int, int] = (0, 0)
    """Indices i and j of the place furthest north-west."""


def lattice_over(shape: Geometry, pitch: float, origin: np.ndarray | None) -> Lattice:
    """Return a lattice over a house, through ``origin``.

    By default the lattice begins half a pitch from the house's corner, so that no body is flush with a wall
    by construction.
    """
    west, north, east, south = shape.bounds
    corner = np.array([west, north])
    if origin is None:
        origin = (corner + pitch / 2).astype(np.float32)
    i, j = np.ceil((corner - origin) / pitch).astype(int).tolist()
    columns, rows = (np.floor((np.array([east, south]) - origin) / pitch).astype(int) + 1).tolist()
    return Lattice(origin, pitch, (columns - i, rows - j), (i, j))


class Backend(Protocol):
    """Motion and sight of bodies.

    ``stands``, ``move``, ``see`` and ``prefetch`` are ``ti.func``s. Their arguments are a bank's ``numbers``
    and ``indices``, and the number of a house in the bank.

    If bodies move continuously (``Config.drives``), an origin is the place of the body, and ``cell`` is its
    heading in radians. Then there is also ``drive(numbers, indices, house, origin, heading, speeds, action,
    shares)``, whose action is a number or the speeds of a command. It returns origin, heading, speeds and
    ``blocked``. ``move`` and ``stands`` are called only for places of lattices.
    """

    config: Config
    """The configuration for this backend; the lengths of body and step may be those of its houses."""
    body: Body
    """The body that the backend moves."""

    def __init__(self, config: Config, lanes: int) -> None:
        """Take a configuration from ``fit``, and the number of rays that are cast together."""
        ...

    @staticmethod
    def fit(config: Config, houses: Sequence[House]) -> Config:
        """Return the configuration for these houses.

        Raises ``ValueError`` for houses that the backend does not support.
        """
        ...

    def pack(self, houses: Sequence[House]) -> Bank:
        """Copy houses to the device."""
        ...

    def lattice(self, shape: Geometry, origin: np.ndarray | None = None) -> Lattice:
        """Return a lattice over a house, through ``origin``; by default the lattice of starts and targets."""
        ...

    def place(self, bank: Bank, house: np.ndarray, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return poses (E, 3) (x, y, heading in radians) as origins (E, 2) float32 and cells (E, 3) int32.

        For bodies that drive, the cells are headings (E,) float32 in radians.
        """
        ...

    def stands(self, numbers: Any, indices: Any, house: Any, origin: Any, cell: Any) -> Any:
        """Return 1 if a body can be at a cell (i32), else 0."""
        ...

    def move(self, numbers: Any, indices: Any, house: Any, origin: Any, cell: Any, action: Any) -> Any:
        """Return the cell that an action leads to, and 1 if something is in the way (i32)."""
        ...

    def see(
        self, numbers: Any, indices: Any, house: Any, origin: Any, cell: Any, target: Any, ray: Any
    ) -> Any:
        """Return the distances of ``lanes`` rays, from number ``ray`` on, and what they hit (u32).

        Distances are in metres; a ray that hits nothing has the range. The target is at (x, y).
        """
        ...

    def prefetch(self, numbers: Any, indices: Any, house: Any, origin: Any, cell: Any) -> Any:
        """Read some of the values that a look from a cell reads, so that they are in the cache for the look.

        The returned number (i32) has no meaning. A backend that gains nothing returns 0.
        """
        ...


METHODS = tuple(name for name in vars(Backend) if not name.startswith("_"))
"""Methods that a backend must have."""
