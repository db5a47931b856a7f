"""What readers make of a file of another program: rooms as polygons, doors and windows, in its units."""

from typing import Any, NamedTuple

from shapely import Geometry, Polygon


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
