"""Sketch of a plan, the result of each reader: rooms as polygons, doors and windows, of one storey."""

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
import shapely
from shapely import Geometry, Polygon

from vitruvius.logic.errors import RequestError
from vitruvius.logic.house.parts import LONGEST_NAME, MOST_OPENINGS, MOST_ROOMS
from vitruvius.logic.spelling import listed, numbered, quoted, unknown

MAX_COORDINATE = 1e8
"""Greatest distance from the origin, in units of the file; coordinates of maps are smaller."""


MAX_CORNERS, MAX_MEETINGS, MAX_CROSSINGS = 1 << 16, 20, 1 << 14
"""Largest numbers: corners in a file, sides that a side meets on average, and crossings of sides.

Each crossing counts for both sides.
"""

MAX_NEAR = 1 << 23
"""Number of pairs of sides whose bounding boxes overlap, which are compared."""

SIDES_PER_QUERY = 256
"""Number of sides in one query of the spatial index."""


METRES, MAX_FLOOR_DISTANCE_M = re.compile(r"[-+]?\d{1,6}(?:\.\d{1,6})?\s?m?"), 0.5
"""Height as a user writes it; greatest distance of a floor from that height, metres."""


class Space(NamedTuple):
    """A room of a file: its name, the words for its type, best first, and its polygon."""

    name: str
    words: tuple[str, ...]
    shape: Polygon
    type: str = ""
    """Type as the grammar writes it, if the file states one."""
    whole: str = ""
    """Name of the room that this part belongs to, if any."""


class Passage(NamedTuple):
    """A door or an opening, as a polygon or a line. ``is_entrance`` is None if the file does not say."""

    shape: Geometry
    is_entrance: bool | None = None
    is_open: bool = False
    """True for an opening without a leaf: a wide gap, or a border without a wall."""


class Sketch(NamedTuple):
    """A plan in the units of its file."""

    format: str
    """Format of the file in words: ``a plan of HouseExpo``."""
    spaces: list[Space]
    passages: list[Passage]
    windows: list[Geometry]
    unit: float = 1.0
    """Metres per unit."""
    north_up: bool = False
    """True if y grows north, as on maps; False if y grows south, as in pictures."""
    guessed: str = ""
    """Reason why the unit is a guess; empty if the file states the unit."""
    has_walls: bool = False
    """True if walls are drawn with their thickness, so that rooms that touch are open to each other."""
    noise: float = 0.0
    """Rounding of corners in the file, metres."""


def numbers(value: Any, least: int) -> list[float] | None:
    """Return a list of at least ``least`` finite numbers; None for any other value of a file."""
    if not isinstance(value, list | tuple) or len(value) < least:
        return None
    if not all(type(each) in (int, float) and abs(each) < 1e6 for each in value):
        return None
    return [float(each) for each in value]


def require_few(rooms: int, openings: int) -> None:
    """Raise ``RequestError`` for more rooms than ``MOST_ROOMS`` or more openings than ``MOST_OPENINGS``."""
    if rooms > MOST_ROOMS or openings > MOST_OPENINGS:
        raise RequestError(
            f"plan: it has {numbered(rooms, 'room')} and {openings:,} doors and windows: at most "
            f"{MOST_ROOMS:,} and {MOST_OPENINGS:,} are read"
        )


def require_plain(shapes: Sequence[Geometry]) -> None:
    """Raise ``RequestError`` for numbers that are too large, and for more than ``MAX_CORNERS`` corners.

    Sides that cross each other too often are refused, too: the work on the shapes would grow with the square
    of the number of sides. ``shapes`` are all shapes of a file, which a reader checks before it makes them
    valid.
    """
    corners, shape = shapely.get_coordinates(shapely.get_parts(shapes), return_index=True)
    if not np.all(np.abs(corners) < MAX_COORDINATE):
        raise RequestError("plan: numbers are too large")
    if len(corners) > MAX_CORNERS:
        raise RequestError(f"plan: it has {len(corners):,} corners: at most {MAX_CORNERS:,} are read")
    sides: Any = shapely.linestrings(np.stack([corners[:-1], corners[1:]], 1)[shape[:-1] == shape[1:]])
    tree = shapely.STRtree(sides)
    bounds: Any = {
        None: MAX_NEAR,
        "intersects": MAX_MEETINGS * (len(sides) + SIDES_PER_QUERY),
        "crosses": MAX_CROSSINGS,
    }
    for predicate, most in bounds.items():
        found = 0
        for first in range(0, len(sides), SIDES_PER_QUERY):
            found += tree.query(sides[first : first + SIDES_PER_QUERY], predicate).shape[1]
            if found > most:
                raise RequestError("plan: its outlines cross each other too often: draw them again")


def polygons(shape: Geometry) -> Iterator[Polygon]:
    """Yield the polygons of a geometry that ``require_plain`` accepted, made valid."""
    yield from _polygons(shapely.make_valid(shape))


def _polygons(shape: Geometry) -> Iterator[Polygon]:
    for part in shapely.get_parts(shape):
        if isinstance(part, Polygon):
            if part.area > 0:
                yield part
        elif shapely.get_num_geometries(part) > 0 and shapely.get_type_id(part) > 3:
            yield from _polygons(part)


def chosen(names: Sequence[str], storey: str | None, floors: Sequence[float] = ()) -> int:
    """Return the index of the storey to read: the storey that the user names, or the only one.

    Storeys with the same name, or without one, get numbers. If the heights of ``floors`` (metres) are known,
    the user may give a height instead of a name.

    Raises ``RequestError`` for a name that no storey has, and if several storeys but no name are given.
    """
    names = [name[:LONGEST_NAME] for name in names]
    counts = Counter(names)
    storeys = [
        f"{name} {number}".strip() if counts[name] > 1 or not name else name
        for number, name in enumerate(names, 1)
    ]
    if storey is None:
        if len(storeys) == 1:
            return 0
        raise RequestError(
            f"plan: it has {len(storeys)} storeys with rooms ({listed(storeys)}): choose one, as in "
            f"--storey {quoted(storeys[0])}"
        )
    same = [place for place, each in enumerate(storeys) if each.casefold() == storey.strip().casefold()]
    if not same and floors and METRES.fullmatch(storey.strip()):
        height = float(storey.strip().removesuffix("m"))
        same = [place for place, floor in enumerate(floors) if abs(floor - height) < MAX_FLOOR_DISTANCE_M]
    if not same:
        raise RequestError(f"plan: {unknown('storey', storey, storeys)}")
    return same[0]


def require_none(storey: str | None) -> None:
    """Raise ``RequestError`` if the user names a storey of a plan that has only one."""
    if storey is not None:
        raise RequestError("plan: it has one storey, without a name: leave --storey out")
