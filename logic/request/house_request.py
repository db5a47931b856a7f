"""Requests for houses: all that a house depends on, apart from its seed and its index.

A new field also belongs in ``read``, ``to_dict`` and ``__str__``; ``logic.request.arguments`` sets it
from the arguments of ``generate``.
"""

from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any

import msgspec
from msgspec.structs import replace

from vitruvius.logic.errors import RequestError
from vitruvius.logic.grammar import Grammar, find
from vitruvius.logic.house.parts import BODY
from vitruvius.logic.request.brief import Brief, read_brief
from vitruvius.logic.request.counts import (
    Range,
    as_range,
    counts,
    in_words,
    range_of,
    ranges_of,
    whole,
)
from vitruvius.logic.request.fixed_rooms import FixedRoom, from_records
from vitruvius.logic.request.own_plan import OwnPlan
from vitruvius.logic.spelling import numbered

MAX_CELL_M = 2
"""Largest width of a grid cell, metres."""

INFERENCES, SECONDS = 100_000_000, 60.0
"""Limits of a house by default: Prolog inferences, and seconds."""

MAX_SECONDS = 1e6
"""Bound on the limit in seconds."""

DEFAULT = "family"
"""Grammar of a request that names none."""


class Record(msgspec.Struct, forbid_unknown_fields=True):
    """JSON form of a request, before its counts are read."""

    rooms: Any
    types: dict[str, Any] = {}
    furniture: dict[str, Any] = {}
    cell: float = 0.0
    keep: list[Any] = []
    plan: OwnPlan | None = None
    brief: dict[str, Any] | None = None


class HouseRequest(msgspec.Struct, frozen=True, dict=True, forbid_unknown_fields=True):
    """Request for houses: all that the houses depend on, apart from seed and index.

    ``types`` gives numbers of rooms of a type. ``furniture`` gives numbers of pieces in each room that may
    have them (``bed``) or in rooms of one type (``bedroom.bed``). If both are given, both hold. Raises
    ``RequestError`` for a request that makes no sense with any rules.
    """

    rooms: int
    """Number of rooms, or the least number of a range. A star's main room does not count."""
    types: Mapping[str, Range] = {}
    furniture: Mapping[str, Range] = {}
    cell: float = 0.0
    """Side of a grid's cell in metres, 0 for none."""
    fixed: tuple[FixedRoom, ...] = ()
    """Rooms of another house, clockwise."""
    plan: OwnPlan | None = None
    """Plan of all rooms, if their places are given."""
    brief: Brief | None = None
    """Requirements of each room by its name."""
    grammar: str = DEFAULT
    """Name or directory of the rules."""
    most_rooms: int | None = None
    """Greatest number of rooms of a range: see ``at``."""
    inferences: int = INFERENCES
    """Largest number of Prolog inferences for a house."""
    seconds: float = SECONDS
    """Largest number of seconds for a house."""

    def __post_init__(self) -> None:
        """Raise ``RequestError`` for a request that makes no sense."""
        range_of(self.rooms if self.most_rooms is None else (self.rooms, self.most_rooms))
        for noun, ranges in (("type", self.types), ("piece", self.furniture)):
            for name, wanted in ranges.items():
                as_range(f"{noun} {name}", wanted)
        if self.cell and not BODY <= self.cell <= MAX_CELL_M:
            raise RequestError(
                f"cell must be {BODY} m (the robot's width) to {MAX_CELL_M} m, not {self.cell!r}"
            )
        whole("inferences", self.inferences, 1)
        if not 0 < self.seconds < MAX_SECONDS:
            raise RequestError(f"seconds must be above 0 and below a million, not {self.seconds!r}")
        self._require_agreement()

    def _require_agreement(self) -> None:
        """Raise ``RequestError`` if parts of the request contradict each other."""
        wanted = f"{self.rooms}" if self.most_rooms is None else f"{self.rooms}..{self.most_rooms}"
        for name, given in (("plan", self.plan), ("brief", self.brief)):
            if given and wanted != str(number := len(given.rooms)):
                raise RequestError(f"{name}: it has {number} rooms, but rooms={wanted}: leave rooms out")
        for name, given in (("cell", self.cell), ("keep", self.fixed)):
            if self.plan and given:
                raise RequestError(f"plan: all rooms already have a place: leave out {name} or plan")
        for name, given in (("plan", self.plan), ("keep", self.fixed)):
            if self.brief and given:
                raise RequestError(f"brief: a brief places its rooms itself: leave out {name} or brief")
        if self.brief and self.cell:
            raise RequestError("cell: a brief does not support a grid: leave out cell or brief")
        if self.fixed and self.cell:
            raise RequestError("keep: rooms to keep may lie off the grid: leave out cell or keep")
        if (fixed := len(self.fixed)) > self.rooms:
            raise RequestError(
                f"keep: the house has {fixed} rooms to keep, but rooms={self.rooms}: ask for rooms={fixed} "
                'or more, or keep some of them: keep=house.only("R0"), on the command line --keep-rooms R0'
            )

    @classmethod
    def read(cls, record: Mapping[str, Any], **others: Any) -> "HouseRequest":
        """Return the request of a JSON form. Raises ``RequestError`` for an invalid form.

        ``others``: the fields that the form lacks, by name.
        """
        try:
            found = msgspec.convert(record, Record)
            least, most = range_of(found.rooms)
            return cls(
                least,
                ranges_of("type", found.types),
                ranges_of("piece", found.furniture),
                found.cell,
                tuple(from_records(found.keep)),
                found.plan,
                None if found.brief is None else read_brief(found.brief),
                most_rooms=most,
                **others,
            )
        except RequestError:
            raise
        except ValueError as error:
            raise RequestError(f"request: {str(error)[0].lower()}{str(error)[1:]}") from None

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON form in files, with an exact number as a number and a range as a list.

        The form has neither the grammar nor the limits: a file states them separately.
        """
        rooms = self.rooms if self.most_rooms is None else [self.rooms, self.most_rooms]
        record: dict[str, Any] = {"rooms": rooms, "types": counts(self.types)}
        if self.furniture:
            record["furniture"] = counts(self.furniture)
        if self.cell:
            record["cell"] = self.cell
        if self.fixed:
            record["keep"] = [msgspec.to_builtins(fixed.room) for fixed in self.fixed]
        if self.plan:
            record["plan"] = msgspec.to_builtins(self.plan)
        if self.brief:
            record["brief"] = msgspec.to_builtins(self.brief)
        return record

    @cached_property
    def rules(self) -> Grammar:
        """The grammar's files. Raises ``GrammarError`` as ``find`` does."""
        return find(self.grammar)

    @property
    def states_rooms(self) -> bool:
        """True if the request states types, a brief or a plan, to which typical rules may give way."""
        return bool(self.types or self.given)

    @property
    def given(self) -> Brief | OwnPlan | None:
        """Brief or plan, which states rooms by name; None without either."""
        return self.brief or self.plan

    def at(self, index: int) -> "HouseRequest":
        """Return the request of house ``index``.

        The houses of a range take its numbers of rooms in turn: the least number first, and again after the
        greatest.
        """
        if self.most_rooms is None:
            return self
        rooms = self.rooms + index % (self.most_rooms - self.rooms + 1)
        return replace(self, rooms=rooms, most_rooms=None)

    def each_size(self) -> Iterator["HouseRequest"]:
        """Yield the request for each number of rooms of its range."""
        return (self.at(index) for index in range((self.most_rooms or self.rooms) - self.rooms + 1))

    def furniture_of(self, type_: str) -> list[tuple[str, str, Range]]:
        """Return each count that holds in a room of this type: name of the count, piece, and range."""
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
