"""Rooms with more than four corners as boxes side by side: the largest is the room, the others are its parts.

A gap that is too narrow for a room, such as a niche, goes to a room beside it.
"""

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations

import shapely
from msgspec import UNSET, UnsetType
from shapely import Geometry, Polygon

from vitruvius.logic.house.parts import LONGEST_NAME, Room
from vitruvius.logic.house.promises import PASSAGE
from vitruvius.logic.shapes.corners import GRID_M, boxes, parts_of, size_of

MIN_PART_M = 0.6
"""Least width of a part of a room, metres; a narrower part is a niche."""

Named = Sequence[tuple[str, str, Polygon]]
"""Name, type and axis-aligned shape of each room."""


def room_boxes(rooms: Named, notes: list[str]) -> tuple[list[Room], list[tuple[str, str]]]:
    """Return the boxes of rooms, and the pairs of boxes that are adjacent parts of one room.

    A niche is left out. If other rooms lie beside a niche, one of them takes it, or it becomes a part.
    """
    split = [list(boxes(shape)) for _, _, shape in rooms]
    every = [(number, part, _is_niche(part, each)) for number, each in enumerate(split) for part in each]
    parts = [(number, part) for number, part, is_niche in every if not is_niche]
    niches = [(number, part) for number, part, is_niche in every if is_niche]

    def say(place: int, strip: Polygon) -> None:
        name = rooms[parts[place][0]][0]
        notes.append(f"{size_of(strip)} beside {name} is too narrow for a room and becomes floor of {name}")

    between = [
        niche for number, niche in niches if any(touch(part, niche) for of, part in parts if of != number)
    ]
    shapes = taken_up([part for _, part in parts], between, say)
    parts = [(number, shape) for (number, _), shape in zip(parts, shapes, strict=True)]
    free = shapely.union_all(gaps(shapes))
    for number, niche in niches:
        beside = [shape for (of, _), shape in zip(parts, shapes, strict=False) if of != number]
        if any(shape.covers(niche.centroid) for shape in shapes):
            continue
        if shapely.intersects(free, niche.centroid) or any(touch(each, niche) for each in beside):
            parts.append((number, niche))
        else:
            notes.append(
                f"a niche of {rooms[number][0]} of {size_of(niche)} is left out: rooms are rectangles"
            )
    for gap in gaps([shape for _, shape in parts]):
        for part in boxes(gap):
            of = max(range(len(parts)), key=lambda k: shapely.intersection(parts[k][1], part).length)
            say(of, part)
            parts.append((parts[of][0], part))
    found, joints = list[Room](), list[tuple[str, str]]()
    taken = {name for name, _, _ in rooms}
    for number, (name, kind, shape) in enumerate(rooms):
        own = [part for of, part in parts if of == number]
        names = [name, *_more(name, len(own) - 1, taken)]
        for part, each in zip(own, names, strict=True):
            # The largest part of a room has the room's type.
            whole = name if each != name and touch(part, own[0]) else UNSET
            found.append(room_of(part, each, kind if each == name else "", whole))
        joints += [
            (a, b)
            for (a, one), (b, other) in combinations(zip(names, own, strict=True), 2)
            if touch(one, other)
        ]
        if len(own) > 1:
            notes.append(
                f"{name} has {len(shape.exterior.coords) - 1} corners, and rooms are rectangles: it is read "
                f"as {len(own)} rooms, {', '.join(names)}"
            )
    return found, joints


def room_of(box: Polygon, name: str, kind: str, whole: str | UnsetType) -> Room:
    """Return the room that a box describes, rounded to a tenth of a millimetre."""
    west, north, east, south = (round(edge, 4) for edge in box.bounds)
    size = round(east - west, 6), round(south - north, 6)
    return Room(west, north, *size, name=name, type=kind, part_of=whole)


def _is_niche(part: Polygon, parts: Sequence[Polygon]) -> bool:
    west, north, east, south = part.bounds
    return part is not parts[0] and min(east - west, south - north) < MIN_PART_M


def _more(name: str, number: int, taken: set[str]) -> Iterator[str]:
    """Yield names for the further parts of a room."""
    place = 1
    for _ in range(number):
        while (own := f"{name[: LONGEST_NAME - 5]} {place}") in taken or place == 1:
            place += 1
        taken.add(own)
        yield own


def touch(one: Polygon, other: Polygon) -> bool:
    """Return True if the boxes share a wall that is wide enough to walk through."""
    return shapely.intersection(one, other).length > MIN_PART_M


def taken_up(
    rooms: Sequence[Polygon], niches: Sequence[Polygon], say: Callable[[int, Polygon], None]
) -> list[Polygon]:
    """Return the boxes of rooms, enlarged by each narrow gap that runs along a whole side of a room.

    ``say(room, strip)`` is called for each strip of floor that a room takes.
    """
    found = list(rooms)
    for gap in gaps(found, niches):
        free: Geometry = gap
        beside = [room for room, box in enumerate(found) if shapely.distance(box, gap) < GRID_M]
        while not free.is_empty and beside:
            strips = [(_strip(found[room], side, free), room) for room in beside for side in range(4)]
            strip, room = max(strips, key=lambda each: each[0].area)
            if strip.area < MIN_PART_M * GRID_M:
                break
            say(room, strip)
            west, north, east, south = (found[room] | strip).bounds
            found[room] = shapely.box(west, north, east, south)
            free = shapely.difference(free, strip, grid_size=GRID_M)
    return found


def gaps(rooms: Sequence[Polygon], niches: Sequence[Polygon] = ()) -> list[Polygon]:
    """Return the gaps between boxes of rooms, and the niches, that are no wider than ``MIN_PART_M``."""
    floor = shapely.union_all(list(rooms), grid_size=GRID_M)
    hulls = shapely.union_all([Polygon(each.exterior) for each in parts_of(floor)])
    closed = hulls.buffer(PASSAGE / 2, join_style="mitre").buffer(-PASSAGE / 2, join_style="mitre")
    free = parts_of(shapely.difference(shapely.union_all([closed, *niches]), floor, grid_size=GRID_M))
    return [each for each in free if each.buffer(-MIN_PART_M / 2 - GRID_M, join_style="mitre").is_empty]


def _strip(room: Polygon, side: int, gap: Geometry) -> Polygon:
    """Return the largest box in a gap along a whole side of a room (west, north, east or south)."""
    if shapely.distance(room, gap) > GRID_M:
        return Polygon()
    edges = [*room.bounds]
    start, outward = edges[side], (-1 if side < 2 else 1)
    places = {float(each) for each in shapely.get_coordinates(gap)[:, side % 2]}
    best = Polygon()
    for place in sorted(places, key=lambda place: outward * place):
        if outward * (place - start) > GRID_M:
            edges[side], edges[(side + 2) % 4] = place, start
            west, north, east, south = edges
            strip = shapely.box(west, north, east, south)
            if shapely.difference(strip, gap, grid_size=GRID_M).area > GRID_M * strip.length:
                break
            best = strip
    return best
