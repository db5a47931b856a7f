"""Plans of houses: rooms by type, walls, doors and furniture, as SVG and PNG, alone or on a sheet."""

import colorsys
import math
import zlib
from collections.abc import Iterable, Sequence
from itertools import product
from pathlib import Path
from typing import Literal

import msgspec
from PIL import Image

from logic.boxes import overlap, walls_touched
from logic.canvas import Block, Box, Drawing, Line, Oval, Shape, Text, png, svg, text_width
from logic.files import write_whole
from logic.house import FORMAT, ORIGINAL, House, Piece, Rect

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


LOOKS = msgspec.json.decode(Path(__file__).with_name("looks.json").read_bytes(), type=Looks)

TITLE, FOOT, MARGIN = 26, 22, 12
"""CSS pixels above a plan, below it and around it."""


def plan_svg(house: House, width: int = 720) -> str:
    """Draw a plan as the text of an SVG file, of this width in CSS pixels."""
    drawing = plan(house, width, _height(house, width))
    return svg([((0, 0), drawing)], drawing.width, drawing.height)


def plan_png(house: House, width: int = 720) -> Image.Image:
    """Draw the same plan as an image, two pixels to a CSS pixel."""
    drawing = plan(house, width, _height(house, width))
    return png([((0, 0), drawing)], drawing.width, drawing.height)


def contact_sheet(houses: Sequence[House], columns: int | None = None, cell: int = 300) -> Image.Image:
    """Draw many plans on one image, each in a square of ``cell`` CSS pixels, as large as it fits."""
    return png(*_sheet(houses, columns, cell))


def contact_sheet_svg(houses: Sequence[House], columns: int | None = None, cell: int = 300) -> str:
    """Draw the same sheet as the text of an SVG file."""
    return svg(*_sheet(houses, columns, cell))


def draw(houses: Iterable[House], out_dir: str | Path, format: Literal["svg", "png"] = "svg") -> list[Path]:
    """Write a plan of each house, then the sheet of all; return the files' paths.

    Each file appears whole or not at all. Raises ``ValueError`` for another format or no house.
    """
    houses, out = list(houses), Path(out_dir)
    if format not in {"svg", "png"}:
        raise ValueError(f"plans are drawn as svg or png, not {format!r}")
    if not houses:
        raise ValueError(f"no house to draw in {out}")
    digits = len(str(len(houses) - 1))
    paths = [out / f"house-{index:0{digits}}.{format}" for index in range(len(houses))]
    for house, path in zip(houses, paths, strict=True):
        write_whole(path, plan_svg(house).encode() if format == "svg" else _encoded(plan_png(house)))
    paths.append(out / f"contact-sheet.{format}")
    sheet = contact_sheet_svg(houses).encode() if format == "svg" else _encoded(contact_sheet(houses))
    write_whole(paths[-1], sheet)
    return paths


def plan(house: House, width: int, height: int) -> Drawing:
    """Draw a house as large as it fits into these CSS pixels, with its title and a scale of a metre."""
    west, north, east, south = _extent(house)
    scale = min((width - 2 * MARGIN) / (east - west), (height - TITLE - FOOT - MARGIN) / (south - north))
    left = (width - scale * (east - west)) / 2 - scale * west
    top = TITLE + (height - TITLE - FOOT - scale * (south - north)) / 2 - scale * north

    def placed(rect: Rect) -> Box:
        x, y, right, bottom = (scale * value for value in rect.box)
        return left + x, top + y, left + right, top + bottom

    wall = min(max(0.09 * scale, 1.5), 4.0)
    size = min(max(0.34 * scale, 8.5), 15.0)
    shapes: list[Shape] = [Block(placed(house.floor), PAPER, WALL, wall)]
    # The rooms' floors hide the main room's walls within them, and their walls lie over the furniture.
    shapes += [Block(placed(room), room_colour(room.type)) for room in house.rooms]
    for room in house.rooms:
        for piece in room.pieces:
            shapes += _piece(piece, placed(piece), _front(house, room, piece), scale)
            if piece.orientation and house.format == FORMAT:
                shapes.append(_front_mark(placed(piece), piece.orientation, scale))
    shapes += [Block(placed(room), "", WALL, wall) for room in house.rooms]
    shapes += [_opening(placed(room.door), wall) for room in house.rooms]
    for room in house.rooms:
        taken = [placed(piece) for piece in room.pieces]
        shapes.append(_label(room.type, placed(room), taken, size, (INK, room_colour(room.type))))
    main = placed(house.floor)
    shapes.append(_label("main room", main, [placed(room) for room in house.rooms], size, (FAINT, PAPER)))
    shapes.append(Text((MARGIN, TITLE / 2 + 2), _title(house, width - 2 * MARGIN), 11.5, INK, "start"))
    return Drawing(width, height, (*shapes, *_scale_bar(scale, height)))


def room_colour(kind: str) -> str:
    """The floor's colour of a room type: always the same for the same name."""
    if kind in LOOKS.rooms:
        return LOOKS.rooms[kind]
    # Not hash(), which differs from process to process.
    hue = zlib.crc32(kind.encode()) / 2**32
    red, green, blue = colorsys.hls_to_rgb(hue, 0.89, 0.45)
    return f"#{round(255 * red):02x}{round(255 * green):02x}{round(255 * blue):02x}"


def _opening(door: Box, wall: float) -> Block:
    """Paper over the wall between the ends of a door: half a wall less, for walls end in a square."""
    left, top, right, bottom = door
    by_x, by_y = (-0.5 * wall, 0.75 * wall) if right - left > bottom - top else (0.75 * wall, -0.5 * wall)
    return Block((left - by_x, top - by_y, right + by_x, bottom + by_y), PAPER)


def _front(house: House, room: Rect, piece: Piece) -> str:
    """Where the front of a piece is drawn; empty reads as south."""
    if house.format == FORMAT:
        return piece.orientation
    # The original's word is not to be trusted: the back is the longest side that stands at a wall.
    sides = [(piece.height, "E"), (piece.width, "S"), (piece.height, "W"), (piece.width, "N")]
    return max((sides[wall] for wall in walls_touched(piece, room)), default=(0.0, piece.orientation))[1]


def _piece(piece: Piece, box: Box, front: str, scale: float) -> list[Shape]:
    """A piece with its symbol, or with its name where it has none."""
    left, top, right, bottom = box
    radius = min(0.07 * scale, (right - left) / 3, (bottom - top) / 3)
    shapes: list[Shape] = [Block(box, WOOD, EDGE, max(0.8, 0.02 * scale), radius)]
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
    width = min(max(0.05 * scale, 1.8), 3.0)
    return Line((_at(box, front, 0.5 - half, 1.0), _at(box, front, 0.5 + half, 1.0)), MARK, width)


def _at(box: Box, front: str, across: float, forth: float) -> tuple[float, float]:
    """A point of a piece's own frame: across, and from its back to its front."""
    turns = {"N": (1 - across, 1 - forth), "E": (forth, 1 - across), "W": (1 - forth, across)}
    u, v = turns.get(front, (across, forth))
    left, top, right, bottom = box
    return left + u * (right - left), top + v * (bottom - top)


def _label(text: str, room: Box, taken: list[Box], size: float, colours: tuple[str, str]) -> Text:
    """Words in a room, as near to its middle as they keep clear of what is there, smaller at need.

    ``colours``: of the words, and of the floor, which is their halo where they must lie on something.
    """
    left, top, right, bottom = room
    middle = (left + right) / 2, (top + bottom) / 2
    steps = [k / 8 for k in range(-8, 9)]
    tries = []
    for smaller in (size, 0.85 * size, 0.7 * size):
        letter = max(5.5, min(smaller, 0.9 * (right - left) / text_width(text or "?", 1)))
        half, tall = text_width(text, letter) / 2 + 0.3 * letter, 0.75 * letter
        # How far the middle of the words may go from the middle of the room.
        wide, high = max(0.0, (right - left) / 2 - half - 1.5), max(0.0, (bottom - top) / 2 - tall - 1.5)
        for u, v in product(steps, steps):
            x, y = middle[0] + u * wide, middle[1] + v * high
            hidden = sum(max(0.0, overlap((x - half, y - tall, x + half, y + tall), box)) for box in taken)
            tries.append((hidden, -letter, math.dist((x, y), middle), (x, y)))
        if min(tries)[0] == 0:
            break
    hidden, letter, _, place = min(tries)
    return Text(place, text, round(-letter, 1), colours[0], halo=colours[1] if hidden else "")


def _scale_bar(scale: float, height: int) -> list[Shape]:
    """A bar of one metre."""
    left, right, y = MARGIN, MARGIN + scale, height - FOOT / 2
    ends = [Line(((x, y - 3), (x, y + 3)), INK, 1.2) for x in (left, right)]
    return [Line(((left, y), (right, y)), INK, 1.2), *ends, Text((right + 6, y), "1 m", 10, INK, "start")]


def _title(house: House, width: float) -> str:
    """Where the house comes from and how large it is; the first words go where there is no room."""
    floor = house.floor.area + sum(room.area for room in house.rooms)
    count = len(house.rooms)
    parts = [f"{count} room{'s' * (count != 1)}"]
    parts = ["original", *parts] if house.format == ORIGINAL else [*parts, f"{floor:.0f} m²"]
    if house.provenance is not None:
        source = house.provenance
        parts = [Path(source.grammar).name, f"seed {source.seed}", f"house {source.index}", *parts]
    while len(parts) > 1 and text_width(" · ".join(parts), 11.5) > width:
        parts = parts[1:]
    return " · ".join(parts)


def _sheet(
    houses: Sequence[House], columns: int | None, cell: int
) -> tuple[list[tuple[tuple[float, float], Drawing]], int, int]:
    """The cells of a sheet, row by row, and its width and height."""
    if not houses:
        raise ValueError("no house for the sheet")
    columns = columns or min(len(houses), max(1, math.isqrt(len(houses) * 3 // 2)))
    cells = [
        ((index % columns * cell, index // columns * cell), plan(house, cell, cell))
        for index, house in enumerate(houses)
    ]
    return [*cells], min(columns, len(houses)) * cell, -(-len(houses) // columns) * cell


def _extent(house: House) -> Box:
    """The box around a house, metres."""
    boxes = [rect.box for rect in (house.floor, *house.rooms)]
    west, north, _, _ = (min(values) for values in zip(*boxes, strict=True))
    _, _, east, south = (max(values) for values in zip(*boxes, strict=True))
    return west, north, east, south


def _height(house: House, width: int) -> int:
    """The height of a plan of this width, CSS pixels: at most one and a half times its width."""
    west, north, east, south = _extent(house)
    tall = (width - 2 * MARGIN) * (south - north) / (east - west)
    return round(min(tall, 1.5 * width) + TITLE + FOOT + MARGIN)


def _encoded(image: Image.Image) -> bytes:
    from io import BytesIO

    buffer = BytesIO()
    image.save(buffer, "PNG")
    return buffer.getvalue()
