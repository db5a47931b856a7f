"""A house as shapes: floors by room type, walls, doors and furniture. Plans and films draw these."""

import colorsys
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import msgspec

from logic.boxes import walls_touched
from logic.canvas import Block, Box, Line, Oval, Part, Point, Shape, Text, text_width
from logic.house import House
from logic.parts import ORIGINAL, Piece, Rect
from logic.targets import doors_by_name, part_names, windows_by_name

PAPER, WALL, INK, FAINT = "#fbfaf6", "#333a45", "#3d4450", "#9aa1ab"
"""Colours of the main room, of walls, of words and of what stands back."""
WOOD, EDGE, MARK = "#ffffff", "#6f7783", "#d9734e"
"""Colours of furniture: its top, its edge and the mark of its front."""

Symbol = tuple[Literal["box", "line", "oval", "ring"], tuple[float, ...]]


class Looks(msgspec.Struct):
    """How types look on a plan (``looks.json``). A type that is not there is drawn by its name."""

    rooms: dict[str, str]
    """Colours of the floors."""
    pieces: dict[str, tuple[Symbol, ...]]
    """Symbols in a piece's own frame: across from 0 to 1, and from the back (0) to the front (1)."""
    heights: dict[str, float]
    """Heights of pieces in metres, for files of solids; plans do not show them."""


LOOKS = msgspec.json.decode(Path(__file__).with_name("looks.json").read_bytes(), type=Looks)


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
        west, north, east, south = rect.box
        return *self.at(west, north), *self.at(east, south)


def extent(house: House) -> Box:
    """The box around a house: (west, north, east, south), metres."""
    boxes = [room.box for room in house.rooms]
    west, north, _, _ = (min(values) for values in zip(*boxes, strict=True))
    _, _, east, south = (max(values) for values in zip(*boxes, strict=True))
    return west, north, east, south


def house_shapes(house: House, frame: Frame) -> list[Shape]:
    """Draw all of a house but words about it: floors first, then furniture and walls, openings last."""
    wall = _stroke(0.09 * frame.scale, 1.5, 4.0)
    # The rooms' floors hide a star's main room's walls within them, and walls lie over the furniture.
    shapes: list[Shape] = []
    if house.is_star:
        shapes.append(Part(house.hub, (Block(frame.box(house.main), PAPER, WALL, wall),)))
    shapes += [Part(room.name, (Block(frame.box(room), room_colour(room.type)),)) for room in house.counted]
    for room in house.counted:
        names = part_names([piece.type for piece in room.pieces])
        for name, piece in zip(names, room.pieces, strict=True):
            drawn = _piece(piece, frame.box(piece), _front(house, room, piece), frame.scale)
            if has_mark(house, piece):
                drawn.append(_front_mark(frame.box(piece), piece.orientation, frame.scale))
            shapes.append(Part(f"{room.name}.{name}", tuple(drawn)))
    if house.is_star:
        shapes += [Block(frame.box(room), "", WALL, wall) for room in house.counted]
    else:
        shapes += _walls(house, frame, wall)
    for name, door in doors_by_name(house).items():
        drawn: list[Shape] = [_opening(frame.box(door), wall)]
        if door.is_entrance:
            (room,) = (room for room in house.rooms if room.name in door.between)
            drawn.append(_entrance(door, room, frame))
        shapes.append(Part(name, tuple(drawn)))
    for name, window in windows_by_name(house).items():
        shapes.append(Part(name, tuple(_window(frame.box(window), wall))))
    return shapes


def room_colour(kind: str) -> str:
    """The floor's colour of a room type: always the same for the same name."""
    if kind in LOOKS.rooms:
        return LOOKS.rooms[kind]
    # Not hash(), which differs from process to process.
    hue = zlib.crc32(kind.encode()) / 2**32
    red, green, blue = colorsys.hls_to_rgb(hue, 0.89, 0.45)
    return f"#{round(255 * red):02x}{round(255 * green):02x}{round(255 * blue):02x}"


def has_mark(house: House, piece: Piece) -> bool:
    """Whether a mark shows a piece's front: the original's word for it is not to be trusted."""
    return bool(piece.orientation) and house.topology != ORIGINAL


def _walls(house: House, frame: Frame, wall: float) -> list[Shape]:
    """The walls of rooms that share them, each once, with square ends."""
    verticals, horizontals = house.walls
    ends = [(frame.at(x, low), frame.at(x, high)) for x, low, high in verticals]
    ends += [(frame.at(low, y), frame.at(high, y)) for y, low, high in horizontals]
    half = wall / 2
    return [Block((x0 - half, y0 - half, x1 + half, y1 + half), WALL) for (x0, y0), (x1, y1) in ends]


def _entrance(door: Rect, room: Rect, frame: Frame) -> Line:
    """An arrow that points from an entrance into its room, within the floor that is kept free there."""
    x, y = door.x + door.width / 2, door.y + door.height / 2
    along_x = door.width > door.height
    inwards = (0.0, room.y + room.height / 2 - y) if along_x else (room.x + room.width / 2 - x, 0.0)
    length = abs(sum(inwards))
    u, v = (0.4 * value / length for value in inwards)
    wings = [(x + u / 2 - v / 2, y + v / 2 - u / 2), (x + u / 2 + v / 2, y + v / 2 + u / 2)]
    tip, foot = (x + u, y + v), (x + u / 8, y + v / 8)
    points = [foot, tip, wings[0], tip, wings[1]]
    return Line(tuple(frame.at(*point) for point in points), MARK, _stroke(0.05 * frame.scale, 1.8, 3.0))


def _window(window: Box, wall: float) -> list[Shape]:
    """A pane between two thin lines in the place of the wall."""
    left, top, right, bottom = window
    along_x = right - left > bottom - top
    by_x, by_y = (0.0, wall / 2) if along_x else (wall / 2, 0.0)
    frame = Block((left - by_x, top - by_y, right + by_x, bottom + by_y), WOOD, WALL, wall / 4)
    return [frame, Line(((left, top), (right, bottom)), WALL, wall / 4)]


def _opening(door: Box, wall: float) -> Block:
    """Paper over the wall between the ends of a door: half a wall less, for walls end in a square."""
    left, top, right, bottom = door
    by_x, by_y = (-0.5 * wall, 0.75 * wall) if right - left > bottom - top else (0.75 * wall, -0.5 * wall)
    return Block((left - by_x, top - by_y, right + by_x, bottom + by_y), PAPER)


def _front(house: House, room: Rect, piece: Piece) -> str:
    """Where the front of a piece is drawn; empty reads as south."""
    if house.topology != ORIGINAL:
        return piece.orientation
    # The original's word is not to be trusted: the back is the longest side that stands at a wall.
    sides = [(piece.height, "E"), (piece.width, "S"), (piece.height, "W"), (piece.width, "N")]
    return max((sides[wall] for wall in walls_touched(piece, room)), default=(0.0, piece.orientation))[1]


def _piece(piece: Piece, box: Box, front: str, scale: float) -> list[Shape]:
    """A piece with its symbol, or with its name where it has none."""
    left, top, right, bottom = box
    radius = min(0.07 * scale, (right - left) / 3, (bottom - top) / 3)
    shapes: list[Shape] = [Block(box, WOOD, EDGE, _stroke(0.02 * scale, 0.8, 4.0), radius)]
    for form, numbers in LOOKS.pieces.get(piece.type, ()):
        x0, y0 = _at(box, front, *numbers[:2])
        if form == "ring":
            by = numbers[2] * min(right - left, bottom - top)
            shapes.append(Oval((x0 - by, y0 - by, x0 + by, y0 + by), "", FAINT, 0.8))
            continue
        x1, y1 = _at(box, front, *numbers[2:])
        around = min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1)
        if form == "line":
            shapes.append(Line(((x0, y0), (x1, y1)), FAINT, 0.8))
        elif form == "oval":
            shapes.append(Oval(around, "", FAINT, 0.8))
        else:
            shapes.append(Block(around, "", FAINT, 0.8, 0.04 * scale))
    if piece.type not in LOOKS.pieces:
        size = min(0.22 * scale, 11.0, 0.9 * (right - left) / text_width(piece.type or "?", 1))
        if 6 <= size <= bottom - top:
            shapes.append(Text(((left + right) / 2, (top + bottom) / 2), piece.type, size, EDGE))
    return shapes


def _front_mark(box: Box, front: str, scale: float) -> Line:
    """A bold line along the middle of the front edge, at most 60 cm long."""
    edge = box[2] - box[0] if front in {"N", "S"} else box[3] - box[1]
    half = min(0.3, 0.3 * scale / edge)
    width = _stroke(0.05 * scale, 1.8, 3.0)
    return Line((_at(box, front, 0.5 - half, 1.0), _at(box, front, 0.5 + half, 1.0)), MARK, width)


def _stroke(width: float, least: float, most: float) -> float:
    """The width of a line, CSS pixels: at least so wide, but on small plans at most four times its due."""
    return min(max(width, min(4 * width, least)), most)


def _at(box: Box, front: str, across: float, forth: float) -> Point:
    """A point of a piece's own frame: across, and from its back to its front."""
    turns = {"N": (1 - across, 1 - forth), "E": (forth, 1 - across), "W": (1 - forth, across)}
    u, v = turns.get(front, (across, forth))
    left, top, right, bottom = box
    return left + u * (right - left), top + v * (bottom - top)
