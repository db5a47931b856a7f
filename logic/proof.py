"""The proof that there is no house, in the user's own words: what clashes, where it stands, what would do."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from clingo import Function, Number, Symbol

from logic.errors import Reason, Unsatisfiable, VitruviusError
from logic.explain import Relaxed, Statement, least
from logic.grammar import Grammar
from logic.keep import Kept
from logic.placement import Clash, Layout, Placer, Refuted, RoomLayout
from logic.request import Range, Request, as_option

NEAR = 8
"""How far from a number of rooms others are tried."""

MOST_ROOMS = 128

INFERENCES = 100_000_000
"""Most Prolog inferences for a room on a grid."""

MORE = 8
"""How many more of a piece are tried than its fact allows."""

Lengths = Mapping[str, Sequence[tuple[Symbol, Symbol]]]
"""For each room type the lengths that stage 1 knows, facts, each with the clause that it comes from."""


class Prover:
    """Finds least sets of reasons why a request has no house.

    The cell of a grid is taken as given, never among the reasons; so are the sizes of rooms that do not fit
    between those that stay.
    """

    def __init__(self, grammar: Grammar, placer: Placer, lengths: Lengths) -> None:
        """Know a grammar and the lengths of each of its room types."""
        self._grammar, self._placer, self._lengths = grammar, placer, lengths
        self._furnishable: dict[tuple[str, tuple[object, ...]], bool] = {}

    def unsatisfiable(
        self,
        request: Request,
        unfurnishable: Iterable[str],
        hopeless: Sequence[Mapping[Symbol, bool]] = (),
    ) -> Unsatisfiable:
        """Why a request has no house, where some types of room are proved to have no furniture.

        And where these orders of the rooms are proved not to fit between those that stay.
        """
        relaxed, statements = self._house(request, unfurnishable)
        stays = {Function("granted", [wish]): True for wish in stays_for(request.keep).values()}
        for order in hopeless:
            relaxed.refute(Clash({**order, **stays}, ()))
        kept = least(statements, lambda some: relaxed.model(some) is not None, relaxed.core)
        # An order is refuted for one number of rooms, and so the number is part of the proof.
        named, rooms = True, None
        if not hopeless:
            named, rooms = self._number_of_rooms(request, unfurnishable, {each.reason for each in kept})
        bare = {_bare(type_): type_ for type_ in sorted(unfurnishable)}
        types = tuple(bare[each.reason] for each in kept if each.reason in bare)
        reasons = [Reason(f"--rooms {request.rooms}")] if named else []
        reasons += [each.reason for each in kept if each.reason not in bare]
        for type_ in types:
            reasons += self._room(request, type_)
        unique = tuple(dict.fromkeys(reasons))
        ways = [f"with --rooms {rooms}"] if rooms else []
        for choice, other in _without_each(request):
            if choice in unique and not request.keep and self._has_house(other):
                ways.append(f"without {choice}")
        advice = f"There is a house {', or '.join(ways)}." if ways else ""
        return Unsatisfiable(self._grammar.name, str(request), unique, advice, types)

    def _house(self, request: Request, unfurnishable: Iterable[str] = ()) -> tuple[Relaxed, list[Statement]]:
        """The program of a house's rooms, and all that may be left out of it."""
        wishes = [
            (_option("--type", name, request.types), wish)
            for name, wish in wishes_for("among", request.types).items()
        ]
        wishes += zip(map(_stay, request.keep), stays_for(request.keep).values(), strict=True)
        relaxed = Relaxed(
            self._grammar.asp,
            {"rooms": request.rooms},
            [("house", []), *((wish.name, wish.arguments) for _, wish in wishes)],
        )
        statements = list(relaxed.statements)
        for reason, wish in wishes:
            statements.append(relaxed.choice(reason, [Function("granted", [wish])]))
        for type_ in sorted(unfurnishable):
            statements.append(relaxed.choice(_bare(type_), fails=_rooms_of(type_, request)))
        return relaxed, statements

    def _number_of_rooms(
        self, request: Request, unfurnishable: Iterable[str], clashing: Collection[Reason]
    ) -> tuple[bool, int | None]:
        """Whether another number of rooms would do for what clashes, and one that does for everything."""
        named = False
        for rooms in _others(request):
            other = replace(request, rooms=rooms)
            relaxed, statements = self._house(other, unfurnishable)
            if relaxed.model([each for each in statements if each.reason in clashing]) is not None:
                named = True
                if request.keep:  # Whether it fits between the rooms that stay is not known.
                    return named, None
                if self._has_house(other):
                    return named, rooms
        return named, None

    def _has_house(self, request: Request) -> bool:
        """Whether a request has a house: rooms, each of which can be furnished."""
        relaxed, statements = self._house(request)
        while (layout := relaxed.model(statements)) is not None:
            types = {atom.arguments[1].name for atom in layout if atom.name == "room"}
            bare = [type_ for type_ in sorted(types) if not self._is_furnishable(request, type_)]
            if not bare:
                return True
            for type_ in bare:
                statements.append(relaxed.choice(_bare(type_), fails=_rooms_of(type_, request)))
        return False

    def _is_furnishable(self, request: Request, type_: str) -> bool:
        """Whether a room of this type can have what is asked for."""
        wishes = tuple(request.wishes(type_))
        if (type_, wishes) not in self._furnishable:
            _, statements, possible = self._furniture(request, type_)
            self._furnishable[type_, wishes] = possible(statements)
        return self._furnishable[type_, wishes]

    def _room(self, request: Request, type_: str) -> list[Reason]:
        """Why no room of this type can be furnished."""
        relaxed, statements, possible = self._furniture(request, type_)
        # This learns all that stage 2 refutes, so that the core is one of both stages.
        if possible(statements):
            raise VitruviusError(f"a {type_} was refuted that can be furnished")
        return [each.reason for each in least(statements, possible, relaxed.core)]

    def _furniture(
        self, request: Request, type_: str
    ) -> tuple[Relaxed, list[Statement], Callable[[Sequence[Statement]], bool]]:
        """The program of a room's furniture, all that may be left out of it, and a test of both stages."""
        facts = self._lengths[type_]
        pieces = {fact.arguments[0].name for fact, _ in facts if fact.name == "extent"}
        wishes = [
            (_option("--piece", name, request.furniture), *wishes_for("has", {piece: wanted}).values())
            for name, piece, wanted in request.wishes(type_)
            if piece in pieces
        ]
        more = [
            ("more", [Function(piece), Number(min(least, MORE))])
            for _, piece, (least, _) in request.wishes(type_)
            if piece in pieces and least
        ]
        origins = self._placer.origins({clause for _, clause in facts})
        located = {clause: _located(*origins[clause]) for _, clause in facts}
        room = Function("size", [Function(type_)])
        lengths = [
            # How much of a wall a piece takes may depend on the wall, and so on the room.
            (fact, {each: located[each] for each in ((clause, room) if fact.name == "extent" else (clause,))})
            for fact, clause in facts
        ]
        relaxed = Relaxed(
            self._grammar.asp,
            {"this_room": type_},
            [("room", []), *((wish.name, wish.arguments) for _, wish in wishes), *more],
            lengths,
            more=True,
        )
        statements = list(relaxed.statements)
        statements += [relaxed.choice(reason, [Function("granted", [wish])]) for reason, wish in wishes]

        def possible(some: Sequence[Statement]) -> bool:
            without = {each.clause for each in relaxed.statements if each.clause and each not in some}
            while (furniture := relaxed.model(some)) is not None:
                clash = self._clash(request, type_, furniture, without)
                if clash is None:
                    return True
                relaxed.refute(clash)
            return False

        return relaxed, statements, possible

    def _clash(
        self, request: Request, type_: str, furniture: Sequence[Symbol], without: Collection[Symbol]
    ) -> Clash | None:
        """What clashes in a room with this furniture, some clauses left out; None if it has places."""
        kind = Function(type_)
        clash = self._placer.clash(kind, furniture, without)
        if clash is None and request.cell and not without:
            # Lengths that only have to be linear may fit where whole numbers of cells do not.
            alone = Layout([RoomLayout(0, kind, Function("north"), furniture)], ())
            try:
                self._placer.place(alone, np.random.default_rng(0), INFERENCES)
            except Refuted as refuted:
                clash = refuted.clashes[0]
        return clash


def _others(request: Request) -> list[int]:
    """Other numbers of rooms, the nearest first: near ones, few, ever more, and what the wishes add up to."""
    wanted = sum(least for least, _ in request.types.values())
    some = {*range(1, NEAR), *(2**n for n in range(8))}
    for number in (request.rooms, wanted):
        some.update(range(number - NEAR, number + NEAR + 1))
    numbers = sorted(some & set(range(1, MOST_ROOMS + 1)) - {request.rooms})
    return sorted(numbers, key=lambda number: abs(number - request.rooms))


def _rooms_of(type_: str, request: Request) -> list[Symbol]:
    return [Function("bare", [Number(number), Function(type_)]) for number in range(request.rooms)]


def wishes_for(kind: str, ranges: Mapping[str, Any]) -> dict[str, Symbol]:
    """The wishes of a request as terms, see ``rules/wishes.lp``."""
    most = 2**31 - 1
    return {
        name: Function(kind, [Function(name), Number(a), Number(most if b is None else b)])
        for name, (a, b) in sorted(ranges.items())
    }


def _option(option: str, name: str, ranges: Mapping[str, Range]) -> Reason:
    """A choice of the request's as on the command line."""
    return Reason(f"{option} {name}={as_option(ranges[name])}")


def _without_each(request: Request) -> Iterator[tuple[Reason, Request]]:
    """Each choice of the request's, and the request without it."""
    for name in request.types:
        fewer = {other: wanted for other, wanted in request.types.items() if other != name}
        yield _option("--type", name, request.types), replace(request, types=fewer)
    for name in request.furniture:
        fewer = {other: wanted for other, wanted in request.furniture.items() if other != name}
        yield _option("--piece", name, request.furniture), replace(request, furniture=fewer)


def stays_for(keep: Sequence[Kept]) -> dict[str, Symbol]:
    """That rooms stay where they are, as terms, see ``rules/wishes.lp``."""
    return {
        f"keep {number}": Function("stays", [Number(number), Function(kept.room.type), Function(kept.side)])
        for number, kept in enumerate(keep)
    }


def _stay(kept: Kept) -> Reason:
    """That a room stays, in words."""
    room = kept.room
    return Reason(f"keep: the {room.type} at x {room.x:.2f}, y {room.y:.2f} m, {kept.side} side")


def _bare(type_: str) -> Reason:
    return Reason(f"no room of type {type_} can be furnished")


def _located(file: str, line: int) -> Reason:
    """The clause's source from its first line to the full stop."""
    with open(file, encoding="utf-8") as rules:
        lines = rules.read().split("\n")[line - 1 :]
    text = ""
    for part in lines:
        text += " " + part.partition("%")[0].strip()
        if text.endswith("."):
            break
    return Reason(" ".join(text.split()), file, line, 1)
