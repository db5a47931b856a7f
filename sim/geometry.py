"""A house as the simulator meets it: boxes that stop rays and bodies.

Two conventions of files, one geometry: rooms may touch the main room from outside (ours) or overlap it (the
original's). In both, the walls are every room's boundary but for its door, and the main room's boundary
where no room covers it.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from logic import House
from logic.house import ORIGINAL

TOLERANCE = 1e-6
"""Metres: lines nearer than this are one line."""

Interval = tuple[float, float]


@dataclass(frozen=True)
class Geometry:
    """A house in rows of (x, y, half width, half height): a box's centre and half its sides, metres.

    Walls have no thickness, so one half is zero. The original's collision rule asks for rooms and doors.
    """

    verticals: np.ndarray
    """(V, 4) float64: walls that run north to south."""
    horizontals: np.ndarray
    """(H, 4) float64: walls that run west to east."""
    pieces: np.ndarray
    """(P, 4) float64: pieces of furniture and their children, solid."""
    rooms: np.ndarray
    """(R, 4) float64: the secondary rooms."""
    doors: np.ndarray
    """(R, 4) float64: each room's door, a segment."""
    floor: np.ndarray
    """(4,) float64: the main room's rectangle."""
    overlapping: bool = False
    """Whether rooms overlap the main room's rectangle, as in the original's files."""

    @property
    def solids(self) -> np.ndarray:
        """All that stops a body, (V + H + P, 4) float64: verticals, horizontals, pieces."""
        return np.concatenate([self.verticals, self.horizontals, self.pieces])

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """(west, north, east, south) of the whole house, metres."""
        boxes = np.vstack([self.floor, self.rooms])
        west, north = (boxes[:, :2] - boxes[:, 2:]).min(axis=0)
        east, south = (boxes[:, :2] + boxes[:, 2:]).max(axis=0)
        return west, north, east, south

    def holds(self, places: np.ndarray) -> np.ndarray:
        """Which of the places (n, 2) are in one of the rooms, or on its boundary: (n,) bool."""
        boxes = np.vstack([self.floor, self.rooms])
        return np.all(np.abs(places[:, None] - boxes[:, :2]) <= boxes[:, 2:], axis=2).any(axis=1)


def geometry(house: House) -> Geometry:
    """A house's boxes; ``geometry(house).solids`` is what stops rays and bodies."""
    verticals: list[tuple[float, Interval]] = []
    horizontals: list[tuple[float, Interval]] = []
    for room in house.rooms:
        west, north, east, south = room.box
        doorway_x, doorway_y, doorway_east, doorway_south = room.door.box
        door_x = min(west, east, key=lambda x: abs(x - doorway_x)) if room.door.width == 0 else None
        door_y = min(north, south, key=lambda y: abs(y - doorway_y)) if room.door.height == 0 else None
        for x in (west, east):
            gaps = [(doorway_y, doorway_south)] if x == door_x else []
            verticals += [(x, span) for span in _remaining((north, south), gaps)]
        for y in (north, south):
            gaps = [(doorway_x, doorway_east)] if y == door_y else []
            horizontals += [(y, span) for span in _remaining((west, east), gaps)]
    west, north, east, south = house.floor.box
    boxes = [room.box for room in house.rooms]
    for x in (west, east):
        covers = [(b[1], b[3]) for b in boxes if b[0] - TOLERANCE <= x <= b[2] + TOLERANCE]
        verticals += [(x, span) for span in _remaining((north, south), covers)]
    for y in (north, south):
        covers = [(b[0], b[2]) for b in boxes if b[1] - TOLERANCE <= y <= b[3] + TOLERANCE]
        horizontals += [(y, span) for span in _remaining((west, east), covers)]
    return Geometry(
        verticals=_rows((x, low, x, high) for x, (low, high) in verticals),
        horizontals=_rows((low, y, high, y) for y, (low, high) in horizontals),
        pieces=_rows(piece.box for room in house.rooms for piece in room.pieces),
        rooms=_rows(boxes),
        doors=_rows(room.door.box for room in house.rooms),
        floor=_rows([house.floor.box])[0],
        overlapping=house.format == ORIGINAL,
    )


def _remaining(span: Interval, gaps: Iterable[Interval]) -> list[Interval]:
    """What is left of a span when the gaps are cut out of it, in order."""
    low, high = span
    left = []
    for start, end in sorted(gaps):
        if start - low > TOLERANCE:
            left.append((low, min(start, high)))
        low = max(low, end)
        if low >= high:
            break
    if high - low > TOLERANCE:
        left.append((low, high))
    return left


def _rows(boxes: Iterable[tuple[float, float, float, float]]) -> np.ndarray:
    """(west, north, east, south) boxes as (n, 4) rows of centres and half sides."""
    corners = np.array(list(boxes), np.float64).reshape(-1, 4)
    return np.hstack([corners[:, :2] + corners[:, 2:], corners[:, 2:] - corners[:, :2]]) / 2
