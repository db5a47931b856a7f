"""Tests of both stages under some of the statements about a house, and the statements in conflict.

Every rule, fact and length of the user may be left out (``logic.layout.relaxed``). Stage 1 learns each
conflict of stage 2. Therefore a test ends with a house or with the statements that conflict in both stages.
"""

import math
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from functools import partial

import numpy as np
from clingo import Function, Number, Symbol

from vitruvius.logic.errors import Reason
from vitruvius.logic.generation.movable_doors import Refuted
from vitruvius.logic.generation.question import Question
from vitruvius.logic.grammar import Grammar
from vitruvius.logic.layout.conditional import Source
from vitruvius.logic.layout.program import HOUSE, Conflict, Program, TooMany, of_one_house
from vitruvius.logic.layout.programs import GIVEN_ROOM_CONSTANTS
from vitruvius.logic.layout.relaxed import Relaxed, Statement
from vitruvius.logic.layout.terms import (
    Lengths,
    brief_requirements,
    granted,
    own_requirements,
    parts,
    requirements,
    room_requirements,
    to_furnish,
)
from vitruvius.logic.placement.layout import Layout, RoomLayout
from vitruvius.logic.placement.placer import Infeasible, Placer
from vitruvius.logic.request.counts import Range, as_option
from vitruvius.logic.request.fixed_rooms import FixedRoom
from vitruvius.logic.request.house_request import HouseRequest

HouseFacts = Sequence[tuple[Symbol, tuple[Symbol, ...]]]
"""Facts of stage 1 about a house's walls and areas, each with the clauses that state it."""

INFERENCES = 100_000_000
"""Largest number of Prolog inferences for a room on a grid."""

MAX_EXTRA_PIECES = 8
"""Number of pieces that are tried beyond the number that a piece's fact allows."""


class Feasibility:
    """Programs of a grammar's houses and rooms with statements that may be left out, and tests of them.

    The cell of a grid is always assumed and never among the reasons. The same holds for the sizes of rooms
    that do not fit between the fixed rooms.
    """

    def __init__(
        self,
        grammar: Grammar,
        placer: Placer,
        lengths: Lengths,
        facts: HouseFacts = (),
        placed: bool = False,
        thorough: bool = False,
    ) -> None:
        """Set a grammar, the lengths of each of its room types, and facts about the whole house.

        If the facts are ``placed`` already, stage 2 has no part in them. ``thorough``: see ``Placer.walls``.
        """
        self.thorough = thorough
        self.grammar, self.placer, self.facts = grammar, placer, facts
        self._lengths = lengths
        self.source = Source(grammar.asp, grammar.left_out)
        self._placed = placed
        self._furnishable: dict[tuple[str, tuple[object, ...]], bool] = {}
        self._refuted: dict[tuple[str, tuple[object, ...]], tuple[Question, list[Statement]]] = {}
        """Furniture that stage 1 refutes by itself."""

    def house(
        self, request: HouseRequest, unfurnishable: Iterable[str] = (), laws: bool = False
    ) -> tuple[Relaxed, list[Statement]]:
        """Return the program of a house's rooms, and all statements that may be left out of it.

        For ``laws`` see ``Relaxed``.
        """
        required = room_requirements(request)
        reasons = [option("--type", name, request.types) for name in sorted(request.types)]
        reasons += map(_fixed, request.fixed)
        reasons += map(Reason, own_requirements(request.plan).values() if request.plan else ())
        relaxed = Relaxed(
            self.source,
            {"rooms": request.rooms},
            [*HOUSE, *parts(required)],
            self._stated(self.facts),
            laws=laws,
        )
        statements = list(relaxed.statements)
        for reason, requirement in zip(reasons, required, strict=False):
            statements.append(relaxed.choice(reason, [granted(requirement)]))
        for words, terms in brief_requirements(request.brief) if request.brief else ():
            statements.append(relaxed.choice(Reason(words), list(map(granted, terms))))
        for type_ in sorted(unfurnishable):
            statements.append(relaxed.choice(barred(type_), fails=to_furnish(type_, request.rooms)))
        return relaxed, statements

    def is_furnishable(self, request: HouseRequest, type_: str, most: float = math.inf) -> bool:
        """Return True if a room of this type can have its requested furniture; see ``Question.layout``."""
        asked = type_, tuple(request.furniture_of(type_))
        if asked not in self._furnishable and self._is_soon_furnished(request, type_):
            self._furnishable[asked] = True
        if asked not in self._furnishable:
            question, statements = self.furniture(request, type_)
            if not Question(question.relaxed).possible(statements, most):
                self._refuted[asked] = question, statements
                self._furnishable[asked] = False
            else:
                self._furnishable[asked] = question.possible(statements, most)
        return self._furnishable[asked]

    def _is_soon_furnished(self, request: HouseRequest, type_: str) -> bool:
        """Return True if the first layout of such a room fits: a program with all statements is small."""
        facts = [fact for fact, _ in self._lengths[type_]]
        required = [requirement for _, requirement in self._required(request, type_)]
        program = Program(
            self.grammar.asp,
            {"this_room": type_},
            [("room", []), ("capacity", []), *parts(facts), *parts(required)],
            searching=of_one_house(0, is_bounded=True),
            left_out=self.grammar.left_out,
        )
        with suppress(TooMany):
            layout = program.sample(np.random.default_rng(0), map(granted, required))
            return layout is not None and self._conflict(request, type_, layout, ()) is None
        return False

    def _required(self, request: HouseRequest, type_: str) -> list[tuple[Reason, Symbol]]:
        """Return the requirements of a request for the pieces that a room type has, each with its choice."""
        pieces = {fact.arguments[0].name for fact, _ in self._lengths[type_] if fact.name == "extent"}
        return [
            (option("--piece", name, request.furniture), requirements("has", {piece: wanted})[0])
            for name, piece, wanted in request.furniture_of(type_)
            if piece in pieces
        ]

    def unfurnishable(self, request: HouseRequest, type_: str) -> tuple[Question, list[Statement]]:
        """Return ``furniture`` of a type that ``is_furnishable`` refuted, once without grounding it again."""
        asked = type_, tuple(request.furniture_of(type_))
        return self._refuted.pop(asked, None) or self.furniture(request, type_)

    def depends_on_doors(self, type_: str) -> bool:
        """Return True if a rule of the grammar mentions the doors of this room type: it may require doors."""
        of_others = re.compile(rf"this_room\s*=\s*(?!{type_}\b)[a-z]")
        rules = self.source.conditional(self.source.files, laws=False).reasons
        return any("doorway(" in rule.text and not of_others.search(rule.text) for rule in rules)

    def furniture(
        self, request: HouseRequest, type_: str, laws: bool = False, room: Refuted | None = None
    ) -> tuple[Question, list[Statement]]:
        """Return the question whether a room can be furnished, and the statements that a proof may leave out.

        The room is ``room`` of a plan, or a room of any size with one door. For ``laws`` see ``Relaxed``.
        """
        facts = [(fact, clause) for fact, clause in self._lengths[type_] if not room or fact.name != "reach"]
        required = self._required(request, type_)
        needed = [requirement.arguments for _, requirement in required if requirement.arguments[1].number]
        more = [
            Function("more", [piece, Number(min(least.number, MAX_EXTRA_PIECES))])
            for piece, least, _ in needed
        ]
        # The length of wall that a piece takes may depend on the wall, and so on a room of any size.
        size = () if room else (Function("size", [Function(type_)]),)
        lengths = self._stated(
            (fact, (clause, *size) if fact.name == "extent" else (clause,)) for fact, clause in facts
        )
        relaxed = Relaxed(
            self.source,
            {"this_room": type_, **(GIVEN_ROOM_CONSTANTS if room else {})},
            [
                ("room", []),
                ("plan" if room else "capacity", []),
                *parts(room.room.facts() if room else ()),
                *parts(requirement for _, requirement in required),
                *parts(more),
            ],
            lengths,
            laws=laws,
        )
        # Fewer pieces make less to refute, so the statement that a piece must exist is left out first.
        statements = sorted(relaxed.statements, key=_keeps)
        statements += [relaxed.choice(reason, [granted(requirement)]) for reason, requirement in required]
        if room:
            relaxed.give(*room.room.given(room.windows))

        def refuted(furniture: Sequence[Symbol], without: Collection[Symbol]) -> Conflict | None:
            if room:
                return self.placer.loose_conflict(room.room.loose_term(furniture), without)
            return self._conflict(request, type_, furniture, without)

        return Question(relaxed, refuted), statements

    def _stated(
        self, facts: Iterable[tuple[Symbol, Sequence[Symbol]]]
    ) -> list[tuple[Symbol, dict[Symbol, Reason]]]:
        """Return facts with the clauses that state them and the places of these.

        Unstated clauses are left out.
        """
        known = list(facts)
        origins = self.placer.origins({clause for _, clauses in known for clause in clauses})
        places = {clause: self.placer.reason(*place) for clause, place in origins.items()}
        return [(fact, {each: places[each] for each in clauses if each in places}) for fact, clauses in known]

    def of_rooms(self, relaxed: Relaxed, request: HouseRequest) -> Question:
        """Return the question about a house's rooms and the places of their walls, or their areas."""
        if self._placed or not self.facts:
            return Question(relaxed)
        if self.grammar.shares_walls:
            return Question(relaxed, partial(self.placer.wall_conflict, thorough=self.thorough))

        def too_small_or_large(layout: Sequence[Symbol], without: Collection[Symbol]) -> Conflict | None:
            unfurnished = Layout.unfurnished(layout, request.fixed)
            return self.placer.area_conflict(unfurnished, request.fixed, sorted(self._lengths), without)

        return Question(relaxed, too_small_or_large)

    def _conflict(
        self, request: HouseRequest, type_: str, furniture: Sequence[Symbol], without: Collection[Symbol]
    ) -> Conflict | None:
        """Return the conflict in a room with this furniture, without some clauses, or None if it fits."""
        kind = Function(type_)
        conflict = self.placer.conflict(kind, furniture, without)
        if conflict is None and request.cell and not without:
            # Lengths may fit when they only have to be linear, but not as whole numbers of cells.
            alone = Layout([RoomLayout(0, kind, Function("north"), furniture)], ())
            try:
                self.placer.place(alone, np.random.default_rng(0), INFERENCES)
            except Infeasible as proof:
                conflict = proof.conflicts[0]
        return conflict


def _keeps(statement: Statement) -> int:
    """Return the order in which statements are kept: lengths, rules, facts."""
    return 0 if statement.clause else 1 if ":-" in statement.reason.text else 2


def option(option: str, name: str, ranges: Mapping[str, Range]) -> Reason:
    """Return a choice of the request as on the command line."""
    return Reason(f"{option} {name}={as_option(ranges[name])}")


def _fixed(fixed: FixedRoom) -> Reason:
    """Return a fixed room in words."""
    room = fixed.room
    return Reason(f"keep: the {room.type} at x {room.x:.2f}, y {room.y:.2f} m, {fixed.side} side")


def barred(type_: str) -> Reason:
    """Return the statement that no room of a type can be furnished."""
    return Reason(f"no room of type {type_} can be furnished")
