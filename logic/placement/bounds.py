"""Possible ranges of the lengths of a house, and the constraints that bind them."""

from collections.abc import Iterable, Sequence
from typing import Any

from clingo import Function, Symbol

from vitruvius.logic.house.parts import Rect
from vitruvius.logic.placement.layout import RoomLayout
from vitruvius.logic.placement.placer import Placer
from vitruvius.logic.placement.prolog import Term
from vitruvius.logic.request.fixed_rooms import FixedRoom


def room_bounds(
    placer: Placer, room: RoomLayout, target: Symbol, taken: float | None = None
) -> dict[str, Any]:
    """Return the ranges of a target's lengths in a room, and the constraints that bind: see core.pl.

    ``taken``: the area of all other rooms of a star, square metres, if the room has the rest of its area.
    """
    others = "any" if taken is None else float(taken)
    return placer.ask("room_lengths", room.type, room.furniture, room.given, others, room.seed, target)


def wall_bounds(
    placer: Placer, layout: Iterable[Symbol], rooms: Sequence[Rect], number: int, outlined: bool = False
) -> dict[str, Any]:
    """Return the ranges of the sizes of a plan's room, and the constraints that bind: ``plan_bounds.pl``.

    ``outlined``: True if the outline of the plan is fixed.
    """
    west, north = min(room.x for room in rooms), min(room.y for room in rooms)
    boxes = [
        Term(
            "box",
            place,
            *(float(x - west) for x in room.box[::2]),
            *(float(y - north) for y in room.box[1::2]),
        )
        for place, room in enumerate(rooms)
    ]
    ends = {"west": 0.0, "north": 0.0}
    ends["east"] = float(max(room.x + room.width for room in rooms) - west)
    ends["south"] = float(max(room.y + room.height for room in rooms) - north)
    lines = [Term("at", Function("outline", [Function(side)]), place) for side, place in ends.items()]
    return placer.ask("plan_room_lengths", layout, lines if outlined else [], boxes, number)


def main_bounds(
    placer: Placer, rooms: Iterable[FixedRoom], corners: Iterable[Symbol], width: float
) -> dict[str, Any]:
    """Return the ranges of the main room's lengths around rooms of these sizes: see core.pl."""
    outlines = [Term("outline", room.side, room.width, room.depth, room.door) for room in rooms]
    return placer.ask("main_lengths", outlines, corners, width)


def open_lengths(placer: Placer, types: tuple[str, str], wall: float) -> tuple[float, float, list[str]]:
    """Return the range of an opening's width between rooms of these types in this part of a wall, metres.

    The third value names the clauses of the range: ``plan_bounds.pl``.
    """
    least, greatest, clauses = placer.ask("open_lengths", *types, float(wall))
    return least, greatest, clauses


def opening_lengths(placer: Placer, type_: str, other: str, start: float, end: float) -> dict[str, Any]:
    """Return lengths of a door between rooms of these types, and of a window of the first, in metres.

    See ``plan_bounds.pl``.
    """
    return placer.ask("opening_lengths", type_, other, float(start), float(end))
