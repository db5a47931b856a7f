"""Walls with a thickness as boxes, for solids and maps."""

from collections.abc import Iterable, Iterator

import numpy as np

from vitruvius.logic.house.boxes import TOLERANCE, Box, overlap
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import OUTSIDE, Door, Rect, Window
from vitruvius.logic.house.walls import doorway

WALL_PARTS = ("", "wall", "door", "opening", "entrance", "window", "parapet", "gate")
"""Kinds of boxes that ``wall_parts`` distinguishes."""


def wall_parts(house: House) -> Iterator[tuple[str, Box]]:
    """Yield the walls of a house with thick walls as boxes that do not overlap, each with its kind.

    The kind is one of ``WALL_PARTS``; a box is (west, north, east, south), metres.
    """
    assert house.wall_thickness
    half, outer = house.half_wall, house.wall_thickness.outer
    indoors = [room for room in house.rooms if not house.is_outdoor(room.name)]
    painted = [("parapet", room.grown(house.parapet).box) for room in house.rooms if room not in indoors]
    painted += [("wall", room.grown(outer).box) for room in indoors]
    painted += [("wall", room.grown(half).box) for room in indoors]
    rooms, tiles = {room.name: room for room in house.rooms}, house.tiles
    for opening in (*house.doors, *house.windows):
        kind, name = _kind(house, opening)
        through = doorway(opening, half)
        if name and not any(overlap(through, tile.box) > TOLERANCE for tile in tiles if tile.name != name):
            through = _through(opening, rooms[name], half, house.parapet if kind == "gate" else outer)
        painted.append((kind, through))
    painted += [("", room.box) for room in house.rooms]
    lines = [_lines(edge for _, box in painted for edge in box[axis::2]) for axis in (0, 1)]
    cells = np.zeros([len(line) - 1 for line in lines], np.uint8)
    for kind, box in painted:
        (x0, x1), (y0, y1) = (
            np.searchsorted(line, np.array(box[axis::2]) - TOLERANCE) for axis, line in enumerate(lines)
        )
        cells[x0:x1, y0:y1] = WALL_PARTS.index(kind)
    for (x0, x1, y0, y1), code in _boxes(cells):
        yield WALL_PARTS[code], (lines[0][x0], lines[1][y0], lines[0][x1], lines[1][y1])


def _kind(house: House, opening: Door | Window) -> tuple[str, str]:
    """Return the kind of an opening, and the name of its room if it leads outside, else an empty name."""
    if not isinstance(opening, Door):
        return "window", opening.room
    if opening.is_entrance:
        name = next(name for name in opening.between if name != OUTSIDE)
        return "gate" if house.is_outdoor(name) else "entrance", name
    return "opening" if opening.opening or house.is_outdoor(*opening.between) else "door", ""


def _through(opening: Rect, room: Rect, half: float, outer: float) -> Box:
    """Return the box of a window or an entrance of a room within its outer wall."""
    axis = int(not opening.height)
    box, at = [*opening.box], opening.box[axis]
    if at < room.box[axis] + (room.box[axis + 2] - room.box[axis]) / 2:
        box[axis], box[axis + 2] = at + half - outer, at + half
    else:
        box[axis], box[axis + 2] = at - half, at - half + outer
    return box[0], box[1], box[2], box[3]


def _lines(edges: Iterable[float]) -> list[float]:
    """Return edges in order, with edges within the tolerance of each other merged."""
    found: list[float] = []
    for edge in sorted(edges):
        if not found or edge - found[-1] > TOLERANCE:
            found.append(float(edge))
    return found


def _boxes(cells: np.ndarray) -> Iterator[tuple[tuple[int, int, int, int], int]]:
    """Yield boxes of equal cells (X, Y) that are not 0: x range, y range, and value."""
    left = cells.copy()
    for x, y in np.argwhere(cells):
        if code := left[x, y]:
            run = left[x:, y] == code
            end = x + int(np.argmin(run)) if not run.all() else len(left)
            low = y + 1
            while low < left.shape[1] and (left[x:end, low] == code).all():
                low += 1
            left[x:end, y:low] = 0
            yield (int(x), int(end), int(y), int(low)), int(code)
