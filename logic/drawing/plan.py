"""Shapes of a house: walls, floors by room type, furniture, doors and windows. Plans and films draw these."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from msgspec import structs

from vitruvius.logic.drawing.canvas import (
    Block,
    Box,
    Curve,
    Line,
    Part,
    Point,
    Rings,
    Shape,
    Strokes,
)
from vitruvius.logic.drawing.door_leaves import Leaf
from vitruvius.logic.drawing.frame import INNER_WALL_M, Frame, thickness
from vitruvius.logic.drawing.furniture import furniture_parts, stroke, thin
from vitruvius.logic.drawing.palettes import Fill, Inks, Style
from vitruvius.logic.drawing.wall_union import wall_rings
from vitruvius.logic.house.house import House
from vitruvius.logic.house.occupancy import OCCUPIED, UNKNOWN, OccupancyGrid
from vitruvius.logic.house.part_names import doors_by_name, windows_by_name
from vitruvius.logic.house.parts import OUTSIDE, Door, Window
from vitruvius.logic.house.walls import crossing

QUARTER_CIRCLE = 0.5523
"""Distance of the inner points from the ends of a cubic curve that draws a quarter of a circle, in radii."""

HATCH = 6.0
"""Distance between the lines of a pattern, CSS pixels."""


def house_shapes(
    house: House,
    frame: Frame,
    style: Style,
    leaves: Sequence[Leaf] = (),
    numbers: Mapping[str, str] | None = None,
) -> list[Shape]:
    """Draw a house without the words of its plan, with walls above the furniture.

    ``leaves`` are those of ``door_leaves``. Films draw none, since robots and rays pass through doors.
    ``numbers`` are the key's numbers by piece type (see ``unlabelled``).
    """
    numbers = numbers or {}
    if house.occupancy:
        return _map_shapes(house, house.occupancy, frame, style, numbers)
    inks, beyond = style.inks, max(thickness(house)[1] * frame.scale, 2.0)
    shapes: list[Shape] = []
    if main := house.main_room:
        shapes.append(Part(main.name, (Block(frame.box(main), inks.paper),)))
    for room in house.counted:
        fill = style.fill(house.whole(room).type)
        if room.type in house.outdoor:  # Boards without a colour, since there is no roof.
            fill = structs.replace(fill, colour=inks.paper, hatch="|")
        shapes.append(Part(room.name, tuple(floor(frame.box(room), fill, inks))))
    shapes += furniture_parts(house, frame, style, numbers)
    inner = () if house.wall_thickness else wall_boxes(house)
    rings = wall_rings(house, beyond / frame.scale, inner)
    shapes.append(Rings(tuple(tuple(frame.at(*point) for point in ring) for ring in rings), inks.wall))
    shapes += _free_walls(house, frame, inks)
    left, tiles = iter(leaves), boxes_of(house)
    for name, door in doors_by_name(house).items():
        leaf = None if door.opening else next(left, None)
        shapes.append(Part(name, tuple(_door(house, tiles, door, leaf, frame, inks))))
    for room in house.counted:
        if room.part_of:  # The floor continues where no wall is.
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
    """Return the shapes of a map: free cells, named areas, furniture, and all other cells."""
    inks, (whole, *areas) = style.inks, house.rooms
    shapes: list[Shape] = [Part(whole.name, (Block(frame.box(whole), inks.paper),))]
    shapes += [Part(area.name, tuple(floor(frame.box(area), style.fill(area.type), inks))) for area in areas]
    shapes += furniture_parts(house, frame, style, numbers)
    for kind, ink in ((UNKNOWN, inks.faint), (OCCUPIED, inks.wall)):
        if blocks := grid.blocks(kind):
            shapes.append(Rings(tuple(_corners(frame.place(box)) for box in blocks), ink))
    return [*shapes, *_free_walls(house, frame, inks)]


def _corners(box: Box) -> tuple[Point, ...]:
    left, top, right, bottom = box
    return (left, top), (right, top), (right, bottom), (left, bottom)


def _free_walls(house: House, frame: Frame, inks: Inks) -> Iterator[Line]:
    for wall in house.free_walls:
        ends = frame.at(wall.x1, wall.y1), frame.at(wall.x2, wall.y2)
        yield Line(ends, inks.wall, max(1.0, wall.thickness * frame.scale))


def wall_boxes(house: House) -> Iterator[Box]:
    """Yield boxes for walls without a thickness, as thick as inner walls, without doorways, metres."""
    half, walls = INNER_WALL_M / 2, house.walls
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
    across, (half, beyond) = int(segment.height == 0), thickness(house)
    if isinstance(segment, Door) and house.is_outdoor(*segment.between):
        beyond = house.parapet - house.half_wall
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
    """Yield the shapes of a floor with its colour and its pattern, in a box of CSS pixels."""
    yield Block(box, fill.colour)
    if fill.hatch:
        yield Strokes(tuple(_hatch(box, fill.hatch)), inks.pattern, 0.7)


def _hatch(box: Box, pattern: str) -> Iterator[tuple[Point, Point]]:
    """Yield the strokes of a pattern within a box, CSS pixels.

    Patterns of neighbours join without a break.
    """
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
    """Yield the doorway, the open leaf with its swing, and at the entrance a mark."""
    place = frame.place(opening(house, tiles, door))
    yield Block(place, inks.paper)
    if leaf is not None:
        (x, y), tip, jamb = leaf.hinge, leaf.tip, leaf.jamb
        controls = [
            (a + QUARTER_CIRCLE * (b[0] - x), a_ + QUARTER_CIRCLE * (b[1] - y))
            for (a, a_), b in ((tip, jamb), (jamb, tip))
        ]
        yield Curve(
            tuple(frame.at(*point) for point in (tip, *controls, jamb)), inks.faint, thin(frame.scale)
        )
        yield Line((frame.at(x, y), frame.at(*tip)), inks.edge, stroke(0.04 * frame.scale, 1.2, 4.0))
    if door.is_entrance and door not in house.garden_doors:
        (name,) = (name for name in door.between if name != OUTSIDE)
        size = min(0.3 * frame.scale, 7.5)
        yield _entrance(place, frame.box(house.room(name)), size, inks)


def _entrance(place: Box, room: Box, size: float, inks: Inks) -> Line:
    """Return an arrow tip outside an entrance that points inwards.

    ``size``: CSS pixels, within a plan's margin.
    """
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
    """Yield a pane between the two faces of the wall."""
    left, top, right, bottom = place
    thin = min(right - left, bottom - top) / 8
    yield Block(place, inks.wood, inks.wall, min(thin, 1.0))
    middle = ((left, (top + bottom) / 2), (right, (top + bottom) / 2))
    if right - left < bottom - top:
        middle = (((left + right) / 2, top), ((left + right) / 2, bottom))
    yield Line(middle, inks.wall, min(thin, 1.0))
