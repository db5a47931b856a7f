"""Names of the parts of a house: ``R3``, ``R3.bed``, ``R1-R3``, ``entrance``."""

from collections.abc import Iterable, Sequence
from typing import Any

from vitruvius.logic.errors import RequestError
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import OUTSIDE, Door, Room, Window
from vitruvius.logic.spelling import closest

DOOR, ENTRANCE, WINDOW = "door", "entrance", "window"
"""Names of parts that are not pieces."""

Part = int | str | Door | Window | None
"""Piece by its index in its room, a star's ``door``, a plan's door or window, or a unit's name.

None for the room itself.
"""


def target_in(house: House, target: str) -> tuple[int | None, Part]:
    """Return the room of a target, by its index in ``house.counted``, and the part that the target names.

    The room is None for a star's main room and for the doors of a plan. Raises ``RequestError`` for a target
    that the house does not have.
    """
    return _in_star(house, target) if house.main_room else _in_plan(house, target)


def _in_star(house: House, target: str) -> tuple[int | None, Part]:
    rooms = [room.name for room in house.counted]
    name, part = _split(target, [house.hub, *rooms])
    _require(name, [house.hub, *rooms], house)
    if name not in rooms:
        if part:
            raise RequestError(f"{target}: the main room has no parts: ask for {name}")
        return None, None
    return rooms.index(name), _part(name, part, {DOOR: DOOR} | _pieces(house, name))


def _in_plan(house: House, target: str) -> tuple[int | None, Part]:
    rooms, doors = [room.name for room in house.rooms], doors_by_name(house)
    either_way = _numbered(("-".join(reversed(door.between)), door) for door in doors.values())
    outside = {"-".join(door.between): door for door in doors.values() if door.is_entrance}
    if door := (either_way | outside | doors).get(target):
        return None, door
    units = units_of(house)
    if target in units:
        return None, target
    name, part = _split(target, [*rooms, *doors, *units])
    _require(name, [*rooms, *doors, *units], house)
    if name in units:
        raise RequestError(f"{target}: ask for {name}, or for a room of it by its name in the house")
    if name not in rooms:
        raise RequestError(f"{target}: a door has no parts: ask for {name}")
    windows = _numbered((WINDOW, window) for window in house.windows if window.room == name)
    own = [each for each in doors if doors[each] in house.doors_of(name)]
    if part == DOOR:
        raise RequestError(f"{target}: ask for a door by both its rooms: {name} has {', '.join(own)}")
    return rooms.index(name), _part(name, part, windows | _pieces(house, name))


def units_of(house: House) -> list[str]:
    """Return the names of a house's units, ``U1``, ``U2``..., in the order of their rooms.

    Each unit has one door to a public room, as its rules require.
    """
    made = house.provenance
    if made is None or made.promises is None or made.request.get("plan"):
        return []
    public = {OUTSIDE, *(room.name for room in house.rooms if room.type in made.promises.public)}
    entered = [each for each in house.doors if not each.is_entrance and len(public & {*each.between}) == 1]
    return [f"U{number}" for number, _ in enumerate(entered, 1)]


def _split(target: str, names: Iterable[str]) -> tuple[str, str]:
    """Return the name of a target, which may contain dots, and the part that follows the name."""
    for name in sorted(names, key=len, reverse=True):
        if target == name or target.startswith(f"{name}."):
            return name, target[len(name) + 1 :]
    name, _, part = target.partition(".")
    return name, part


def doors_by_name(house: House) -> dict[str, Door]:
    """Return the doors of a house by their names, in the house's order.

    Names are as in ``R1-R3``, ``R3.door`` to a star's main room, and ``entrance`` for a door that leads
    outside.
    """
    return _numbered((_door_name(door, house.main_room), door) for door in house.doors)


def _door_name(door: Door, main: Room | None) -> str:
    if door.is_entrance:
        return ENTRANCE
    if main is None:
        return "-".join(door.between)
    return f"{next(name for name in door.between if name != main.name)}.{DOOR}"


def windows_by_name(house: House) -> dict[str, Window]:
    """Return the windows of a house by their names, in the house's order: ``R3.window``, ``R3.window2``."""
    return _numbered((f"{window.room}.{WINDOW}", window) for window in house.windows)


def part_names(types: Sequence[str]) -> list[str]:
    """Return names such as ``bed``, ``bed2`` for pieces of these types, in the file's order."""
    counts = [types[: index + 1].count(type_) for index, type_ in enumerate(types)]
    return [type_ if count == 1 else f"{type_}{count}" for type_, count in zip(types, counts, strict=True)]


def _pieces(house: House, name: str) -> dict[str, Part]:
    """Return the indices of a room's pieces, by their short names."""
    return {
        piece: index
        for index, piece in enumerate(part_names([piece.type for piece in house.room(name).pieces]))
    }


def _numbered(named: Iterable[tuple[str, Any]]) -> dict[str, Any]:
    """Return parts by their names, with numbers for parts that share a name."""
    pairs = list(named)
    names = part_names([name for name, _ in pairs])
    return {name: each for name, (_, each) in zip(names, pairs, strict=True)}


def _part(name: str, part: str, parts: dict[str, Part]) -> Part:
    """Return the part of a room by its name: ``bed2`` or ``bed.2``, and ``bed1`` for ``bed``."""
    if not part:
        return None
    type_, _, number = part.rpartition(".")
    plain = type_ + number if number.isdigit() else part
    found = parts.get(plain, parts.get(plain.removesuffix("1")))
    if found is None:
        hint = _hint(f"{name}.", part, [*parts])
        raise RequestError(f"there is no {name}.{part}: {hint}{name} has {', '.join(parts) or 'no parts'}")
    return found


def _require(name: str, names: Sequence[str], house: House) -> None:
    if name in names:
        return
    pieces = [f"{room.name}.{name}" for room in house.rooms if name in _pieces(house, room.name)]
    hint = f"did you mean {' or '.join(pieces)}? " if pieces else _hint("", name, names)
    raise RequestError(f"there is no {name}: {hint}the house has {', '.join(names)}")


def _hint(before: str, name: str, names: Sequence[str]) -> str:
    close = closest(name, names)
    return f"did you mean {before}{close}? " if close else ""
