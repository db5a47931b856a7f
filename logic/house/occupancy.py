"""Occupancy grids: maps of square cells that are free, occupied or unknown, as robots make them.

A house with an occupancy grid is a map, whose walls lie between free cells and all others.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import lru_cache
from typing import Annotated, Any

import msgspec
import numpy as np
from msgspec import Meta

from vitruvius.logic.house.boxes import Box
from vitruvius.logic.house.parts import MAX_COORDINATE_M, Place
from vitruvius.logic.house.walls import Line

FREE, OCCUPIED, UNKNOWN = 0, 100, -1
"""Values of cells, as in ROS's ``nav_msgs/OccupancyGrid``."""

LETTERS = {".": FREE, "#": OCCUPIED, "?": UNKNOWN}
"""Letters of cells in a house file."""

MOST_CELLS = 1 << 25
"""Largest number of cells of a map: 5,792 by 5,792."""

MAX_RUNS = 1 << 20
"""Largest number of runs of equal cells in a map, along its rows or along its columns."""

RUNS = re.compile(r"(?:[1-9]\d{0,7}[.#?])+")
RUN = re.compile(r"(\d+)(.)")


class OccupancyGrid(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Square grid of free, occupied and unknown cells. Metres; x grows east, y south."""

    x: Place
    """Its west edge."""
    y: Place
    """Its north edge."""
    cell: Annotated[float, Meta(extra_json_schema={"exclusiveMinimum": 0})]
    """Side of a cell."""
    rows: Annotated[
        tuple[Annotated[str, Meta(extra_json_schema={"pattern": f"^{RUNS.pattern}$"})], ...],
        Meta(min_length=1),
    ]
    """Rows from north to south, each from west to east in runs of cells, as in ``12#30.2?``.

    Cells are free (.), occupied (#) or unknown (?).
    """

    @classmethod
    def of(cls, values: np.ndarray, cell: float, corner: tuple[float, float]) -> OccupancyGrid:
        """Return the map of ``values`` (H, W) with its north-west ``corner`` at (x, y), metres.

        Raises ``ValueError`` for an array that is no map: see ``House.from_grid``.
        """
        cells = _values(values)
        if (runs := _most_runs(cells)) > MAX_RUNS:
            raise ValueError(_too_many_runs(runs))
        grid = cls(float(corner[0]), float(corner[1]), float(cell), tuple(map(_runs, cells)))
        if fault := grid.fault():
            raise ValueError(fault)
        return grid

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of rows and columns."""
        return len(self.rows), _width(self.rows[0])

    @property
    def box(self) -> Box:
        """(west, north, east, south), metres."""
        rows, columns = self.shape
        return self.x, self.y, self.x + self.cell * columns, self.y + self.cell * rows

    @property
    def values(self) -> np.ndarray:
        """Cells (H, W) int8: ``FREE``, ``OCCUPIED`` or ``UNKNOWN``, row 0 in the north. Read-only."""
        return _decoded(self.rows)

    def coarser(self, times: int) -> OccupancyGrid:
        """Return the map with cells ``times`` as wide: occupied if one of its cells is, free if all are.

        Cells beyond the east and the south edge count as unknown. Raises ``ValueError`` if no free cell is
        left, or ``times`` is below 1.
        """
        if times < 1:
            raise ValueError(f"cells {times} times as wide: 1 or more")
        padded = np.pad(
            self.values, [(0, -size % times) for size in self.shape], constant_values=np.int8(UNKNOWN)
        )
        rows, columns = (size // times for size in padded.shape)
        blocks = padded.reshape(rows, times, columns, times)
        free, taken = ((blocks == FREE).all((1, 3)), (blocks == OCCUPIED).any((1, 3)))
        cells = np.where(free, FREE, np.where(taken, OCCUPIED, UNKNOWN)).astype(np.int8)
        return OccupancyGrid.of(cells, times * self.cell, (self.x, self.y))

    def lines(self) -> tuple[list[Line], list[Line]]:
        """Return the walls around the free cells: those that run north to south, then west to east."""
        return _lines(self)

    def blocks(self, *kinds: int) -> list[Box]:
        """Return all cells of these kinds as few boxes (west, north, east, south), metres.

        By default these are all cells that are not free.
        """
        return _blocks(self, kinds or (OCCUPIED, UNKNOWN))

    def fault(self) -> str:
        """Return the reason why the grid cannot be read as a map, or an empty text."""
        if not 0 < self.cell <= MAX_COORDINATE_M:
            return f"its cells are {self.cell} m wide: more than 0 m, and at most {MAX_COORDINATE_M:g} m"
        if wrong := _fault_of_rows(self.rows):
            return wrong
        if not all(abs(value) <= MAX_COORDINATE_M for value in self.box):
            return f"it lies beyond {MAX_COORDINATE_M:g} m or is not a number"
        if (runs := _most_runs(self.values)) > MAX_RUNS:
            return _too_many_runs(runs)
        return "" if any("." in row for row in self.rows) else "it has no free cell"


def _fault_of_rows(rows: tuple[str, ...]) -> str:
    """Return the reason why these are not rows of a map; empty if they are."""
    for number, row in enumerate(rows):
        if not RUNS.fullmatch(row):
            return f"row {number} is not a row of cells such as 12#30.2?"
    if (runs := sum(row.count(letter) for row in rows for letter in LETTERS)) > MAX_RUNS:
        return _too_many_runs(runs)
    widths = list(map(_width, rows))
    if max(widths) * len(rows) > MOST_CELLS:
        return too_many(len(rows), max(widths))
    if strange := next((width for width in widths if width != widths[0]), 0):
        return f"row {widths.index(strange)} has {strange} cells, row 0 has {widths[0]}"
    return ""


def too_many(rows: int, columns: int) -> str:
    """Return the message for a map with too many cells."""
    return f"it has {columns:,} by {rows:,} cells: at most {MOST_CELLS:,} are read"


def _too_many_runs(runs: int) -> str:
    """Return the message for a map whose cells change too often."""
    return f"its rows or columns have {runs:,} runs of equal cells: at most {MAX_RUNS:,} are read"


def _most_runs(cells: np.ndarray) -> int:
    """Return the number of runs of equal cells along the rows, or along the columns if they have more."""
    changes = (np.count_nonzero(cells[1:] != cells[:-1]), np.count_nonzero(cells[:, 1:] != cells[:, :-1]))
    return max(changes[0] + cells.shape[1], changes[1] + cells.shape[0])


def _values(values: Any) -> np.ndarray:
    """Return cells as int8. Raises ``ValueError`` for an array that holds no cells."""
    cells = np.asarray(values)
    if cells.ndim != 2 or not cells.size:
        raise ValueError(f"cells in an array of shape {cells.shape}: it must be rows by columns, not empty")
    if cells.size > MOST_CELLS:
        raise ValueError(too_many(*cells.shape))
    if cells.dtype == bool:
        return np.where(cells, OCCUPIED, FREE).astype(np.int8)
    if cells.dtype.kind not in "iu":
        raise ValueError(
            f"cells of {cells.dtype}: give bool, True where occupied, or whole numbers, "
            f"{FREE} free, {OCCUPIED} occupied, {UNKNOWN} unknown"
        )
    if strange := np.setdiff1d(cells, list(LETTERS.values())).tolist():
        raise ValueError(
            f"cells of {strange[0]}: there are {FREE} (free), {OCCUPIED} (occupied) and {UNKNOWN} (unknown)"
        )
    return cells.astype(np.int8)


def _runs(row: np.ndarray) -> str:
    """Return a row of cells in runs."""
    ends = np.append(np.flatnonzero(np.diff(row)) + 1, len(row))
    letters = {value: letter for letter, value in LETTERS.items()}
    lengths = np.diff(ends, prepend=0)
    return "".join(f"{n}{letters[int(row[end - 1])]}" for n, end in zip(lengths, ends, strict=True))


def _width(row: str) -> int:
    """Return the number of cells of a row."""
    return sum(int(length) for length, _ in RUN.findall(row))


@lru_cache(8)
def _decoded(rows: tuple[str, ...]) -> np.ndarray:
    found = [run for row in rows for run in RUN.findall(row)]
    values = np.repeat(
        np.array([LETTERS[letter] for _, letter in found], np.int8), [int(n) for n, _ in found]
    )
    values.flags.writeable = False
    return values.reshape(len(rows), -1)


@lru_cache(8)
def _lines(grid: OccupancyGrid) -> tuple[list[Line], list[Line]]:
    free = np.pad(grid.values == FREE, 1)
    corner, found = (grid.x, grid.y), []
    for axis in (0, 1):
        # A run of edges between neighbours on one line, along x and then along y, is a wall.
        sides = np.diff(free.T if axis == 0 else free, axis=0)[:, 1:-1]
        places, runs = corner[axis], corner[1 - axis]
        found.append(
            [
                (places + grid.cell * k, runs + grid.cell * low, runs + grid.cell * high)
                for k, low, high in _spans(sides)
            ]
        )
    return found[0], found[1]


@lru_cache(8)
def _blocks(grid: OccupancyGrid, kinds: tuple[int, ...]) -> list[Box]:
    shut = np.isin(grid.values, kinds)
    by_rows, by_columns = list(_merged(shut)), list(_merged(shut.T))
    if len(by_columns) < len(by_rows):
        by_rows = [(north, south, west, east) for west, east, north, south in by_columns]
    x, y, cell = grid.x, grid.y, grid.cell
    return [(x + cell * w, y + cell * n, x + cell * e, y + cell * s) for w, e, n, s in by_rows]


def _spans(mask: np.ndarray) -> Iterator[tuple[int, int, int]]:
    """Yield the runs of True in the rows of a mask (H, W): row, start, end."""
    edges = np.diff(np.pad(mask, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    (rows, first), (_, end) = np.nonzero(edges == 1), np.nonzero(edges == -1)
    yield from zip(rows.tolist(), first.tolist(), end.tolist(), strict=True)


def _merged(mask: np.ndarray) -> Iterator[tuple[int, int, int, int]]:
    """Yield boxes of True: start and end within rows, then first and last row of equal runs."""
    open_: dict[tuple[int, int], int] = {}
    rows: list[set[tuple[int, int]]] = [set() for _ in range(len(mask) + 1)]
    for row, first, end in _spans(mask):
        rows[row].add((first, end))
    for row, runs in enumerate(rows):
        for run in [each for each in open_ if each not in runs]:
            yield *run, open_.pop(run), row
        for run in runs:
            open_.setdefault(run, row)
