"""Relevance of boxes and lines for the cells of a house: small functions for the kernels in ``lists.py``.

A function may call something relevant that is not, but never the opposite: margins exceed rounding errors.
"""

import numpy as np

from vitruvius.sim.backends.backend import PIECE
from vitruvius.sim.backends.blocks import CELL, COLUMNS, FIRST_CELL, HEADER
from vitruvius.sim.backends.continuous.layout import FIRST_BOX, FIRST_LINE, FIRST_PIECE, FLOOR, ROOMS
from vitruvius.sim.backends.rays import MARGIN
from vitruvius.sim.config import Config
from vitruvius.sim.runtime import constants, ti

LINES, ACROSS_X = HEADER, HEADER + 1
"""Indices of the numbers of all lines and of those across x, after the header of a house."""

EACH = HEADER + 2
"""Number of integers of a house in ``houses``."""


@ti.data_oriented
class Relevance:
    """Functions of a configuration. ``at`` is the place of a house's header in ``houses``."""

    def __init__(self, config: Config) -> None:
        """Prepare the reach of the body, and the outermost rays at each heading."""
        self.config, self.body = config, max(config.body)
        self.within = self.body + config.step + MARGIN
        left, right = (
            np.deg2rad(45 * np.arange(8) + angle)
            for angle in (config.first_ray, config.first_ray - config.ray_spacing * (config.rays - 1))
        )
        # If the field of view is over half a turn, a line to the left of one edge may still be seen.
        self.narrow = config.ray_spacing * (config.rays - 1) < 175
        edges = np.column_stack([np.cos(left), -np.sin(left), np.cos(right), -np.sin(right)])
        self.sides = constants(edges.astype(np.float32))

    @ti.func
    def square(self, numbers: ti.template(), houses: ti.template(), owner: ti.template(), c):
        """Return the header of a cell's house, and the cell (west, north, east, south) with a margin."""
        house = owner[c]
        at = house * EACH
        k = c - (houses[at + FIRST_CELL] - houses[FIRST_CELL])
        y, x = k // houses[at + COLUMNS], k % houses[at + COLUMNS]
        west = numbers[2 * house] + ti.cast(x, ti.f32) * CELL
        north = numbers[2 * house + 1] + ti.cast(y, ti.f32) * CELL
        return at, ti.Vector([west - MARGIN, north - MARGIN, west + CELL + MARGIN, north + CELL + MARGIN])

    @ti.func
    def indoors(self, numbers: ti.template(), houses: ti.template(), at, cell):
        """Return 1 if an eye in a cell may belong to a body that is in a room, or half in it."""
        x, y = 0.5 * (cell[0] + cell[2]), 0.5 * (cell[1] + cell[3])
        half, found = 0.5 * (cell[2] - cell[0]) + ti.static(self.body), 0
        for k in range(houses[at + ROOMS] + 1):
            room = houses[at + FLOOR] + 8 * k
            across_x = ti.abs(x - numbers[room]) < numbers[room + 2] + half
            across_y = ti.abs(y - numbers[room + 1]) < numbers[room + 3] + half
            found |= ti.cast(across_x & across_y, ti.i32)
        return found

    @ti.func
    def near(self, numbers: ti.template(), box, cell):
        """Return True if a body whose centre is in a cell may touch a box by one action."""
        west, north, east, south = numbers[box], numbers[box + 1], numbers[box + 2], numbers[box + 3]
        return (
            (west - ti.static(self.within) < cell[2])
            & (cell[0] < east + ti.static(self.within))
            & (north - ti.static(self.within) < cell[3])
            & (cell[1] < south + ti.static(self.within))
        )

    @ti.func
    def in_range(self, numbers: ti.template(), box, cell):
        """Return 1 if a part of a box is in the range of an eye in a cell."""
        x = ti.max(0.0, ti.max(numbers[box] - cell[2], cell[0] - numbers[box + 2]))
        y = ti.max(0.0, ti.max(numbers[box + 1] - cell[3], cell[1] - numbers[box + 3]))
        return ti.cast(x * x + y * y < ti.static((self.config.range + MARGIN) ** 2), ti.i32)

    @ti.func
    def seen(
        self,
        numbers: ti.template(),
        houses: ti.template(),
        nearby: ti.template(),
        here,
        at,
        k,
        line,
        axis,
        cell,
    ):
        """Return 1 if a part of a line may be visible from somewhere in a cell, at some heading.

        Whatever hides the line is nearer than the line, so it is one of the walls ``nearby``.
        """
        kind = numbers[k + 3]
        low, high = cell[0], cell[2]
        side_0, side_1 = cell[1], cell[3]
        if axis == 1:
            low, high, side_0, side_1 = cell[1], cell[3], cell[0], cell[2]
        faces = not ((kind <= -PIECE) & (low > line[0]) | (kind >= PIECE) & (high < line[0]))
        ahead = ti.max(0.0, ti.max(low - line[0], line[0] - high))
        aside = ti.max(0.0, ti.max(side_0 - line[2], line[1] - side_1))
        result = ti.cast(faces & (ahead * ahead + aside * aside < ti.static(self.config.range**2)), ti.i32)
        first = houses[at + FIRST_BOX]
        word, last = 0, (houses[at + FIRST_PIECE] - first) // 128
        while (result == 1) & (word <= last):
            bits = nearby[here + word]
            wall = first + 128 * word
            while (result == 1) & (bits != 0):
                if bits & 1:
                    result -= self.hides(numbers, wall, line, axis, cell)
                bits = ti.bit_shr(bits, 1)
                wall += 4
            word += 1
        return result

    @ti.func
    def hides(self, numbers: ti.template(), wall, line, axis, cell):
        """Return 1 if one wall stands between all of a cell and all of a line (at, from, to) across an axis.

        As either end of a sight line moves along an edge, the crossing with the wall's line moves in one
        direction. So the corners decide.
        """
        # An axis separates them: the wall's own.
        upright = numbers[wall] == numbers[wall + 2]
        at, low, high = numbers[wall], numbers[wall + 1], numbers[wall + 3]
        near_0, near_1, side_0, side_1 = cell[0], cell[2], cell[1], cell[3]
        if not upright:
            at, low, high = numbers[wall + 1], numbers[wall], numbers[wall + 2]
            near_0, near_1, side_0, side_1 = cell[1], cell[3], cell[0], cell[2]
        along = ti.cast(upright, ti.i32) == axis  # the line runs along the axis that the wall lies across
        far_0, far_1, aside_0, aside_1 = line[0], line[0], line[1], line[2]
        if along:
            far_0, far_1, aside_0, aside_1 = line[1], line[2], line[0], line[0]
        beyond = (near_1 < at) & (at < ti.min(far_0, far_1)) | (near_0 > at) & (at > ti.max(far_0, far_1))
        hidden = 0
        if beyond:
            hidden = 1
            for corner in ti.static(range(8)):
                near_ = near_1 if ti.static(corner & 1) else near_0
                side = side_1 if ti.static(corner & 2) else side_0
                far = far_1 if ti.static(corner & 4) else far_0
                aside = aside_1 if ti.static(corner & 4) else aside_0
                cross = side + (at - near_) / (far - near_) * (aside - side)
                hidden &= ti.cast((low + MARGIN < cross) & (cross < high - MARGIN), ti.i32)
        return hidden

    @ti.func
    def ahead(self, heading, line, axis, cell):
        """Return 1 if a line may be in the field of view of an eye in a cell at a heading.

        Such a line is not completely to the left of the first ray, nor to the right of the last, from any
        corner.
        """
        result = 1
        if ti.static(self.narrow):
            side = self.sides[heading]
            left, right = 1, 1
            for corner in ti.static(range(8)):
                x = cell[2] if ti.static(corner & 1) else cell[0]
                y = cell[3] if ti.static(corner & 2) else cell[1]
                end = line[2] if ti.static(corner & 4) else line[1]
                dx, dy = line[0] - x, end - y
                if axis == 1:
                    dx, dy = end - x, line[0] - y
                left &= ti.cast(side[0] * dy - side[1] * dx < -MARGIN, ti.i32)
                right &= ti.cast(side[2] * dy - side[3] * dx > MARGIN, ti.i32)
            result = 1 - (left | right)
        return result

    @ti.func
    def line_at(self, numbers: ti.template(), k):
        """Return a line (at, from, to), with the extension that rays see."""
        return ti.Vector([numbers[k], numbers[k + 1] - numbers[k + 2], numbers[k + 1] + numbers[k + 2]])

    @ti.func
    def box(self, houses: ti.template(), at, k):
        """Return the place of a house's k-th box in ``numbers``."""
        return houses[at + FIRST_BOX] + 4 * k

    @ti.func
    def line(self, houses: ti.template(), at, k):
        """Return the place of a house's k-th line in ``numbers``."""
        return houses[at + FIRST_LINE] + 4 * k

    @ti.func
    def axis(self, houses: ti.template(), at, k):
        """Return the axis that a house's k-th line lies across: 0 is x, 1 is y."""
        return ti.cast(k >= houses[at + ACROSS_X], ti.i32)
