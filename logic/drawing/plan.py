"""A house as shapes: walls, floors by room type, furniture, doors and windows. Plans and films draw these."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from msgspec import structs

from logic.drawing.canvas import (
    Block,
    Box,
    Curve,
    Line,
    Oval,
    Part,
    Point,
    Region,
    Shape,
    Strokes,
    Text,
    text_width,
)
from logic.drawing.door_leaves import Leaf
from logic.drawing.palettes import Fill, Inks, Style
from logic.drawing.wall_union import wall_rings
from logic.house.boxes import walls_touched
from logic.house.house import House
from logic.house.occupancy import OCCUPIED, UNKNOWN, OccupancyGrid
from logic.house.part_names import doors_by_name, part_names, windows_by_name
from logic.house.parts import ORIGINAL, OUTSIDE, Door, Piece, Rect, Window
from logic.house.walls import crossing

OUTER, INNER = 0.2, 0.1
"""Metres: how thick walls are drawn. In our houses they have no thickness: half of an inner wall lies on each
side of where it stands, and as much of an outer one within, so that both have one face where they go on in
each other.
"""

BEYOND = OUTER - INNER / 2
"""Metres: how much of an outer wall lies outside of the rooms."""

QUARTER_CIRCLE = 0.5523
"""Of a cubic curve for a quarter of a circle: how far its inner points are from its ends, in radii."""

HATCH = 6.0
"""CSS pixels between the lines of a pattern."""


@dataclass(frozen=True)
class Frame:
    """Where a house lies on a picture."""

    scale: float
    """CSS pixels to a metre."""
    left: float
    """CSS pixels: where x is 0."""
    top: float
    """CSS pixels: where y is 0."""

    def at(self, x: float, y: float) -> Point:
        """A point, given in metres."""
        return self.left + self.scale * x, self.top + self.scale * y

    def box(self, rect: Rect) -> Box:
        """A rectangle, given in metres."""
        return self.place(rect.box)

    def place(self, box: Box) -> Box:
        """A box (west, north, east, south), given in metres."""
        return *self.at(*box[:2]), *self.at(*box[2:])


def _thickness(house: House) -> tuple[float, float]:
    """Half of an inner wall, and how far beyond its middle an outer one would reach: metres."""
    if thick := house.wall_thickness:
        return house.half_wall, thick.outer - house.half_wall
    return INNER / 2, BEYOND


def extent(house: House) -> Box:
    """The box around the rooms of a house: (west, north, east, south), metres."""
    boxes = [room.box for room in house.rooms]
    west, north, _, _ = (min(values) for values in zip(*boxes, strict=True))
    _, _, east, south = (max(values) for values in zip(*boxes, strict=True))
    return west, north, east, south


def drawn_extent(house: House) -> Box:
    """The same with the outer walls."""
    return grown(extent(house), house.half_wall + _thickness(house)[1])


def house_shapes(
    house: House,
    frame: Frame,
    style: Style,
    leaves: Sequence[Leaf] = (),
    numbers: Mapping[str, str] | None = None,
) -> list[Shape]:
    """Draw all of a house but words about it, walls over the furniture.

    ``leaves``: see ``door_leaves``, or none, as in films, whose bodies and rays pass. ``numbers``: those of
    types of pieces in the key: see ``unlabelled``.
    """
    numbers = numbers or {}
    if house.occupancy:
        return _map_shapes(house, house.occupancy, frame, style, numbers)
    inks, beyond = style.inks, max(_thickness(house)[1] * frame.scale, 2.0)
    shapes: list[Shape] = []
    if main := house.main_room:
        shapes.append(Part(main.name, (Block(frame.box(main), inks.paper),)))
    for room in house.counted:
        fill = style.fill(house.whole(room).type)
        if room.type in house.outdoor:  # Boards, and no colour: there is no roof.
            fill = structs.replace(fill, colour=inks.paper, hatch="|")
        shapes.append(Part(room.name, tuple(floor(frame.box(room), fill, inks))))
    shapes += _furniture(house, frame, style, numbers)
    inner = () if house.wall_thickness else wall_boxes(house)
    rings = wall_rings(house, beyond / frame.scale, inner)
    shapes.append(Region(tuple(tuple(frame.at(*point) for point in ring) for ring in rings), inks.wall))
    shapes += _free_walls(house, frame, inks)
    left, tiles = iter(leaves), boxes_of(house)
    for name, door in doors_by_name(house).items():
        leaf = None if door.opening else next(left, None)
        shapes.append(Part(name, tuple(_door(house, tiles, door, leaf, frame, inks))))
    for room in house.counted:
        if room.part_of:  # The floor goes on where no wall is.
            joints = [door for door in house.doors if {*door.between} == {room.name, room.part_of}]
            fill = style.fill(house.whole(room).type)
            shapes += [
                shape
                for door in joints
                for shape in floor(frame.place(opening(house, tiles, door)), fill, inks)
            ]
    for name, window in windows_by_name(house).items():
        shapes.append(Part(name, tuple(_window(frame.place(opening(house, tiles, window)), inks))))
    return shapes


def _map_shapes(
    house: House, grid: OccupancyGrid, frame: Frame, style: Style, numbers: Mapping[str, str]
) -> list[Shape]:
    """A map: free cells, areas that have names, furniture, and all other cells."""
    inks, (whole, *areas) = style.inks, house.rooms
    shapes: list[Shape] = [Part(whole.name, (Block(frame.box(whole), inks.paper),))]
    shapes += [Part(area.name, tuple(floor(frame.box(area), style.fill(area.type), inks))) for area in areas]
    shapes += _furniture(house, frame, style, numbers)
    for kind, ink in ((UNKNOWN, inks.faint), (OCCUPIED, inks.wall)):
        if blocks := grid.blocks(kind):
            shapes.append(Region(tuple(_corners(frame.place(box)) for box in blocks), ink))
    return [*shapes, *_free_walls(house, frame, inks)]


def _corners(box: Box) -> tuple[Point, ...]:
    left, top, right, bottom = box
    return (left, top), (right, top), (right, bottom), (left, bottom)


def _free_walls(house: House, frame: Frame, inks: Inks) -> Iterator[Line]:
    for wall in house.free_walls:
        ends = frame.at(wall.x1, wall.y1), frame.at(wall.x2, wall.y2)
        yield Line(ends, inks.wall, max(1.0, wall.thickness * frame.scale))


def _furniture(house: House, frame: Frame, style: Style, numbers: Mapping[str, str]) -> Iterator[Part]:
    for room in house.counted:
        names = part_names([piece.type for piece in room.pieces])
        for name, piece in zip(names, room.pieces, strict=True):
            front, number = _front(house, room, piece), numbers.get(piece.type, "")
            drawn = piece_shapes(piece, frame.box(piece), front, frame.scale, style, number)
            if has_mark(house, piece, style):
                drawn.append(_front_mark(frame.box(piece), piece.orientation, frame.scale, style.inks))
            yield Part(f"{room.name}.{name}", tuple(drawn))


def has_mark(house: House, piece: Piece, style: Style) -> bool:
    """Whether a mark shows a piece's front, for want of a symbol. The original's word for it is not to be
    trusted.
    """
    return bool(piece.orientation) and house.topology != ORIGINAL and style.looks.symbol(piece.type) is None


def grown(box: Box, by: float) -> Box:
    """A box with so much more on each side."""
    return box[0] - by, box[1] - by, box[2] + by, box[3] + by


def wall_boxes(house: House) -> Iterator[Box]:
    """Walls without a thickness as thick as inner ones, without the doorways between rooms: metres."""
    half, walls = INNER / 2, house.walls
    for axis, lines in enumerate(walls):
        across = np.array(walls[1 - axis])
        for at, low, high in lines:
            first = low - half * crossing(at, low, across)
            last = high + half * crossing(at, high, across)
            yield (at - half, first, at + half, last) if axis == 0 else (first, at - half, last, at + half)


def boxes_of(house: House) -> np.ndarray:
    """Return the boxes of a house's tiles (N, 4), metres."""
    return np.array([tile.box for tile in house.tiles])


def opening(house: House, tiles: np.ndarray, segment: Door | Window) -> Box:
    """Return the box of a door or a window, as thick as its wall, metres. ``tiles``: see ``boxes_of``."""
    across, (half, beyond) = int(segment.height == 0), _thickness(house)
    x, y = segment.x + segment.width / 2, segment.y + segment.height / 2
    depths = []
    for way in (-1, 1):
        near = (x, y + 0.01 * way) if across else (x + 0.01 * way, y)
        indoors = ((tiles[:, :2] < near) & (near < tiles[:, 2:])).all(axis=1).any()
        depths.append(half if indoors else beyond)
    west, north, east, south = segment.box
    if across:
        return west, north - depths[0], east, south + depths[1]
    return west - depths[0], north, east + depths[1], south


def floor(box: Box, fill: Fill, inks: Inks) -> Iterator[Shape]:
    """A floor with its colour and its pattern, in a box of CSS pixels."""
    yield Block(box, fill.colour)
    if fill.hatch:
        yield Strokes(tuple(_hatch(box, fill.hatch)), inks.pattern, 0.7)


def _hatch(box: Box, pattern: str) -> Iterator[tuple[Point, Point]]:
    """The strokes of a pattern within a box; CSS pixels. Patterns of neighbours go on in each other."""
    left, top, right, bottom = box

    def steps(low: float, high: float, gap: float) -> Iterator[float]:
        return (gap * k for k in range(int(low // gap) + 1, int(high // gap) + 1))

    if pattern in "-+":
        yield from (((left, y), (right, y)) for y in steps(top, bottom, HATCH))
    if pattern in "|+":
        yield from (((x, top), (x, bottom)) for x in steps(left, right, HATCH))
    if pattern in "/x":  # x + y is the same along a stroke
        for c in steps(left + top, right + bottom, 1.4 * HATCH):
            yield (max(left, c - bottom), min(bottom, c - left)), (min(right, c - top), max(top, c - right))
    if pattern in "\\x":  # x - y is
        for c in steps(left - bottom, right - top, 1.4 * HATCH):
            yield (max(left, c + top), max(top, left - c)), (min(right, c + bottom), min(bottom, right - c))
    if pattern == ".":
        for y in steps(top, bottom, HATCH):
            shift = round(y / HATCH) % 2 * HATCH
            dots = (x + shift for x in steps(left - shift, right - shift - 1, 2 * HATCH))
            yield from (((x, y), (x + 1, y)) for x in dots)


def _door(
    house: House, tiles: np.ndarray, door: Door, leaf: Leaf | None, frame: Frame, inks: Inks
) -> Iterator[Shape]:
    """The doorway, the open leaf with its swing, and at an entrance a mark."""
    place = frame.place(opening(house, tiles, door))
    yield Block(place, inks.paper)
    if leaf is not None:
        (x, y), tip, jamb = leaf.hinge, leaf.tip, leaf.jamb
        controls = [
            (a + QUARTER_CIRCLE * (b[0] - x), a_ + QUARTER_CIRCLE * (b[1] - y))
            for (a, a_), b in ((tip, jamb), (jamb, tip))
        ]
        yield Curve(
            tuple(frame.at(*point) for point in (tip, *controls, jamb)), inks.faint, _thin(frame.scale)
        )
        yield Line((frame.at(x, y), frame.at(*tip)), inks.edge, _stroke(0.04 * frame.scale, 1.2, 4.0))
    if door.is_entrance:
        (name,) = (name for name in door.between if name != OUTSIDE)
        size = min(0.3 * frame.scale, 7.5)
        yield _entrance(place, frame.box(house.room(name)), size, inks)


def _entrance(place: Box, room: Box, size: float, inks: Inks) -> Line:
    """A tip outside of an entrance that points in. ``size``: CSS pixels, within a plan's margin."""
    x, y = (place[0] + place[2]) / 2, (place[1] + place[3]) / 2
    if place[2] - place[0] > place[3] - place[1]:
        u, v = 0.0, size if y < (room[1] + room[3]) / 2 else -size
        y = place[1] if v > 0 else place[3]
    else:
        u, v = size if x < (room[0] + room[2]) / 2 else -size, 0.0
        x = place[0] if u > 0 else place[2]
    points = (x - u - v, y - v - u), (x - u / 5, y - v / 5), (x - u + v, y - v + u)
    return Line(points, inks.mark, size / 4)


def _window(place: Box, inks: Inks) -> Iterator[Shape]:
    """A pane between the two faces of the wall."""
    left, top, right, bottom = place
    thin = min(right - left, bottom - top) / 8
    yield Block(place, inks.wood, inks.wall, min(thin, 1.0))
    middle = ((left, (top + bottom) / 2), (right, (top + bottom) / 2))
    if right - left < bottom - top:
        middle = (((left + right) / 2, top), ((left + right) / 2, bottom))
    yield Line(middle, inks.wall, min(thin, 1.0))


def _front(house: House, room: Rect, piece: Piece) -> str:
    """Where the front of a piece is drawn; empty reads as south."""
    if house.topology != ORIGINAL:
        return piece.orientation
    # The original's word is not to be trusted: the back is the longest side that stands at a wall.
    sides = [(piece.height, "E"), (piece.width, "S"), (piece.height, "W"), (piece.width, "N")]
    return max((sides[wall] for wall in walls_touched(piece, room)), default=(0.0, piece.orientation))[1]


def unlabelled(house: House, frame: Frame, style: Style) -> list[str]:
    """Return the types of pieces that have neither a symbol nor room for their names, sorted."""
    pieces = (piece for room in house.counted for piece in room.pieces)
    return sorted(
        {
            piece.type
            for piece in pieces
            if piece.type
            and style.looks.symbol(piece.type) is None
            and not _written(style.looks.name(piece.type), frame.box(piece), frame.scale)
        }
    )


def _written(words: str, box: Box, scale: float) -> float:
    """Return the size of letters in which words fit on a piece, or 0."""
    left, top, right, bottom = box
    size = min(0.22 * scale, 11.0, 0.9 * (right - left) / text_width(words, 1))
    return size if 6 <= size <= bottom - top else 0.0


def piece_shapes(
    piece: Piece, box: Box, front: str, scale: float, style: Style, number: str = ""
) -> list[Shape]:
    """A piece with its symbol; without one with its name, or its number in the key if that does not fit."""
    left, top, right, bottom = box
    inks, thin = style.inks, _thin(scale)
    radius = min(0.05 * scale, (right - left) / 3, (bottom - top) / 3)
    shapes: list[Shape] = [Block(box, inks.wood, inks.edge, _stroke(0.02 * scale, 0.8, 4.0), radius)]
    forms = style.looks.symbol(piece.type)
    for form, numbers in forms or ():
        points = [_at(box, front, *numbers[k : k + 2]) for k in range(0, 2 * (len(numbers) // 2), 2)]
        x0, y0 = points[0]
        if form == "ring":
            by = numbers[2] * min(right - left, bottom - top)
            shapes.append(Oval((x0 - by, y0 - by, x0 + by, y0 + by), "", inks.faint, thin))
        elif form == "line":
            shapes.append(Line(tuple(points), inks.faint, thin))
        elif form == "curve":
            shapes.append(Curve(tuple(points), inks.faint, thin))
        else:
            x1, y1 = points[1]
            around = min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1)
            if form == "oval":
                shapes.append(Oval(around, "", inks.faint, thin))
            else:
                shapes.append(Block(around, "", inks.faint, thin, 0.04 * scale))
    if forms is None and piece.type:
        words, middle = style.looks.name(piece.type), ((left + right) / 2, (top + bottom) / 2)
        if size := _written(words, box, scale):
            shapes.append(Text(middle, words, size, inks.edge))
        elif number:
            size = max(5.0, min(8.0, 0.9 * (right - left) / text_width(number, 1), bottom - top))
            shapes.append(Text(middle, number, size, inks.edge))
    return shapes


def _front_mark(box: Box, front: str, scale: float, inks: Inks) -> Line:
    """A bold line along the middle of the front edge, at most 60 cm long."""
    edge = box[2] - box[0] if front in {"N", "S"} else box[3] - box[1]
    half = min(0.3, 0.3 * scale / edge)
    width = _stroke(0.05 * scale, 1.8, 3.0)
    return Line((_at(box, front, 0.5 - half, 1.0), _at(box, front, 0.5 + half, 1.0)), inks.mark, width)


def _thin(scale: float) -> float:
    return _stroke(0.012 * scale, 0.8, 1.2)


def _stroke(width: float, least: float, most: float) -> float:
    """The width of a line, CSS pixels: at least so wide, but on small plans at most four times its due."""
    return min(max(width, min(4 * width, least)), most)


def _at(box: Box, front: str, across: float, forth: float) -> Point:
    """A point of a piece's own frame: across, and from its back to its front."""
    turns = {"N": (1 - across, 1 - forth), "E": (forth, 1 - across), "W": (1 - forth, across)}
    u, v = turns.get(front, (across, forth))
    left, top, right, bottom = box
    return left + u * (right - left), top + v * (bottom - top)
