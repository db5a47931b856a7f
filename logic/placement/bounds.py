"""What the lengths of a house could have been, and which constraints bind them."""

from collections.abc import Iterable, Sequence
from typing import Any

from clingo import Function, Symbol

from logic.house.parts import Rect
from logic.placement.layout import RoomLayout
from logic.placement.placer import Placer
from logic.placement.prolog import Term
from logic.request.fixed_rooms import FixedRoom


def room_bounds(
    placer: Placer, room: RoomLayout, target: Symbol, taken: float | None = None
) -> dict[str, Any]:
    """What the lengths of a target in a room could have been, and which constraints bind: see core.pl.

    ``taken``: the area of all other rooms of a star, square metres, of whose area the room has the rest.
    """
    others = "any" if taken is None else float(taken)
    return placer.ask("room_lengths", room.type, room.furniture, room.given, others, room.seed, target)


def wall_bounds(
    placer: Placer, layout: Iterable[Symbol], rooms: Sequence[Rect], number: int, outlined: bool = False
) -> dict[str, Any]:
    """What the sizes of a plan's room could have been, and which constraints bind: ``plan_bounds.pl``.

    ``outlined``: where the outline of the plan stays as it is.
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
    """What the main room's lengths could have been around rooms of these sizes: see core.pl."""
    outlines = [Term("outline", room.side, room.width, room.depth, room.door) for room in rooms]
    return placer.ask("main_lengths", outlines, corners, width)


def open_lengths(placer: Placer, types: tuple[str, str], wall: float) -> tuple[float, float, list[str]]:
    """How wide (m) an opening between rooms of these types may be in this part of a wall, by which clauses:
    ``plan_bounds.pl``.
    """
    least, greatest, clauses = placer.ask("open_lengths", *types, float(wall))
    return least, greatest, clauses


def opening_lengths(placer: Placer, type_: str, other: str, start: float, end: float) -> dict[str, Any]:
    """Lengths (m) of a door between rooms of these types, and of a window of the first: ``plan_bounds``."""
    return placer.ask("opening_lengths", type_, other, float(start), float(end))
