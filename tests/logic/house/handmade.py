"""Handmade houses for tests: each keeps every promise, with sizes that Hypothesis chooses."""

from dataclasses import dataclass
from typing import TypeVar, cast

from hypothesis import strategies as st
from msgspec.structs import replace

from tests.sample_houses import changed_star
from vitruvius.logic import House, Piece, Rect, Star, StarRoom
from vitruvius.logic.house.parts import Orientation

Placed = TypeVar("Placed", bound=Rect)

DOOR = 0.762
TURNED = {"": "", "N": "E", "E": "S", "S": "W", "W": "N"}


@dataclass(frozen=True)
class Sketch:
    """Room north of the main room: its sizes, and the shifts of its wall and its door to the east."""

    type: str
    width: float
    depth: float
    shift: float = 0.0
    door: float = 0.6
    pieces: tuple[Piece, ...] = ()


def piece(kind: str, *box: float, front: str = "", children: tuple[Piece, ...] = ()) -> Piece:
    """Return a piece of a type at x, y, width, height, metres."""
    x, y, width, height = box
    return Piece(x, y, width, height, kind, cast("Orientation", front), children)


def turned(rect: Placed, quarters: int) -> Placed:
    """Return a rectangle turned clockwise about the origin by quarters, with all that it holds."""
    for _ in range(quarters % 4):
        changes: dict = {"x": -rect.y - rect.height, "y": rect.x, "width": rect.height, "height": rect.width}
        if isinstance(rect, Piece):
            changes["orientation"] = TURNED[rect.orientation]
        if isinstance(rect, Piece | StarRoom):
            changes["children"] = tuple(turned(child, 1) for child in rect.children)
        if isinstance(rect, StarRoom):
            changes["door"] = turned(rect.door, 1)
        rect = replace(rect, **changes)
    return rect


def moved(rect: Placed, x: float, y: float) -> Placed:
    """Return a moved rectangle with all that it holds."""
    changes: dict = {"x": rect.x + x, "y": rect.y + y}
    if isinstance(rect, Piece | StarRoom):
        changes["children"] = tuple(moved(child, x, y) for child in rect.children)
    if isinstance(rect, StarRoom):
        changes["door"] = moved(rect.door, x, y)
    return replace(rect, **changes)


def built(width: float, height: float, sides: tuple[tuple[Sketch, ...], ...]) -> House:
    """Return a house around the origin from the rooms north, east, south and west, clockwise on each side."""
    rooms = []
    for side, sketches in enumerate(sides):
        half, out = (width / 2, height / 2) if side % 2 == 0 else (height / 2, width / 2)
        for sketch in sketches:
            x, y = sketch.shift - half, -out - sketch.depth
            room = StarRoom(
                x,
                y,
                sketch.width,
                sketch.depth,
                sketch.type,
                tuple(moved(item, x, y) for item in sketch.pieces),
                Rect(x + sketch.door, -out, DOOR, 0.0),
            )
            rooms.append(turned(room, side))
    return House.of_star(Star(Rect(-width / 2, -height / 2, width, height), tuple(rooms)))


def sketches(bedroom=(3.6, 3.8), bathroom=(3.0, 2.6), kitchen=(3.5, 3.7), hall=(3.7, 3.9)) -> list[Sketch]:
    """Return a furnished room of each type with this width and depth (metres), and its door in the south."""
    w = bathroom[0]
    wet = (
        piece("toilet", 0.0, 0.0, 0.5, 0.7, front="S"),
        piece("sink", 1.0, 0.0, 0.6, 0.4, front="S"),
        piece("shower", w - 0.9, 0.0, 0.9, 0.9),
    )
    w = bedroom[0]
    bedside = piece("bedside", 0.0, 0.0, 0.4, 0.4, front="S")
    sleeping = (
        piece("bed", 0.5, 0.0, 1.5, 2.0, front="S", children=(bedside,)),
        piece("wardrobe", w - 0.6, 0.3, 0.6, 1.4, front="W"),
    )
    w = kitchen[0]
    chairs = (
        piece("chair", w / 2 - 0.8, 1.5, 0.4, 0.4, front="E"),
        piece("chair", w / 2 + 0.4, 1.5, 0.4, 0.4, front="W"),
    )
    cooking = (
        piece("desk", 0.0, 0.0, w, 0.6, front="S"),
        piece("table", w / 2 - 0.4, 1.3, 0.8, 0.8, children=chairs),
    )
    w = hall[0]
    sitting = (
        piece("sofa", 0.6, 0.0, 1.9, 0.8, front="S"),
        piece("cupboard", w - 0.5, 0.9, 0.5, 1.5, front="W"),
    )
    return [
        Sketch("bedroom", *bedroom, pieces=sleeping),
        Sketch("bathroom", *bathroom, pieces=wet),
        Sketch("kitchen", *kitchen, pieces=cooking),
        Sketch("hall", *hall, pieces=sitting),
    ]


@st.composite
def houses(draw) -> House:
    """Return a valid house: bedroom, bathroom, kitchen and hall clockwise around a main room of 16-20 m²."""

    def length(low: float, high: float) -> float:
        return draw(st.floats(low, high, allow_subnormal=False))

    width, height = length(4.0, 4.45), length(4.0, 4.45)
    rooms = [
        replace_sketch(sketch, length(0.0, 4.0 - sketch.width))
        for sketch in sketches(
            (length(3.5, 3.9), length(3.6, 4.0)),
            (length(2.9, 3.9), length(2.4, 3.0)),
            (length(3.4, 3.9), length(3.6, 4.0)),
            (length(3.6, 3.9), length(3.7, 4.0)),
        )
    ]
    house = built(width, height, tuple((room,) for room in rooms))
    return turned_house(house, draw(st.integers(0, 3)), length(-20, 20), length(-20, 20))


def replace_sketch(sketch: Sketch, shift: float) -> Sketch:
    return Sketch(sketch.type, sketch.width, sketch.depth, shift, sketch.door, sketch.pieces)


def turned_house(house: House, quarters: int, x: float = 0.0, y: float = 0.0) -> House:
    """Return the house turned clockwise by quarters, then moved (metres)."""
    rooms = tuple(moved(turned(room, quarters), x, y) for room in house.star.rooms)
    return changed_star(house, floor=moved(turned(house.star.floor, quarters), x, y), rooms=rooms)
