"""The proof that there is no house, in the user's own words: the conflict, where it stands, what would do."""

from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
from clingo import Function, Number, Symbol

from logic.errors import Reason, Unsatisfiable, VitruviusError
from logic.generation.movable_doors import Refuted
from logic.grammar import Grammar
from logic.layout.account import PROOF
from logic.layout.program import Conflict
from logic.layout.programs import GIVEN
from logic.layout.relaxed import Relaxed, Source, Statement, minimal
from logic.layout.terms import (
    Lengths,
    fixed_requirements,
    granted,
    own_requirements,
    parts,
    requirements,
    room_requirements,
    to_furnish,
)
from logic.placement.placer import Infeasible, Layout, Placer, RoomLayout, located
from logic.request.fixed_rooms import FixedRoom
from logic.request.request import MOST_ROOMS, Range, Request, as_option

Walls = Sequence[tuple[Symbol, tuple[Symbol, ...]]]
"""What stage 1 knows of walls, each fact with the clauses that it comes from."""

NEAR = 8
"""How far from a number of rooms others are tried."""

NEXT = 3
"""The same for rooms that share walls, of which each number takes a tenth of a second or more."""

INFERENCES = 100_000_000
"""Most Prolog inferences for a room on a grid."""

MORE = 8
"""How many more of a piece are tried than its fact allows."""


class Prover:
    """Finds minimal sets of reasons why a request has no house.

    The cell of a grid is taken as given, never among the reasons; so are the sizes of rooms that do not fit
    between the fixed rooms.
    """

    def __init__(
        self, grammar: Grammar, placer: Placer, lengths: Lengths, walls: Walls = (), placed: bool = False
    ) -> None:
        """Know a grammar, the lengths of each of its room types, and those of walls that rooms share.

        Where these are ``placed`` already, stage 2 has no part in them.
        """
        self._grammar, self._placer, self._lengths, self._walls = grammar, placer, lengths, walls
        self._source = Source(grammar.asp)
        self._placed = placed
        self._furnishable: dict[tuple[str, tuple[object, ...]], bool] = {}

    def unsatisfiable(
        self,
        request: Request,
        unfurnishable: Iterable[str],
        infeasible: Sequence[Mapping[Symbol, bool]] = (),
        refuted: Sequence[Refuted] = (),
    ) -> Unsatisfiable:
        """Why a request has no house, where some types of room are proved to have no furniture.

        And where these orders of the rooms are proved not to fit between the fixed rooms, or these rooms of a
        plan to have no furniture.
        """
        self._placer.account.at(PROOF, f"the proof that there is no house with {request}")
        relaxed, statements = self.house(request, unfurnishable)
        bare_rooms: dict[Reason, list[Refuted]] = defaultdict(list)
        for each in refuted:
            bare_rooms[Reason(str(each))].append(each)
        for reason, rooms_ in bare_rooms.items():
            nogoods = [{**each.atoms, **dict.fromkeys(each.grants, True)} for each in rooms_]
            statements.append(relaxed.proved(reason, nogoods))
        if refuted:  # The user's plan says more than rules from which the same follows: it is left out last.
            statements.sort(key=lambda each: each.reason.file is not None)
        fixed = {granted(each): True for each in fixed_requirements(request.fixed)}
        for order in infeasible:
            relaxed.exclude(Conflict({**order, **fixed}, ()))
        possible = self.has_walls(relaxed)
        # This learns what stage 2 proves infeasible, so that the core is one of both.
        if possible(statements):
            raise VitruviusError(f"{request} was proved infeasible that has walls")
        core = relaxed.core
        places = _rooms_of(request)
        for room in places:
            # What forbids a room of the plan says more than what follows for the other rooms.
            others = set().union(*places) - room
            some = [each for each in statements if each.reason not in others]
            if not possible(some):
                statements, core = some, list
                break
        needed = minimal(statements, possible, core)
        # An order is infeasible for one number of rooms, and so the number is part of the proof.
        named, rooms = True, None
        if request.plan:
            named = False
        elif not infeasible:
            named, rooms = self._number_of_rooms(request, unfurnishable, {each.reason for each in needed})
        bare = {_bare(type_): type_ for type_ in sorted(unfurnishable)}
        types = tuple(bare[each.reason] for each in needed if each.reason in bare)
        reasons = [Reason(f"--rooms {request.rooms}")] if named else []
        reasons += [each.reason for each in needed if each.reason not in {*bare, *bare_rooms}]
        for type_ in types:
            reasons += self._room(request, type_)
        for each in needed:
            reasons += self._rooms(request, bare_rooms.get(each.reason, ()))
        unique = tuple(dict.fromkeys(reasons))
        ways = [f"with --rooms {rooms}"] if rooms else []
        for choice, other in _without_each(request):
            if choice in unique and not (request.fixed or refuted) and self._has_house(other):
                ways.append(f"without {choice}")
        advice = f"There is a house {', or '.join(ways)}." if ways else ""
        return Unsatisfiable(self._grammar.name, str(request), unique, advice, types)

    def house(
        self, request: Request, unfurnishable: Iterable[str] = (), laws: bool = False
    ) -> tuple[Relaxed, list[Statement]]:
        """The program of a house's rooms, and all that may be left out of it (``laws``: see ``Relaxed``)."""
        required = room_requirements(request)
        reasons = [option("--type", name, request.types) for name in sorted(request.types)]
        reasons += map(_fixed, request.fixed)
        reasons += map(Reason, own_requirements(request.plan).values() if request.plan else ())
        relaxed = Relaxed(
            self._source,
            {"rooms": request.rooms},
            [("house", []), *parts(required)],
            self._stated(self._walls),
            laws=laws,
        )
        statements = list(relaxed.statements)
        for reason, requirement in zip(reasons, required, strict=True):
            statements.append(relaxed.choice(reason, [granted(requirement)]))
        for type_ in sorted(unfurnishable):
            statements.append(relaxed.choice(_bare(type_), fails=to_furnish(type_, request.rooms)))
        return relaxed, statements

    def conflict(self, request: Request) -> list[Reason]:
        """Why there are no such rooms, without what would do: the request's own choices among the reasons."""
        relaxed, statements = self.house(request)
        return [each.reason for each in minimal(statements, self.has_walls(relaxed), relaxed.core)]

    def _number_of_rooms(
        self, request: Request, unfurnishable: Iterable[str], conflict: Collection[Reason]
    ) -> tuple[bool, int | None]:
        """Whether another number of rooms would end the conflict, and one that does for everything."""
        named = False
        for rooms in _others(request, far=not self._walls):
            other = replace(request, rooms=rooms)
            relaxed, statements = self.house(other, unfurnishable)
            if self.has_walls(relaxed)([each for each in statements if each.reason in conflict]):
                named = True
                if request.fixed:  # Whether it fits between the fixed rooms is not known.
                    return named, None
                if self._has_house(other):
                    return named, rooms
        return named, None

    def _has_house(self, request: Request) -> bool:
        """Whether a request has a house: rooms, each of which can be furnished."""
        relaxed, statements = self.house(request)
        while (layout := relaxed.model(statements)) is not None:
            types = {atom.arguments[1].name for atom in layout if atom.name == "room"}
            bare = [type_ for type_ in sorted(types) if not self.is_furnishable(request, type_)]
            if not bare:
                return True
            for type_ in bare:
                statements.append(relaxed.choice(_bare(type_), fails=to_furnish(type_, request.rooms)))
        return False

    def is_furnishable(self, request: Request, type_: str) -> bool:
        """Whether a room of this type can have what is asked for."""
        asked = tuple(request.furniture_of(type_))
        if (type_, asked) not in self._furnishable:
            _, statements, possible = self.furniture(request, type_)
            self._furnishable[type_, asked] = possible(statements)
        return self._furnishable[type_, asked]

    def _room(self, request: Request, type_: str) -> list[Reason]:
        """Why no room of this type can be furnished."""
        relaxed, statements, possible = self.furniture(request, type_)
        # This learns all that stage 2 proves infeasible, so that the core is one of both stages.
        if possible(statements):
            raise VitruviusError(f"a {type_} was proved infeasible that can be furnished")
        return [each.reason for each in minimal(statements, possible, relaxed.core)]

    def _rooms(self, request: Request, refuted: Sequence[Refuted]) -> list[Reason]:
        """Why a room of a plan cannot be furnished, with any of these doors."""
        if not refuted:
            return []
        each = [self.furniture(request, one.room.room.type, room=one) for one in refuted]
        places = {id(statement): place for place, statement in enumerate(each[0][1])}

        def of(some: Sequence[Statement], statements: Sequence[Statement]) -> list[Statement]:
            return [statements[places[id(statement)]] for statement in some]

        def possible(some: Sequence[Statement]) -> bool:
            return any(test(of(some, statements)) for _, statements, test in each)

        def core(some: Sequence[Statement]) -> list[Statement]:
            found = set()
            for relaxed, statements, _ in each:
                kept = {id(statement) for statement in relaxed.core(of(some, statements))}
                found |= {place for place, statement in enumerate(statements) if id(statement) in kept}
            return [statement for statement in some if places[id(statement)] in found]

        if possible(each[0][1]):
            raise VitruviusError(f"{refuted[0].name} was proved infeasible, and can be furnished")
        return [statement.reason for statement in minimal(each[0][1], possible, core)]

    def furniture(
        self, request: Request, type_: str, laws: bool = False, room: Refuted | None = None
    ) -> tuple[Relaxed, list[Statement], Callable[[Sequence[Statement]], bool]]:
        """The program of a room's furniture, all that may be left out of it, and a test of both stages.

        Of a ``room`` of a plan or of one of any size with one door. With ``laws``, see ``Relaxed``.
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
        size = Function("size", [Function(type_)])
        # How much of a wall a piece takes may depend on the wall, and so on the room.
        lengths = self._stated(
            (fact, (clause, size) if fact.name == "extent" else (clause,)) for fact, clause in facts
        )
        relaxed = Relaxed(
            self._source,
            {"this_room": type_, **(GIVEN if room else {})},
            [
                ("room", []),
                ("plan" if room else "capacity", []),
                *parts(room.room.doorways() if room else ()),
                *parts(requirement for _, requirement in required),
                *parts(more),
            ],
            lengths,
            laws=laws,
        )
        statements = list(relaxed.statements)
        statements += [relaxed.choice(reason, [granted(requirement)]) for reason, requirement in required]
        if room:
            relaxed.give(*room.room.given(room.windows))

        def possible(some: Sequence[Statement]) -> bool:
            stated = {each.literals for each in some}
            without = {
                each.clause for each in relaxed.statements if each.clause and each.literals not in stated
            }
            while (furniture := relaxed.model(some)) is not None:
                if room:
                    conflict = self._placer.loose_conflict(room.room.loose_term(furniture), without)
                else:
                    conflict = self._conflict(request, type_, furniture, without)
                if conflict is None:
                    return True
                relaxed.exclude(conflict)
            return False

        return relaxed, statements, possible

    def _stated(
        self, facts: Iterable[tuple[Symbol, Sequence[Symbol]]]
    ) -> list[tuple[Symbol, dict[Symbol, Reason]]]:
        """Facts with the clauses that they come from, and where these stand; not those that nobody states."""
        known = list(facts)
        origins = self._placer.origins({clause for _, clauses in known for clause in clauses})
        places = {clause: located(*place) for clause, place in origins.items()}
        return [(fact, {each: places[each] for each in clauses if each in places}) for fact, clauses in known]

    def has_walls(self, relaxed: Relaxed) -> Callable[[Sequence[Statement]], bool]:
        """A test whether there are rooms under some statements, and places for the walls that they share."""

        def possible(some: Sequence[Statement]) -> bool:
            stated = {each.literals for each in some}
            without = {
                each.clause for each in relaxed.statements if each.clause and each.literals not in stated
            }
            while (layout := relaxed.model(some)) is not None:
                unplaced = self._walls and not self._placed
                conflict = self._placer.wall_conflict(layout, without) if unplaced else None
                if conflict is None:
                    return True
                relaxed.exclude(conflict)
            return False

        return possible

    def _conflict(
        self, request: Request, type_: str, furniture: Sequence[Symbol], without: Collection[Symbol]
    ) -> Conflict | None:
        """The conflict in a room with this furniture, some clauses left out; None if it has places."""
        kind = Function(type_)
        conflict = self._placer.conflict(kind, furniture, without)
        if conflict is None and request.cell and not without:
            # Lengths that only have to be linear may fit where whole numbers of cells do not.
            alone = Layout([RoomLayout(0, kind, Function("north"), furniture)], ())
            try:
                self._placer.place(alone, np.random.default_rng(0), INFERENCES)
            except Infeasible as proof:
                conflict = proof.conflicts[0]
        return conflict


def _others(request: Request, far: bool) -> list[int]:
    """Other numbers of rooms, the nearest first: near this one and near the sum of types.

    With ``far``, powers of two as well: the rules of walls that rooms share are too many for a large house.
    """
    wanted = sum(least for least, _ in request.types.values())
    near = NEAR if far else NEXT
    some = {*range(1, near), *(2**n for n in range(8) if far)}
    for number in (request.rooms, wanted):
        some.update(range(number - near, number + near + 1))
    numbers = sorted(some & set(range(1, MOST_ROOMS + 1)) - {request.rooms})
    return sorted(numbers, key=lambda number: abs(number - request.rooms))


def option(option: str, name: str, ranges: Mapping[str, Range]) -> Reason:
    """A choice of the request's as on the command line."""
    return Reason(f"{option} {name}={as_option(ranges[name])}")


def _without_each(request: Request) -> Iterator[tuple[Reason, Request]]:
    """Each choice of the request's, and the request without it."""
    for name in request.types:
        fewer = {other: wanted for other, wanted in request.types.items() if other != name}
        yield option("--type", name, request.types), replace(request, types=fewer)
    for name in request.furniture:
        fewer = {other: wanted for other, wanted in request.furniture.items() if other != name}
        yield option("--piece", name, request.furniture), replace(request, furniture=fewer)


def _rooms_of(request: Request) -> list[set[Reason]]:
    """What the request's plan says of each of its rooms, if it has one; before that, where the request too
    counts types, the types of all rooms.
    """
    rooms: dict[Symbol, set[Reason]] = {}
    types: set[Reason] = set()
    for requirement, text in own_requirements(request.plan).items() if request.plan else ():
        rooms.setdefault(requirement.arguments[0], set()).add(Reason(text))
        if requirement.name == "typed":
            types.add(Reason(text))
    return [types, *rooms.values()] if types and request.types else list(rooms.values())


def _fixed(fixed: FixedRoom) -> Reason:
    """A fixed room, in words."""
    room = fixed.room
    return Reason(f"keep: the {room.type} at x {room.x:.2f}, y {room.y:.2f} m, {fixed.side} side")


def _bare(type_: str) -> Reason:
    return Reason(f"no room of type {type_} can be furnished")
