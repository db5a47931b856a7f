"""What readers make of a file of another program: rooms as polygons, doors and windows, in its units."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import shapely
from shapely import Geometry, Polygon

FAR = 1e8
"""In units of a file: as far from the origin as coordinates of maps are."""


class Space(NamedTuple):
    """A room as a file says it: its name, the words for its type, best first, and its polygon."""

    name: str
    words: tuple[str, ...]
    shape: Polygon


class Passage(NamedTuple):
    """A door or a wide opening: the polygon or line where it is; whether it is the entrance, if known."""

    shape: Geometry
    is_entrance: bool | None = None


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


def numbers(value: Any, least: int) -> list[float] | None:
    """A list of at least so many finite numbers; None for another value, as a file can hold any."""
    if not isinstance(value, list | tuple) or len(value) < least:
        return None
    if not all(type(each) in (int, float) and abs(each) < 1e6 for each in value):
        return None
    return [float(each) for each in value]


def polygons(shape: Geometry) -> Iterator[Polygon]:
    """The polygons of a geometry, made valid. Raises ``ValueError`` for numbers that are too large."""
    if not np.all(np.abs(shapely.get_coordinates(shape)) < FAR):
        raise ValueError("numbers are too large")
    yield from _polygons(shapely.make_valid(shape))


def _polygons(shape: Geometry) -> Iterator[Polygon]:
    for part in shapely.get_parts(shape):
        if isinstance(part, Polygon):
            if part.area > 0:
                yield part
        elif shapely.get_num_geometries(part) > 0 and shapely.get_type_id(part) > 3:
            yield from _polygons(part)
