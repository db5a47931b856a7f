"""Computation of the continuous backend's lists on the device.

A cell's lists have the boxes that bodies in the cell may touch, and the lines that eyes in it may see.
"""

from functools import cache
from typing import Any

import numpy as np

from vitruvius.sim.backends.backend import PIECE
from vitruvius.sim.backends.blocks import AHEAD, CELL, COLUMNS, FIRST_CELL, HEADER, LONGEST, ROWS, end_of
from vitruvius.sim.backends.continuous.layout import (
    BOXES,
    ENDS,
    FIRST_BOX,
    FIRST_LINE,
    FIRST_PIECE,
    FLOOR,
    LISTS,
    ROOMS,
)
from vitruvius.sim.backends.rays import MARGIN
from vitruvius.sim.config import Config
from vitruvius.sim.runtime import Array, Floats, Ints, Launch, constants, start, ti


def listed_arrays(
    numbers: np.ndarray, header: np.ndarray, lines: np.ndarray, config: Config
) -> tuple[Array, Array]:
    """Return the two arrays of a bank, with its lists.

    ``numbers`` (n,) has the numbers of the bank, ``header`` (H, 9) the header of each house, and ``lines``
    (H, 2) the number of all its lines and of those across x. Raises ``ValueError`` for a house with too many
    lines or boxes.
    """
    owner = np.repeat(np.arange(len(header)), header[:, COLUMNS] * header[:, ROWS])
    arrays = {
        "numbers": Array.of(numbers),
        "houses": Array.of(np.column_stack([header, lines]).astype(np.int32).ravel()),
        "owner": Array.of(owner.astype(np.int32)),
        "visible": Array(ti.i32, len(owner) * (int(lines[:, 0].max()) // 32 + 1)),
        "nearby": Array(ti.i32, len(owner) * (int(header[:, BOXES].max()) // 32 + 1)),
        "counts": Array(ti.i32, len(owner) * LISTS),
    }
    find, fill = _kernels(start(), config)
    Launch(find, arrays)()
    counts = arrays["counts"].numpy().reshape(-1, LISTS).cumsum(axis=1)
    total = counts[:, -1]
    most = np.maximum(header[:, BOXES], lines[:, 0])
    if max(total.max(), most.max()) > LONGEST:
        house = most.argmax() if most.max() > LONGEST else owner[total.argmax()]
        raise ValueError(f"house {house} of {len(header)} has more walls and furniture than lists can hold")
    ends = np.zeros((len(owner), 2 * ENDS), np.uint16)
    ends[:, 1 : LISTS + 1] = counts
    words = np.where(total > 0, ENDS + (total + 1) // 2, 0)
    first = header.size + len(owner)
    block = np.where(total > 0, first + ENDS + words.cumsum() - words, first)
    indices = np.zeros(first + ENDS + int(words.sum()) + AHEAD, np.int32)
    indices[:first] = np.concatenate([header.ravel(), block])
    indices[block[total > 0, None] + np.arange(ENDS)] = ends[total > 0].view(np.int32)
    arrays["indices"] = Array.of(indices)
    Launch(fill, arrays)()
    return arrays["numbers"], arrays["indices"]


@cache
def _kernels(program: Any, config: Config) -> tuple[Any, Any]:
    """Return a kernel that finds and counts the visible lines of each cell, and one that fills the lists."""
    body = max(config.body)
    within = body + config.step + MARGIN
    left, right = (
        np.deg2rad(45 * np.arange(8) + angle)
        for angle in (config.first_ray, config.first_ray - config.ray_spacing * (config.rays - 1))
    )
    narrow = config.ray_spacing * (config.rays - 1) < 175
    edges = np.column_stack([np.cos(left), -np.sin(left), np.cos(right), -np.sin(right)])
    sides = constants(edges.astype(np.float32))
    each = HEADER + 2

    @ti.func
    def square(numbers: ti.template(), houses: ti.template(), owner: ti.template(), c):
        """Return the header of a cell's house, and the cell (west, north, east, south) with a margin."""
        house = owner[c]
        at = house * each
        k = c - (houses[at + FIRST_CELL] - houses[FIRST_CELL])
        y, x = k // houses[at + COLUMNS], k % houses[at + COLUMNS]
        west = numbers[2 * house] + ti.cast(x, ti.f32) * CELL
        north = numbers[2 * house + 1] + ti.cast(y, ti.f32) * CELL
        return at, ti.Vector([west - MARGIN, north - MARGIN, west + CELL + MARGIN, north + CELL + MARGIN])

    @ti.func
    def indoors(numbers: ti.template(), houses: ti.template(), at, cell):
        """Return 1 if an eye in a cell may belong to a body that is in a room, or half in it."""
        x, y = 0.5 * (cell[0] + cell[2]), 0.5 * (cell[1] + cell[3])
        half, found = 0.5 * (cell[2] - cell[0]) + ti.static(body), 0
        for k in range(houses[at + ROOMS] + 1):
            room = houses[at + FLOOR] + 8 * k
            across_x = ti.abs(x - numbers[room]) < numbers[room + 2] + half
            across_y = ti.abs(y - numbers[room + 1]) < numbers[room + 3] + half
            found |= ti.cast(across_x & across_y, ti.i32)
        return found

    @ti.func
    def near(numbers: ti.template(), box, cell):
        """Return True if a body whose centre is in a cell may touch a box by one action."""
        west, north, east, south = numbers[box], numbers[box + 1], numbers[box + 2], numbers[box + 3]
        return (
            (west - within < cell[2])
            & (cell[0] < east + within)
            & (north - within < cell[3])
            & (cell[1] < south + within)
        )

    @ti.func
    def hides(numbers: ti.template(), wall, line, axis, cell):
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
    def in_range(numbers: ti.template(), box, cell):
        """Return 1 if a part of a box is in the range of an eye in a cell."""
        x = ti.max(0.0, ti.max(numbers[box] - cell[2], cell[0] - numbers[box + 2]))
        y = ti.max(0.0, ti.max(numbers[box + 1] - cell[3], cell[1] - numbers[box + 3]))
        return ti.cast(x * x + y * y < ti.static((config.range + MARGIN) ** 2), ti.i32)

    @ti.func
    def seen(
        numbers: ti.template(), houses: ti.template(), nearby: ti.template(), here, at, k, line, axis, cell
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
        result = ti.cast(faces & (ahead * ahead + aside * aside < ti.static(config.range**2)), ti.i32)
        first = houses[at + FIRST_BOX]
        word, last = 0, (houses[at + FIRST_PIECE] - first) // 128
        while (result == 1) & (word <= last):
            bits = nearby[here + word]
            wall = first + 128 * word
            while (result == 1) & (bits != 0):
                if bits & 1:
                    result -= hides(numbers, wall, line, axis, cell)
                bits = ti.bit_shr(bits, 1)
                wall += 4
            word += 1
        return result

    @ti.func
    def ahead(heading, line, axis, cell):
        """Return 1 if a line may be in the field of view of an eye in a cell at a heading.

        Such a line is not completely to the left of the first ray, nor to the right of the last, from any
        corner.
        """
        result = 1
        if ti.static(narrow):
            side = sides[heading]
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
    def line_at(numbers: ti.template(), k):
        """Return a line (at, from, to), with the extension that rays see."""
        return ti.Vector([numbers[k], numbers[k + 1] - numbers[k + 2], numbers[k + 1] + numbers[k + 2]])

    @ti.kernel
    def find(numbers: Floats, houses: Ints, owner: Ints, visible: Ints, nearby: Ints, counts: Ints):
        for c in range(owner.shape[0]):
            words, of_boxes = visible.shape[0] // owner.shape[0], nearby.shape[0] // owner.shape[0]
            at, cell = square(numbers, houses, owner, c)
            if indoors(numbers, houses, at, cell):
                for k in range(houses[at + BOXES]):
                    box = houses[at + FIRST_BOX] + 4 * k
                    if near(numbers, box, cell):
                        counts[c * LISTS] += 1
                    if (box < houses[at + FIRST_PIECE]) & in_range(numbers, box, cell):
                        nearby[c * of_boxes + k // 32] |= 1 << (k & 31)
                for k in range(houses[at + HEADER]):
                    axis = ti.cast(k >= houses[at + HEADER + 1], ti.i32)
                    place = houses[at + FIRST_LINE] + 4 * k
                    line = line_at(numbers, place)
                    if seen(numbers, houses, nearby, c * of_boxes, at, place, line, axis, cell):
                        visible[c * words + k // 32] |= 1 << (k & 31)
                        for heading in range(8):
                            counts[c * LISTS + 1 + 2 * heading + axis] += ahead(heading, line, axis, cell)

    @ti.func
    def put(indices: ti.template(), first, k, number):
        """Write the k-th number of 16 bits, counted from a word on, where the bits are 0."""
        indices[first + (k >> 1)] |= number << ((k & 1) << 4)

    @ti.kernel
    def fill(numbers: Floats, houses: Ints, owner: Ints, visible: Ints, counts: Ints, indices: Ints):
        for c in range(owner.shape[0]):
            words = visible.shape[0] // owner.shape[0]
            at, cell = square(numbers, houses, owner, c)
            block = indices[houses[FIRST_CELL] + c]
            first = block + ENDS
            free = ti.Vector([0 for _ in range(LISTS)])
            for k in ti.static(range(LISTS)):
                free[k] = end_of(indices, block, k)
            if counts[c * LISTS] > 0:
                for k in range(houses[at + BOXES]):
                    if near(numbers, houses[at + FIRST_BOX] + 4 * k, cell):
                        put(indices, first, free[0], k)
                        free[0] += 1
            for k in range(houses[at + HEADER]):
                if visible[c * words + k // 32] >> (k & 31) & 1:
                    axis = ti.cast(k >= houses[at + HEADER + 1], ti.i32)
                    line = line_at(numbers, houses[at + FIRST_LINE] + 4 * k)
                    for heading in range(8):
                        if ahead(heading, line, axis, cell):
                            row = 1 + 2 * heading + axis
                            put(indices, first, free[row], k)
                            free[row] += 1

    return find, fill
