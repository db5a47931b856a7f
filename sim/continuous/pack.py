"""Houses as the continuous backend holds them: boxes and lines, and lists of those that matter.

A house is divided into cells of ``CELL`` metres. Each has a list of the boxes that a body in it may touch by
one action, and for each heading two lists of the lines that an eye in it may see: those across x, and those
across y. A list leaves out only what it surely may: what is out of range, out of the field of view,
turned away, or hidden behind one wall from every place of the cell. So it loses nothing, and a step meets
about a sixth of a house.

    numbers   H x (west, north) | boxes (west, north, east, south) | lines (at, middle, reach, kind), where
              reach is half of a line's length and a seam | by house: floor, then each room and its door
              (x, y, half width, half height)
    indices   H x header | for each cell where its block is | blocks; all cells out of doors share the first
    header    first box, boxes, first piece, floor, rooms, first cell, columns, rows, first line
    block     how many numbers the lists have up to the end of each | lists; numbers of 16 bits, two in each
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from logic import House
from sim.backend import PIECE, WALL, Bank
from sim.config import Config
from sim.geometry import Geometry, geometry
from sim.rays import SEAM
from sim.runtime import Array, Launch, start, ti

CELL = 1.0
"""Metres: the side of a cell. Smaller ones make shorter lists, and more of them."""

MARGIN = 1e-3
"""Metres by which lists are more generous than they need to be: more than rounding can take away."""

HEADER = 9
FIRST_BOX, BOXES, FIRST_PIECE, FLOOR, ROOMS, FIRST_CELL, COLUMNS, ROWS, FIRST_LINE = range(HEADER)

LISTS = 17
"""A cell's lists: near boxes, then for each heading the lines across x and those across y."""

ENDS = LISTS // 2 + 1
"""Words of a block before its lists."""

LONGEST = 2**16 - 1
"""Of a cell's lists together: they are counted in 16 bits."""

LINE, AHEAD = 16, 64
"""Words of a cache line, and of a block's beginning that is prefetched; the last block, too, has as many
behind it."""

WEST, EAST = -1, 1
"""A line that is seen from the west (or north) only, or from the east (or south); walls are 0."""

Numbers, Indices = ti.types.ndarray(ti.f32, 1), ti.types.ndarray(ti.i32, 1)


@ti.func
def cell_of(numbers: ti.template(), indices: ti.template(), house, place):
    """Where in ``indices`` the block of a place's cell is."""
    header = house * HEADER
    columns, rows = indices[header + COLUMNS], indices[header + ROWS]
    x = ti.cast((place[0] - numbers[2 * house]) * ti.static(1 / CELL), ti.i32)
    y = ti.cast((place[1] - numbers[2 * house + 1]) * ti.static(1 / CELL), ti.i32)
    x, y = ti.max(0, ti.min(columns - 1, x)), ti.max(0, ti.min(rows - 1, y))
    return indices[indices[header + FIRST_CELL] + y * columns + x]


@ti.func
def half_word(words: ti.template(), first, k):
    """The k-th number of 16 bits from a word on."""
    return (words[first + (k >> 1)] >> ((k & 1) << 4)) & 0xFFFF


@ti.func
def end_of(indices: ti.template(), block, k):
    """How many numbers a cell's lists have before the k-th."""
    return half_word(indices, block, k)


@ti.func
def listed(indices: ti.template(), block, k):
    """The k-th number in a cell's lists."""
    return half_word(indices, block + ENDS, k)


def pack(houses: Sequence[House], config: Config) -> Bank:
    """Bring houses to the device: boxes, lines and lists."""
    shapes = [geometry(house) for house in houses]
    parts = [_Part.of(shape) for shape in shapes]
    count = len(parts)
    numbers, at = [np.array([part.corner for part in parts], np.float32).ravel()], 2 * count
    header = np.zeros((count, HEADER), np.int32)
    cell = header.size
    for k, part in enumerate(parts):
        boxes, lines = len(part.boxes), len(part.lines)
        floor = at + 4 * (boxes + lines)
        counts = at, boxes, at + 4 * part.walls, floor, len(part.rooms) - 1
        header[k] = (*counts, cell, *part.size, at + 4 * boxes)
        rows = np.concatenate([part.boxes, part.lines, part.rooms.reshape(-1, 4)], dtype=np.float32).ravel()
        numbers.append(rows)
        at += len(rows)
        cell += part.size[0] * part.size[1]
    return Bank(shapes, *_lists(np.concatenate(numbers), header, parts, config))


def lines_listed(tables: Mapping[str, np.ndarray], house: np.ndarray, pose: np.ndarray) -> np.ndarray:
    """How many lines a look meets, (E,) int: those listed for the cell and the heading of an eye at each of
    the poses (E, 3) in houses (E,). ``tables``: ``numbers`` and ``indices`` of a bank.
    """
    indices = tables["indices"]
    header = indices[: HEADER * (house.max() + 1)].reshape(-1, HEADER)[house]
    corner = np.column_stack([tables["numbers"][2 * house], tables["numbers"][2 * house + 1]])
    column, row = ((pose[:, :2] - corner) / CELL).astype(int).T
    block = indices[header[:, FIRST_CELL] + row * header[:, COLUMNS] + column]
    first = 1 + 2 * np.round(pose[:, 2] / (np.pi / 4)).astype(int) % 16
    ends = indices.view(np.uint16)
    return ends[2 * block + first + 2].astype(int) - ends[2 * block + first]


@dataclass(frozen=True)
class _Part:
    """A house's share of a bank: rows for ``numbers``."""

    corner: tuple[float, float]
    size: tuple[int, int]
    boxes: np.ndarray
    walls: int
    lines: np.ndarray
    across_x: int
    rooms: np.ndarray

    @classmethod
    def of(cls, shape: Geometry) -> "_Part":
        solids = shape.solids
        boxes = np.hstack([solids[:, :2] - solids[:, 2:], solids[:, :2] + solids[:, 2:]])
        walls = len(shape.verticals) + len(shape.horizontals)
        west, north, east, south = shape.bounds
        across = [_lines(boxes[: len(shape.verticals)], boxes[walls:], axis=0)]
        across += [_lines(boxes[len(shape.verticals) : walls], boxes[walls:], axis=1)]
        doors = np.vstack([shape.floor, shape.doors])
        rooms = np.stack([np.vstack([shape.floor, shape.rooms]), doors], axis=1)
        columns, rows = int((east - west) / CELL) + 1, int((south - north) / CELL) + 1
        return cls((west, north), (columns, rows), boxes, walls, np.vstack(across), len(across[0]), rooms)


def _lines(walls: np.ndarray, pieces: np.ndarray, axis: int) -> np.ndarray:
    """Lines across an axis (n, 4) float32: where, middle, reach, kind; a piece's side is negative where it
    looks west.
    """
    other = 1 - axis
    rows = [
        np.column_stack([walls[:, axis], walls[:, other], walls[:, other + 2], np.full(len(walls), WALL)])
    ]
    for side, sign in ((axis, -1), (axis + 2, 1)):
        kind = np.full(len(pieces), sign * PIECE)
        rows.append(np.column_stack([pieces[:, side], pieces[:, other], pieces[:, other + 2], kind]))
    at, low, high, kind = np.vstack(rows).astype(np.float32).T
    half = np.float32(0.5)
    return np.column_stack([at, half * (low + high), half * (high - low) + np.float32(SEAM), kind])


def _lists(
    numbers: np.ndarray, header: np.ndarray, parts: list[_Part], config: Config
) -> tuple[Array, Array]:
    """A bank's arrays, with the lists made on the device."""
    owner = np.repeat(np.arange(len(parts)), [part.size[0] * part.size[1] for part in parts])
    lines = [(len(part.lines), part.across_x) for part in parts]
    arrays = {
        "numbers": Array.of(numbers),
        "houses": Array.of(np.column_stack([header, lines]).astype(np.int32).ravel()),
        "owner": Array.of(owner.astype(np.int32)),
        "visible": Array(ti.i32, len(owner) * (max(len(part.lines) for part in parts) // 32 + 1)),
        "counts": Array(ti.i32, len(owner) * LISTS),
    }
    find, fill = _kernels(start(), config)
    Launch(find, arrays)()
    counts = arrays["counts"].numpy().reshape(-1, LISTS).cumsum(axis=1)
    total = counts[:, -1]
    if total.max() > LONGEST:
        house = owner[total.argmax()]
        raise ValueError(f"house {house} of {len(parts)} has more walls and furniture than lists can hold")
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
    """Kernels that find what is visible from each cell and count it, and that fill the lists."""
    body = max(config.body)
    reach = body + config.step + MARGIN
    left, right = (
        np.deg2rad(45 * np.arange(8) + angle)
        for angle in (config.first_ray, config.first_ray - config.ray_spacing * (config.rays - 1))
    )
    narrow = config.ray_spacing * (config.rays - 1) < 175
    edges = np.column_stack([np.cos(left), -np.sin(left), np.cos(right), -np.sin(right)])
    sides = ti.Vector.field(4, ti.f32, shape=8)
    sides.from_numpy(edges.astype(np.float32))
    each = HEADER + 2

    @ti.func
    def square(numbers: ti.template(), houses: ti.template(), owner: ti.template(), c):
        """A cell's house and its (west, north, east, south), a little larger than it is."""
        house = owner[c]
        at = house * each
        k = c - (houses[at + FIRST_CELL] - houses[FIRST_CELL])
        y, x = k // houses[at + COLUMNS], k % houses[at + COLUMNS]
        west = numbers[2 * house] + ti.cast(x, ti.f32) * CELL
        north = numbers[2 * house + 1] + ti.cast(y, ti.f32) * CELL
        return at, ti.Vector([west - MARGIN, north - MARGIN, west + CELL + MARGIN, north + CELL + MARGIN])

    @ti.func
    def indoors(numbers: ti.template(), houses: ti.template(), at, cell):
        """Whether an eye in a cell may be that of a body which stands in a room, or half in it."""
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
        """Whether a body whose centre is in a cell may touch a box by one action."""
        west, north, east, south = numbers[box], numbers[box + 1], numbers[box + 2], numbers[box + 3]
        return (
            (west - reach < cell[2])
            & (cell[0] < east + reach)
            & (north - reach < cell[3])
            & (cell[1] < south + reach)
        )

    @ti.func
    def hides(numbers: ti.template(), wall, line, axis, cell):
        """Whether one wall stands between all of a cell and all of a line (at, from, to) across an axis.

        A sight line crosses the wall's at a place that goes one way as either of its ends moves along an
        edge, so the corners decide.
        """
        # What separates them is an axis: the wall's own.
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
    def seen(numbers: ti.template(), houses: ti.template(), at, k, line, axis, cell):
        """Whether some of a line may be seen from somewhere in a cell, at some heading."""
        kind = numbers[k + 3]
        low, high = cell[0], cell[2]
        side_0, side_1 = cell[1], cell[3]
        if axis == 1:
            low, high, side_0, side_1 = cell[1], cell[3], cell[0], cell[2]
        faces = not ((kind == -PIECE) & (low > line[0]) | (kind == PIECE) & (high < line[0]))
        ahead = ti.max(0.0, ti.max(low - line[0], line[0] - high))
        aside = ti.max(0.0, ti.max(side_0 - line[2], line[1] - side_1))
        result = ti.cast(faces & (ahead * ahead + aside * aside < ti.static(config.range**2)), ti.i32)
        wall, last = houses[at + FIRST_BOX], houses[at + FIRST_PIECE]
        while (result == 1) & (wall < last):
            result -= hides(numbers, wall, line, axis, cell)
            wall += 4
        return result

    @ti.func
    def ahead(heading, line, axis, cell):
        """Whether a line may be in the field of view of an eye in a cell at a heading: it is not wholly to
        the left of the first ray, nor to the right of the last, from any corner.
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
        """A line (at, from, to), as far as rays meet it."""
        return ti.Vector([numbers[k], numbers[k + 1] - numbers[k + 2], numbers[k + 1] + numbers[k + 2]])

    @ti.kernel
    def find(numbers: Numbers, houses: Indices, owner: Indices, visible: Indices, counts: Indices):
        for c in range(owner.shape[0]):
            words = visible.shape[0] // owner.shape[0]
            at, cell = square(numbers, houses, owner, c)
            if indoors(numbers, houses, at, cell):
                for k in range(houses[at + BOXES]):
                    if near(numbers, houses[at + FIRST_BOX] + 4 * k, cell):
                        counts[c * LISTS] += 1
                for k in range(houses[at + HEADER]):
                    axis = ti.cast(k >= houses[at + HEADER + 1], ti.i32)
                    place = houses[at + FIRST_LINE] + 4 * k
                    line = line_at(numbers, place)
                    if seen(numbers, houses, at, place, line, axis, cell):
                        visible[c * words + k // 32] |= 1 << (k & 31)
                        for heading in range(8):
                            counts[c * LISTS + 1 + 2 * heading + axis] += ahead(heading, line, axis, cell)

    @ti.func
    def put(indices: ti.template(), first, k, number):
        """Write the k-th number of 16 bits from a word on, where there was 0."""
        indices[first + (k >> 1)] |= number << ((k & 1) << 4)

    @ti.kernel
    def fill(
        numbers: Numbers, houses: Indices, owner: Indices, visible: Indices, counts: Indices, indices: Indices
    ):
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
