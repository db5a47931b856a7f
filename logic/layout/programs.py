"""Programs of stage 1 for one grammar: the rooms of a house, and the furniture of each room type."""

import time
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Set
from functools import cache

import numpy as np
from clingo import Symbol

from vitruvius.logic.errors import GrammarError
from vitruvius.logic.grammar import Grammar
from vitruvius.logic.layout.account import GROUNDING, LAYOUT, Account
from vitruvius.logic.layout.messages import placed_error
from vitruvius.logic.layout.program import ALL_LAYOUTS, HOUSE, KEPT_SEARCH, Program, of_one_house
from vitruvius.logic.layout.terms import (
    Lengths,
    granted,
    parts,
    requirements,
    room_requirements,
    shared_requirements,
)
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.spelling import article

GIVEN_ROOM_CONSTANTS = {"in_a_row": 4, "fuller": 2}
"""Constants of ``rules/room/room.lp`` for rooms of given sizes."""

MIN_CROWD_PIECES = 6
"""Least number of pieces, of one type or required together, in a crowded room.

For crowded rooms, picks that are sampled one by one may lead to a proof of exponential length that the pieces
do not fit in a few rows. Therefore crowded rooms have a separate program for each house (``of_one_house``).
"""


def crowded(may: Iterable[Symbol]) -> set[str]:
    """Return the crowded room types, by the facts ``may/4``; see ``MIN_CROWD_PIECES``."""
    needed, most = Counter[str](), Counter[str]()
    for type_, _, fewest, number in (fact.arguments for fact in may):
        needed[str(type_)] += fewest.number
        most[str(type_)] = max(most[str(type_)], number.number)
    return {type_ for type_ in most if max(needed[type_], most[type_]) >= MIN_CROWD_PIECES}


def grouped(one_room: Iterable[Symbol], may: Iterable[Symbol]) -> tuple[dict[Symbol, set[str]], set[str]]:
    """Return the pieces of each group of ``one_room/2``, and the room types that need some of these."""
    groups: dict[Symbol, set[str]] = {}
    for group, piece in (fact.arguments for fact in one_room):
        groups.setdefault(group, set()).add(str(piece))
    every = set().union(*groups.values())
    needing = {
        str(type_)
        for type_, piece, least, _ in (fact.arguments for fact in may)
        if least.number and str(piece) in every
    }
    return groups, needing


class Programs:
    """Ground programs of a grammar, each ground once and kept."""

    def __init__(
        self,
        grammar: Grammar,
        furniture: Mapping[str, Iterable[str]],
        lengths: Lengths,
        account: Account,
        walls: Iterable[Symbol] = (),
        crowded: Collection[str] = (),
        groups: Mapping[Symbol, Set[str]] | None = None,
        first: Collection[str] = (),
    ) -> None:
        """Keep a grammar, the pieces of each room type, the facts of their lengths, and the facts of walls.

        ``account`` records the program that is being ground. ``crowded`` are the crowded room types.
        ``groups`` are the pieces of each group of ``one_room/2``, ``first`` the room types that need some.
        """
        self._account, self._crowded = account, crowded
        self.groups, self.first = groups or {}, first
        self._of_all: dict[tuple[object, ...], Program] = {}
        self._of_house: dict[tuple[object, ...], Program] = {}
        self._grammar, self._furniture, self._lengths, self._walls = grammar, furniture, lengths, tuple(walls)
        self.rooms, self.units = cache(self._rooms), cache(self._units)

    def _rooms(
        self, rooms: int, required: tuple[Symbol, ...] = (), arguments: tuple[str, ...] = ()
    ) -> Program:
        """Return the program of a house's rooms, with these requirements and arguments for clingo."""
        self._account.at(GROUNDING, f"grounding the rules for {rooms} rooms (clingo)")
        return Program(
            self._grammar.asp,
            {"rooms": rooms},
            [*HOUSE, *parts(self._walls), *parts(required)],
            arguments=arguments,
            left_out=self._grammar.left_out,
        )

    def house(self, request: HouseRequest, seed: int) -> Program:
        """Return the program of one house's rooms, with a random search by a seed: see ``of_one_house``."""
        self._account.at(GROUNDING, f"grounding the rules for {request.rooms} rooms (clingo)")
        stages = [*HOUSE, *parts(self._walls), *parts(room_requirements(request))]
        constants, left_out = {"rooms": request.rooms}, self._grammar.left_out
        searching = of_one_house(seed)
        return Program(self._grammar.asp, constants, stages, searching=searching, left_out=left_out)

    def _units(
        self, rooms: int, required: tuple[Symbol, ...] = (), arguments: tuple[str, ...] = ()
    ) -> Program:
        """Return the program of the units of a house, for a topology with units, as ``rooms`` does."""
        stages = [("units", []), *parts(required)]
        self._account.at(GROUNDING, f"grounding the rules for units of {rooms} rooms in all (clingo)")
        return Program(self._grammar.asp, {"rooms": rooms}, stages, arguments=arguments)

    def unit_sizes(self, rooms: int) -> list[int]:
        """Return the possible numbers of rooms of a unit; empty for a topology without units."""
        return sorted({atom.arguments[1].number for atom in self.units(rooms).atoms("unit", 2)})

    def furniture(
        self,
        type_: str,
        required: tuple[Symbol, ...] = (),
        arguments: tuple[str, ...] = (),
        rng: np.random.Generator | None = None,
    ) -> Program:
        """Return the program of a room's furniture, with the extremes of its lengths as facts.

        For a crowded room type the program belongs to the current house and has a seed from ``rng``.
        """
        facts = [fact for fact, _ in self._lengths[type_]]
        return self._furnishing(type_, "capacity", (*facts, *required), arguments, rng)

    def given(
        self,
        type_: str,
        openings: tuple[Symbol, ...],
        required: tuple[Symbol, ...],
        rng: np.random.Generator,
    ) -> Program:
        """Return the program of a room of given size and ``openings`` (``Frame.facts``): ``doors.lp``."""
        facts = [fact for fact, _ in self._lengths[type_] if fact.name != "reach"]
        return self._furnishing(type_, "plan", (*facts, *openings, *required), (), rng)

    def _furnishing(
        self,
        type_: str,
        stage: str,
        facts: tuple[Symbol, ...],
        arguments: tuple[str, ...],
        rng: np.random.Generator | None,
    ) -> Program:
        key, own = (type_, stage, facts, arguments), rng if type_ in self._crowded else None
        known = self._of_house if own or key in self._of_house else self._of_all
        if key not in known:
            self._account.at(GROUNDING, f"grounding the rules for the furniture of {article(type_)} (clingo)")
            known[key] = Program(
                self._grammar.asp,
                {"this_room": type_, **(GIVEN_ROOM_CONSTANTS if stage == "plan" else {})},
                [("room", []), (stage, []), *parts(facts)],
                arguments=arguments,
                searching=of_one_house(int(own.integers(2**31)), is_bounded=True) if own else KEPT_SEARCH,
            )
        return known[key]

    def begin(self) -> None:
        """Begin another house, without the programs of the last one."""
        self._of_house.clear()

    def has_furniture(self, type_: str) -> bool:
        """Return True if a room of this type may have furniture."""
        return bool(self._furniture[type_])

    def rooms_for(
        self, request: HouseRequest, arguments: tuple[str, ...] = ()
    ) -> tuple[Program, list[Symbol]]:
        """Return the program of a request's rooms, and the atoms to assume."""
        required = room_requirements(request)
        return self.rooms(request.rooms, tuple(required), arguments), [granted(each) for each in required]

    def units_for(
        self, request: HouseRequest, barred: Iterable[Symbol] = (), arguments: tuple[str, ...] = ()
    ) -> tuple[Program, list[Symbol]]:
        """Return the program of the units of a request's house, and the atoms to assume."""
        required = [*shared_requirements(request), *barred]
        program = self.units(request.rooms, tuple(required), arguments)
        return program, [granted(each) for each in required]

    def unit_for(self, request: HouseRequest) -> tuple[Program, list[Symbol]]:
        """Return the program of a unit's rooms for any numbers of these types, and the atoms to assume."""
        numbers = range(request.rooms + 1)
        each_number = [dict.fromkeys(request.types, (number, number)) for number in numbers]
        possible = [each for types in each_number for each in requirements("among", types)]
        assumed = [granted(each) for each in requirements("among", request.types)]
        return self.rooms(request.rooms, tuple(possible)), assumed

    def furniture_for(
        self,
        type_: str,
        request: HouseRequest,
        arguments: tuple[str, ...] = (),
        rng: np.random.Generator | None = None,
    ) -> tuple[Program, list[Symbol]]:
        """Return the program that furnishes a room of this type for a request, and the atoms to assume."""
        required = self.required_in(type_, request)
        return self.furniture(type_, required, arguments, rng), [granted(each) for each in required]

    def required_in(self, type_: str, request: HouseRequest) -> tuple[Symbol, ...]:
        """Return the requirements of a request for the furniture of a room of this type."""
        asked = request.pieces_of(type_)
        return tuple(
            requirements("has", {name: n for name, n in asked.items() if name in self._furniture[type_]})
        )

    def all_furniture(self, request: HouseRequest) -> list[Program]:
        """Return the programs that furnish rooms for a request, one for each type."""
        return [self.furniture_for(type_, request)[0] for type_ in sorted(self._furniture)]

    def counts(self, request: HouseRequest, seconds: float) -> Iterator[tuple[str, int, bool | None]]:
        """Yield the running counts of layouts of the rooms, and of the furniture of each room type.

        Each item is a name, the number so far, and its state: True if complete, False if the share of the
        seconds ran out, None if the count continues.
        """
        end = time.monotonic() + seconds
        named = [(str(request), self.rooms_for(request, ALL_LAYOUTS))]
        if sizes := self.unit_sizes(request.rooms):
            named = [(f"units of {request}", self.units_for(request, arguments=ALL_LAYOUTS))]
            named += [
                (f"a unit of {size} rooms", self.rooms_for(HouseRequest(size), ALL_LAYOUTS)) for size in sizes
            ]
        named += [
            (type_, self.furniture_for(type_, request, ALL_LAYOUTS)) for type_ in sorted(self._furniture)
        ]
        for place, (name, (program, assumed)) in enumerate(named):
            self._account.at(LAYOUT, f"counting layouts: {name} (clingo)")
            share = max(0.0, end - time.monotonic()) / (len(named) - place)
            for count in program.count(assumed, share):
                yield (name, *count)

    def remarks(self) -> Iterator[GrammarError]:
        """Yield clingo's messages about the grammar's files that are not errors.

        The message that an atom is in no rule's head is left out: a program holds the rules of one stage.
        """
        own = tuple(f"{file}:" for file in self._grammar.own)
        found: dict[tuple[str, int | None, int | None], GrammarError] = {}
        for program in (self.rooms(1), *self.all_furniture(HouseRequest(1))):
            for remark in program.remarks:
                if remark.startswith(own) and "does not occur in any rule head" not in remark:
                    error = placed_error(remark)
                    found.setdefault((str(error.file), error.line, error.column), error)
        yield from found.values()
