"""Shapes around a plan: dimension lines of the whole house, the north arrow, and on paper the title block."""

from collections.abc import Iterator, Sequence

from vitruvius.logic.drawing.canvas import Block, Box, Line, Point, Shape, Text, text_width
from vitruvius.logic.drawing.frame import Frame, drawn_extent, extent
from vitruvius.logic.drawing.palettes import Inks
from vitruvius.logic.house.house import House

DIMENSION = 26.0
"""Space for dimension lines beside and below a plan, CSS pixels."""

BLOCK = 46.0
"""Height of the title block, CSS pixels."""

NORTH = 16.0
"""Height of the north arrow, CSS pixels."""


def measured_extent(house: House) -> Box:
    """Return the box that dimension lines measure: (west, north, east, south), metres.

    If walls have a thickness, the box reaches their outer faces; otherwise the outer edges of the rooms.
    """
    return drawn_extent(house) if house.wall_thickness else extent(house)


def dimensions(house: House, frame: Frame, inks: Inks) -> Iterator[Shape]:
    """Draw the width of a house below it, and its depth west of it, in metres to the centimetre."""
    west, north, east, south = measured_extent(house)
    left, _, _, foot = frame.place(drawn_extent(house))
    across, down = frame.at(west, south), frame.at(east, south)
    y = foot + DIMENSION / 2
    words = Text(((across[0] + down[0]) / 2, y), f"{east - west:.2f} m", 10, inks.ink)
    yield from _dimension((across[0], y), (down[0], y), words, inks)
    top, bottom = frame.at(west, north)[1], frame.at(west, south)[1]
    x = left - DIMENSION / 2
    words = Text((x, (top + bottom) / 2), f"{south - north:.2f} m", 10, inks.ink, turned=True)
    yield from _dimension((x, top), (x, bottom), words, inks)


def _dimension(start: Point, end: Point, words: Text, inks: Inks) -> Iterator[Shape]:
    """Draw a line with slanted strokes at its ends and a gap for its words."""
    axis = int(start[0] == end[0])
    half = text_width(words.text, words.size) / 2 + 4
    middle = words.at[axis]
    for tip, sign in ((start, -1), (end, 1)):
        inner = (middle + sign * half, tip[1]) if axis == 0 else (tip[0], middle + sign * half)
        if sign * (tip[axis] - inner[axis]) > 0:
            yield Line((tip, inner), inks.ink, 0.8)
        yield Line(((tip[0] - 3, tip[1] + 3), (tip[0] + 3, tip[1] - 3)), inks.ink, 1.4)
    yield words


def north_arrow(right: float, y: float, inks: Inks) -> Iterator[Shape]:
    """Draw the north arrow with its letter on the left. They end at ``right``, and ``y`` is their middle."""
    x, half = right - 5, NORTH / 2
    points = (x, y + half), (x, y - half), (x - 4, y - half + 6), (x, y - half), (x + 4, y - half + 6)
    yield Line(points, inks.ink, 1.3)
    yield Text((x - 8, y), "N", 10, inks.ink, "end")


def title_block(cells: Sequence[tuple[str, str]], box: Box, inks: Inks) -> Iterator[Shape]:
    """Draw a cell for each heading, with its text below, and a last cell with the north arrow."""
    left, top, right, bottom = box
    yield Block(box, "", inks.ink, 1.2)
    ends = right - 2.2 * NORTH
    x = left
    free = (ends - left - sum(_cell_width(cell) for cell in cells)) / len(cells)
    for heading, words in cells:
        yield Text((x + 8, top + 14), heading, 8, inks.ink, "start")
        yield Text((x + 8, top + 31), words, 11, inks.ink, "start")
        x += _cell_width((heading, words)) + free
        yield Line(((x, top), (x, bottom)), inks.ink, 0.8)
    yield from north_arrow(right - NORTH / 2, (top + bottom) / 2, inks)


def _cell_width(cell: tuple[str, str]) -> float:
    return 16 + max(text_width(cell[0], 8), text_width(cell[1], 11))
