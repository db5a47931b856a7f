"""The proof that there is no house, in the user's own words: what clashes, where it stands, what would do."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from clingo import Function, Number, Symbol

from logic.errors import Reason, Unsatisfiable
from logic.explain import Relaxed, Statement, least
from logic.grammar import Grammar
from logic.placement import Placer
from logic.request import Request, as_option

NEAR = 24
"""How many other numbers of rooms, the nearest ones, are tried."""

MOST_ROOMS = 128


Lengths = Mapping[str, Sequence[tuple[Symbol, Symbol]]]
"""For each room type the lengths that stage 1 knows, facts, each with the clause that it comes from."""


class Prover:
    """Finds least sets of reasons why a request has no house."""

    def __init__(self, grammar: Grammar, placer: Placer, lengths: Lengths) -> None:
        """Know a grammar and the lengths of each of its room types."""
        self._grammar, self._placer, self._lengths = grammar, placer, lengths

    def unsatisfiable(self, request: Request, unfurnishable: Iterable[str]) -> Unsatisfiable:
        """Why a request has no house, where some types of room are proved to have no furniture."""
        unfurnishable = sorted(unfurnishable)
        relaxed, statements = self._house(request, request.rooms, unfurnishable)
        kept = least(statements, lambda some: relaxed.model(some) is not None, relaxed.core)
        reasons, advice = self._number_of_rooms(request, unfurnishable, kept)
        for statement in kept:
            bare = [type_ for type_ in unfurnishable if statement.reason == _bare(type_)]
            reasons += self._room(request, bare[0]) if bare else [statement.reason]
        return Unsatisfiable(self._grammar.name, str(request), tuple(dict.fromkeys(reasons)), advice)

    def _house(
        self, request: Request, rooms: int, unfurnishable: Iterable[str]
    ) -> tuple[Relaxed, list[Statement]]:
        """The program of a house's rooms, and all that may be left out of it."""
        wishes = wishes_for("among", request.types)
        relaxed = Relaxed(
            self._grammar.asp,
            {"rooms": rooms},
            [("house", []), *((wish.name, wish.arguments) for wish in wishes.values())],
        )
        statements = list(relaxed.statements)
        for name, wish in wishes.items():
            reason = Reason(f"--type {name}={as_option(request.types[name])}")
            statements.append(relaxed.choice(reason, [Function("granted", [wish])]))
        for type_ in unfurnishable:
            atoms = [Function("room", [Number(number), Function(type_)]) for number in range(rooms)]
            statements.append(relaxed.choice(_bare(type_), fails=atoms))
        return relaxed, statements

    def _number_of_rooms(
        self, request: Request, unfurnishable: Iterable[str], kept: Sequence[Statement]
    ) -> tuple[list[Reason], str]:
        """The number of rooms is a reason where another one would do for what clashes."""
        clashing = {statement.reason for statement in kept}
        named = False
        for rooms in sorted(range(1, MOST_ROOMS + 1), key=lambda n: abs(n - request.rooms))[1 : NEAR + 1]:
            relaxed, statements = self._house(request, rooms, unfurnishable)
            if (
                relaxed.model([statement for statement in statements if statement.reason in clashing])
                is not None
            ):
                named = True
                if relaxed.model(statements) is not None:
                    return [Reason(f"--rooms {request.rooms}")], f"With --rooms {rooms} there is one."
        return ([Reason(f"--rooms {request.rooms}")] if named else []), ""

    def _room(self, request: Request, type_: str) -> list[Reason]:
        """Why no room of this type can be furnished."""
        wishes = wishes_for("has", request.wants(type_))
        facts = self._lengths[type_]
        origins = self._placer.origins({clause for _, clause in facts})
        located = [(fact, clause, _located(*origins[clause])) for fact, clause in facts if clause in origins]
        relaxed = Relaxed(
            self._grammar.asp,
            {"this_room": type_},
            [("room", []), *((wish.name, wish.arguments) for wish in wishes.values())],
            located,
        )
        statements = list(relaxed.statements)
        for name, wish in wishes.items():
            option = next(key for key in (f"{type_}.{name}", name) if key in request.furniture)
            reason = Reason(f"--piece {option}={as_option(request.furniture[option])}")
            statements.append(relaxed.choice(reason, [Function("granted", [wish])]))

        def possible(some: Sequence[Statement]) -> bool:
            without = {s.clause for s in relaxed.statements if s.clause is not None and s not in some}
            while (furniture := relaxed.model(some)) is not None:
                clash = self._placer.clash(Function(type_), furniture, without)
                if clash is None:
                    return True
                relaxed.refute(clash)
            return False

        possible(statements)  # Learns all that stage 2 refutes, so that the core is one of both stages.
        return [statement.reason for statement in least(statements, possible, relaxed.core)]


def wishes_for(kind: str, ranges: Mapping[str, Any]) -> dict[str, Symbol]:
    """The wishes of a request as terms, see ``rules/wishes.lp``."""
    most = 2**31 - 1
    return {
        name: Function(kind, [Function(name), Number(a), Number(most if b is None else b)])
        for name, (a, b) in sorted(ranges.items())
    }


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
