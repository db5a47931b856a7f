"""HouseExpo (Li and others, IROS 2020): JSON of one house, in metres, with y as in pictures.

``verts`` is the outline of the free floor, walls and doors cut out of it; ``room_category`` has the bounding
boxes of the rooms of each type.
"""

from typing import Any

import shapely
from shapely import Polygon

from logic.errors import RequestError
from logic.house.parts import MOST_ROOMS
from logic.readers.sketch import Passage, Sketch, Space, numbers, require_plain

FORMAT = "a plan of HouseExpo"

MAX_BOXES = 2 * MOST_ROOMS
"""Number of boxes of rooms: a room may be listed under several types."""

SAME = 0.05
"""Metres within which boxes of two types are one room."""

DOOR, DEEP = (0.5, 3.0), (0.02, 0.6)
"""Metres: how wide floor between rooms is where it is a door, and how deep in its wall."""


def is_houseexpo(_: bytes, record: Any) -> bool:
    """Whether a file is one of HouseExpo."""
    return isinstance(record, dict) and {"verts", "room_category"} <= record.keys()


def read_houseexpo(_: bytes, record: Any) -> Sketch:
    """The rooms are their boxes, of which what is no floor and what is another, smaller room's is cut off."""
    floor = shapely.make_valid(outline(record))
    boxes = _boxes(record["room_category"])
    spaces, taken = [], Polygon()
    for box, words in sorted(boxes, key=lambda each: each[0].area):
        parts = shapely.get_parts(shapely.intersection(box, floor).difference(taken))
        polygons = [each for each in parts if isinstance(each, Polygon) and each.area > SAME]
        if not polygons:
            continue
        shape = max(polygons, key=lambda each: each.area)
        taken = taken.union(shape)
        spaces.append(Space(words[0].replace("_", " "), words, shape))
    doors = [Passage(each) for each in shapely.get_parts(floor.difference(taken)) if _is_door(each)]
    return Sketch(FORMAT, spaces[::-1], doors, [])


def outline(record: Any) -> Polygon:
    """The free floor as the file has it. Raises ``RequestError`` where it is none."""
    corners = [numbers(each, 2) for each in _list(record["verts"])]
    if len(corners) < 4 or None in corners:
        raise RequestError(f"plan: {FORMAT} has verts, a list of at least four corners of two numbers each")
    found = Polygon([each[:2] for each in corners if each])
    try:
        require_plain([found])
    except ValueError as error:
        raise RequestError(f"plan: {FORMAT}: {error}") from None
    return found


def _boxes(categories: Any) -> list[tuple[Polygon, tuple[str, ...]]]:
    """The boxes of the rooms, each with all types it is listed under."""
    if not isinstance(categories, dict):
        raise RequestError(f"plan: {FORMAT} has room_category, an object of lists of boxes by type")
    found: list[tuple[Polygon, tuple[str, ...]]] = []
    if sum(len(_list(boxes)) for boxes in categories.values()) > MAX_BOXES:
        raise RequestError(f"plan: {FORMAT} with more than {MAX_BOXES:,} boxes of rooms")
    for word, boxes in categories.items():
        for each in _list(boxes):
            if (box := numbers(each, 4)) is None or box[0] >= box[2] or box[1] >= box[3]:
                raise RequestError(
                    f"plan: a box of {word} is no x1, y1, x2, y2 in metres: {str(each)[:60]!r}"
                )
            shape = shapely.box(box[0], box[1], box[2], box[3])
            for place, (other, words) in enumerate(found):
                if max(abs(a - b) for a, b in zip(shape.bounds, other.bounds, strict=True)) < SAME:
                    found[place] = other, (*words, word)
                    break
            else:
                found.append((shape, (word,)))
    return found


def _is_door(shape: Any) -> bool:
    west, north, east, south = shape.bounds
    deep, wide = sorted((east - west, south - north))
    return shape.geom_type == "Polygon" and DEEP[0] < deep < DEEP[1] and DOOR[0] < wide < DOOR[1]


def _list(value: Any) -> list[Any]:
    return value if isinstance(value, list) else []
