"""Checks of doors and windows in houses whose rooms share walls.

Doors and windows lie in walls that both rooms share or in outer walls, and clear of corners, of each other
and of furniture.
"""

from collections.abc import Collection, Iterator
from typing import Any, Generic, TypeVar

import numpy as np
import shapely

from vitruvius.logic.checking.fault import Fault
from vitruvius.logic.checking.figures import figure, number
from vitruvius.logic.checking.names import named
from vitruvius.logic.house.boxes import TOLERANCE, Box, is_on_wall, overlap
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import OUTSIDE, Door, Rect, Room, Window
from vitruvius.logic.house.promises import PASSAGE, Promises
from vitruvius.logic.spelling import article

T = TypeVar("T", bound=Rect)

BEFORE = 0.3
"""Distance within which furniture hides a window, metres."""


def plan_doors(house: House, promises: Promises) -> Iterator[Fault]:
    """Yield a fault for each door that is too narrow, on no shared wall, or between wrong types."""
    rooms = {room.name: room for room in house.tiles}
    tiles, openings, gardens = _Rects(rooms.values()), _Rects(house.doors), {*house.garden_doors}
    for door in house.doors:
        name, names = _between(house, door), _joined(door)
        joined = [rooms[each] for each in names]
        one, other = (rooms[each].type if each in rooms else OUTSIDE for each in door.between)
        least = promises.least_door(one, other)
        least = PASSAGE if least is None else least
        if door.length < least - TOLERANCE:
            width = figure(door.length, least, digits=3)
            yield Fault(f"{name}: is {width} m wide (at least {number(least)})", names)
        if len(joined) == 1:
            yield from _not_outer(house, tiles, door, joined[0], f"{name}:")
        elif not _is_shared(door, *joined):
            yield Fault(f"{name}: is not on a wall that they share", names)
        if (
            promises.opens
            and door not in gardens
            and not (other in promises.opens.get(one, ()) or one in promises.opens.get(other, ()))
        ):
            yield Fault(f"{name}: {one} and {other} do not open into each other", names)
        if (promises.openings or promises.parts) and door.opening and not promises.are_open(one, other):
            yield Fault(f"{name}: has no leaf (must have one)", names)
    leafless = np.array([door.opening for door in house.doors])
    for index, one in enumerate(house.doors):
        meet = openings.met_by(one)
        if one.opening:  # Another wall may begin at the end of an opening.
            meet &= ~leafless | (openings.shared(one.box) > TOLERANCE)
        for other in openings.where(meet, index + 1):
            text = f"{_between(house, one)}: meets the {_between(house, other)}"
            yield Fault(text, _joined(one) + _joined(other))
    if promises.entrance and not any(door.is_entrance for door in house.doors):
        yield Fault("house: has no door to the outside")


def plan_corners(house: House, _: Promises) -> Iterator[Fault]:
    """Yield a fault for each door or window that reaches past a corner of its room into the wall across."""
    rooms = {room.name: room for room in house.rooms}
    windows = [
        (window, (window.room,), f"{named(rooms[window.room])}: {_window(window)}")
        for window in house.windows
    ]
    doors = [(door, _joined(door), f"{_between(house, door)}:") for door in house.doors]
    for opening, names, its in (*doors, *windows):
        k = _along(opening)
        ends = [(rooms[name].box[k], rooms[name].box[k + 2]) for name in names]
        juts = max(max(start - opening.box[k], opening.box[k + 2] - end) for start, end in ends)
        # An opening that reaches farther is on no wall of the room.
        if TOLERANCE < juts <= house.half_wall + TOLERANCE:
            yield Fault(f"{its} reaches {figure(juts)} m into the wall across", names)


def plan_windows(house: House, promises: Promises) -> Iterator[Fault]:
    """Yield a fault for each wrong window, and for each room that lacks a window.

    A window is wrong if it lies in no outer wall, over another opening, or behind furniture.
    """
    rooms = {room.name: room for room in house.tiles}
    tiles, doors, windows = _Rects(rooms.values()), _Rects(house.doors), _Rects(house.windows)
    for index, window in enumerate(house.windows):
        room = rooms[window.room]
        name = f"{named(room)}: {_window(window)}"
        yield from _not_outer(house, tiles, window, room, name, promises.outdoor)
        for kind, meet in (
            ("a door", doors.met_by(window)),
            ("another window", windows.met_by(window)[:index]),
        ):
            if meet.any():
                yield Fault(f"{name} meets {kind}", (room.name,))
        for piece in room.pieces:
            if (
                piece.type in promises.hides
                and overlap(_before(window, house.half_wall), piece.box) > TOLERANCE
            ):
                yield Fault(f"{name} is behind {article(piece.type)}", (room.name,))
    lit = {window.room for window in house.windows}
    outside = {room.name for room in house.rooms if room.type in promises.outdoor}
    by_doors = {name for door in house.doors if outside & {*door.between} for name in door.between}
    by_doors |= {name for door in house.garden_doors for name in door.between}
    for room in house.rooms:
        if room.type in promises.lit and room.name not in lit | by_doors | outside:
            yield Fault(f"{named(room)}: has no window", (room.name,))
        if room.name in outside & lit:
            yield Fault(f"{named(room)}: has a window, and is outside", (room.name,))
        if room.name in outside and not _at_outer_wall(house, tiles, room):
            yield Fault(f"{named(room)}: has no outer wall, and is outside", (room.name,))


class _Rects(Generic[T]):
    """Rectangles that NumPy compares with one rectangle in one operation."""

    def __init__(self, rects: Collection[T]) -> None:
        self._rects = [*rects]
        self._boxes = np.array([rect.box for rect in rects], float).reshape(-1, 4)
        self._along = np.array([_along(rect) for rect in rects])

    def where(self, mask: Any, first: int = 0) -> Iterator[T]:
        """Yield the rectangles that a mask (N,) selects, from index ``first`` on."""
        yield from (self._rects[index] for index in np.flatnonzero(mask[first:]) + first)

    def apart(self, box: Box) -> np.ndarray:
        """Return the gaps from each rectangle to the box (N, 2), metres; negative if they overlap."""
        return np.maximum(self._boxes[:, :2] - box[2:], np.subtract(box[:2], self._boxes[:, 2:]))

    def met_by(self, opening: Rect) -> np.ndarray:
        """Return a mask (N,) of the openings that touch or overlap another opening in the same wall."""
        away = np.hypot(*self.apart(opening.box).clip(0).T)
        return (away <= TOLERANCE) & (self._along == _along(opening))

    def shared(self, segment: Box) -> np.ndarray:
        """Return the length of a segment in or on each rectangle (N,), metres; negative if they are apart."""
        along, across = (
            np.minimum(segment[k + 2], self._boxes[:, k + 2]) - np.maximum(segment[k], self._boxes[:, k])
            for k in ((0, 1) if segment[2] - segment[0] > segment[3] - segment[1] else (1, 0))
        )
        return np.where(across >= -TOLERANCE, along, across)


def _at_outer_wall(house: House, tiles: _Rects[Room], room: Room) -> bool:
    """Return True if a part of the room's boundary has no other room behind it."""
    whole = room.grown(house.half_wall).box
    beside = tiles.where((tiles.apart(whole) <= PASSAGE).all(axis=1))
    others = shapely.union_all([shapely.box(*other.box) for other in beside if other.name != room.name])
    border = shapely.box(*whole).exterior
    return border.difference(others.buffer(TOLERANCE, join_style="mitre")).length > PASSAGE


def _is_shared(door: Door, one: Room, other: Room) -> bool:
    """Return True if a door lies on a wall of one room that is also the facing wall of the other."""
    return any(is_on_wall(door, one, wall) and is_on_wall(door, other, (wall + 2) % 4) for wall in range(4))


def _not_outer(
    house: House, tiles: _Rects[Room], opening: Rect, room: Room, name: str, outdoor: Collection[str] = ()
) -> Iterator[Fault]:
    """Yield faults of an opening, ``name``, that leads neither outside nor to a room of ``outdoor`` types."""
    if not any(is_on_wall(opening, room, wall) for wall in range(4)):
        yield Fault(f"{name} is not on a wall of the room", (room.name,))
    entered = tiles.where(tiles.shared(opening.box) > TOLERANCE)
    into = [other for other in entered if other.name != room.name]
    for other in into:
        if other.type not in outdoor:
            yield Fault(f"{name} leads into {named(other)}, not outside", (room.name, other.name))
    if house.wall_thickness and not into:
        outside = house.wall_thickness.outer - house.half_wall
        before = _outside(opening, room, outside)
        for other in tiles.where((tiles.apart(before) <= outside).all(axis=1)):
            if other.name != room.name and overlap(other.grown(outside).box, before) > TOLERANCE:
                yield Fault(f"{name} is behind an outer wall of {named(other)}", (room.name, other.name))


def _outside(opening: Rect, room: Room, off: float) -> Box:
    """Return a strip of 1 cm outside an opening, at the outer face of its wall, ``off`` metres away."""
    box, axis = [*opening.box], 1 - _along(opening)
    way = 1 if box[axis] > (room.box[axis] + room.box[axis + 2]) / 2 else -1
    ends = sorted((box[axis] + way * off, box[axis] + way * (off + 0.01)))
    box[axis], box[axis + 2] = ends
    return box[0], box[1], box[2], box[3]


def _along(opening: Rect) -> int:
    """Return the axis that an opening runs along: 0 for x, 1 for y."""
    return int(opening.height > opening.width)


def _before(window: Window, half: float) -> Box:
    """Return the floor on both sides of a window; ``half`` is half the thickness of its wall, metres."""
    west, north, east, south = window.box
    by_x, by_y = (BEFORE + half, 0.0) if _along(window) else (0.0, BEFORE + half)
    return west - by_x, north - by_y, east + by_x, south + by_y


def _joined(door: Door) -> tuple[str, ...]:
    """Return the names of the rooms that a door leads into."""
    return tuple(name for name in door.between if name != OUTSIDE)


def _window(window: Window) -> str:
    return f"its window at ({window.x:.2f}, {window.y:.2f})"


def _between(house: House, door: Door) -> str:
    names = (named(house.room(name)) if name != OUTSIDE else OUTSIDE for name in door.between)
    return f"door between {' and '.join(names)}"
