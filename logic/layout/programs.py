"""The programs of stage 1 for one grammar: the rooms of a house, and the furniture of a room of each type."""

import time
from collections.abc import Iterable, Iterator, Mapping
from functools import cache

from clingo import Symbol

from logic.errors import GrammarError
from logic.grammar import Grammar
from logic.layout.account import GROUNDING, LAYOUT, Account
from logic.layout.messages import placed_error
from logic.layout.program import EVERY, Program
from logic.layout.terms import (
    Lengths,
    granted,
    parts,
    requirements,
    room_requirements,
    shared_requirements,
)
from logic.request.request import Request

GIVEN = {"in_a_row": 4, "fuller": 2}
"""Constants of ``rules/room/room.lp`` for rooms of given sizes."""


class Programs:
    """Grounds each program once and keeps it."""

    def __init__(
        self,
        grammar: Grammar,
        furniture: Mapping[str, Iterable[str]],
        lengths: Lengths,
        account: Account,
        walls: Iterable[Symbol] = (),
    ) -> None:
        """Know a grammar's files, the pieces of each of its room types, their lengths, and those of walls.

        ``account`` hears what is ground.
        """
        self._account = account
        self._grammar, self._furniture, self._lengths, self._walls = grammar, furniture, lengths, tuple(walls)

    @cache  # noqa: B019 (the programs live as long as their process)
    def rooms(
        self, rooms: int, required: tuple[Symbol, ...] = (), arguments: tuple[str, ...] = ()
    ) -> Program:
        """The program of a house's rooms, with these requirements and arguments for clingo."""
        self._account.at(GROUNDING, f"grounding the rules for {rooms} rooms (clingo)")
        return Program(
            self._grammar.asp,
            {"rooms": rooms},
            [("house", []), *parts(self._walls), *parts(required)],
            arguments=arguments,
        )

    def house(self, request: Request, seed: int) -> Program:
        """The program of one house's rooms, which searches at random by a seed: see ``program.FREE``."""
        self._account.at(GROUNDING, f"grounding the rules for {request.rooms} rooms (clingo)")
        stages = [("house", []), *parts(self._walls), *parts(room_requirements(request))]
        return Program(self._grammar.asp, {"rooms": request.rooms}, stages, seed=seed)

    @cache  # noqa: B019
    def units(
        self, rooms: int, required: tuple[Symbol, ...] = (), arguments: tuple[str, ...] = ()
    ) -> Program:
        """The program of the units of a house, for a topology that has units: as ``rooms``."""
        stages = [("units", []), *parts(required)]
        self._account.at(GROUNDING, f"grounding the rules for units of {rooms} rooms in all (clingo)")
        return Program(self._grammar.asp, {"rooms": rooms}, stages, arguments=arguments)

    def unit_sizes(self, rooms: int) -> list[int]:
        """How many rooms the units of a house may have; none where it has no units."""
        return sorted({atom.arguments[1].number for atom in self.units(rooms).atoms("unit", 2)})

    @cache  # noqa: B019
    def furniture(
        self, type_: str, required: tuple[Symbol, ...] = (), arguments: tuple[str, ...] = ()
    ) -> Program:
        """The program of a room's furniture, with the extremes of its lengths as facts."""
        facts = [fact for fact, _ in self._lengths[type_]]
        self._account.at(GROUNDING, f"grounding the rules for the furniture of a {type_} (clingo)")
        return Program(
            self._grammar.asp,
            {"this_room": type_},
            [("room", []), ("capacity", []), *parts(facts), *parts(required)],
            arguments=arguments,
        )

    @cache  # noqa: B019
    def given(self, type_: str, doorways: tuple[Symbol, ...], required: tuple[Symbol, ...] = ()) -> Program:
        """The program of a room's furniture whose size, doors and windows are given: ``doors.lp``."""
        facts = [fact for fact, _ in self._lengths[type_] if fact.name != "reach"]
        self._account.at(GROUNDING, f"grounding the rules for the furniture of a {type_} (clingo)")
        return Program(
            self._grammar.asp,
            {"this_room": type_, **GIVEN},
            [("room", []), ("plan", []), *parts(facts), *parts(doorways), *parts(required)],
        )

    def has_furniture(self, type_: str) -> bool:
        """Whether there is anything that a room of this type may have."""
        return bool(self._furniture[type_])

    def rooms_for(self, request: Request, arguments: tuple[str, ...] = ()) -> tuple[Program, list[Symbol]]:
        """The program of a request's rooms, and what to assume in it."""
        required = room_requirements(request)
        return self.rooms(request.rooms, tuple(required), arguments), [granted(each) for each in required]

    def units_for(
        self, request: Request, barred: Iterable[Symbol] = (), arguments: tuple[str, ...] = ()
    ) -> tuple[Program, list[Symbol]]:
        """The program of the units of a request's house, and what to assume in it."""
        required = [*shared_requirements(request), *barred]
        program = self.units(request.rooms, tuple(required), arguments)
        return program, [granted(each) for each in required]

    def unit_for(self, request: Request) -> tuple[Program, list[Symbol]]:
        """The program of a unit's rooms, whatever the numbers of some types, and what to assume in it."""
        numbers = range(request.rooms + 1)
        each_number = [dict.fromkeys(request.types, (number, number)) for number in numbers]
        possible = [each for types in each_number for each in requirements("among", types)]
        assumed = [granted(each) for each in requirements("among", request.types)]
        return self.rooms(request.rooms, tuple(possible)), assumed

    def furniture_for(
        self, type_: str, request: Request, arguments: tuple[str, ...] = ()
    ) -> tuple[Program, list[Symbol]]:
        """The program that furnishes a room of this type for a request, and what to assume in it."""
        required = self.required_in(type_, request)
        return self.furniture(type_, required, arguments), [granted(each) for each in required]

    def required_in(self, type_: str, request: Request) -> tuple[Symbol, ...]:
        """What a request requires of the furniture of a room of this type."""
        asked = request.pieces_of(type_)
        return tuple(
            requirements("has", {name: n for name, n in asked.items() if name in self._furniture[type_]})
        )

    def all_furniture(self, request: Request) -> list[Program]:
        """The programs that furnish rooms for a request, of each type."""
        return [self.furniture_for(type_, request)[0] for type_ in sorted(self._furniture)]

    def counts(self, request: Request, seconds: float) -> Iterator[tuple[str, int, bool | None]]:
        """How many layouts there are: of the rooms, and of the furniture of each type of room.

        A name, the number, and whether it is all of them: False where its share of the seconds ran out, None
        where the count goes on.
        """
        end = time.monotonic() + seconds
        named = [(str(request), self.rooms_for(request, EVERY))]
        if sizes := self.unit_sizes(request.rooms):
            named = [(f"units of {request}", self.units_for(request, arguments=EVERY))]
            named += [(f"a unit of {size} rooms", self.rooms_for(Request(size), EVERY)) for size in sizes]
        named += [(type_, self.furniture_for(type_, request, EVERY)) for type_ in sorted(self._furniture)]
        for place, (name, (program, assumed)) in enumerate(named):
            self._account.at(LAYOUT, f"counting layouts: {name} (clingo)")
            share = max(0.0, end - time.monotonic()) / (len(named) - place)
            for count in program.count(assumed, share):
                yield (name, *count)

    def remarks(self) -> Iterator[GrammarError]:
        """What clingo only remarks on, and passes over, in the grammar's files.

        That an atom is in no rule's head is no mistake: a program holds the rules of one stage.
        """
        own = tuple(f"{file}:" for file in self._grammar.own)
        found: dict[tuple[str, int | None, int | None], GrammarError] = {}
        for program in (self.rooms(1), *self.all_furniture(Request(1))):
            for remark in program.remarks:
                if remark.startswith(own) and "does not occur in any rule head" not in remark:
                    error = placed_error(remark)
                    found.setdefault((str(error.file), error.line, error.column), error)
        yield from found.values()
