"""Two houses on one plan: the second house, with marks for added, removed and moved parts."""

from collections import Counter
from collections.abc import Iterator

from vitruvius.logic.drawing.canvas import Drawing, Line, Point, Shape, Text, svg, text_width
from vitruvius.logic.drawing.door_leaves import door_leaves
from vitruvius.logic.drawing.draw import FOOT, MARGIN, PLAN_PX, TITLE
from vitruvius.logic.drawing.frame import Frame, drawn_extent, grown
from vitruvius.logic.drawing.labels import legend, room_names, title
from vitruvius.logic.drawing.palettes import Fill, Style, style
from vitruvius.logic.drawing.plan import house_shapes
from vitruvius.logic.house.boxes import Box
from vitruvius.logic.house.diff import Change, changes
from vitruvius.logic.house.house import House

COLOURS = {"came": "#0072b2", "went": "#d55e00", "moved": "#cc79a7"}
"""Colours of the marks, by Okabe and Ito, for the colour-blind.

The marks also differ in their lines: solid, dashed, and both with an arrow between them.
"""
FLOOR = "#f5f5f3"
"""Colour of all floors, so that only changes have a colour."""


def diff_svg(before: House, after: House, width: int = PLAN_PX) -> str:
    """Draw the differences between two houses as the text of an SVG file of this width in CSS pixels."""
    drawing = diff_drawing(before, after, changes(before, after), width)
    return svg([((0, 0), drawing)], drawing.width, drawing.height)


def diff_drawing(before: House, after: House, found: list[Change], width: int = PLAN_PX) -> Drawing:
    """Draw the given changes between two houses."""
    plain = style([after])
    look = Style(plain.inks, plain.looks, {room.type: Fill(FLOOR) for room in after.rooms})
    frame, height = _frame(before, after, width)
    leaves = door_leaves(after)
    names = room_names(after, frame, look, {}, leaves=leaves)
    counts = Counter(change.what for change in found)
    words = " to ".join(dict.fromkeys(title(house, width / 2 - MARGIN) for house in (before, after)))
    foot = height - FOOT / 2
    shapes: list[Shape] = [
        *house_shapes(after, frame, look, leaves),
        *(word for name in names for word in name),
        *(shape for change in found for shape in _marks(change, frame)),
        Text((MARGIN, TITLE / 2), words, 11.5, look.inks.ink, "start"),
        *legend(after, look, frame.scale, MARGIN, foot - FOOT),
        *_key(counts, look, foot),
    ]
    return Drawing(width, height, tuple(shapes))


def _frame(before: House, after: House, width: int) -> tuple[Frame, float]:
    """Return a frame that centres both houses in a picture, and the picture's height."""
    ends = list(zip(drawn_extent(before), drawn_extent(after), strict=True))
    west, north, east, south = (*map(min, ends[:2]), *map(max, ends[2:]))
    scale = min((width - 2 * MARGIN) / (east - west), 1.5 * width / (south - north))
    left = (width - scale * (east - west)) / 2 - scale * west
    return Frame(scale, left, TITLE - scale * north), TITLE + scale * (south - north) + MARGIN + 2 * FOOT


def _marks(change: Change, frame: Frame) -> Iterator[Shape]:
    colour = COLOURS[change.what]
    if change.before:
        yield _outline(_seen(frame.place(change.before.box)), colour, 1.6 if change.after else 2.4, 5.0)
    if change.after:
        yield _outline(_seen(frame.place(change.after.box)), colour, 2.4)
    if change.before and change.after:
        yield from _arrow(
            _middle(frame.place(change.before.box)), _middle(frame.place(change.after.box)), colour
        )


def _seen(box: Box) -> Box:
    """Return a box on the picture, slightly enlarged if it is a segment."""
    return grown(box, 3.0 if min(box[2] - box[0], box[3] - box[1]) < 1 else -1.2)


def _outline(box: Box, colour: str, width: float, dash: float = 0.0) -> Line:
    left, top, right, bottom = box
    return Line(
        ((left, top), (right, top), (right, bottom), (left, bottom), (left, top)), colour, width, dash
    )


def _middle(box: Box) -> Point:
    return (box[0] + box[2]) / 2, (box[1] + box[3]) / 2


def _arrow(tail: Point, tip: Point, colour: str) -> Iterator[Shape]:
    """Yield an arrow, unless it is too short to be seen."""
    x, y = tip[0] - tail[0], tip[1] - tail[1]
    length = (x**2 + y**2) ** 0.5
    if length < 8:
        return
    u, v = 6 * x / length, 6 * y / length
    wings = [(tip[0] - u - v / 2, tip[1] - v + u / 2), (tip[0] - u + v / 2, tip[1] - v - u / 2)]
    yield Line((tail, tip, wings[0], tip, wings[1]), colour, 1.6)


def _key(counts: Counter[str], look: Style, y: float) -> Iterator[Shape]:
    """Yield the mark of each kind of change with the number of changes."""
    x = float(MARGIN)
    if not counts:
        yield Text((x, y), "nothing differs", 10, look.inks.ink, "start")
    for what, colour in COLOURS.items():
        if counts[what]:
            yield _outline((x, y - 5, x + 14, y + 5), colour, 2.0, 3.0 if what == "went" else 0.0)
            words = f"{what} {counts[what]}"
            if what == "moved":
                yield from _arrow((x - 1, y), (x + 13, y), colour)
            yield Text((x + 20, y), words, 10, look.inks.ink, "start")
            x += 20 + text_width(words, 10) + 16
