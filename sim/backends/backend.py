"""The interface of a backend: it packs houses, and places, moves and sees in them.

A pose is a place on a lattice through the body's first position, so that where a body is depends on the
steps it made and not on their order, and poses can be counted: ``origin`` (x, y) in metres, and ``cell``
(i, j, heading): i and j steps east and south of the origin, heading times 45 degrees counter-clockwise
from east. Rewards, resets, targets and random numbers belong to the world.

A backend is made once for a configuration and holds no house: those are in banks, whose arrays its functions
are given. So another bank needs no compilation.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from logic import House
from sim.backends.body import Body
from sim.config import Config
from sim.geometry import Geometry
from sim.runtime import Array

WALL, PIECE, TARGET, DOOR = 1, 2, 3, 4
"""What a ray hits; 0 is nothing. No backend hits a door, a closed one: ``doors``. Where kinds of pieces
are told apart, a piece of the first of them is ``NAMED``, and so on."""

NAMED = 16


@dataclass(frozen=True)
class Bank:
    """H houses as a backend has packed them: only that backend knows what the two arrays hold."""

    geometries: list[Geometry]
    numbers: Array
    """(n,) float32."""
    indices: Array
    """(m,) int32."""


@dataclass(frozen=True)
class Lattice:
    """The places that a body reaches from one of them: origin + pitch * (i, j) for i and j from ``first``."""

    origin: np.ndarray
    """(2,) float32, metres: the place (0, 0)."""
    pitch: float
    """Metres between neighbours: what ``forward`` goes along an axis."""
    shape: tuple[int, int]
    """Places east and south."""
    first: tuple[int, int] = (0, 0)
    """The i and j of the place furthest north-west."""


def lattice_over(shape: Geometry, pitch: float, origin: np.ndarray | None) -> Lattice:
    """A lattice over a house, through ``origin``; without one half a pitch off its corner, so that no body is
    flush by construction.
    """
    west, north, east, south = shape.bounds
    corner = np.array([west, north])
    if origin is None:
        origin = (corner + pitch / 2).astype(np.float32)
    i, j = np.ceil((corner - origin) / pitch).astype(int).tolist()
    columns, rows = (np.floor((np.array([east, south]) - origin) / pitch).astype(int) + 1).tolist()
    return Lattice(origin, pitch, (columns - i, rows - j), (i, j))


class Backend(Protocol):
    """Motion and sight: ``stands``, ``move``, ``see`` and ``prefetch`` are ``ti.func``s, which get a bank's
    ``numbers`` and ``indices`` and the number of a house in it.

    Where bodies move freely (``Config.drives``) there is also ``drive``, with the arguments of ``move``, but
    an action of 64 bits, a number or v and w as float32: it gives an origin, a cell and ``blocked``. Then
    ``move`` and ``stands`` are asked about places of lattices alone, and what an origin and a cell are while
    a body drives is the backend's own.
    """

    config: Config
    """The configuration as this backend has it: the lengths of body and step may be those of its houses."""
    body: Body
    """The body that it moves."""

    def __init__(self, config: Config, lanes: int) -> None:
        """For a configuration from ``fit``, with ``lanes`` rays in a look."""
        ...

    @staticmethod
    def fit(config: Config, houses: Sequence[House]) -> Config:
        """The configuration for these houses; ``ValueError`` where the backend cannot take them."""
        ...

    def pack(self, houses: Sequence[House]) -> Bank:
        """Bring houses to the device."""
        ...

    def lattice(self, shape: Geometry, origin: np.ndarray | None = None) -> Lattice:
        """A lattice over a house, through ``origin`` or where the house's starts and targets lie."""
        ...

    def place(self, bank: Bank, house: np.ndarray, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Poses (E, 3) (x, y, heading in radians) as origins (E, 2) float32 and cells (E, 3) int32.

        Raises ``ValueError`` for a pose that the backend does not allow.
        """
        ...

    def stands(self, numbers: Any, indices: Any, house: Any, origin: Any, cell: Any) -> Any:
        """Whether a body can be at a cell (i32)."""
        ...

    def move(self, numbers: Any, indices: Any, house: Any, origin: Any, cell: Any, action: Any) -> Any:
        """The cell that an action leads to, and whether something is in the way (i32)."""
        ...

    def see(
        self, numbers: Any, indices: Any, house: Any, origin: Any, cell: Any, target: Any, ray: Any
    ) -> Any:
        """For ``lanes`` rays from number ``ray`` on, the distances (metres, the range where nothing is hit)
        and what they hit (u32), with the target at (x, y).
        """
        ...

    def prefetch(self, numbers: Any, indices: Any, house: Any, origin: Any, cell: Any) -> Any:
        """Read some of what a look from a cell reads, so that it is in the cache when it is read again: any
        number (i32). A backend that gains nothing by it returns 0.
        """
        ...


METHODS = tuple(name for name in vars(Backend) if not name.startswith("_"))
"""What a backend must have."""
