"""Distance between furniture and doors.

The topology decides which doors count and how distance is measured.
"""

from collections.abc import Callable, Iterator

from vitruvius.logic.checking.figures import figure, number
from vitruvius.logic.checking.names import space_name
from vitruvius.logic.checking.walk import way_through
from vitruvius.logic.house.boxes import TOLERANCE, distance, front, overlap
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import OUTSIDE, Door, Piece, Room
from vitruvius.logic.house.promises import FRONTAL, Promises
from vitruvius.logic.house.topology_kinds import Kind


def near_doors(house: House, room: Room, piece: Piece, promises: Promises) -> Iterator[str]:
    """Yield a text for each door that a piece stands too near to."""
    return NEAR[house.kind](house, room, piece, promises)


def _near_any(house: House, room: Room, piece: Piece, promises: Promises) -> Iterator[str]:
    return _nearer(house, room, piece, house.doors, promises.door_clearance)


def _near_its_own(house: House, room: Room, piece: Piece, promises: Promises) -> Iterator[str]:
    """Count only the room's own doors, since doors of other rooms are behind a wall if rooms share walls."""
    return _nearer(house, room, piece, house.doors_of(room.name), promises.door_clearance)


def _nearer(house: House, room: Room, piece: Piece, doors: tuple[Door, ...], least: float) -> Iterator[str]:
    for door in doors:
        away = distance(piece.box, way_through(door, house.half_wall))
        if away < least - TOLERANCE:
            yield _stands(away, "from", _whose(house, room, door), least)


def _in_front(house: House, room: Room, piece: Piece, _: Promises) -> Iterator[str]:
    """Count the zones in front of doors and behind them, but not beside them, as the original does."""
    for door in house.doors:
        if overlap(piece.box, front(door.box, FRONTAL)) > TOLERANCE:
            away = distance(piece.box, door.box)
            yield _stands(away, "in front of", _whose(house, room, door), FRONTAL)


NEAR: dict[Kind, Callable[[House, Room, Piece, Promises], Iterator[str]]] = {
    Kind.STAR: _near_any,
    Kind.ORIGINAL: _in_front,
    Kind.MAP: _near_its_own,
    Kind.SHARED_WALLS: _near_its_own,
}


def _stands(away: float, where: str, whose: str, least: float) -> str:
    """Return the distance between a piece and a door, and the least permitted distance, as text."""
    return f"stands {figure(away, least)} m {where} {whose} (at least {number(least)})"


def _whose(house: House, room: Room, door: Door) -> str:
    """Return the name of a door in a room's faults: its first room, and not the main room if possible."""
    if room.name in door.between:
        return "its door"
    rooms = [house.room(name) for name in door.between if name != OUTSIDE]
    return f"the door of {space_name(house, min(rooms, key=lambda each: each is house.main_room))}"
