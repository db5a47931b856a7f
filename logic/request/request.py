"""Requests: the user's choices in addition to the grammar's rules."""

import operator
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import msgspec

from vitruvius.logic.errors import RequestError
from vitruvius.logic.house.parts import BODY
from vitruvius.logic.plain import plain
from vitruvius.logic.request.brief import Brief, read_brief
from vitruvius.logic.request.fixed_rooms import FixedRoom, from_records
from vitruvius.logic.request.own_plan import OwnPlan
from vitruvius.logic.spelling import numbered, unknown

Range = tuple[int, int | None]
"""Least and greatest number; None for no bound."""

Count = int | tuple[int, int | None]
"""Exact number, or a range."""

MAX_CELL_M = 2
"""Largest width of a grid cell, metres."""

MOST_ROOMS = 128
MOST = 2**31 - 1
"""Largest number of clingo, which stands for no bound."""


def whole(name: str, value: Any, least: int, most: int = MOST) -> int:
    """Return a whole number of any library as Python's.

    Raises ``RequestError`` for another value, and for a number outside ``least`` to ``most``.
    """
    try:
        if isinstance(value, bool):
            raise TypeError
        number = operator.index(value)
    except TypeError:
        raise RequestError(f"{name} must be a whole number, {least} or more, not {value!r}") from None
    if not least <= number <= most:
        bounds = f"a whole number, {least} or more" if number < least else f"at most {most}"
        raise RequestError(f"{name} must be {bounds}, not {number}")
    return number


class Stated(msgspec.Struct, forbid_unknown_fields=True):
    """JSON form of a request, before its counts are read."""

    rooms: Any
    types: dict[str, Any] = {}
    furniture: dict[str, Any] = {}
    cell: float = 0.0
    keep: list[Any] = []
    plan: OwnPlan | None = None
    brief: dict[str, Any] | None = None


@dataclass(frozen=True)
class Request:
    """Number of secondary rooms, numbers of rooms of each type, and their furniture.

    ``furniture`` gives numbers of pieces in each room that may have them (``bed``) or in rooms of one type
    (``bedroom.bed``). If both are given, both hold. ``cell`` is the side of a grid's cell in metres, 0 for
    none.
    """

    rooms: int
    types: Mapping[str, Range] = field(default_factory=dict)
    furniture: Mapping[str, Range] = field(default_factory=dict)
    cell: float = 0.0
    fixed: tuple[FixedRoom, ...] = ()
    """Rooms of another house, clockwise."""
    plan: OwnPlan | None = None
    """Plan of all rooms, if their places are given."""
    brief: Brief | None = None
    """Requirements of each room by its name."""

    @property
    def states_rooms(self) -> bool:
        """True if the request states what the rooms are, so that typical rules may give way to it."""
        return bool(self.types or self.given)

    @property
    def given(self) -> Brief | OwnPlan | None:
        """Brief or plan, which states rooms by name; None without either."""
        return self.brief or self.plan

    @classmethod
    def read(cls, record: Mapping[str, Any]) -> "Request":
        """Return the request of a JSON form, which may come from a file.

        Raises ``RequestError`` for an invalid form.
        """
        try:
            found = msgspec.convert(record, Stated)
            if found.cell and not BODY <= found.cell <= MAX_CELL_M:
                raise RequestError(
                    f"cell must be {BODY} m (the body's width) to {MAX_CELL_M} m, not {found.cell!r}"
                )
            return cls(
                whole("rooms", found.rooms, 1, MOST_ROOMS),
                {name: as_range(f"type {name}", count) for name, count in found.types.items()},
                {name: as_range(f"piece {name}", count) for name, count in found.furniture.items()},
                found.cell,
                tuple(from_records(found.keep)),
                found.plan,
                None if found.brief is None else read_brief(found.brief),
            )
        except RequestError:
            raise
        except ValueError as error:
            raise RequestError(f"request: {str(error)[0].lower()}{str(error)[1:]}") from None

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON form, with exact numbers as such and ranges as lists."""
        record: dict[str, Any] = {"rooms": self.rooms, "types": _counts(self.types)}
        if self.furniture:
            record["furniture"] = _counts(self.furniture)
        if self.cell:
            record["cell"] = self.cell
        if self.fixed:
            record["keep"] = [msgspec.to_builtins(fixed.room) for fixed in self.fixed]
        if self.plan:
            record["plan"] = msgspec.to_builtins(self.plan)
        if self.brief:
            record["brief"] = msgspec.to_builtins(self.brief)
        return record

    def furniture_of(self, type_: str) -> list[tuple[str, str, Range]]:
        """Return the required furniture of a room of this type: name of the count, piece, and range."""
        found = []
        for name, wanted in sorted(self.furniture.items()):
            of, _, piece = name.rpartition(".")
            if of in {"", type_}:
                found.append((name, piece, wanted))
        return found

    def pieces_of(self, type_: str) -> dict[str, Range]:
        """Return the range of each kind of piece in a room of this type, by all counts together."""
        pieces: dict[str, Range] = {}
        for _, piece, (least, most) in self.furniture_of(type_):
            a, b = pieces.get(piece, (0, None))
            bounds = [bound for bound in (b, most) if bound is not None]
            pieces[piece] = max(a, least), min(bounds, default=None)
        return pieces

    def __str__(self) -> str:
        """Return the request in words, as in ``3 rooms, 2 of type bedroom``."""
        rooms = numbered(self.rooms, "room")
        types = [f"{in_words(wanted)} of type {name}" for name, wanted in self.types.items()]
        pieces = []
        for name, wanted in self.furniture.items():
            of, _, piece = name.rpartition(".")
            pieces.append(f"{in_words(wanted)} of {piece} in each {of or 'room for it'}")
        grid = [f"all on a grid of {self.cell:g} m"] if self.cell else []
        fixed = [f"{each.room.type} fixed on the {each.side} side" for each in self.fixed]
        drawn = ["all where the plan says"] if self.plan else []
        drawn += (
            [f"{', '.join(self.plan.kept)} with the furniture kept"] if self.plan and self.plan.kept else []
        )
        briefed = ["all as the brief says"] if self.brief else []
        return ", ".join([rooms, *types, *pieces, *grid, *fixed, *drawn, *briefed])


def as_range(name: str, count: Any) -> Range:
    """Return a count as a range. Raises ``RequestError`` for an invalid count."""
    count = plain(count)
    least, most = (count, count) if isinstance(count, int) else (*count,) if _is_pair(count) else (None, None)
    if type(least) is not int or not (most is None or type(most) is int):
        raise RequestError(f"{name}: a count is a whole number or a pair of them, not {count!r}")
    if not 0 <= least <= (MOST if most is None else most) <= MOST:
        raise RequestError(f"{name}: counts are whole numbers from 0, the lesser first, not {count!r}")
    return least, most


def require_series(record: Mapping[str, Any]) -> None:
    """Raise ``RequestError`` unless a file's record is a request of a series, as ``HouseSeries`` takes it."""
    rooms = record.get("rooms")
    least, most = rooms if isinstance(rooms, list) and len(rooms) == 2 else (rooms, rooms)
    found = [Request.read({**record, "rooms": number}).rooms for number in (least, most)]
    if found[0] > found[1]:
        raise RequestError(f"rooms: the lesser number comes first, not {rooms}")


def request_at(index: int, request: dict[str, Any]) -> dict[str, Any]:
    """Return the request of house ``index`` of a series, whose ``rooms`` may be a range, as a list.

    The numbers of the range then follow each other from house to house, from the least on.
    """
    if isinstance(request["rooms"], int):
        return request
    least, most = request["rooms"]
    return request | {"rooms": least + index % (most - least + 1)}


def in_words(wanted: Range) -> str:
    """Return a range in words, as in ``2``, ``1 to 3``, ``2 or more``."""
    least, most = wanted
    return f"{least}" if most == least else f"{least} or more" if most is None else f"{least} to {most}"


def as_option(wanted: Range) -> str:
    """Return a range as on the command line: ``2``, ``1..3``, ``2..``."""
    least, most = wanted
    return f"{least}" if most == least else f"{least}..{'' if most is None else most}"


def from_option(text: str) -> Count:
    """Return the count in a text of ``as_option``, or in ``..3``. Raises ``ValueError`` for another text."""
    if ".." not in text:
        return int(text)
    least, _, most = text.partition("..")
    return int(least or 0), int(most) if most else None


def known(what: str, name: str, names: Iterable[str]) -> None:
    """Raise ``RequestError`` for a name that is not one of these."""
    names = sorted(names)
    if name not in names:
        raise RequestError(unknown(what, name, names))


def _is_pair(count: Any) -> bool:
    return isinstance(count, tuple | list) and len(count) == 2


def _counts(ranges: Mapping[str, Range]) -> dict[str, Any]:
    return {name: least if least == most else [least, most] for name, (least, most) in ranges.items()}
