# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false
"""What a world asks of a backend: to take in houses, and to place, move and see in them.

A pose is a place on a lattice through the body's first position, so that where a body is depends on the
steps it made and not on their order, and poses can be counted: ``origin`` (x, y) in metres, and ``cell``
(i, j, heading): i and j steps east and south of the origin, heading times 45 degrees counter-clockwise
from east. Rewards, resets, targets and random numbers belong to the world.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from logic import House
from sim.body import Body
from sim.geometry import Geometry

STRAIGHT, DIAGONAL = 1 << 8, 1 << 9
"""Bits of a survey: the body can be at this place with a heading along an axis, on a diagonal."""


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


class Backend(Protocol):
    """Motion and sight in a bank of houses; ``move`` and ``see`` are ``ti.func``s."""

    body: Body
    """The body that it moves."""

    def pack(self, houses: Sequence[House]) -> list[Geometry]:
        """Take in a bank of houses, H of them."""
        ...

    def lattice(self, house: int, origin: np.ndarray | None = None) -> Lattice:
        """A lattice over a house, through ``origin`` or where the house's starts and targets lie."""
        ...

    def survey(self, house: int, lattice: Lattice) -> np.ndarray:
        """What the body can do at each place: (X, Y) uint16, by the very arithmetic of ``move``.

        Bit h: ``forward`` at heading h is not blocked; bits 8 and 9: ``STRAIGHT`` and ``DIAGONAL``.
        """
        ...

    def place(self, house: np.ndarray, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Poses (E, 3) (x, y, heading in radians) as origins (E, 2) float32 and cells (E, 3) int32.

        Raises ``ValueError`` for a pose where the body cannot be, or that the backend does not have.
        """
        ...

    def move(self, house: Any, origin: Any, cell: Any, action: Any) -> Any:
        """The cell that an action leads to, and whether something is in the way (i32)."""
        ...

    def see(self, house: Any, origin: Any, cell: Any, target: Any) -> Any:
        """For each ray the distance of the nearest hit (metres, the range if none), and 1 where it is the
        target at (x, y), else 0.
        """
        ...
