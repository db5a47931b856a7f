"""Shortest paths of a disc's centre among obstacles, in the backend ``free``: a visibility graph.

Each solid is widened by a distance, which gives a convex polygon. The free corners of the polygons are the
nodes of the graph. A shortest path is a sequence of straight lines between nodes. The polygon contains all
places where the disc would touch the solid, so a body that follows a path touches nothing. With ``cut``,
``sees`` cuts off the polygon's corners, so that the polygon is inside of these places: a body that stands
near a corner can continue.
"""

from functools import cache
from typing import Any, NamedTuple

import numpy as np

from vitruvius.sim.backends.blocks import HEADER
from vitruvius.sim.backends.body import SKIN
from vitruvius.sim.backends.free.contact import into
from vitruvius.sim.backends.free.layout import FIRST_SOLID, ROW, SOLIDS
from vitruvius.sim.geometry import Geometry
from vitruvius.sim.runtime import Array, Floats, Ints, Launch, kernel, start, ti
from vitruvius.sim.world.world import World

MAX_CORNERS = 4096
"""Largest number of corners of a house's graph, which takes 4 bytes for each pair."""

NO_PATH_M = 1e9
"""Length in metres that stands for "no path"."""


class Roads(NamedTuple):
    """Graphs of a bank, in arrays for kernels."""

    numbers: Floats
    indices: Ints
    corners: Floats
    """(x, y) of each corner, house by house."""
    firsts: Ints
    """(H + 1) index of the first corner of each house, then (H) index of its first length."""
    lengths: Floats
    """Length of the shortest path between each two corners of a house, in metres, or ``NO_PATH_M``."""


@ti.func
def crosses(solid, p, q, wide, cut: ti.template()):
    """Return 1 (i32) if a segment from p to q goes through a widened solid, and not along its side."""
    a = into(solid, p - ti.Vector([solid[0], solid[1]]))
    way = into(solid, q - p)
    near, far = ti.f32(0.0), ti.f32(1.0)
    x, y = solid[4] + wide, solid[5] + wide
    near, far = clipped(near, far, a[0], way[0], x)
    near, far = clipped(near, far, a[1], way[1], y)
    if ti.static(cut):
        near, far = clipped(near, far, a[0] + a[1], way[0] + way[1], x + solid[5])
        near, far = clipped(near, far, a[0] - a[1], way[0] - way[1], x + solid[5])
    return ti.cast(near < far, ti.i32)


@ti.func
def clipped(near, far, at, way, half):
    """Return the part of a segment within ``half`` of 0, as two fractions of the segment."""
    low, high = near, far
    if ti.abs(way) > 1e-9:
        one, other = (-half - at) / way, (half - at) / way
        low, high = ti.max(near, ti.min(one, other)), ti.min(far, ti.max(one, other))
    elif ti.abs(at) >= half:
        low = high
    return low, high


@ti.func
def sees(roads: ti.template(), house, p, q, wide, cut: ti.template()):
    """Return 1 (i32) if no widened solid of a house is between p and q."""
    header = house * HEADER
    at, left, free = roads.indices[header + FIRST_SOLID], roads.indices[header + SOLIDS], 1
    low, high = ti.min(p, q), ti.max(p, q)
    while left > 0:
        solid = ti.Vector([roads.numbers[at + part] for part in range(ROW)])
        reach = solid[4] * ti.abs(ti.Vector([solid[2], solid[3]])) + wide
        reach += solid[5] * ti.abs(ti.Vector([solid[3], solid[2]]))
        middle = ti.Vector([solid[0], solid[1]])
        if ((middle + reach > low) & (middle - reach < high)).all():  # noqa: SIM102 - Taichi does both
            if crosses(solid, p, q, wide, cut):
                free, left = 0, 0
        at, left = at + ROW, left - 1
    return free


@ti.func
def graph(roads: ti.template(), house):
    """Return the index of a house's first corner, the number of corners, and the index of its lengths."""
    houses = ti.cast((roads.firsts.shape[0] - 1) // 2, ti.i32)
    first = roads.firsts[house]
    return first, roads.firsts[house + 1] - first, roads.firsts[houses + 1 + house]


@ti.func
def point(values: ti.template(), k):
    """Return the k-th (x, y)."""
    return ti.Vector([values[2 * k], values[2 * k + 1]])


class Roadmap:
    """Visibility graphs of a world's bank, which must not change."""

    def __init__(self, world: World, wide: float) -> None:
        """Build the graphs, with all solids widened by ``wide`` metres.

        Raises ``ValueError`` for a house with more than ``MAX_CORNERS`` corners.
        """
        shapes = world.bank.geometries
        rows = solids_of(world)
        corners = [corners_of(each, shape, wide) for each, shape in zip(rows, shapes, strict=True)]
        counts = np.array([len(each) for each in corners])
        if counts.max() > MAX_CORNERS:
            house = int(counts.argmax())
            raise ValueError(
                f"house {house} of {len(counts)} has {counts[house]:,} corners at which paths can turn: at "
                f"most {MAX_CORNERS:,} are supported"
            )
        squares = np.cumsum([0, *counts**2])
        if squares[-1] >= 1 << 31:
            raise ValueError(f"{len(counts)} houses have too many corners for one graph: pass fewer at once")
        firsts = np.concatenate([np.cumsum([0, *counts]), squares[:-1]])
        self.most = int(counts.max())
        self.inside = wide - 2 * SKIN
        """Width in metres that is added to solids when visibility is tested. A path straight along a solid
        then passes it, however it is rounded."""
        self.arrays = {
            "numbers": world.bank.numbers,
            "indices": world.bank.indices,
            "corners": Array.of(np.concatenate(corners).astype(np.float32).ravel()),
            "firsts": Array.of(firsts.astype(np.int32)),
            "lengths": Array(ti.f32, int(squares[-1])),
        }
        houses = np.repeat(np.arange(len(counts)), counts).astype(np.int32)
        self._launch(0, {"houses": Array.of(houses)})
        self._launch(1, {})

    def _launch(self, which: int, more: dict[str, Array]) -> None:
        Launch(_kernels(start(), self.inside)[which], self.arrays | more)()


def solids_of(world: World) -> list[np.ndarray]:
    """Return the solids of each house of a bank, (n, 6) float64: see ``sim.backends.free.layout``."""
    numbers, indices = world.bank.numbers.numpy(), world.bank.indices.numpy()
    found = []
    for house in range(len(world.bank.geometries)):
        first, count = indices[house * HEADER + FIRST_SOLID], indices[house * HEADER + SOLIDS]
        found.append(numbers[first : first + ROW * count].reshape(-1, ROW).astype(float))
    return found


def corners_of(solids: np.ndarray, shape: Geometry, wide: float) -> np.ndarray:
    """Return the corners (n, 2) of widened solids that are in the house and outside all other solids."""
    middle, along, half = solids[:, :2], solids[:, 2:4], solids[:, 4:]
    across = np.column_stack([-along[:, 1], along[:, 0]])
    reach = half + wide
    corners = np.concatenate(
        [
            middle + east * reach[:, :1] * along + south * reach[:, 1:] * across
            for east in (-1, 1)
            for south in (-1, 1)
        ]
    )
    corners = corners[shape.holds(corners)]
    free = np.ones(len(corners), bool)
    for x, y, u, v, length, width in solids.tolist():
        away = corners - (x, y)
        own = np.abs(np.column_stack([away @ (u, v), away @ (-v, u)]))
        inner = wide - 2 * SKIN
        free &= ~(own < (length + inner, width + inner)).all(axis=1)
    return np.unique(corners[free].round(6), axis=0)


@cache
def _kernels(program: Any, wide: float) -> tuple[Any, Any]:
    """Return a kernel that finds the visible pairs of corners, and one that finds shortest paths."""

    @kernel
    def look(roads: Roads, houses: Ints):
        for a in range(houses.shape[0]):
            first, count, table = graph(roads, houses[a])
            for b in range(count):
                here, there = point(roads.corners, a), point(roads.corners, first + b)
                seen = sees(roads, houses[a], here, there, ti.static(wide), False)
                roads.lengths[table + (a - first) * count + b] = ti.select(
                    seen, (there - here).norm(), NO_PATH_M
                )

    @kernel
    def join(roads: Roads):
        for house in range((roads.firsts.shape[0] - 1) // 2):
            _, count, table = graph(roads, house)
            for k in range(count):  # Floyd and Warshall
                for a in range(count):
                    first = roads.lengths[table + a * count + k]
                    if first < NO_PATH_M:
                        for b in range(count):
                            at = table + a * count + b
                            by = first + roads.lengths[table + k * count + b]
                            roads.lengths[at] = ti.min(roads.lengths[at], by)

    return look, join
