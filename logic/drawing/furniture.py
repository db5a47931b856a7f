"""Shapes of furniture: symbols, names, and marks at the fronts of pieces."""

from collections.abc import Iterator, Mapping

from vitruvius.logic.drawing.canvas import Block, Box, Curve, Line, Oval, Part, Point, Shape, Text, text_width
from vitruvius.logic.drawing.frame import Frame
from vitruvius.logic.drawing.palettes import Inks, Style
from vitruvius.logic.house.boxes import walls_touched
from vitruvius.logic.house.house import House
from vitruvius.logic.house.part_names import part_names
from vitruvius.logic.house.parts import ORIGINAL, Piece, Rect


def furniture_parts(house: House, frame: Frame, style: Style, numbers: Mapping[str, str]) -> Iterator[Part]:
    """Draw each piece of a house. ``numbers`` are the key's numbers by piece type (see ``unlabelled``)."""
    for room in house.counted:
        names = part_names([piece.type for piece in room.pieces])
        for name, piece in zip(names, room.pieces, strict=True):
            front, number = _front(house, room, piece), numbers.get(piece.type, "")
            drawn = piece_shapes(piece, frame.box(piece), front, frame.scale, style, number)
            if has_mark(house, piece, style):
                drawn.append(_front_mark(frame.box(piece), piece.orientation, frame.scale, style.inks))
            yield Part(f"{room.name}.{name}", tuple(drawn))


def has_mark(house: House, piece: Piece, style: Style) -> bool:
    """Return True if a mark shows the piece's front: the piece has an orientation, but its type no symbol.

    Houses of the original program have no marks, since their orientations are unreliable.
    """
    return bool(piece.orientation) and house.topology != ORIGINAL and style.looks.symbol(piece.type) is None


def _front(house: House, room: Rect, piece: Piece) -> str:
    """Return the side on which a piece's front is drawn: N, E, S or W. An empty text means south."""
    if house.topology != ORIGINAL:
        return piece.orientation
    # The original's orientations are unreliable: the back is the longest side at a wall.
    sides = [(piece.height, "E"), (piece.width, "S"), (piece.height, "W"), (piece.width, "N")]
    return max((sides[wall] for wall in walls_touched(piece, room)), default=(0.0, piece.orientation))[1]


def unlabelled(house: House, frame: Frame, style: Style) -> list[str]:
    """Return the piece types that have no symbol and whose names do not fit on every piece, sorted."""
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
    """Return the font size in which the words fit on a piece, or 0 if they do not fit."""
    left, top, right, bottom = box
    size = min(0.22 * scale, 11.0, 0.9 * (right - left) / text_width(words, 1))
    return size if 6 <= size <= bottom - top else 0.0


def piece_shapes(
    piece: Piece, box: Box, front: str, scale: float, style: Style, number: str = ""
) -> list[Shape]:
    """Return the shapes of a piece: its box, and its symbol, or its name, or its number in the key.

    A type without a symbol has its name; if the name does not fit, the number.
    """
    left, top, right, bottom = box
    inks, fine = style.inks, thin(scale)
    radius = min(0.05 * scale, (right - left) / 3, (bottom - top) / 3)
    shapes: list[Shape] = [Block(box, inks.wood, inks.edge, stroke(0.02 * scale, 0.8, 4.0), radius)]
    forms = style.looks.symbol(piece.type)
    for form, numbers in forms or ():
        points = [_at(box, front, *numbers[k : k + 2]) for k in range(0, 2 * (len(numbers) // 2), 2)]
        x0, y0 = points[0]
        if form == "ring":
            by = numbers[2] * min(right - left, bottom - top)
            shapes.append(Oval((x0 - by, y0 - by, x0 + by, y0 + by), "", inks.faint, fine))
        elif form == "line":
            shapes.append(Line(tuple(points), inks.faint, fine))
        elif form == "curve":
            shapes.append(Curve(tuple(points), inks.faint, fine))
        else:
            x1, y1 = points[1]
            around = min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1)
            if form == "oval":
                shapes.append(Oval(around, "", inks.faint, fine))
            else:
                shapes.append(Block(around, "", inks.faint, fine, 0.04 * scale))
    if forms is None and piece.type:
        words, middle = style.looks.name(piece.type), ((left + right) / 2, (top + bottom) / 2)
        if size := _written(words, box, scale):
            shapes.append(Text(middle, words, size, inks.edge))
        elif number:
            size = max(5.0, min(8.0, 0.9 * (right - left) / text_width(number, 1), bottom - top))
            shapes.append(Text(middle, number, size, inks.edge))
    return shapes


def _front_mark(box: Box, front: str, scale: float, inks: Inks) -> Line:
    """Return a bold line along the middle of the front edge, at most 60 cm long."""
    edge = box[2] - box[0] if front in {"N", "S"} else box[3] - box[1]
    half = min(0.3, 0.3 * scale / edge)
    width = stroke(0.05 * scale, 1.8, 3.0)
    return Line((_at(box, front, 0.5 - half, 1.0), _at(box, front, 0.5 + half, 1.0)), inks.mark, width)


def thin(scale: float) -> float:
    """Return the line width of symbols, CSS pixels."""
    return stroke(0.012 * scale, 0.8, 1.2)


def stroke(width: float, least: float, most: float) -> float:
    """Return a line width, CSS pixels, from ``least`` to ``most``.

    On small plans the line is thinner than ``least``: at most four times the ``width`` that is to scale.
    """
    return min(max(width, min(4 * width, least)), most)


def _at(box: Box, front: str, across: float, forth: float) -> Point:
    """Return a point given in the frame of a piece: ``across``, and ``forth`` from its back to its front."""
    turns = {"N": (1 - across, 1 - forth), "E": (forth, 1 - across), "W": (1 - forth, across)}
    u, v = turns.get(front, (across, forth))
    left, top, right, bottom = box
    return left + u * (right - left), top + v * (bottom - top)
