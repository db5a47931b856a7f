"""Search for the typical rules of a grammar that give way: those that contradict the rooms of a request."""

from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import suppress
from functools import partial

from clingo import Function

from vitruvius.logic.errors import Reason
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.generation.loop import NoLayout, NoUnits
from vitruvius.logic.generation.question import Question
from vitruvius.logic.generation.unit import no_unit
from vitruvius.logic.layout.conflicts import minimal
from vitruvius.logic.layout.relaxed import Statement, TooMany
from vitruvius.logic.placement.lengths import DOOR_WIDTH, metres, typical_lengths
from vitruvius.logic.proofs.least import least
from vitruvius.logic.proofs.proof import asked
from vitruvius.logic.request.brief import bounds, tolerance_of
from vitruvius.logic.request.house_request import HouseRequest

MAX_REFUTED = 60
"""Number of layouts that stage 2 refutes in a search for typical lengths that contradict a request."""

MAX_CONFLICTS = 3_000
"""Number of conflicts of clingo in each search for typical rules that contradict a request."""

MAX_RULES_OF_UNITS = 2
"""Number of typical rules that give way one after the other to a house of units, before all others do."""

Span = tuple[float, float]
"""Least and greatest value, metres or square metres."""


def unlike_stated_sizes(builder: Builder, request: HouseRequest) -> list[Reason]:
    """Return the typical sizes, areas and door width that exclude the sizes, areas and doors of a request."""
    types = builder.loaded.extremes["rooms"]
    areas = {name: (least, most) for name, least, most in metres(builder.placer, types)["areas"]}
    names: dict[str, set[str]] = {"size": set(), "room_area": set()}
    for type_, sides, area in _stated(request):
        if type_ not in types:  # The maker refuses the type.
            continue
        width, depth = types[type_][:2], types[type_][2:]
        fits = not sides or any(_within(a, width) and _within(b, depth) for a, b in (sides, sides[::-1]))
        if not fits or (area and not _within(area, (width[0] * depth[0], width[1] * depth[1]))):
            names["size"].add(type_)
        if area and type_ in areas and not _within(area, areas[type_]):
            names["room_area"].add(type_)
    unlike = {Function(name, [Function(each)]) for name, some in names.items() for each in some}
    width = builder.loaded.extremes["lengths"]["door_width"]
    if any(door.length < width - 1e-6 for door in (request.plan.doors if request.plan else ())):
        unlike.add(DOOR_WIDTH)
    return [each for clause, each in typical_lengths(builder.placer, types).items() if clause in unlike]


def _stated(request: HouseRequest) -> Iterator[tuple[str, tuple[Span, ...], Span | None]]:
    """Yield the type, the sides and the area of each room whose type a request states."""
    for room in request.plan.rooms if request.plan else ():
        if room.type:
            sides = (room.width, room.width), (room.height, room.height)
            yield room.type, sides, (room.area, room.area)
    brief = request.brief
    for room in brief.rooms if brief else ():
        if brief and room.type and (room.size or room.area):
            tolerance = tolerance_of(brief, room)
            sides = tuple(bounds(side, tolerance) for side in room.size or ())
            area = bounds(room.area, tolerance) if room.area else None
            if sides and not area:
                area = sides[0][0] * sides[1][0], sides[0][1] * sides[1][1]
            yield room.type, sides, area


def _within(stated: Span, typical: Sequence[float]) -> bool:
    return typical[0] - 1e-6 <= stated[0] and stated[1] <= typical[1] + 1e-6


def giving_way(found: NoLayout) -> list[Reason]:
    """Return the typical rules that give way to a request without a house.

    Return none if the request states nothing of its rooms, or if the other rules alone refute it. In each
    conflict the last rule of the file gives way. If no conflict is found within the limits, the last quarter
    of the lengths gives way. The result depends only on the request and the evidence.
    """
    if not found.request.states_rooms:
        return []
    if isinstance(found, NoUnits):
        return _of_units(found)
    question, statements, _ = asked(found)
    must = [each for each in statements if not each.reason.typical]
    typical = [each for each in statements if each.reason.typical and _is_about(each, found.request)]
    typical.sort(key=_place)
    try:
        rules = _in_conflict(
            partial(question.relaxed.model, conflicts=MAX_CONFLICTS), question, must, typical
        )
        if rules == []:  # Stage 1 has a layout, so lengths are in conflict.
            rules = _in_conflict(partial(question.layout, most=MAX_REFUTED), question, must, typical)
    except TooMany:
        lengths = [each for each in typical if each.clause]
        rules = lengths[-max(1, len(lengths) // 4) :] or typical
    return [each.reason for each in rules or ()]


def _of_units(found: NoUnits) -> list[Reason]:
    """Return typical rules without which there is a unit that the proof of no house names."""
    if len(found.unit.grammar.gave_way) > MAX_RULES_OF_UNITS:
        rules = found.unit.source.conditional(found.unit.source.files, laws=False).reasons
        return [each for each in rules if each.typical]
    barred = {no_unit(unit): unit for unit in found.barred.values()}
    ways: list[list[Reason]] = []
    question, statements, _ = asked(found)
    for each in least(question, statements):
        if each.reason in barred:
            ways.append(_of_unit(found, barred[each.reason]))
            if len(ways[-1]) == 1:
                return ways[-1]
    return min(filter(None, ways), key=len, default=[])


def _of_unit(found: NoUnits, unit: HouseRequest) -> list[Reason]:
    """Return typical rules without which there is a unit."""
    relaxed, statements = found.unit.house(unit)
    must = [each for each in statements if not each.reason.typical]
    typical = sorted((each for each in statements if each.reason.typical), key=_place)
    try:
        layout = partial(relaxed.model, conflicts=MAX_CONFLICTS)
        return [each.reason for each in _in_conflict(layout, Question(relaxed), must, typical) or ()]
    except TooMany:
        return [each.reason for each in typical]


def _is_about(statement: Statement, request: HouseRequest) -> bool:
    """Return True unless the statement is about the size of a type that no room of the request has."""
    types = {room.type for room in request.given.rooms} if request.given else {""}
    clause = statement.clause
    about = clause.arguments if clause and clause != DOOR_WIDTH else ()
    return not about or "" in types or about[0].name in types


def _place(statement: Statement) -> tuple[str, int]:
    return str(statement.reason.file), statement.reason.line or 0


def _in_conflict(
    layout: Callable[[Sequence[Statement]], object | None],
    question: Question,
    must: Sequence[Statement],
    typical: Sequence[Statement],
) -> list[Statement] | None:
    """Return the last typical rule of each conflict; without these rules there may be a ``layout``.

    Return None if the other rules alone have no layout. Raises ``TooMany`` if the search for a first conflict
    reaches its limit.
    """

    def possible(some: Sequence[Statement]) -> bool:
        with suppress(TooMany):
            return layout([*must, *some]) is not None
        return True

    def core(some: Sequence[Statement]) -> list[Statement]:
        found = {id(each) for each in question.core([*must, *some])}
        return [each for each in some if id(each) in found]

    kept, left_out = list(typical), list[Statement]()
    refuted = bool(kept) and layout([*must, *kept]) is None
    while refuted:
        conflict = minimal(kept, possible, core)
        if not conflict:
            return None
        left_out.append(conflict[-1])
        kept.remove(conflict[-1])
        refuted = not possible(kept)
    for each in left_out[-2::-1]:  # which another that went later may have made needless
        with suppress(TooMany):
            if layout([*must, *kept, each]) is not None:
                kept.append(each)
                left_out.remove(each)
    return left_out


def without(builder: Builder, request: HouseRequest, gave_way: Collection[str]) -> Builder:
    """Return the builder without the typical rules that a house file cites as having given way to a request.

    Without citations, as for a row of a set, leave out the rules that contradict the request's counts.
    """
    if not request.states_rooms:
        return builder
    feasibility = builder.maker_of(request).feasibility
    if gave_way:
        _, statements = feasibility.house(request)
        typical = [each.reason for each in statements if each.reason.typical]
        rules = [each for each in typical if builder.grammar.cited(each) in gave_way]
    else:
        rules = [] if request.given else giving_way(NoLayout(request, feasibility))
    return builder.giving_way(rules) if rules else builder
