"""Relevance of solids and lines for the cells of a house: small functions for the kernels in ``lists.py``.

A function may call something relevant that is not, but never the opposite: margins exceed rounding errors.
"""

import numpy as np

from vitruvius.sim.backends.blocks import CELL
from vitruvius.sim.backends.free.layout import (
    ACROSS,
    ACROSS_X,
    FIRST_LINE,
    FIRST_SOLID,
    ROW,
    SECTORS,
    SOLIDS,
)
from vitruvius.sim.backends.free.see import swing
from vitruvius.sim.backends.rays import MARGIN
from vitruvius.sim.config import Config
from vitruvius.sim.runtime import constants, ti


@ti.data_oriented
class Relevance:
    """Functions of a configuration. ``at`` is the place of a house's header in ``header``."""

    def __init__(self, config: Config) -> None:
        """Prepare the reach of the body, and the outermost rays of each sector of headings."""
        self.config = config
        self.within = max(config.body) / 2 + max(config.step, config.drive.travel) + MARGIN
        leftmost, rightmost = config.first_ray, config.first_ray - config.ray_spacing * (config.rays - 1)
        # Half a sector to either side, the errors of directions, and a tenth of a degree for rounding.
        half = 180 / SECTORS + swing(config) + 0.1
        # If the field of view is over half a turn, a line to the left of one edge may still be seen.
        self.narrow = leftmost - rightmost + 2 * half < 175
        left, right = (
            np.deg2rad(360 / SECTORS * np.arange(SECTORS) + angle)
            for angle in (leftmost + half, rightmost - half)
        )
        edges = np.column_stack([np.cos(left), -np.sin(left), np.cos(right), -np.sin(right)])
        self.sides = constants(edges.astype(np.float32))

    @ti.func
    def row(self, numbers: ti.template(), at):
        """Return a solid or a line."""
        return ti.Vector([numbers[at + part] for part in range(ROW)])

    @ti.func
    def corner(self, cell, k: ti.template()):
        """Return a corner of a cell (middle x, y, half a side)."""
        return ti.Vector(
            [
                cell[0] + ti.static(1 if k & 1 else -1) * cell[2],
                cell[1] + ti.static(1 if k & 2 else -1) * cell[2],
            ]
        )

    @ti.func
    def square(self, numbers: ti.template(), cells: ti.template(), c):
        """Return a cell (middle x, y, half a side), enlarged by a margin."""
        house = cells[3 * c]
        x = numbers[2 * house] + (ti.cast(cells[3 * c + 1], ti.f32) + 0.5) * CELL
        y = numbers[2 * house + 1] + (ti.cast(cells[3 * c + 2], ti.f32) + 0.5) * CELL
        return ti.Vector([x, y, 0.5 * CELL + MARGIN])

    @ti.func
    def near(self, solid, cell):
        """Return True if a body whose middle is in a cell may touch a solid in one step.

        Then no axis, of the cell or of the solid, separates the two.
        """
        x, y, u, v = cell[0] - solid[0], cell[1] - solid[1], ti.abs(solid[2]), ti.abs(solid[3])
        reach = cell[2] + ti.static(self.within)
        along, across = x * solid[2] + y * solid[3], y * solid[2] - x * solid[3]
        return (
            (ti.abs(along) < solid[4] + reach * (u + v))
            & (ti.abs(across) < solid[5] + reach * (u + v))
            & (ti.abs(x) < solid[4] * u + solid[5] * v + reach)
            & (ti.abs(y) < solid[4] * v + solid[5] * u + reach)
        )

    @ti.func
    def in_range(self, solid, cell):
        """Return 1 if a part of a solid may be in the range of an eye in a cell."""
        x, y, around = cell[0] - solid[0], cell[1] - solid[1], solid[4] + solid[5] + 2 * cell[2]
        return ti.cast(ti.sqrt(x * x + y * y) < around + ti.static(self.config.range), ti.i32)

    @ti.func
    def seen(
        self, numbers: ti.template(), header: ti.template(), nearby: ti.template(), here, at, line, cell
    ):
        """Return 1 if a part of a line may be visible from somewhere in a cell, at some heading.

        Whatever hides the line is nearer than the line, so it is one of the solids ``nearby``.
        """
        middle, way = ti.Vector([line[0], line[1]]), ti.Vector([line[2], line[3]])
        first, last = middle - line[4] * way, middle + line[4] * way
        x, y = cell[0] - line[0], cell[1] - line[1]
        # The nearest point of the line to the cell's middle, and the side of the line on which the cell is.
        past = ti.max(0.0, ti.abs(x * way[0] + y * way[1]) - line[4])
        side = x * way[1] - y * way[0]
        away = ti.sqrt(past * past + side * side) - ti.static(2**0.5) * cell[2]
        front = side + cell[2] * (ti.abs(way[0]) + ti.abs(way[1]))
        result = ti.cast((away < ti.static(self.config.range)) & ((line[5] < 0) | (front > -MARGIN)), ti.i32)
        word, words = 0, header[at + SOLIDS] // 32
        while (result == 1) & (word <= words):
            bits = nearby[here + word]
            solid = header[at + FIRST_SOLID] + 32 * ROW * word
            while (result == 1) & (bits != 0):
                if bits & 1:
                    result -= self.hides(self.row(numbers, solid), first, last, cell)
                bits = ti.bit_shr(bits, 1)
                solid += ROW
            word += 1
        return result

    @ti.func
    def hides(self, solid, first, last, cell):
        """Return 1 if the middle line of a solid is between all of a cell and all of a line (first, last).

        As either end of a sight line moves along an edge, the crossing with the middle line moves in one
        direction. So the corners decide.
        """
        beyond, hidden, sign = 1, 1, 0.0
        for k in ti.static(range(4)):
            x, y = self.corner(cell, k)[0] - solid[0], self.corner(cell, k)[1] - solid[1]
            away = y * solid[2] - x * solid[3]
            if ti.static(k == 0):
                sign = ti.select(away > 0, 1.0, -1.0)
            beyond &= ti.cast(sign * away > MARGIN, ti.i32)
        for end in ti.static((0, 1)):
            to = last if ti.static(end) else first
            x, y = to[0] - solid[0], to[1] - solid[1]
            beyond &= ti.cast(sign * (y * solid[2] - x * solid[3]) < -MARGIN, ti.i32)
        if beyond:
            for end in ti.static((0, 1)):
                to = last if ti.static(end) else first
                far_x, far_y = to[0] - solid[0], to[1] - solid[1]
                far, there = far_y * solid[2] - far_x * solid[3], far_x * solid[2] + far_y * solid[3]
                for k in ti.static(range(4)):
                    x, y = self.corner(cell, k)[0] - solid[0], self.corner(cell, k)[1] - solid[1]
                    away, here = y * solid[2] - x * solid[3], x * solid[2] + y * solid[3]
                    cross = here + away / (away - far) * (there - here)
                    hidden &= ti.cast(ti.abs(cross) < solid[4] - MARGIN, ti.i32)
        return hidden & beyond

    @ti.func
    def ahead(self, sector, line, cell):
        """Return 1 if a line may be in the field of view of an eye in a cell, at headings of a sector.

        Such a line is not completely to the left of the first ray, nor to the right of the last, from any
        corner.
        """
        result = 1
        if ti.static(self.narrow):
            edge, left_of, right_of = self.sides[sector], 1, 1
            for k in ti.static(range(8)):
                sign = ti.static(1.0 if k & 4 else -1.0)
                x = line[0] + sign * line[4] * line[2] - self.corner(cell, k & 3)[0]
                y = line[1] + sign * line[4] * line[3] - self.corner(cell, k & 3)[1]
                left_of &= ti.cast(edge[0] * y - edge[1] * x < -MARGIN, ti.i32)
                right_of &= ti.cast(edge[2] * y - edge[3] * x > MARGIN, ti.i32)
            result = 1 - (left_of | right_of)
        return result

    @ti.func
    def kind_of(self, header: ti.template(), at, k):
        """Return the kind of a line: across x (0), across y (1) or at an angle (2)."""
        return ti.cast(k >= header[at + ACROSS_X], ti.i32) + ti.cast(k >= header[at + ACROSS], ti.i32)

    @ti.func
    def solid(self, numbers: ti.template(), header: ti.template(), at, k):
        """Return a house's k-th solid."""
        return self.row(numbers, header[at + FIRST_SOLID] + ROW * k)

    @ti.func
    def line(self, numbers: ti.template(), header: ti.template(), at, k):
        """Return a house's k-th line."""
        return self.row(numbers, header[at + FIRST_LINE] + ROW * k)
