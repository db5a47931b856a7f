"""Inputs of stage 1 besides the rules, as ASP terms: a request's requirements and a grammar's lengths."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import ceil, floor, log
from typing import Any

from clingo import Function, Number, Symbol, parse_term

from vitruvius.logic.layout.program import Part
from vitruvius.logic.request.brief import LEAST_SIDE, Brief, length_range, tolerance_of
from vitruvius.logic.request.brief_lines import area_ranges, void_numbers
from vitruvius.logic.request.brief_lines import requirements as brief_lines
from vitruvius.logic.request.counts import MAX_COUNT, Range
from vitruvius.logic.request.fixed_rooms import FixedRoom
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.request.own_plan import OwnPlan

DEPTH_STEP_MM = 500
"""Precision of the depth of a unit in stage 1, millimetres."""

Span = tuple[float, float]
"""Least and greatest value."""

ANY: Span = (0.0, 1e6)
"""Span of an unlimited length, millimetres."""

MIN_STEP_RATIO = 1.08
"""Least ratio between the widths of successive steps of an area."""

Lengths = Mapping[str, Sequence[tuple[Symbol, Symbol]]]
"""Facts of stage 1 about lengths by room type, each with the clause that it comes from."""


def requirements(kind: str, ranges: Mapping[str, Range]) -> list[Symbol]:
    """Return the requirements ``among`` (room types) or ``has`` (pieces), by name: ``rules/request.lp``."""
    return [
        Function(kind, [Function(name), Number(least), Number(MAX_COUNT if most is None else most)])
        for name, (least, most) in sorted(ranges.items())
    ]


def fixed_requirements(rooms: Sequence[FixedRoom]) -> list[Symbol]:
    """Return the requirement ``fixed`` of each fixed room."""
    return [
        Function("fixed", [Number(number), Function(fixed.room.type), Function(fixed.side)])
        for number, fixed in enumerate(rooms)
    ]


def room_requirements(request: HouseRequest) -> list[Symbol]:
    """Return all requirements of a request on the rooms of a house."""
    own = own_requirements(request.plan) if request.plan else {}
    brief = [each for _, some in brief_requirements(request.brief) for each in some] if request.brief else []
    return [*requirements("among", request.types), *fixed_requirements(request.fixed), *own, *brief]


def shared_requirements(request: HouseRequest) -> list[Symbol]:
    """Return all requirements on the rooms of a house of units: see ``rules/shared_walls/units.lp``."""
    return requirements("shared", request.types)


def own_requirements(plan: OwnPlan) -> dict[Symbol, str]:
    """Return the requirements of a user's plan, each in words: see ``rules/shared_walls/own.lp``."""
    found = {}
    ends = [max(line[side][1] for line in plan.lines) for side in ("east", "south")]
    for number, (room, lines) in enumerate(zip(plan.rooms, plan.lines, strict=True)):
        at = []
        for side in ("west", "east", "north", "south"):
            axis, place = lines[side]
            last = ends["xy".index(axis)]
            outline = {("x", 0): "west", ("x", last): "east", ("y", 0): "north", ("y", last): "south"}
            name = outline[axis, place] if place in (0, last) else ""
            at.append(Function("outline", [Function(name)]) if name else Function(axis, [Number(place)]))
        size = f"{room.width:.2f} by {room.height:.2f} m at x {room.x:.2f}, y {room.y:.2f}"
        found[Function("drawn", [Number(number), *at])] = f"plan: {room.name} is {size}"
        if room.type:
            typed = Function("typed", [Number(number), Function(room.type)])
            found[typed] = f"plan: {room.name} is of type {room.type}"
    for door in plan.doors:
        if wall := plan.wall_of(door):
            behind = Function(wall.side) if wall.behind is None else Number(wall.behind)
            joined = Function("joined", [Number(wall.room), behind])
            found[joined] = f"plan: a door joins {door.between[0]} and {door.between[1]}"
    for kind, some in (
        ("doors", [door for door in plan.doors if not door.is_entrance and not plan.has_more_doors]),
        ("windows", plan.windows),
    ):
        if some:
            found[Function("only", [Function(kind)])] = f"plan: there are no other {kind}"
    return found


ASKED_DOORS = Function("asked_doors", [])
"""Fact that excludes doors that a brief does not ask for: see ``rules/brief/brief.lp``."""


def brief_requirements(brief: Brief) -> list[tuple[str, list[Symbol]]]:
    """Return the requirements of a brief, each line in words: see ``rules/brief/brief.lp``."""
    return [(line.reason, [_term(*term) for term in line.terms]) for line in brief_lines(brief)]


def brief_facts(brief: Brief, on_request: bool, lengths: Iterable[Symbol] = ()) -> list[Symbol]:
    """Return the facts of a brief for stage 1 besides its requirements: voids, and areas as stairs.

    A brief without a grammar also excludes other doors. With ``on_request``, stage 1 derives shared walls
    only for rooms that the brief asks about. Stairs end at the longest sides that the brief and ``lengths``
    (facts of ``wall_facts``) permit; without ``lengths``, at the longest sides of any room, so that a proof
    may leave lengths out.
    """
    found = [_term("void", number) for number in void_numbers(brief)]
    found += [Function("on_request", [])] if on_request else []
    found += [ASKED_DOORS] if brief.is_alone and not brief.other_doors else []
    sides = dict(_sides(brief, lengths))
    for box, (least, most) in area_ranges(brief).items():
        ratio = max(MIN_STEP_RATIO, (most / least) ** 0.5)
        lower = ceil(log(most / least) / log(ratio) - 1e-9)
        square = 100 * most  # square millimetres
        widths = _stairs(*_widths(100 * least, square, *sides.get(box, (ANY, ANY))), ratio, lower)
        found.append(_term("stairs", box, len(widths) - 1, lower))
        for number, width in enumerate(widths):
            depth = square / width
            ends = floor(width), ceil(width), floor(depth), ceil(depth)
            found.append(_term("step", box, number, *ends))
    return found


def _sides(brief: Brief, lengths: Iterable[Symbol]) -> Iterator[tuple[int | str, tuple[Span, Span]]]:
    """Yield the least and greatest sides of boxes in x and y, millimetres, by ``lengths`` and the brief."""
    reach = {
        fact.arguments[0].name: [each.number for each in fact.arguments[1:]]
        for fact in lengths
        if fact.name == "reach"
    }
    if not reach:
        return
    given = (brief.outline.width, brief.outline.depth)
    outline = tuple(ANY if each is None else length_range(each, 0) for each in given)
    yield "outline", (outline[0], outline[1])
    for number, room in enumerate(brief.rooms):
        kinds = [reach[room.type]] if room.type else reach.values()
        least, most = min(min(each) for each in kinds), max(max(each) for each in kinds)
        if room.size:
            sizes = [length_range(side, tolerance_of(brief, room)) for side in room.size]
            least, most = max(least, min(map(min, sizes))), min(most, max(map(max, sizes)))
        yield number, ((least, min(most, outline[0][1])), (least, min(most, outline[1][1])))


def _widths(least: float, most: float, across: Span, down: Span) -> Span:
    """Return the range of widths of a box with areas (square millimetres) and sides in these ranges.

    If no such box exists, return the range for any sides.
    """
    slit = 1e3 * LEAST_SIDE
    low = max(slit, across[0], least / down[1])
    high = min(across[1], most / max(slit, down[0]))
    return (low, high) if low < high else (slit, most / slit)


def _stairs(least: float, most: float, ratio: float, lower: int) -> list[float]:
    """Return widths in steps of ``ratio``, from below ``least`` to ``lower`` widths above ``most``."""
    steps = 2 + ceil(log(most / least) / log(ratio)) + lower
    return [least * ratio ** (number - 1) for number in range(steps)]


def _term(name: str, *arguments: str | int) -> Symbol:
    return Function(name, [Number(each) if isinstance(each, int) else Function(each) for each in arguments])


def granted(requirement: Symbol) -> Symbol:
    """Return the atom to assume if a requirement must hold."""
    return Function("granted", [requirement])


def parts(terms: Iterable[Symbol]) -> list[Part]:
    """Return the parts of the rules that these terms name, with their arguments."""
    return [(term.name, term.arguments) for term in terms]


def to_furnish(type_: str, rooms: int) -> list[Symbol]:
    """Return atoms, one of which holds if some room of this type must be furnished."""
    return [Function("unfurnished", [Number(number), Function(type_)]) for number in range(rooms)]


def length_facts(lengths: Mapping[str, Any]) -> Lengths:
    """Return the lengths of ``logic.placement.lengths.stated_lengths`` in whole millimetres, by room type."""
    named = [
        (Function("length", [Function(name), Number(floor(1000 * m))]), Function("length", [Function(name)]))
        for name, m in lengths["lengths"].items()
    ]
    facts = {}
    for type_, extremes in lengths["rooms"].items():
        kind = Function(type_)
        reach = Function("reach", [kind, *_millimetres(extremes)])
        facts[type_] = [*named, (reach, Function("size", [kind]))]
        if side := lengths["turning"].get(type_):
            square = Function("turning", [Number(floor(1000 * side))])
            facts[type_].append((square, Function("turning", [kind])))
        for piece, each in lengths["pieces"][type_].items():
            extent = Function("extent", [Function(piece), *_millimetres(each)])
            facts[type_].append((extent, Function("size", [kind, Function(piece)])))
    return facts


def wall_facts(
    doorway: float,
    contact: float,
    openings: Iterable[tuple[str, str, float, Sequence[str]]],
    extremes: Iterable[Sequence[Any]],
    thickness: float,
    doors: Iterable[str],
) -> list[tuple[Symbol, tuple[Symbol, ...]]]:
    """Return the facts of stage 1 about walls (``differences.lp``), each with the clauses it comes from.

    For the arguments see ``logic.placement.lengths.wall_lengths``. Clauses that only stage 2 knows have a
    fact, too.
    """
    door = Function("length", [Function("doorway"), Number(floor(1000 * doorway))])
    clauses = tuple(Function("length", [Function(name)]) for name in ("door_width", "door_margin"))
    share = Function("length", [Function("contact"), Number(floor(1000 * contact))])
    facts: list[tuple[Symbol, tuple[Symbol, ...]]] = [(door, clauses), (share, ())]
    for one, other, metres, stated in openings:
        wall = Function("opening_wall", [Function(one), Function(other), Number(floor(1000 * metres))])
        facts.append((wall, tuple(map(parse_term, stated))))
    if thickness:
        thick = [Number(bound(round(1000 * thickness, 6))) for bound in (floor, ceil)]
        inner = Function("length", [Function("inner_wall")])
        facts.append((Function("inner_wall", thick), (inner,)))
    only = [Function("house_size"), *map(parse_term, doors)]
    for type_, reach, uppers, lowers in extremes:
        kind = Function(type_)
        clauses = Function("size", [kind]), Function("room_area", [kind])
        facts.append((Function("reach", [kind, *_millimetres(reach)]), clauses))
        for name, bound, pairs in (("upper_bound", ceil, uppers), ("lower_bound", floor, lowers)):
            facts += [
                (Function(name, [kind, *(Number(bound(1000 * each)) for each in pair)]), clauses)
                for pair in pairs
            ]
        only += [Function(name, [kind]) for name in ("window_size", "whole_area")]
    return facts + [(Function("sized", [clause]), (clause,)) for clause in only]


def area_facts(
    total: Sequence[float], rooms: Iterable[tuple[str, float, float, float, float]]
) -> list[tuple[Symbol, tuple[Symbol, ...]]]:
    """Return the facts of stage 1 about the areas of the house and of each room type (``areas.lp``).

    Each fact has the clauses it comes from. ``rooms``: see ``logic.placement.lengths.area_bounds``.
    """

    def bounds(least: float, most: float) -> tuple[Symbol, Symbol]:
        return Number(floor(100 * least)), Number(ceil(100 * most))

    facts: list[tuple[Symbol, tuple[Symbol, ...]]] = []
    if total:
        facts.append((Function("total", bounds(*total)), (Function("house_area"),)))
    for type_, least, most, *_ in rooms:
        kind = Function(type_)
        clauses = Function("size", [kind]), Function("room_area", [kind])
        facts.append((Function("floor", [kind, *bounds(least, most)]), clauses))
    return facts


def berth_fact(
    lengths: Mapping[str, float], rooms: Sequence[tuple[str, float, float, float, float]]
) -> tuple[Symbol, tuple[Symbol, ...]]:
    """Return the fact of the wall that rooms take of a star's main room, centimetres, with its clauses.

    See ``star/areas.lp``.
    """
    gap = max(lengths["room_gap"], lengths["door_clearance"])
    bounds = [min(room[3] for room in rooms), max(room[4] for room in rooms)]
    bounds += [gap, gap, lengths["door_width"], lengths["door_width"]]
    numbers = [
        Number(rounded(100 * length)) for length, rounded in zip(bounds, (floor, ceil) * 3, strict=True)
    ]
    clauses = [Function("length", [Function(name)]) for name in ("room_gap", "door_clearance", "door_width")]
    sizes = [Function("size", [Function(type_)]) for type_, *_ in rooms]
    return Function("berth", numbers), (*sizes, *clauses)


def depth_steps(least: float, most: float) -> list[Symbol]:
    """Return the facts of ``rules/shared_walls/units.lp`` about the depths of units, metres."""
    first, last = floor(1000 * least / DEPTH_STEP_MM), ceil(1000 * most / DEPTH_STEP_MM)
    return [Function("step", [Number(DEPTH_STEP_MM * number)]) for number in range(first, last + 1)]


def _millimetres(extremes: Sequence[float]) -> list[Symbol]:
    """Return least and greatest lengths in turn, as whole millimetres that exclude none of them."""
    bounds = [floor, ceil] * (len(extremes) // 2)
    return [Number(bound(1000 * metres)) for bound, metres in zip(bounds, extremes, strict=True)]
