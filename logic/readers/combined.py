"""Division of a room of several uses, such as ``Wohnen/Essen/Kochen``, into one room for each use.

The rooms are open to each other.
"""

from collections.abc import Iterator, Sequence
from itertools import pairwise, repeat
from math import atan2, degrees
from typing import Any, NamedTuple

import shapely
from shapely import LineString, Polygon, affinity

from vitruvius.logic.readers.length_units import metres_to
from vitruvius.logic.readers.sketch import Passage, Sketch, Space
from vitruvius.logic.readers.types import TOGETHER, Least, least_sizes, uses
from vitruvius.logic.shapes.lines import MAX_WALL_M

MAX_CORNERS, MAX_OUTLINE = 8, 64
"""Number of corners at which a room may be cut, for each axis; number of corners of a room that is cut."""


class Cut(NamedTuple):
    """Parts of a room, one for each use, and the lines between them."""

    parts: list[Polygon]
    lines: list[LineString]


def divided(sketch: Sketch, unit: str | None = None) -> tuple[Sketch, list[str]]:
    """Return a sketch whose rooms have one use each, and notes for the user. ``unit`` is the user's.

    Each use gets floor in proportion to the least floor that it needs. A use is dropped if the floor is too
    small for it, or if another room has that use. The best cut crosses no door or window, and gives each part
    a window.
    """
    metres = metres_to(unit) if unit else sketch.unit
    wanted = [() if space.type else uses(space.words) for space in sketch.spaces]
    had = {each[0] for each in wanted if len(each) == 1}
    spaces, passages, notes = list[Space](), list(sketch.passages), list[str]()
    for space, each in zip(sketch.spaces, wanted, strict=True):
        if len(each) < 2:
            spaces.append(space)
            continue
        own = _fitting([use for use in least_sizes() if use in each and use not in had], space, metres)
        while (cut := _best(space, own, sketch, metres)) is None and len(own) > 1:
            own = own[:-1]
        had |= {*own}
        if cut is None:
            spaces.append(space._replace(words=tuple((own or each)[:1])))
            continue
        names = [_name(space.name, use) for use in own]
        spaces += [
            space._replace(name=name, words=(use,), shape=part)
            for name, use, part in zip(names, own, cut.parts, strict=True)
        ]
        passages += [Passage(line, is_open=True) for line in cut.lines]
        notes.append(
            f"{space.name} is read as {len(own)} rooms that are open to each other: {', '.join(names)}"
        )
    return sketch._replace(spaces=spaces, passages=passages), notes


def _fitting(own: list[str], space: Space, metres: float) -> list[str]:
    """Return the uses for which a room has enough floor, the most important first."""
    area, least = space.shape.area * metres**2, least_sizes()
    while len(own) > 1 and sum(least[use].floor for use in own) > area:
        own = own[:-1]
    return own


def _name(name: str, use: str) -> str:
    """Return the name of the part for a use: its own words in the room's name, else the name and the use."""
    return next(
        (part.strip(" -") for part in TOGETHER.split(name) if uses([part]) == (use,)), f"{name} {use}"
    )


def _best(space: Space, own: Sequence[str], sketch: Sketch, metres: float) -> Cut | None:
    """Return the best cut of a room; None for one use, or if every cut leaves a part that is too narrow."""
    if len(own) < 2 or shapely.get_num_coordinates(space.shape) > MAX_OUTLINE:
        return None
    reach = MAX_WALL_M / metres
    near = [each.shape for each in sketch.spaces if space.shape.dwithin(each.shape, 2 * reach)]
    around = shapely.union_all([each for each in near if each is not space.shape]).buffer(reach)
    panes = [each for each in sketch.windows if shapely.distance(each, space.shape) < reach]
    doors = (each.shape for each in sketch.passages)
    openings: list[Any] = [*(each for each in doors if space.shape.dwithin(each, reach)), *panes]

    def is_dark(part: Polygon) -> bool:
        if sketch.windows:
            return all(shapely.distance(part, pane) > reach for pane in panes)
        inner = shapely.difference(space.shape, part).buffer(reach)
        return shapely.difference(part.exterior - around, inner).length * metres < 1

    def cost(cut: Cut) -> tuple[float, ...]:
        crossed = sum(line.distance(each) * metres < 0.1 for line in cut.lines for each in openings)
        corners = sum(len(shapely.simplify(part, 0.01 / metres).exterior.coords) for part in cut.parts)
        shape = sum(part.exterior.length**2 / part.area for part in cut.parts)
        return crossed, sum(map(is_dark, cut.parts)), corners, round(shape, 6)

    return min(_cuts(space.shape, [least_sizes()[use] for use in own], metres), key=cost, default=None)


def _cuts(room: Polygon, least: Sequence[Least], metres: float) -> Iterator[Cut]:
    """Yield the cuts of a room along its walls: first the first use is cut off, then the rest is divided."""
    (x, y), (to_x, to_y) = max(pairwise(room.exterior.coords), key=lambda side: LineString(side).length)
    turn = degrees(atan2(to_y - y, to_x - x)) % 90
    upright, near = affinity.rotate(room, -turn, origin=(0, 0)), 0.01 / metres
    for axis in (0, 1):
        for first, rest, line in _halves(upright, axis, least[0], least[1:], metres):
            ways = [([first, rest], [line])]
            if len(least) > 2:
                ways = [
                    (
                        [first, one, other],
                        [*(line.intersection(each.buffer(near)) for each in (one, other)), across],
                    )
                    for one, other, across in _halves(rest, 1 - axis, least[1], least[2:], metres)
                ]
            for parts, lines in ways:
                fit = map(_fits, parts, least, repeat(metres))
                if all(fit) and all(isinstance(each, LineString) for each in lines):
                    back = [affinity.rotate(each, turn, origin=(0, 0)) for each in (*parts, *lines)]
                    yield Cut(back[: len(parts)], back[len(parts) :])


def _halves(
    room: Any, axis: int, least: Least, others: Sequence[Least], metres: float
) -> Iterator[tuple[Any, Any, Any]]:
    """Yield the part of a room for one use, the rest for the others, and the line between them.

    The part lies on either side of the line. The line divides the floor by shares, to a centimetre, and
    leaves each side as wide as its uses need; or it runs through a corner of the room.
    """
    low, high = shapely.bounds(room).tolist()[axis::2]
    corners = shapely.get_coordinates(shapely.simplify(room, 0.1 / metres))[:, axis].tolist()
    inner = sorted({each for each in corners if low < each < high})[:MAX_CORNERS]
    for is_first in (True, False):
        for place in (_share(room, axis, is_first, least, others, metres), *inner):
            one, other, line = _parted(room, axis, place)
            yield (one, other, line) if is_first else (other, one, line)


def _share(
    room: Any, axis: int, is_first: bool, least: Least, others: Sequence[Least], metres: float
) -> float:
    """Return the place of a line that leaves both sides their share of the floor and the width they need."""
    low, high = shapely.bounds(room).tolist()[axis::2]
    share = least.floor / (least.floor + sum(each.floor for each in others))
    wanted, ends = room.area * (share if is_first else 1 - share), [low, high]
    for _ in range(20):
        middle = sum(ends) / 2
        ends[room.intersection(_below(room, axis, middle)).area > wanted] = middle
    wide, wide_other = least.width / metres, max(each.width for each in others) / metres
    margins = (wide, wide_other) if is_first else (wide_other, wide)
    place = max(low + margins[0], min(sum(ends) / 2, high - margins[1]))
    return low + round((place - low) * metres, 2) / metres


def _parted(room: Any, axis: int, place: float) -> tuple[Any, Any, Any]:
    """Return the parts of a room below and above a place along an axis, and the line between them."""
    west, south, east, north = shapely.bounds(room).tolist()
    below = _below(room, axis, place)
    line = LineString([(place, south), (place, north)] if axis == 0 else [(west, place), (east, place)])
    one, other = room.intersection(below), room.difference(below)
    near = 1e-6 * (east - west + north - south)
    return (
        one,
        other,
        shapely.line_merge(line.intersection(one.buffer(near)).intersection(other.buffer(near))),
    )


def _below(room: Any, axis: int, place: float) -> Polygon:
    west, south, east, north = shapely.bounds(room).tolist()
    return shapely.box(west, south, place, north) if axis == 0 else shapely.box(west, south, east, place)


def _fits(part: Any, least: Least, metres: float) -> bool:
    """Return True if a part has the floor and the width that a use needs."""
    half = (least.width / 2 - 0.01) / metres
    is_whole = isinstance(part, Polygon) and part.area * metres**2 > least.floor - 0.1
    return is_whole and not part.buffer(-half, join_style="mitre").is_empty
