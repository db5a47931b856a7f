"""The simulator's geometry told a second time, in plain terms and float64: the oracle of rays and moves.

It shares nothing with ``sim``: walls by shapely's set operations, rays by cross products, moves by the
convex hull of what the body sweeps. Where it is too close to say, it says so.
"""

from collections.abc import Iterable
from itertools import pairwise

import numpy as np
import shapely
from shapely import box

from logic import House

CLOSE = 1e-4
"""Metres: what passes an edge nearer than this could be told either way in float32."""


class Reference:
    """A house's walls and pieces."""

    def __init__(self, house: House) -> None:
        """Prepare them; ``joints`` (n, 2) are the places where two lines end."""
        pieces = [box(*piece.box) for room in house.rooms for piece in room.pieces]
        self.walls = walls(house)
        self.solid = shapely.GeometryCollection([self.walls, *pieces])
        shapely.prepare(self.solid)
        outlines = [self.walls, *(piece.boundary for piece in pieces)]
        lines = [pair for line in shapely.get_parts(outlines) for pair in pairwise(np.array(line.coords))]
        ends, count = np.unique(np.round(lines, 9).reshape(-1, 2), axis=0, return_counts=True)
        self.joints = ends[count >= 2]

    def in_the_way(self, old: np.ndarray, new: np.ndarray, side: float) -> bool | None:
        """Whether a square that slides from one centre to another meets something; None if that is close."""
        squares = [box(x - side / 2, y - side / 2, x + side / 2, y + side / 2) for x, y in (old, new)]
        swept = shapely.union_all(squares).convex_hull
        if self.solid.intersects(swept.buffer(-CLOSE, join_style="mitre")):
            return True
        return None if self.solid.intersects(swept.buffer(CLOSE, join_style="mitre")) else False

    def is_free(self, place: np.ndarray, side: float) -> bool:
        """Whether a square is surely clear of everything."""
        return self.in_the_way(place, place, side) is False


def walls(house: House) -> shapely.Geometry:
    """All walls as lines: rooms' boundaries without their doors, and the main room's where no room is."""
    # Doors and covers are a little wide, so that rounding leaves no splinter of a wall.
    parts = [box(*room.box).boundary.difference(box(*room.door.box).buffer(1e-9)) for room in house.rooms]
    covered = shapely.union_all([box(*room.box).buffer(1e-7, join_style="mitre") for room in house.rooms])
    return shapely.union_all([*parts, box(*house.floor.box).boundary.difference(covered)])


def sides(boxes: Iterable[np.ndarray]) -> np.ndarray:
    """The sides (S, 2, 2) of boxes (west, north, east, south); a flat box has one."""
    lines = []
    for west, north, east, south in boxes:
        flat = west == east or north == south
        ring = [(west, north), (east, north), (east, south), (west, south), (west, north)]
        lines += [(ring[0], ring[2])] if flat else pairwise(ring)
    return np.array(lines, float)


def cast(lines: np.ndarray, eye: np.ndarray, angle: np.ndarray, slack: float = 0.0) -> np.ndarray:
    """How far rays at ``angle`` (R,) radians, counter-clockwise as seen, go to the first of the lines
    (S, 2, 2), each longer by ``slack`` at both ends; infinite where there is none.
    """
    way = np.column_stack([np.cos(angle), -np.sin(angle)])[:, None]
    start, along = lines[None, :, 0] - eye, lines[None, :, 1] - lines[None, :, 0]
    more = slack / np.hypot(along[..., 0], along[..., 1])
    turn = way[..., 0] * along[..., 1] - way[..., 1] * along[..., 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (start[..., 0] * along[..., 1] - start[..., 1] * along[..., 0]) / turn
        u = (start[..., 0] * way[..., 1] - start[..., 1] * way[..., 0]) / turn
    hit = (turn != 0) & (t >= 0) & (u >= -more) & (u <= 1 + more)
    return np.where(hit, t, np.inf).min(axis=1)
