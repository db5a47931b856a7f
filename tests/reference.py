"""Second implementation of the simulator's geometry, in plain terms and float64: reference of rays and moves.

It shares nothing with ``sim``. Walls come from shapely's set operations, rays from cross products, moves from
the convex hull of what the body sweeps. The reference states when a case is too close to decide.

``sights`` and ``stopped`` do the same for many rays and bodies at once, among a house's boxes as kernels have
them. The boxes are float32 numbers, so no difference comes from rounded inputs.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from shapely import box

from tests.thick import faces
from vitruvius.logic import House
from vitruvius.sim.geometry import Geometry

CLOSE = 1e-4
"""Distance to an edge, in metres, below which float32 may decide either way."""

OVERLAP = 2e-5
"""Extension of lines beyond their ends for rays, in metres, as the simulator states it."""

SKIN = 1e-5
"""Depth, in metres, that a body must reach into an obstacle to be stopped, as the simulator states it."""

ROUNDING = 5e-6
"""Bound, in metres, on how far float32 can shift a ray at a line's end, or a body at a box."""

WALL, PIECE, DOOR, TARGET = 1, 2, 4, 3
"""Kinds of hits, in the order in which hits at one distance count; 0 is no hit."""


class Reference:
    """Walls and furniture of a house."""

    def __init__(self, house: House) -> None:
        """Prepare the walls and furniture; ``joints`` (n, 2) are the places where two lines end."""
        pieces = [box(*piece.box) for room in house.rooms for piece in room.pieces]
        self.walls = walls(house)
        self.solid = shapely.GeometryCollection([self.walls, *pieces])
        shapely.prepare(self.solid)
        outlines = [self.walls, *(piece.boundary for piece in pieces)]
        lines = [pair for line in shapely.get_parts(outlines) for pair in pairwise(np.array(line.coords))]
        ends, count = np.unique(np.round(lines, 9).reshape(-1, 2), axis=0, return_counts=True)
        self.joints = ends[count >= 2]

    def in_the_way(self, old: np.ndarray, new: np.ndarray, side: float) -> bool | None:
        """Return True if a square that slides from one centre to another meets an obstacle; None if close."""
        squares = [box(x - side / 2, y - side / 2, x + side / 2, y + side / 2) for x, y in (old, new)]
        swept = shapely.union_all(squares).convex_hull
        if self.solid.intersects(swept.buffer(-CLOSE, join_style="mitre")):
            return True
        return None if self.solid.intersects(swept.buffer(CLOSE, join_style="mitre")) else False

    def is_free(self, place: np.ndarray, side: float) -> bool:
        """Return True if a square is surely clear of everything."""
        return self.in_the_way(place, place, side) is False


def walls(house: House) -> shapely.Geometry:
    """Return all walls as lines: rooms' boundaries without the doors between them.

    A star's main room has walls only where no room adjoins. Walls with a thickness are the edges of rooms and
    doorways.
    """
    if house.wall_thickness:
        return faces(house)
    # Doors and covers have a small width, so that rounding leaves no fragment of a wall.
    if not house.main_room:
        doors = [box(*door.box).buffer(1e-9) for door in house.doors if "outside" not in door.between]
        outlines = [box(*room.box).boundary for room in house.rooms]
        return shapely.union_all(outlines).difference(shapely.union_all(doors))
    star = house.star
    parts = [box(*room.box).boundary.difference(box(*room.door.box).buffer(1e-9)) for room in star.rooms]
    covered = shapely.union_all([box(*room.box).buffer(1e-7, join_style="mitre") for room in star.rooms])
    return shapely.union_all([*parts, box(*star.floor.box).boundary.difference(covered)])


def sides(boxes: Iterable[np.ndarray]) -> np.ndarray:
    """Return the sides (S, 2, 2) of boxes (west, north, east, south); a flat box has one."""
    lines = []
    for west, north, east, south in boxes:
        flat = west == east or north == south
        ring = [(west, north), (east, north), (east, south), (west, south), (west, north)]
        lines += [(ring[0], ring[2])] if flat else pairwise(ring)
    return np.array(lines, float)


def cast(lines: np.ndarray, eye: np.ndarray, angle: np.ndarray, slack: float = 0.0) -> np.ndarray:
    """Return how far rays at ``angle`` (R,) radians go to the first of the lines (S, 2, 2).

    Angles are counter-clockwise as seen. Each line is longer by ``slack`` at both ends. The distance is
    infinite without a hit.
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
    """Walls (W, 4), furniture (P, 4) and closed doors (D, 4) of a house, as kernels have them.

    A box is (west, north, east, south).
    """

    walls: np.ndarray
    pieces: np.ndarray
    doors: np.ndarray

    @classmethod
    def of(cls, shape: Geometry, closed: np.ndarray | None = None) -> "Boxes":
        """Return boxes rounded to float32 and kept in float64.

        ``closed`` (D,) bool marks the closed doors, by default none.
        """
        doors = shape.doors[np.zeros(len(shape.doors), bool) if closed is None else closed]
        rows = np.concatenate([shape.solids, doors])
        boxes = np.hstack([rows[:, :2] - rows[:, 2:], rows[:, :2] + rows[:, 2:]])
        boxes = boxes.astype(np.float32).astype(float)
        count = len(shape.verticals) + len(shape.horizontals)
        last = len(shape.solids)
        return cls(boxes[:count], boxes[count:last], boxes[last:])

    @property
    def all(self) -> np.ndarray:
        """Walls, furniture and closed doors."""
        return np.concatenate([self.walls, self.pieces, self.doors])

    def clear(self, centre: np.ndarray, half: np.ndarray | float) -> np.ndarray:
        """Return a mask (N,) bool of squares round centres (N, 2) that are clear of all boxes by 1e-4 m."""
        reach, boxes = np.reshape(half, (-1, 1, 1)) + CLOSE, self.all
        low, high = centre[:, None] - reach, centre[:, None] + reach
        return ~np.all((low < boxes[:, 2:]) & (boxes[:, :2] < high), axis=2).any(axis=1)


def meetings(lines: np.ndarray, eye: np.ndarray, angle: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return the meetings of rays (N,) with lines, each ray from its own eye (N, 2); all are (N, S).

    The first is the distance, infinite behind the eye. The second is by how much the ray misses the line's
    ends, negative between them. The third is True if a box with the line as one of its ``sides`` is behind
    it. Lines are the same for all rays, (S, 2, 2), or each ray's own, (N, S, 2, 2).
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
    # A ray along a line does not meet it, but meets the lines across its ends.
    parallel = ~(np.abs(turn) < 1e12)
    return np.where((far < 0) | parallel, np.inf, far), miss, across < 0


def sights(
    boxes: Boxes, eye: np.ndarray, angle: np.ndarray, target: np.ndarray, side: float, reach: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return what rays (N,) from eyes (N, 2) see up to ``reach`` metres, each with its own target (N, 2).

    The result is distances and kinds, and masks of the distances and the kinds that are beyond doubt. A
    target is seen only from outside.
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
    # For each axis, meetings with the lines across it: walls, furniture, doors and targets.
    met = []
    for axis in (0, 1):
        for lines in kinds:
            one = lines if lines.ndim == 3 else lines[0]
            met.append(meetings(lines[..., one[:, 0, axis] == one[:, 1, axis], :, :], eye, angle))
        met[-4][2][:] = met[-2][2][:] = True  # a wall or a door has two faces
        met[-1][0][inside] = np.inf
    outcomes = []
    for slack, only_faces in ((OVERLAP - ROUNDING, True), (OVERLAP + ROUNDING, False)):
        # A ray that grazes a box's far corner meets a side that looks away: this side may count or not.
        nearest = np.array(
            [
                np.where((miss <= slack) & (face | (not only_faces)), far, np.inf).min(axis=1, initial=np.inf)
                for far, miss, face in met
            ]
        ).reshape(2, 4, -1)
        # For hits at one distance, and so on one line, the first kind counts.
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
    """Return masks (N,) bool of squares that a box stops between centres, and of sure cases.

    The test compares the intervals of time in which the square overlaps each box along x and along y.
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
