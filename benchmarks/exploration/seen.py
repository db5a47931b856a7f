"""Area of a map that bodies have seen, and the shortest paths over the cells that they know to be free.

Many beams of a laser are marched through the cells of the true map, from cell to cell. Free cells are seen,
and so is the first cell that is not free, which ends the beam.
"""

# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false

from functools import cache
from typing import Any

import numpy as np

from vitruvius.logic.house.occupancy import FREE, OccupancyGrid
from vitruvius.sim.actions import HEADINGS
from vitruvius.sim.backends.backend import Lattice
from vitruvius.sim.runtime import Array, Bytes, Floats, Ints, Launch, kernel, start, ti

UNSEEN, OPEN, SHUT = range(3)
"""States of a cell."""

BEGUN = 9
"""Mark of the cell where a search begins; other cells have the heading of the search there, from 1 on."""

AIR = 1e-4
"""Width in metres that is added to each side of a body, because a touched obstacle stops it."""


class Seen:
    """Maps that E bodies make of one true map."""

    def __init__(
        self,
        grid: OccupancyGrid,
        lattice: Lattice,
        body: float,
        bodies: int,
        beams: int,
        field: float,
        reach: float,
    ) -> None:
        """Prepare maps for bodies with a side of ``body`` metres, whose middles are on a ``lattice``.

        ``beams``: number of beams over a ``field`` of view in radians. ``reach``: length of a beam in metres.
        """
        rows, columns = grid.shape
        self.grid, self.bodies, self.shape = grid, bodies, (rows, columns)
        self.origin, self.pitch = np.array(lattice.origin, float), lattice.pitch
        corner, step = self.cells(self.origin[None])[0], lattice.pitch / grid.cell
        half = (body / 2 + AIR) / grid.cell
        free = (grid.values == FREE).astype(np.uint8)
        self.nodes = lattice.shape
        self.arrays = {
            "free": Array.of(free.ravel()),
            "known": Array(ti.u8, bodies * rows * columns),
            "goals": Array(ti.u8, bodies * rows * columns),
            "places": Array(ti.f32, bodies * 3),
            "chosen": Array(ti.i32, bodies),
            "came": Array(ti.u8, bodies * lattice.shape[0] * lattice.shape[1]),
            "queue": Array(ti.i32, bodies * lattice.shape[0] * lattice.shape[1]),
            "found": Array(ti.i32, bodies),
            "sizes": Array.of(np.array([rows, columns, beams, *lattice.shape], np.int32)),
            "lengths": Array.of(np.array([field, reach / grid.cell, *corner, step, half], np.float32)),
        }
        look, spread = _kernels(start())
        self._look, self._spread = Launch(look, self.arrays), Launch(spread, self.arrays)

    @property
    def known(self) -> np.ndarray:
        """State of each cell (E, H, W): ``UNSEEN``, ``OPEN`` or ``SHUT``, as a view of the memory."""
        return self.arrays["known"].view().reshape(self.bodies, *self.shape)

    def cells(self, places: np.ndarray) -> np.ndarray:
        """Return places (n, 2) in metres as cells (column, row), with fractions."""
        return (places - (self.grid.x, self.grid.y)) / self.grid.cell

    def look(self, poses: np.ndarray, chosen: np.ndarray) -> None:
        """Look from poses (E, 3), for the bodies that are ``chosen`` (E,) bool."""
        self._place(np.column_stack([self.cells(poses[:, :2]), poses[:, 2]]), chosen)
        self._look()

    def ways(self, poses: np.ndarray, goals: np.ndarray, chosen: np.ndarray) -> list[list[int]]:
        """Return the headings of a shortest path from each chosen body to its ``goals`` (E, H, W) bool.

        A path leads over cells that are known to be free, and ends when the body's middle is in a goal.
        Without a path the list is empty.
        """
        self.arrays["goals"].view()[:] = goals.ravel()
        nodes = np.round((poses[:, :2] - self.origin) / self.pitch)
        self._place(np.column_stack([nodes, np.zeros(len(poses))]), chosen)
        self._spread()
        came = self.arrays["came"].view().reshape(self.bodies, *self.nodes)
        found, ways = self.arrays["found"].view(), []
        for e in range(self.bodies):
            way, node = [], int(found[e]) if chosen[e] else -1
            while node >= 0 and (heading := int(came[e].flat[node]) - 1) < 8:
                way.append(heading)
                east, south = HEADINGS[heading]
                node -= east * self.nodes[1] + south
            ways.append(way[::-1])
        return ways

    def _place(self, places: np.ndarray, chosen: np.ndarray) -> None:
        self.arrays["places"].view()[:] = places.astype(np.float32).ravel()
        self.arrays["chosen"].view()[:] = chosen


@cache
def _kernels(program: Any) -> tuple[Any, Any]:
    """Return the kernel that looks, and the kernel that searches from the bodies over the passable cells."""

    @kernel
    def look(free: Bytes, known: Bytes, places: Floats, chosen: Ints, sizes: Ints, lengths: Floats):
        for e in range(chosen.shape[0]):
            if chosen[e]:
                rows, columns, beams = sizes[0], sizes[1], sizes[2]
                x, y, heading = places[3 * e], places[3 * e + 1], places[3 * e + 2]
                for beam in range(beams):
                    angle = heading + lengths[0] * ((ti.cast(beam, ti.f32) + 0.5) / beams - 0.5)
                    east, south = ti.cos(angle), -ti.sin(angle)
                    column, row = ti.cast(ti.floor(x), ti.i32), ti.cast(ti.floor(y), ti.i32)
                    step_x, step_y = ti.select(east > 0, 1, -1), ti.select(south > 0, 1, -1)
                    over_x, over_y = 1.0 / ti.max(ti.abs(east), 1e-9), 1.0 / ti.max(ti.abs(south), 1e-9)
                    next_x = (ti.select(east > 0, column + 1.0 - x, x - column)) * over_x
                    next_y = (ti.select(south > 0, row + 1.0 - y, y - row)) * over_y
                    far, going = ti.f32(0.0), 1
                    while going and far < lengths[1]:
                        going = ti.cast(0 <= column < columns and 0 <= row < rows, ti.i32)
                        if going:
                            cell = row * columns + column
                            known[e * rows * columns + cell] = ti.cast(2 - free[cell], ti.u8)
                            going = ti.cast(free[cell], ti.i32)
                        if next_x < next_y:
                            far, column, next_x = next_x, column + step_x, next_x + over_x
                        else:
                            far, row, next_y = next_y, row + step_y, next_y + over_y

    @ti.func
    def stands(known: ti.template(), sizes: ti.template(), lengths: ti.template(), e, i, j):
        """Return True if all cells that a body at a place of the lattice touches are known to be free."""
        rows, columns = sizes[0], sizes[1]
        x, y = lengths[2] + lengths[4] * i, lengths[3] + lengths[4] * j
        free = ti.cast(0 <= i < sizes[3] and 0 <= j < sizes[4], ti.i32)
        if free:
            west, east = ti.cast(ti.floor(x - lengths[5]), ti.i32), ti.cast(ti.floor(x + lengths[5]), ti.i32)
            north, south = (
                ti.cast(ti.floor(y - lengths[5]), ti.i32),
                ti.cast(ti.floor(y + lengths[5]), ti.i32),
            )
            free = ti.cast(west >= 0 and north >= 0 and east < columns and south < rows, ti.i32)
            if free:
                for row in range(north, south + 1):
                    for column in range(west, east + 1):
                        free &= ti.cast(known[e * rows * columns + row * columns + column] == OPEN, ti.i32)
        return free

    @kernel
    def spread(
        known: Bytes, goals: Bytes, places: Floats, chosen: Ints, came: Bytes, queue: Ints, found: Ints,
        sizes: Ints, lengths: Floats,
    ):  # fmt: skip
        for e in range(chosen.shape[0]):
            if chosen[e]:
                lines = sizes[4]
                base = e * sizes[3] * lines
                for k in range(sizes[3] * lines):
                    came[base + k] = ti.u8(0)
                first = ti.cast(places[3 * e], ti.i32) * lines + ti.cast(places[3 * e + 1], ti.i32)
                came[base + first], queue[base], found[e] = ti.u8(BEGUN), first, -1
                head, tail = 0, 1
                while head < tail:
                    node = queue[base + head]
                    head += 1
                    i, j = node // lines, node % lines
                    column = ti.cast(lengths[2] + lengths[4] * i, ti.i32)
                    row = ti.cast(lengths[3] + lengths[4] * j, ti.i32)
                    if goals[(e * sizes[0] + row) * sizes[1] + column]:
                        found[e], head = node, tail
                    else:
                        for heading in ti.static(range(8)):
                            east, south = ti.static(HEADINGS[heading][0]), ti.static(HEADINGS[heading][1])
                            there = base + node + east * lines + south
                            # Nested, because Taichi's ``and`` computes both sides.
                            if stands(known, sizes, lengths, e, i + east, j + south):  # noqa: SIM102
                                if came[there] == 0:
                                    open_ = 1
                                    if ti.static(heading % 2):
                                        open_ = stands(known, sizes, lengths, e, i + east, j) & stands(
                                            known, sizes, lengths, e, i, j + south
                                        )
                                    if open_:
                                        came[there] = ti.u8(heading + 1)
                                        queue[base + tail] = there - base
                                        tail += 1

    return look, spread
