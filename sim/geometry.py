"""Geometry of a house for the simulator: boxes that stop rays and bodies, for any topology.

A wall between two rooms is a single wall, and the doors between rooms are cut out of it. Doors to the outside
are closed.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np

from vitruvius.logic import House

Box = tuple[float, float, float, float]
"""(west, north, east, south), metres."""

TOLERANCE = 1e-6
"""Largest distance between two lines that count as one line, in metres."""


@dataclass(frozen=True)
class Geometry:
    """A house as rows of (x, y, half width, half height): the centre of a box and half its sides, in metres.

    Walls are lines, so one half is zero. If walls have a thickness, these lines are their faces.
    Free-standing walls are lines or boxes, or ``slanted`` if they run at an angle. The original program's
    collision rule reads rooms and doors: in a star, the k-th door belongs to the k-th room.
    """

    verticals: np.ndarray
    """(V, 4) float64: walls that run north to south."""
    horizontals: np.ndarray
    """(H, 4) float64: walls that run west to east."""
    pieces: np.ndarray
    """(P, 4) float64: furniture and its children, solid."""
    blocks: np.ndarray
    """(B, 4) float64: free-standing walls along an axis that have a thickness, solid."""
    slanted: np.ndarray
    """(S, 6) float64: walls at an angle, as (x, y, east, south, half length, half thickness): the middle, and
    the unit vector along the wall."""
    rooms: np.ndarray
    """(R, 4) float64: all rooms except ``floor``; in a star, the secondary rooms."""
    doors: np.ndarray
    """(D, 4) float64: doors between rooms, without openings, as segments."""
    floor: np.ndarray
    """(4,) float64: the room in which bodies start; in a star, the main room's rectangle."""
    doorways: np.ndarray
    """(W, 4) float64: passages between rooms through walls that have a thickness."""
    filled: np.ndarray
    """(F, 4) float64: solid areas behind walls, such as the occupied cells of a map. Bodies cannot be there,
    and rays end at the walls."""
    overlapping: bool = False
    """True if rooms overlap the main room's rectangle, as in the original program's files."""

    @property
    def solids(self) -> np.ndarray:
        """All axis-aligned boxes that stop a body, (n, 4) float64.

        The order is: verticals, horizontals, pieces, blocks, filled.
        """
        return np.concatenate([self.verticals, self.horizontals, self.pieces, self.blocks, self.filled])

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Bounds of the whole house: (west, north, east, south), metres."""
        boxes = np.vstack([self.floor, self.rooms])
        west, north = (boxes[:, :2] - boxes[:, 2:]).min(axis=0)
        east, south = (boxes[:, :2] + boxes[:, 2:]).max(axis=0)
        return west, north, east, south

    def holds(self, places: np.ndarray) -> np.ndarray:
        """Return a mask (n,) bool of the places (n, 2) in a room or a doorway, or on its boundary."""
        boxes = np.vstack([self.floor, self.rooms, self.doorways])
        return np.all(np.abs(places[:, None] - boxes[:, :2]) <= boxes[:, 2:], axis=2).any(axis=1)


def geometry(house: House) -> Geometry:
    """Return the boxes of a house; ``geometry(house).solids`` are the boxes that stop rays and bodies."""
    verticals, horizontals = house.walls
    start, half = house.start, house.half_wall
    straight = [wall.box for wall in house.free_walls if wall.box]
    upright = [box for box in straight if box[0] == box[2]]
    level = [box for box in straight if box[1] == box[3]]
    return Geometry(
        verticals=_rows([*((x, low, x, high) for x, low, high in verticals), *upright]),
        horizontals=_rows([*((low, y, high, y) for y, low, high in horizontals), *level]),
        pieces=_rows(piece.box for room in house.rooms for piece in room.pieces),
        blocks=_rows(box for box in straight if box[0] < box[2] and box[1] < box[3]),
        slanted=np.array([wall.oriented for wall in house.free_walls if not wall.box]).reshape(-1, 6),
        rooms=_rows(room.box for room in house.rooms if room is not start),
        doors=_rows(shut(house, door) for door in house.doors if not (door.is_entrance or door.opening)),
        doorways=_rows(house.doorway(door) for door in house.doors if half and not door.is_entrance),
        filled=_rows(house.filled),
        floor=_rows([start.box])[0],
        overlapping=house.topology == "original",
    )


def shut(house: House, door: Any) -> Box:
    """Return the segment of a closed door, at the face of its wall in the first room that the door names."""
    if not house.half_wall:
        return door.box
    first = house.whole(next(room for name in door.between for room in house.rooms if room.name == name))
    axis, box = int(door.height == 0), [*door.box]
    middle = (box[1 - axis] + box[3 - axis]) / 2
    parts = [part.box for part in house.parts(first) if part.box[1 - axis] < middle < part.box[3 - axis]]
    faces = [face for part in parts or [first.box] for face in part[axis::2]]
    box[axis] = box[axis + 2] = min(faces, key=lambda face: abs(face - door.box[axis]))
    return box[0], box[1], box[2], box[3]


def require_straight(houses: Sequence[House], backend: str) -> None:
    """Raise ``ValueError`` for a house with a wall at an angle, which ``backend`` does not support."""
    for index, house in enumerate(houses):
        if any(not wall.box for wall in house.free_walls):
            where = f"house {index} of {len(houses)} has walls at an angle"
            raise ValueError(
                f"{where}: the {backend} backend needs walls along the axes: use the backend free"
            )


def _rows(boxes: Iterable[tuple[float, float, float, float]]) -> np.ndarray:
    """Return (west, north, east, south) boxes as (n, 4) rows of centres and half sides."""
    corners = np.array(list(boxes), np.float64).reshape(-1, 4)
    return np.hstack([corners[:, :2] + corners[:, 2:], corners[:, 2:] - corners[:, :2]]) / 2


MAX_COORDINATE_M = 512.0
"""Largest distance of a house from the origin, in metres. The rounding error of a float32 coordinate is 4e-6
m up to 128 m from the origin, and 8e-6 m up to 256 m. Up to 512 m it is 1.5e-5 m, more than the body's
skin."""


def check_lengths(houses: Sequence[House]) -> None:
    """Raise ``ValueError`` for a length that is not finite, negative, or too far from the origin.

    The check runs before any memory is allocated.
    """
    for index, house in enumerate(houses):
        rects: list[tuple[str, Any]] = []
        for room in sorted(house.rooms, key=lambda room: room.name != house.hub):
            rects.append(("the main room" if room.name == "main" else f"room {room.name}", room))
            rects += [(f"a {piece.type} in room {room.name}", piece) for piece in room.pieces]
        rects += [(f"the door of room {door.between[0]}", door) for door in house.doors]
        rects += [(f"wall {k}", wall.around) for k, wall in enumerate(house.free_walls)]
        for name, rect in rects:
            if not (isfinite(sum(rect.box)) and rect.width >= 0 and rect.height >= 0):
                raise ValueError(
                    f"house {index} of {len(houses)}: {name} is at ({rect.x}, {rect.y}), {rect.width} x "
                    f"{rect.height}: all must be finite numbers in metres, and no side negative"
                )
            if max(map(abs, rect.box)) > MAX_COORDINATE_M:
                at = f"house {index} of {len(houses)}: {name}"
                hint = ": House.from_grid centres a map there" if house.occupancy else ""
                raise ValueError(f"{at} extends more than {MAX_COORDINATE_M:.0f} m from the origin{hint}")
