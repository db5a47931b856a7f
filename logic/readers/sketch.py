"""What readers make of a file of another program: rooms as polygons, doors and windows, of one storey."""

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
import shapely
from shapely import Geometry, Polygon

from logic.errors import RequestError
from logic.spelling import listed, quoted, unknown

FAR = 1e8
"""In units of a file: as far from the origin as coordinates of maps are."""


MAX_CORNERS, MAX_MEETINGS, MAX_CROSSINGS = 1 << 16, 20, 1 << 14
"""Corners of all polygons of a file; sides that a side meets, on average; crossings of sides, each counted
for both sides."""

SIDES_PER_QUERY = 256
"""Sides in one query of the spatial index."""


METRES, NEAR = re.compile(r"[-+]?\d{1,6}(?:\.\d{1,6})?\s?m?"), 0.5
"""A height as a user gives it; metres within which it is that of a floor."""


class Space(NamedTuple):
    """A room as a file says it: its name, the words for its type, best first, and its polygon."""

    name: str
    words: tuple[str, ...]
    shape: Polygon
    type: str = ""
    """Its type in the words of a grammar, if the file says that."""
    whole: str = ""
    """Name of the room that it is a part of, if any."""


class Passage(NamedTuple):
    """A door or an opening: the polygon or line where it is; whether it is the entrance, if known."""

    shape: Geometry
    is_entrance: bool | None = None
    is_open: bool = False
    """Whether it has no leaf: a wide gap, or floor that no wall divides."""


class Sketch(NamedTuple):
    """A plan in the units of its file."""

    format: str
    """What the file is, in words: ``a plan of HouseExpo``."""
    spaces: list[Space]
    passages: list[Passage]
    windows: list[Geometry]
    unit: float = 1.0
    """Metres to a unit."""
    north_up: bool = False
    """Whether y grows north, as on maps, and not south, as in pictures."""
    guessed: str = ""
    """Why the unit is a guess, where it is one."""
    has_walls: bool = False
    """Whether walls are as thick as they are drawn, so that rooms that touch are open to each other."""
    noise: float = 0.0
    """Metres by which corners may be beside their places, as the file rounds them."""


def numbers(value: Any, least: int) -> list[float] | None:
    """A list of at least so many finite numbers; None for another value, as a file can hold any."""
    if not isinstance(value, list | tuple) or len(value) < least:
        return None
    if not all(type(each) in (int, float) and abs(each) < 1e6 for each in value):
        return None
    return [float(each) for each in value]


def require_plain(shapes: Sequence[Geometry]) -> None:
    """Raise ``ValueError`` for numbers that are too large, and for more than ``MAX_CORNERS`` corners.

    Sides that cross each other too often are refused, too: the work on the shapes would grow with the square
    of the number of sides.
    """
    corners, shape = shapely.get_coordinates(shapes, return_index=True)
    if not np.all(np.abs(corners) < FAR):
        raise ValueError("numbers are too large")
    if len(corners) > MAX_CORNERS:
        raise ValueError(f"it has {len(corners):,} corners: at most {MAX_CORNERS:,} are read")
    sides: Any = shapely.linestrings(np.stack([corners[:-1], corners[1:]], 1)[shape[:-1] == shape[1:]])
    tree = shapely.STRtree(sides)
    bounds: Any = {"intersects": MAX_MEETINGS * (len(sides) + SIDES_PER_QUERY), "crosses": MAX_CROSSINGS}
    for predicate, most in bounds.items():
        found = 0
        for first in range(0, len(sides), SIDES_PER_QUERY):
            found += tree.query(sides[first : first + SIDES_PER_QUERY], predicate).shape[1]
            if found > most:
                raise ValueError("its outlines cross each other too often: draw them again")


def polygons(shape: Geometry) -> Iterator[Polygon]:
    """Yield the polygons of a geometry, made valid. Raises ``ValueError`` as ``require_plain`` does."""
    require_plain([shape])
    yield from _polygons(shapely.make_valid(shape))


def _polygons(shape: Geometry) -> Iterator[Polygon]:
    for part in shapely.get_parts(shape):
        if isinstance(part, Polygon):
            if part.area > 0:
                yield part
        elif shapely.get_num_geometries(part) > 0 and shapely.get_type_id(part) > 3:
            yield from _polygons(part)


def chosen(names: Sequence[str], storey: str | None, floors: Sequence[float] = ()) -> int:
    """Return which of the storeys with rooms is read, by their names: the one that the user names, or the
    only one. Numbers tell those of one name, and without one, apart. The user may give a height, where those
    of ``floors`` are known, metres.

    Raises ``RequestError`` for a name that no storey has, and without a name where there are several.
    """
    counts = Counter(names)
    storeys = [
        f"{name} {number}".strip() if counts[name] > 1 or not name else name
        for number, name in enumerate(names, 1)
    ]
    if storey is None:
        if len(storeys) == 1:
            return 0
        raise RequestError(
            f"plan: it has {len(storeys)} storeys with rooms ({listed(storeys)}): say which, as in --storey "
            f"{quoted(storeys[0])}"
        )
    same = [place for place, each in enumerate(storeys) if each.casefold() == storey.strip().casefold()]
    if not same and floors and METRES.fullmatch(storey.strip()):
        height = float(storey.strip().removesuffix("m"))
        same = [place for place, floor in enumerate(floors) if abs(floor - height) < NEAR]
    if not same:
        raise RequestError(f"plan: {unknown('storey', storey, storeys)}")
    return same[0]


def require_none(storey: str | None) -> None:
    """Raise ``RequestError`` for the name of a storey of a plan that has one storey."""
    if storey is not None:
        raise RequestError("plan: it has one storey, without a name: leave --storey out")
