"""Both stages under some of the statements that make a house: whether there is one, and what forbids it.

Every rule, fact and length of the user's may be left out (``logic.layout.relaxed``). What stage 2 refutes is
learnt by stage 1, so a test ends with a house or with what conflicts in both.
"""

import math
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import partial

import numpy as np
from clingo import Function, Number, Symbol

from logic.errors import Reason
from logic.generation.movable_doors import Refuted
from logic.generation.question import Question
from logic.grammar import Grammar
from logic.layout.conditional import Source
from logic.layout.program import HOUSE, Conflict
from logic.layout.programs import GIVEN
from logic.layout.relaxed import Relaxed, Statement
from logic.layout.terms import (
    Lengths,
    brief_requirements,
    granted,
    own_requirements,
    parts,
    requirements,
    room_requirements,
    to_furnish,
)
from logic.placement.layout import Layout, RoomLayout
from logic.placement.placer import Infeasible, Placer
from logic.request.fixed_rooms import FixedRoom
from logic.request.request import Range, Request, as_option

HouseFacts = Sequence[tuple[Symbol, tuple[Symbol, ...]]]
"""What stage 1 knows of a house's walls and areas, each fact with the clauses that it comes from."""

INFERENCES = 100_000_000
"""Most Prolog inferences for a room on a grid."""

MORE = 8
"""How many more of a piece are tried than its fact allows."""


class Feasibility:
    """The programs of a grammar's houses and rooms with statements that may be left out, and tests of these.

    The cell of a grid is taken as given, never among the reasons; so are the sizes of rooms that do not fit
    between the fixed rooms.
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
        """Know a grammar, the lengths of each of its room types, and facts about all of a house.

        Where these are ``placed`` already, stage 2 has no part in them. ``thorough``: see ``Placer.walls``.
        """
        self.thorough = thorough
        self.grammar, self.placer, self.facts = grammar, placer, facts
        self._lengths = lengths
        self.source = Source(grammar.asp, grammar.left_out)
        self._placed = placed
        self._furnishable: dict[tuple[str, tuple[object, ...]], bool] = {}

    def house(
        self, request: Request, unfurnishable: Iterable[str] = (), laws: bool = False
    ) -> tuple[Relaxed, list[Statement]]:
        """The program of a house's rooms, and all that may be left out of it (``laws``: see ``Relaxed``)."""
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

    def is_furnishable(self, request: Request, type_: str, most: float = math.inf) -> bool:
        """Return True if a room of this type can have its requested furniture; see ``Question.layout``."""
        asked = tuple(request.furniture_of(type_))
        if (type_, asked) not in self._furnishable:
            question, statements = self.furniture(request, type_)
            self._furnishable[type_, asked] = question.possible(statements, most)
        return self._furnishable[type_, asked]

    def depends_on_doors(self, type_: str) -> bool:
        """Return True if a rule of the grammar mentions the doors of this room type: it may require doors."""
        of_others = re.compile(rf"this_room\s*=\s*(?!{type_}\b)[a-z]")
        rules = self.source.conditional(self.source.files, laws=False).reasons
        return any("doorway(" in rule.text and not of_others.search(rule.text) for rule in rules)

    def furniture(
        self, request: Request, type_: str, laws: bool = False, room: Refuted | None = None
    ) -> tuple[Question, list[Statement]]:
        """Return the question whether a room can be furnished, and the statements that a proof may leave out.

        The room is ``room`` of a plan, or a room of any size with one door. For ``laws`` see ``Relaxed``.
        """
        facts = [(fact, clause) for fact, clause in self._lengths[type_] if not room or fact.name != "reach"]
        pieces = {fact.arguments[0].name for fact, _ in facts if fact.name == "extent"}
        asked = [each for each in request.furniture_of(type_) if each[1] in pieces]
        required = [
            (option("--piece", name, request.furniture), *requirements("has", {piece: wanted}))
            for name, piece, wanted in asked
        ]
        more = [
            Function("more", [Function(piece), Number(min(least, MORE))])
            for _, piece, (least, _) in asked
            if least
        ]
        # How much of a wall a piece takes may depend on the wall, and so on a room of any size.
        size = () if room else (Function("size", [Function(type_)]),)
        lengths = self._stated(
            (fact, (clause, *size) if fact.name == "extent" else (clause,)) for fact, clause in facts
        )
        relaxed = Relaxed(
            self.source,
            {"this_room": type_, **(GIVEN if room else {})},
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
        # With fewer pieces less is to be refuted: that there must be a piece is the first to be left out.
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
        """Facts with the clauses that they come from, and where these stand; not those that nobody states."""
        known = list(facts)
        origins = self.placer.origins({clause for _, clauses in known for clause in clauses})
        places = {clause: self.placer.reason(*place) for clause, place in origins.items()}
        return [(fact, {each: places[each] for each in clauses if each in places}) for fact, clauses in known]

    def of_rooms(self, relaxed: Relaxed, request: Request) -> Question:
        """What can be asked of the rooms of a house, and of the places for their walls or of their areas."""
        if self._placed or not self.facts:
            return Question(relaxed)
        if self.grammar.shares_walls:
            return Question(relaxed, partial(self.placer.wall_conflict, thorough=self.thorough))

        def too_small_or_large(layout: Sequence[Symbol], without: Collection[Symbol]) -> Conflict | None:
            unfurnished = Layout.unfurnished(layout, request.fixed)
            return self.placer.area_conflict(unfurnished, request.fixed, sorted(self._lengths), without)

        return Question(relaxed, too_small_or_large)

    def _conflict(
        self, request: Request, type_: str, furniture: Sequence[Symbol], without: Collection[Symbol]
    ) -> Conflict | None:
        """The conflict in a room with this furniture, some clauses left out; None if it has places."""
        kind = Function(type_)
        conflict = self.placer.conflict(kind, furniture, without)
        if conflict is None and request.cell and not without:
            # Lengths that only have to be linear may fit where whole numbers of cells do not.
            alone = Layout([RoomLayout(0, kind, Function("north"), furniture)], ())
            try:
                self.placer.place(alone, np.random.default_rng(0), INFERENCES)
            except Infeasible as proof:
                conflict = proof.conflicts[0]
        return conflict


def _keeps(statement: Statement) -> int:
    """In which order statements are kept: lengths, rules, facts."""
    return 0 if statement.clause else 1 if ":-" in statement.reason.text else 2


def option(option: str, name: str, ranges: Mapping[str, Range]) -> Reason:
    """A choice of the request's as on the command line."""
    return Reason(f"{option} {name}={as_option(ranges[name])}")


def _fixed(fixed: FixedRoom) -> Reason:
    """A fixed room, in words."""
    room = fixed.room
    return Reason(f"keep: the {room.type} at x {room.x:.2f}, y {room.y:.2f} m, {fixed.side} side")


def barred(type_: str) -> Reason:
    """That no room of a type can be furnished, as a statement."""
    return Reason(f"no room of type {type_} can be furnished")
