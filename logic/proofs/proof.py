"""Proof that there is no house, in the user's own words: the core, its places, and possible remedies."""

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

from clingo import Symbol
from msgspec.structs import replace

from vitruvius.logic.errors import LimitReached, Reason, Unsatisfiable, VitruviusError
from vitruvius.logic.generation.feasibility import Feasibility, barred, option
from vitruvius.logic.generation.loop import NoLayout
from vitruvius.logic.generation.movable_doors import Refuted
from vitruvius.logic.generation.question import Question
from vitruvius.logic.layout.account import PROOF
from vitruvius.logic.layout.program import Conflict, TooMany
from vitruvius.logic.layout.relaxed import Statement
from vitruvius.logic.layout.terms import (
    brief_requirements,
    fixed_requirements,
    granted,
    own_requirements,
    to_furnish,
)
from vitruvius.logic.proofs.least import AnyOf, least, least_of_brief, least_of_plan
from vitruvius.logic.request.counts import MOST_ROOMS
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.spelling import article

MAX_ROOMS_AWAY_IN_STARS = 8
"""Largest distance of other numbers of rooms that are tried."""

MAX_TRIED_LAYOUTS = 100
"""Largest number of refuted layouts in a test if another request has a house."""

MAX_ROOMS_AWAY = 3
"""The same for rooms that share walls, for which each number takes a tenth of a second or more."""


class Prover:
    """Search for minimal sets of reasons why a request has no house."""

    def __init__(self, feasibility: Feasibility) -> None:
        """Set the rules, as statements that may be left out."""
        self._of = feasibility

    def unsatisfiable(self, found: NoLayout) -> Unsatisfiable:
        """Return the proof that a request has no house, by the evidence that stage 1 has no layout."""
        request = found.request
        self._of.placer.account.at(
            PROOF, f"why there is no house with {request}: the proof that none exists is complete"
        )
        question, statements, refuted = asked(found)
        if request.states_rooms:  # Typical rules have given way.
            statements = [each for each in statements if not each.reason.typical]
        if question.possible(statements):
            if request.brief or self._of.thorough:  # A search with fewer lines may decide less.
                raise LimitReached(
                    f"there is no house with {request}, but the search did not find which lines exclude it"
                )
            raise VitruviusError(f"{request} was proved infeasible, but has walls")
        if request.plan:
            own = map(Reason, own_requirements(request.plan).values())
            needed = least_of_plan(question, statements, [*own])
        elif request.brief and request.brief.is_alone:
            lines = {Reason(line) for line, _ in brief_requirements(request.brief)}
            needed = least_of_brief(question, statements, lines)
        else:
            needed = least(question, statements)
        # An order is infeasible for one number of rooms, and so the number is part of the proof.
        named, rooms = True, None
        if request.given:
            named = False
        elif not found.orders:
            named, rooms = self._number_of_rooms(
                request, found.unfurnishable, {each.reason for each in needed}
            )
        barring = {barred(type_): type_ for type_ in sorted(found.unfurnishable)}
        types = tuple(barring[each.reason] for each in needed if each.reason in barring)
        reasons = [Reason(f"--rooms {request.rooms}")] if named else []
        reasons += [each.reason for each in needed if each.reason not in {*barring, *refuted}]
        for type_ in types:
            reasons += self._room(request, type_)
        for each in needed:
            reasons += self._rooms(request, refuted.get(each.reason, ()))
        unique = tuple(dict.fromkeys(reasons))
        ways = [f"with --rooms {rooms}"] if rooms else []
        for choice, other in _without_each(request):
            if choice in unique and not (request.fixed or found.refuted):
                relaxed, statements = self._of.house(other)
                if self._has_house(other, self._of.of_rooms(relaxed, other), statements):
                    ways.append(f"without {choice}")
        # The area that a star needs is known when its rooms are furnished, which was not tried.
        is_there = "may be" if self._of.facts and not self._of.grammar.shares_walls else "is"
        advice = f"There {is_there} a house {', or '.join(ways)}." if ways else ""
        return Unsatisfiable(self._of.grammar.name, str(request), unique, advice, types)

    def conflict(self, request: HouseRequest) -> list[Reason]:
        """Return the reasons why there are no such rooms, among them choices of the request.

        Typical rules are among them only if the others permit such rooms.
        """
        relaxed, statements = self._of.house(request)
        question = self._of.of_rooms(relaxed, request)
        must = [each for each in statements if not each.reason.typical]
        if not question.possible(must):
            statements = must
        return [each.reason for each in least(question, statements)]

    def _number_of_rooms(
        self, request: HouseRequest, unfurnishable: Iterable[str], conflict: Collection[Reason]
    ) -> tuple[bool, int | None]:
        """Return True if another number of rooms would end the conflict, and a number with a house."""
        named = False
        first, then = _others(request, far=not self._of.grammar.shares_walls)
        for rooms in (each for each in (*first, *then) if each >= len(request.fixed)):
            # These take longer, and rarely end a conflict that the first numbers do not end.
            if rooms in then and conflict and not named:
                break
            other = replace(request, rooms=rooms)
            relaxed, statements = self._of.house(other, unfurnishable)
            some = [each for each in statements if each.reason in conflict]
            question = self._of.of_rooms(relaxed, other)
            try:
                possible = question.possible(some, MAX_TRIED_LAYOUTS)
            except TooMany:  # It may be: so the number is named.
                named = True
                continue
            if possible:
                named = True
                if request.fixed:  # It is unknown if the number fits between them.
                    return named, None
                if self._has_house(other, question, statements):
                    return named, rooms
        return named, None

    def _has_house(self, request: HouseRequest, question: Question, statements: list[Statement]) -> bool:
        """Return True if a house is soon found under all statements, with rooms that can be furnished."""
        while (layout := _soon(question, statements)) is not None:
            types = {atom.arguments[1].name for atom in layout if atom.name == "room"}
            unfurnished = [type_ for type_ in sorted(types) if not self._of.is_furnishable(request, type_)]
            if not unfurnished:
                return True
            for type_ in unfurnished:
                barring = question.relaxed.choice(barred(type_), fails=to_furnish(type_, request.rooms))
                statements.append(barring)
        return False

    def _room(self, request: HouseRequest, type_: str) -> list[Reason]:
        """Return the reasons why no room of this type can be furnished."""
        question, statements = self._of.unfurnishable(request, type_)
        alone = Question(question.relaxed)
        if not alone.possible(statements):  # Without stage 2 a minimal conflict is found quickly.
            statements = least(alone, statements)
            question.relaxed.prefer_none()
        if question.possible(statements):
            raise VitruviusError(f"{article(type_)} was proved infeasible, but can be furnished")
        return [each.reason for each in least(question, statements)]

    def _rooms(self, request: HouseRequest, refuted: Sequence[Refuted]) -> list[Reason]:
        """Return the reasons why a room of a plan cannot be furnished with any of these doors."""
        if not refuted:
            return []
        each = [self._of.furniture(request, one.room.room.type, room=one) for one in refuted]
        statements = each[0][1]
        question = AnyOf([asked for asked, _ in each], [some for _, some in each])
        if question.possible(statements):
            raise VitruviusError(f"{refuted[0].name} was proved infeasible, but can be furnished")
        return [statement.reason for statement in least(question, statements)]


def asked(found: NoLayout) -> tuple[Question, list[Statement], Mapping[Reason, Sequence[Refuted]]]:
    """Return the question whether a request has rooms, given the evidence, its statements, and refuted rooms.

    The refuted rooms are those of a plan that cannot be furnished, by the reason of the statement about them.
    """
    request, feasibility = found.request, found.feasibility
    relaxed, statements = feasibility.house(request, found.unfurnishable)
    refuted: dict[Reason, list[Refuted]] = defaultdict(list)
    for each in found.refuted:
        refuted[Reason(str(each))].append(each)
    for reason, rooms_ in refuted.items():
        nogoods = [{**each.atoms, **dict.fromkeys(each.grants, True)} for each in rooms_]
        statements.append(relaxed.proved(reason, nogoods))
    # A line of the user's plan or brief explains more than a rule, so it is left out last.
    if request.given:
        statements.sort(key=lambda each: each.reason.file is not None)
    fixed = {granted(each): True for each in fixed_requirements(request.fixed)}
    for order in found.orders:
        relaxed.exclude(Conflict({**order, **fixed}, ()))
    return feasibility.of_rooms(relaxed, request), statements, refuted


def _soon(question: Question, statements: Sequence[Statement]) -> list[Symbol] | None:
    """Return a layout; None if there is none, or none is found within ``MAX_TRIED_LAYOUTS``."""
    try:
        return question.layout(statements, MAX_TRIED_LAYOUTS)
    except TooMany:
        return None


def _others(request: HouseRequest, far: bool) -> tuple[list[int], list[int]]:
    """Return other numbers of rooms to try first, and to try later, each sorted by distance.

    The numbers are near the request's number and near the sum of its types. With ``far``, all are tried
    first, and powers of two in addition; without it, large houses have too many rules of shared walls.
    """
    wanted = sum(least for least, _ in request.types.values())
    near = MAX_ROOMS_AWAY_IN_STARS if far else MAX_ROOMS_AWAY
    few = {*range(1, near), *(2**n for n in range(8) if far)}
    some = {*few, *(n for number in (request.rooms, wanted) for n in range(number - near, number + near + 1))}
    first = some if far or wanted > request.rooms else {*few, request.rooms - 1, request.rooms + 1}

    def nearest(numbers: Iterable[int]) -> list[int]:
        known = set(numbers) & set(range(1, MOST_ROOMS + 1)) - {request.rooms}
        return sorted(known, key=lambda number: abs(number - request.rooms))

    return nearest(first), nearest(some - first)


def _without_each(request: HouseRequest) -> Iterator[tuple[Reason, HouseRequest]]:
    """Yield each choice of the request, and the request without that choice."""
    for name in request.types:
        fewer = {other: wanted for other, wanted in request.types.items() if other != name}
        yield option("--type", name, request.types), replace(request, types=fewer)
    for name in request.furniture:
        fewer = {other: wanted for other, wanted in request.furniture.items() if other != name}
        yield option("--piece", name, request.furniture), replace(request, furniture=fewer)
