"""Differences between two houses: added, removed and moved parts."""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from typing import Literal

import msgspec

from vitruvius.logic.house.boxes import Box
from vitruvius.logic.house.house import House
from vitruvius.logic.house.part_names import doors_by_name, part_names, windows_by_name
from vitruvius.logic.house.parts import Room

MIN_DIFFERENCE_M = 1e-3
"""Smallest difference that counts, metres."""


class Item(msgspec.Struct, frozen=True):
    """Part of a house: its name for ``explain_house``, its type and its place."""

    name: str
    type: str
    box: Box
    """(west, north, east, south), metres."""
    orientation: str = ""


class Change(msgspec.Struct, frozen=True, omit_defaults=True):
    """Part that differs between two houses."""

    what: Literal["came", "went", "moved"]
    """``moved``: the part stands elsewhere, has another size or faces another way."""
    before: Item | None = None
    after: Item | None = None

    def __str__(self) -> str:
        """Return the change in a sentence."""
        now = self.after or self.before
        assert now is not None
        if self.before is None or self.after is None:
            return f"{_called(now)} {self.what}"
        was, renamed = self.before, ""
        if was.name != now.name:
            renamed = f", {was.name} before"
        parts = []
        if _differ(_size(was.box), _size(now.box)):
            parts.append(
                "is {:.2f} x {:.2f} m, was {:.2f} x {:.2f} m".format(*_size(now.box), *_size(was.box))
            )
        if way := _way(was.box, now.box):
            parts.append(f"moved {way}")
        if was.orientation != now.orientation:
            parts.append(f"faces {now.orientation or 'nowhere'}, faced {was.orientation or 'nowhere'}")
        return f"{_called(now)}{renamed} {', '.join(parts)}"


def changes(before: House, after: House) -> list[Change]:
    """Return the differences between two houses: rooms, then pieces, doors and windows.

    A room corresponds to the most similar room of its type in the other house, whatever its name. A piece
    corresponds to one of its type in the same room, a door to one between the same rooms, and a window to one
    of the same room.
    """
    found: list[tuple[Item | None, Item | None]] = []
    same = {"outside": "outside"}
    """Names of rooms in the second house, by those in the first."""
    rooms = [{room.name: _room(house, room) for room in house.rooms} for house in (before, after)]
    for was, now in _pairs(
        [(item.type, item) for item in rooms[0].values()], [(item.type, item) for item in rooms[1].values()]
    ):
        found.append((was, now))
        if was and now:
            same[was.name] = now.name
    found += _pairs(
        [*_parts(before, same)], [*_parts(after, {name: name for name in [*rooms[1], "outside"]})]
    )
    return [change for was, now in found if (change := _change(was, now))]


def _room(house: House, room: Room) -> Item:
    return Item(room.name, "main room" if room is house.main_room else room.type, room.box)


def _parts(house: House, same: dict[str, str]) -> Iterator[tuple[Hashable, Item]]:
    """Yield pieces, doors and windows, each with a key that its counterpart in the other house must share.

    Keys contain the names of rooms in the other house. A room without a counterpart keeps its own name, which
    no room there has.
    """

    def there(name: str) -> str:
        return same.get(name, f"{name} of this house")

    for room in house.rooms:
        names = part_names([piece.type for piece in room.pieces])
        for name, piece in zip(names, room.pieces, strict=True):
            yield (
                (there(room.name), piece.type),
                Item(f"{room.name}.{name}", piece.type, piece.box, piece.orientation),
            )
    for name, door in doors_by_name(house).items():
        yield frozenset(map(there, door.between)), Item(name, "door", door.box)
    for name, window in windows_by_name(house).items():
        yield (there(window.room),), Item(name, "window", window.box)


def _pairs(
    before: list[tuple[Hashable, Item]], after: list[tuple[Hashable, Item]]
) -> list[tuple[Item | None, Item | None]]:
    """Return each item with the most similar item of the other house that has the same key.

    The most similar pairs come first.
    """
    near = sorted(
        (
            sum(abs(a - b) for a, b in zip(was.box, now.box, strict=True))
            + (was.orientation != now.orientation),
            i,
            j,
        )
        for i, (key, was) in enumerate(before)
        for j, (other, now) in enumerate(after)
        if key == other
    )
    partners: dict[int, int] = {}
    for _, i, j in near:
        if i not in partners and j not in partners.values():
            partners[i] = j
    taken = set(partners.values())
    pairs: list[tuple[Item | None, Item | None]] = [
        (was, after[partners[i]][1] if i in partners else None) for i, (_, was) in enumerate(before)
    ]
    return pairs + [(None, now) for j, (_, now) in enumerate(after) if j not in taken]


def _change(was: Item | None, now: Item | None) -> Change | None:
    if was is None or now is None:
        return Change("came" if was is None else "went", was, now)
    if _differ(was.box, now.box) or was.orientation != now.orientation:
        return Change("moved", was, now)
    return None


def _differ(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    return any(abs(a - b) > MIN_DIFFERENCE_M for a, b in zip(one, other, strict=True))


def _size(box: Box) -> tuple[float, float]:
    return box[2] - box[0], box[3] - box[1]


def _called(item: Item) -> str:
    return item.name if item.type in item.name or item.name == "entrance" else f"{item.name} ({item.type})"


def _way(was: Box, now: Box) -> str:
    """Return the movement of a box's middle in words."""
    east, south = ((now[k] + now[k + 2] - was[k] - was[k + 2]) / 2 for k in (0, 1))
    ways = [(east, "east", "west"), (south, "south", "north")]
    return " and ".join(
        f"{abs(by):.2f} m {one if by > 0 else other}" for by, one, other in ways if abs(by) > MIN_DIFFERENCE_M
    )
