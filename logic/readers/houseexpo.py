"""Reader of HouseExpo (Li and others, IROS 2020): JSON of one house, in metres, with y growing south.

``verts`` is the outline of the free floor, without walls and door leaves, traced from a picture of 1 cm per
pixel. ``room_category`` has the boxes of rooms by type; boxes reach over walls and cover door swings.
"""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import shapely
from shapely import Geometry, Polygon

from vitruvius.logic.errors import RequestError
from vitruvius.logic.house.parts import MOST_ROOMS
from vitruvius.logic.readers.sketch import Passage, Sketch, Space, numbers, require_none, require_plain
from vitruvius.logic.readers.types import OUTSIDE, meant
from vitruvius.logic.shapes.corners import parts_of
from vitruvius.logic.shapes.doorways import MIN_ROOM_M2, Doorway, cut, doorways_of

FORMAT = "a plan of HouseExpo"

MAX_BOXES = 2 * MOST_ROOMS
"""Number of boxes of rooms: a room may be listed under several types."""

MAX_WORK = 1 << 24
"""Number of corners times doorways times boxes: each doorway compares the rooms beside it with all boxes."""

SAME_BOX_M = 0.05
"""Metres within which boxes of two types are one room."""

MAX_DOOR_M = 1.3
"""Greatest width, metres, of a gap from a wall's end to a wall's side that is a door if no box decides."""

SURE_OVERLAP, LIKELY_OVERLAP = 0.7, 0.5
"""Intersection over union of a box and a room, from which the box certainly or probably is that room's."""

MAX_BEVEL_M = 0.03
"""Greatest length of a bevel along an axis, metres."""

PART, OF_ROOM, OF_BOX = 0.8, 0.6, 0.7
"""Limits for a room without walls in another room.

In order: its least area, square metres; the least fraction of a room that a box of the whole room covers; and
the least fraction of a box that lies in the room of which the box is a part.
"""

MAX_SNAP_M = 0.3
"""Distance within which a side of such a part moves onto a wall, metres."""


class Boxes(NamedTuple):
    """Boxes of rooms: the floor in each box, and the types under which the box is listed."""

    shapes: np.ndarray
    words: list[tuple[str, ...]]

    def fits(self, room: Geometry) -> np.ndarray:
        """Return the intersection over union of each box and a room, shape (B,)."""
        common = shapely.area(shapely.intersection(self.shapes, room))
        return common / (shapely.area(self.shapes) + shapely.area(room) - common)


def is_houseexpo(_: bytes, record: Any) -> bool:
    """Return True if the JSON is a plan of HouseExpo."""
    return isinstance(record, dict) and {"verts", "room_category"} <= record.keys()


def read_houseexpo(_: bytes, record: Any, storey: str | None) -> Sketch:
    """Return the floor cut into rooms at its doorways; boxes give the types and divide open rooms."""
    require_none(storey)
    floor = shapely.make_valid(outline(record))
    boxes = _boxes(record["room_category"], floor)
    doorways = doorways_of(floor)
    if (len(doorways) + 1) * (len(boxes.words) + 1) * shapely.get_num_coordinates(floor) > MAX_WORK:
        raise RequestError(f"plan: {FORMAT}: too many corners, doorways and boxes of rooms: keep one house")
    rooms, doorways = cut(floor, doorways, lambda one, other, doorway: _is_one(one, other, doorway, boxes))
    passages = [Passage(each.gap, is_open=each.width > MAX_DOOR_M) for each in doorways]
    fits = np.array([boxes.fits(room) for room in rooms])
    spaces = list[Space]()
    for number, room in enumerate(rooms):
        own = np.flatnonzero((fits.argmax(0) == number) & (fits[number] > 0)).tolist()
        for shape, words in _parts(room, boxes, own):
            spaces.append(Space(words[0].replace("_", " "), words, shape))
    spaces.sort(key=lambda space: space.shape.area, reverse=True)
    return Sketch(FORMAT, spaces, passages, [], has_walls=True)


def outline(record: Any) -> Polygon:
    """Return the outline of the free floor. Raises ``RequestError`` if the file has no valid outline."""
    corners = [numbers(each, 2) for each in _list(record["verts"])]
    if len(corners) < 4 or None in corners:
        raise RequestError(f"plan: {FORMAT} has verts, a list of at least four corners of two numbers each")
    found = Polygon([each[:2] for each in corners if each])
    require_plain([found])
    return found


def without_bevels(shape: Polygon) -> Polygon:
    """Return the outline with right angles for bevels of a pixel, if all walls then run along the axes."""
    corners = list[tuple[float, float]]()
    ring = [(x, y) for x, y, *_ in shape.exterior.coords]
    is_level = ring[-2][1] == ring[0][1]
    for (x, y), (to_x, to_y) in pairwise(ring):
        corners.append((x, y))
        if x != to_x and y != to_y:
            if max(abs(to_x - x), abs(to_y - y)) > MAX_BEVEL_M:
                return shape
            # The wall before the bevel is extended to the corner.
            corners.append((to_x, y) if is_level else (x, to_y))
            is_level = not is_level
        else:
            is_level = y == to_y
    return Polygon(corners)


def _boxes(categories: Any, floor: Geometry) -> Boxes:
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
                if max(abs(a - b) for a, b in zip(shape.bounds, other.bounds, strict=True)) < SAME_BOX_M:
                    # A bathroom with a toilet is listed as both.
                    found[place] = other, ((word, *words) if "Toilet" in words else (*words, word))
                    break
            else:
                found.append((shape, (word,)))
    return Boxes(shapely.intersection([shape for shape, _ in found], floor), [words for _, words in found])


def _is_one(one: Polygon, other: Polygon, doorway: Doorway, boxes: Boxes) -> bool:
    """Return True if a gap from a wall's end to a wall's side lies in one room: one box covers both sides."""
    if doorway.is_facing:
        return False
    whole = shapely.union_all([one, other, doorway.shape])
    apart, together = max(_best(boxes, one), _best(boxes, other)), _best(boxes, whole)
    if max(apart, together) < LIKELY_OVERLAP:
        return doorway.width > MAX_DOOR_M
    return apart < SURE_OVERLAP and apart < together


def _best(boxes: Boxes, room: Geometry) -> float:
    return float(boxes.fits(room).max(initial=0.0))


def _parts(room: Polygon, boxes: Boxes, own: Sequence[int]) -> Iterator[tuple[Polygon, tuple[str, ...]]]:
    """Yield a room with the words of its boxes, and each open part that has a box, cut off from the room."""
    common = {box: shapely.intersection(boxes.shapes[box], room).area for box in own}
    is_whole = {box: common[box] > OF_ROOM * room.area for box in own}
    parts = [
        box
        for box in sorted(own, key=lambda box: common[box])
        if not is_whole[box]
        and common[box] > max(PART, OF_BOX * boxes.shapes[box].area)
        and meant(boxes.words[box])[0] != OUTSIDE
    ]
    if not any(is_whole.values()) and parts:
        is_whole[parts.pop()] = True
    for box in parts:
        split = _split(room, boxes.shapes[box], [boxes.shapes[each] for each in own if each != box])
        part, rest = ([each for each in parts_of(some) if each.area > MIN_ROOM_M2] for some in split)
        if len(part) == len(rest) == 1 and min(part[0].area, rest[0].area) > PART:
            yield part[0], boxes.words[box]
            room = rest[0]
    whole = [word for box in own if is_whole[box] for word in boxes.words[box]]
    words = whole or [word for box in own if box not in parts for word in boxes.words[box]]
    yield room, tuple(words) or ("Room",)


def _split(room: Polygon, box: Polygon, others: Sequence[Polygon]) -> tuple[Geometry, Geometry]:
    """Return the room inside a box and the room outside it.

    A side of the box moves onto a near wall of the room; without one, halfway to a near side of another box.
    """
    corners = shapely.get_coordinates(room)
    edges = []
    for k, edge in enumerate(box.bounds):
        walls = corners[:, k % 2]
        near = walls[abs(walls - edge).argmin()]
        if abs(near - edge) >= MAX_SNAP_M:
            facing = [other.bounds[(k + 2) % 4] for other in others]
            near = (min(facing, key=lambda place: abs(place - edge), default=edge) + edge) / 2
        edges.append(near if abs(near - edge) < MAX_SNAP_M else edge)
    inner = shapely.box(*edges)
    return room & inner, room - inner


def _list(value: Any) -> list[Any]:
    return value if isinstance(value, list) else []
