"""Computation of the free backend's lists on the device.

A cell's lists have the solids that bodies in the cell may touch, and the lines that eyes in it may see.
"""

from functools import cache
from typing import Any

import numpy as np

from vitruvius.sim.backends.blocks import AHEAD, CELL, COLUMNS, FIRST_CELL, HEADER, LONGEST, ROWS, end_of
from vitruvius.sim.backends.free.layout import (
    ACROSS,
    ACROSS_X,
    ENDS,
    FIRST_LINE,
    FIRST_SOLID,
    LINES,
    LISTS,
    ROW,
    SECTORS,
    SOLIDS,
)
from vitruvius.sim.backends.free.see import swing
from vitruvius.sim.backends.rays import MARGIN
from vitruvius.sim.config import Config
from vitruvius.sim.runtime import Array, Floats, Ints, Launch, constants, start, ti


def listed_arrays(
    numbers: np.ndarray, header: np.ndarray, used: np.ndarray, config: Config
) -> tuple[Array, Array]:
    """Return the two arrays of a bank, with its lists.

    ``numbers`` (n,) has the numbers of the bank, ``header`` (H, 9) the header of each house. ``used`` (c,)
    bool is True for the cells of all houses that a body may be in. Raises ``ValueError`` for a house with too
    many lines or solids.
    """
    sizes = header[:, COLUMNS] * header[:, ROWS]
    house, place = np.repeat(np.arange(len(header)), sizes), np.concatenate([*map(np.arange, sizes)])
    house, place = house[used], place[used]
    columns = header[house, COLUMNS]
    cells = np.column_stack([house, place % columns, place // columns]).astype(np.int32)
    arrays = {
        "numbers": Array.of(numbers),
        "header": Array.of(header.ravel()),
        "cells": Array.of(cells.ravel()),
        "visible": Array(ti.i32, len(cells) * (int(header[:, LINES].max()) // 32 + 1)),
        "nearby": Array(ti.i32, len(cells) * (int(header[:, SOLIDS].max()) // 32 + 1)),
        "counts": Array(ti.i32, len(cells) * LISTS),
    }
    find, fill = _kernels(start(), config)
    Launch(find, arrays)()
    counts = arrays["counts"].numpy().reshape(-1, LISTS).cumsum(axis=1)
    total = counts[:, -1]
    most = int(np.maximum(header[:, SOLIDS], header[:, LINES]).max())
    if max(int(total.max(initial=0)), most) > LONGEST:
        k = int(house[total.argmax()]) if most <= LONGEST else int(header[:, LINES].argmax())
        raise ValueError(f"house {k} of {len(header)} has more walls and furniture than lists can hold")
    ends = np.zeros((len(cells), 2 * ENDS), np.uint16)
    ends[:, 1 : LISTS + 1] = counts
    words = ENDS + (total + 1) // 2
    first = header.size + len(used)
    block = first + ENDS + words.cumsum() - words
    indices = np.zeros(first + ENDS + int(words.sum()) + AHEAD, np.int32)
    indices[: header.size], indices[header.size : first] = header.ravel(), first
    indices[header.size : first][used] = block
    indices[block[:, None] + np.arange(ENDS)] = ends.view(np.int32)
    arrays["indices"] = Array.of(indices)
    Launch(fill, arrays)()
    return arrays["numbers"], arrays["indices"]


@cache
def _kernels(program: Any, config: Config) -> tuple[Any, Any]:
    """Return a kernel that finds and counts the visible lines of each cell, and one that fills the lists."""
    within = max(config.body) / 2 + max(config.step, config.drive.travel) + MARGIN
    leftmost, rightmost = config.first_ray, config.first_ray - config.ray_spacing * (config.rays - 1)
    half = 180 / SECTORS + swing(config) + 0.1
    narrow = leftmost - rightmost + 2 * half < 175
    left, right = (
        np.deg2rad(360 / SECTORS * np.arange(SECTORS) + angle)
        for angle in (leftmost + half, rightmost - half)
    )
    edges = np.column_stack([np.cos(left), -np.sin(left), np.cos(right), -np.sin(right)])
    sides = constants(edges.astype(np.float32))

    @ti.func
    def row(numbers: ti.template(), at):
        """Return a solid or a line."""
        return ti.Vector([numbers[at + part] for part in range(ROW)])

    @ti.func
    def corner(cell, k: ti.template()):
        """Return a corner of a cell (middle x, y, half a side)."""
        return ti.Vector(
            [
                cell[0] + ti.static(1 if k & 1 else -1) * cell[2],
                cell[1] + ti.static(1 if k & 2 else -1) * cell[2],
            ]
        )

    @ti.func
    def square(numbers: ti.template(), cells: ti.template(), c):
        """Return a cell (middle x, y, half a side), enlarged by a margin."""
        house = cells[3 * c]
        x = numbers[2 * house] + (ti.cast(cells[3 * c + 1], ti.f32) + 0.5) * CELL
        y = numbers[2 * house + 1] + (ti.cast(cells[3 * c + 2], ti.f32) + 0.5) * CELL
        return ti.Vector([x, y, 0.5 * CELL + MARGIN])

    @ti.func
    def near(solid, cell):
        """Return True if a body whose middle is in a cell may touch a solid in one step.

        Then no axis, of the cell or of the solid, separates the two.
        """
        x, y, u, v = cell[0] - solid[0], cell[1] - solid[1], ti.abs(solid[2]), ti.abs(solid[3])
        reach = cell[2] + within
        along, across = x * solid[2] + y * solid[3], y * solid[2] - x * solid[3]
        return (
            (ti.abs(along) < solid[4] + reach * (u + v))
            & (ti.abs(across) < solid[5] + reach * (u + v))
            & (ti.abs(x) < solid[4] * u + solid[5] * v + reach)
            & (ti.abs(y) < solid[4] * v + solid[5] * u + reach)
        )

    @ti.func
    def hides(solid, first, last, cell):
        """Return 1 if the middle line of a solid is between all of a cell and all of a line (first, last).

        As either end of a sight line moves along an edge, the crossing with the middle line moves in one
        direction. So the corners decide.
        """
        beyond, hidden, sign = 1, 1, 0.0
        for k in ti.static(range(4)):
            x, y = corner(cell, k)[0] - solid[0], corner(cell, k)[1] - solid[1]
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
                    x, y = corner(cell, k)[0] - solid[0], corner(cell, k)[1] - solid[1]
                    away, here = y * solid[2] - x * solid[3], x * solid[2] + y * solid[3]
                    cross = here + away / (away - far) * (there - here)
                    hidden &= ti.cast(ti.abs(cross) < solid[4] - MARGIN, ti.i32)
        return hidden & beyond

    @ti.func
    def in_range(solid, cell):
        """Return 1 if a part of a solid may be in the range of an eye in a cell."""
        x, y, around = cell[0] - solid[0], cell[1] - solid[1], solid[4] + solid[5] + 2 * cell[2]
        return ti.cast(ti.sqrt(x * x + y * y) < around + ti.static(config.range), ti.i32)

    @ti.func
    def seen(numbers: ti.template(), header: ti.template(), nearby: ti.template(), here, at, line, cell):
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
        result = ti.cast((away < ti.static(config.range)) & ((line[5] < 0) | (front > -MARGIN)), ti.i32)
        word, words = 0, header[at + SOLIDS] // 32
        while (result == 1) & (word <= words):
            bits = nearby[here + word]
            solid = header[at + FIRST_SOLID] + 32 * ROW * word
            while (result == 1) & (bits != 0):
                if bits & 1:
                    result -= hides(row(numbers, solid), first, last, cell)
                bits = ti.bit_shr(bits, 1)
                solid += ROW
            word += 1
        return result

    @ti.func
    def ahead(sector, line, cell):
        """Return 1 if a line may be in the field of view of an eye in a cell, at headings of a sector.

        Such a line is not completely to the left of the first ray, nor to the right of the last, from any
        corner.
        """
        result = 1
        if ti.static(narrow):
            edge, left_of, right_of = sides[sector], 1, 1
            for k in ti.static(range(8)):
                sign = ti.static(1.0 if k & 4 else -1.0)
                x = line[0] + sign * line[4] * line[2] - corner(cell, k & 3)[0]
                y = line[1] + sign * line[4] * line[3] - corner(cell, k & 3)[1]
                left_of &= ti.cast(edge[0] * y - edge[1] * x < -MARGIN, ti.i32)
                right_of &= ti.cast(edge[2] * y - edge[3] * x > MARGIN, ti.i32)
            result = 1 - (left_of | right_of)
        return result

    @ti.func
    def kind_of(header: ti.template(), at, k):
        """Return the kind of a line: across x (0), across y (1) or at an angle (2)."""
        return ti.cast(k >= header[at + ACROSS_X], ti.i32) + ti.cast(k >= header[at + ACROSS], ti.i32)

    @ti.kernel
    def find(numbers: Floats, header: Ints, cells: Ints, visible: Ints, nearby: Ints, counts: Ints):
        for c in range(cells.shape[0] // 3):
            words = visible.shape[0] // (cells.shape[0] // 3)
            here = c * (nearby.shape[0] // (cells.shape[0] // 3))
            at, cell = HEADER * cells[3 * c], square(numbers, cells, c)
            for k in range(header[at + SOLIDS]):
                solid = row(numbers, header[at + FIRST_SOLID] + ROW * k)
                counts[c * LISTS] += ti.cast(near(solid, cell), ti.i32)
                nearby[here + k // 32] |= in_range(solid, cell) << (k & 31)
            for k in range(header[at + LINES]):
                line = row(numbers, header[at + FIRST_LINE] + ROW * k)
                if seen(numbers, header, nearby, here, at, line, cell):
                    visible[c * words + k // 32] |= 1 << (k & 31)
                    for sector in range(SECTORS):
                        counts[c * LISTS + 1 + 3 * sector + kind_of(header, at, k)] += ahead(
                            sector, line, cell
                        )

    @ti.func
    def put(indices: ti.template(), first, k, number):
        """Write the k-th number of 16 bits, counted from a word on, where the bits are 0."""
        indices[first + (k >> 1)] |= number << ((k & 1) << 4)

    @ti.kernel
    def fill(numbers: Floats, header: Ints, cells: Ints, visible: Ints, indices: Ints):
        for c in range(cells.shape[0] // 3):
            words = visible.shape[0] // (cells.shape[0] // 3)
            at, cell = HEADER * cells[3 * c], square(numbers, cells, c)
            place = cells[3 * c + 2] * header[at + COLUMNS] + cells[3 * c + 1]
            block = indices[header[at + FIRST_CELL] + place]
            first, free = block + ENDS, ti.Vector([0 for _ in range(LISTS)])
            for k in ti.static(range(LISTS)):
                free[k] = end_of(indices, block, k)
            for k in range(header[at + SOLIDS]):
                if near(row(numbers, header[at + FIRST_SOLID] + ROW * k), cell):
                    put(indices, first, free[0], k)
                    free[0] += 1
            for k in range(header[at + LINES]):
                if visible[c * words + k // 32] >> (k & 31) & 1:
                    line = row(numbers, header[at + FIRST_LINE] + ROW * k)
                    for sector in range(SECTORS):
                        if ahead(sector, line, cell):
                            kind = 1 + 3 * sector + kind_of(header, at, k)
                            put(indices, first, free[kind], k)
                            free[kind] += 1

    return find, fill
