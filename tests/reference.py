"""The simulator's geometry written a second time, in plain terms and float64: the oracle of rays and moves.

It shares nothing with ``sim``: walls by shapely's set operations, rays by cross products, moves by the
convex hull of what the body sweeps. Where it is too close to say, it says so.

``sights`` and ``stopped`` do the same for many rays and bodies at once, among a house's boxes as kernels have
them: float32 numbers, so that no difference is the fault of rounded inputs.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from shapely import box

from logic import House
from sim.geometry import Geometry
from tests.thick import faces

CLOSE = 1e-4
"""Metres: what passes an edge nearer than this may be decided either way in float32."""

OVERLAP = 2e-5
"""Metres that lines reach beyond their ends for rays, as the simulator states it."""

SKIN = 1e-5
"""Metres that a body must reach into something to be stopped by it, as the simulator states it."""

ROUNDING = 5e-6
"""Metres: more than float32 can shift where a ray passes a line's end, or a body a box."""

WALL, PIECE, DOOR, TARGET = 1, 2, 4, 3
"""What a ray hits, in the order in which hits at one distance count; 0 is nothing."""


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
    """All walls as lines: rooms' boundaries without the doors between them, but a star's main room's only
    where no room is. Of walls with a thickness they are the edge of rooms and doorways.
    """
    if house.wall_thickness:
        return faces(house)
    # Doors and covers are a little wide, so that rounding leaves no splinter of a wall.
    if not house.main_room:
        doors = [box(*door.box).buffer(1e-9) for door in house.doors if "outside" not in door.between]
        outlines = [box(*room.box).boundary for room in house.rooms]
        return shapely.union_all(outlines).difference(shapely.union_all(doors))
    star = house.star
    parts = [box(*room.box).boundary.difference(box(*room.door.box).buffer(1e-9)) for room in star.rooms]
    covered = shapely.union_all([box(*room.box).buffer(1e-7, join_style="mitre") for room in star.rooms])
    return shapely.union_all([*parts, box(*star.floor.box).boundary.difference(covered)])


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


@dataclass(frozen=True)
class Boxes:
    """A house's walls (W, 4), pieces (P, 4) and closed doors (D, 4), (west, north, east, south), as kernels
    have them.
    """

    walls: np.ndarray
    pieces: np.ndarray
    doors: np.ndarray

    @classmethod
    def of(cls, shape: Geometry, closed: np.ndarray | None = None) -> "Boxes":
        """Rounded to float32 and kept in float64. ``closed`` (D,) bool: which doors are, by default none."""
        doors = shape.doors[np.zeros(len(shape.doors), bool) if closed is None else closed]
        rows = np.concatenate([shape.solids, doors])
        boxes = np.hstack([rows[:, :2] - rows[:, 2:], rows[:, :2] + rows[:, 2:]])
        boxes = boxes.astype(np.float32).astype(float)
        count = len(shape.verticals) + len(shape.horizontals)
        last = len(shape.solids)
        return cls(boxes[:count], boxes[count:last], boxes[last:])

    @property
    def all(self) -> np.ndarray:
        """Walls, pieces, closed doors."""
        return np.concatenate([self.walls, self.pieces, self.doors])

    def clear(self, centre: np.ndarray, half: np.ndarray | float) -> np.ndarray:
        """Whether squares round centres (N, 2) are clear of everything, by 1e-4 m. (N,) bool."""
        reach, boxes = np.reshape(half, (-1, 1, 1)) + CLOSE, self.all
        low, high = centre[:, None] - reach, centre[:, None] + reach
        return ~np.all((low < boxes[:, 2:]) & (boxes[:, :2] < high), axis=2).any(axis=1)


def meetings(lines: np.ndarray, eye: np.ndarray, angle: np.ndarray) -> tuple[np.ndarray, ...]:
    """How far rays (N,), each from its own eye (N, 2), go to each line, infinite if that is behind; by how
    much they miss its ends there, negative between them; whether a box that has it as one of its ``sides`` is
    behind it: (N, S) all. Lines are the same for all, (S, 2, 2), or each ray's own, (N, S, 2, 2).
    """
    way_x, way_y = np.cos(angle)[:, None], -np.sin(angle)[:, None]
    start_x, start_y = lines[..., 0, 0] - eye[:, :1], lines[..., 0, 1] - eye[:, 1:]
    along_x, along_y = np.moveaxis(lines[..., 1, :] - lines[..., 0, :], -1, 0)
    length = np.hypot(along_x, along_y)
    along_x, along_y = along_x / length, along_y / length
    with np.errstate(divide="ignore", invalid="ignore"):
        turn = 1 / (way_x * along_y - way_y * along_x)
        across = start_x * along_y - start_y * along_x
        far, past = across * turn, (start_x * way_y - start_y * way_x) * turn
        miss = np.abs(past - length / 2) - length / 2
    # Along a line no ray meets it; those across its ends do.
    parallel = ~(np.abs(turn) < 1e12)
    return np.where((far < 0) | parallel, np.inf, far), miss, across < 0


def sights(
    boxes: Boxes, eye: np.ndarray, angle: np.ndarray, target: np.ndarray, side: float, reach: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """What rays (N,) from eyes (N, 2) see up to ``reach`` metres, each with its own target (N, 2): distances
    and kinds, and which of the ones and of the others are beyond doubt. A target is seen from outside only.
    """
    half = np.float32(side / 2)
    goal = target.astype(np.float32)
    low, high = (goal - half).astype(float), (goal + half).astype(float)
    ring = [low, np.column_stack([high[:, 0], low[:, 1]]), high, np.column_stack([low[:, 0], high[:, 1]])]
    square = np.stack([np.stack(ring, axis=1), np.stack([*ring[1:], ring[0]], axis=1)], axis=2)
    kinds = (
        sides(boxes.walls),
        *(sides(some).reshape(-1, 2, 2) for some in (boxes.pieces, boxes.doors)),
        square,
    )
    inside = ~((low > eye) | (high < eye)).any(axis=1)
    # For each axis what is met of the lines across it, walls, pieces, doors and targets.
    met = []
    for axis in (0, 1):
        for lines in kinds:
            one = lines if lines.ndim == 3 else lines[0]
            met.append(meetings(lines[..., one[:, 0, axis] == one[:, 1, axis], :, :], eye, angle))
        met[-4][2][:] = met[-2][2][:] = True  # a wall or a door has two faces
        met[-1][0][inside] = np.inf
    outcomes = []
    for slack, only_faces in ((OVERLAP - ROUNDING, True), (OVERLAP + ROUNDING, False)):
        # A ray that grazes a box's far corner meets a side that looks away: it may count or not.
        nearest = np.array(
            [
                np.where((miss <= slack) & (face | (not only_faces)), far, np.inf).min(axis=1, initial=np.inf)
                for far, miss, face in met
            ]
        ).reshape(2, 4, -1)
        # Of hits at one distance, on one line that is, the first kind counts.
        first = nearest.min(axis=1)
        same = nearest <= first[:, None] + 1e-9
        kind = np.array([WALL, PIECE, DOOR, TARGET])[same.argmax(axis=1)]
        clear = (same | (nearest > first[:, None] + 1e-5)).all(axis=(0, 1))
        with np.errstate(invalid="ignore"):
            clear &= (np.abs(first[0] - first[1]) > 1e-5) | (kind[0] == kind[1])
        kind = np.where(first[0] <= first[1], *kind)
        first = first.min(axis=0)
        kind[first >= reach] = 0
        outcomes.append((np.minimum(first, reach), kind, clear & (np.abs(first - reach) > 1e-5)))
    (short, kind_short, _), (distance, kind, clear) = outcomes
    sure = np.abs(short - distance) < 1e-9
    return distance, kind, sure, sure & clear & (kind_short == kind)


def stopped(
    boxes: Boxes, old: np.ndarray, new: np.ndarray, half: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Whether squares that slide from centres (N, 2) to others are stopped by a box, and where that is beyond
    doubt: the way in time that the square overlaps each box along x, and along y, and whether they meet.
    """
    outcomes = []
    for skin in (SKIN - ROUNDING, SKIN + ROUNDING):
        enter, leave = np.zeros((len(old), len(boxes.all))), np.ones((len(old), len(boxes.all)))
        for axis in (0, 1):
            way, start = (new - old)[:, None, axis], old[:, None, axis]
            low = boxes.all[:, axis] - half[:, None] + skin
            high = boxes.all[:, axis + 2] + half[:, None] - skin
            with np.errstate(divide="ignore", invalid="ignore"):
                a, b = (low - start) / way, (high - start) / way
            still = np.abs(way) < 1e-12
            never = still & ((start <= low) | (start >= high))
            enter = np.maximum(enter, np.where(still, np.where(never, 2.0, 0.0), np.minimum(a, b)))
            leave = np.minimum(leave, np.where(still, 1.0, np.maximum(a, b)))
        outcomes.append((enter < leave).any(axis=1))
    return outcomes[1], outcomes[0] == outcomes[1]
