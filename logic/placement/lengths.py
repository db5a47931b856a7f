"""What the lengths of a grammar say by themselves: extremes, areas, contradictions."""

from collections.abc import Container, Iterable, Mapping, Sequence
from typing import Any

from clingo import Function, Symbol

from logic.errors import GrammarError, Reason
from logic.grammar import LENGTHS
from logic.placement.placer import Placer
from logic.placement.prolog import Term

DOOR_WIDTH = Function("length", [Function("door_width")])
"""The clause of the width of doors, by its name as in ``Conflict``."""


def stated_lengths(
    placer: Placer, furniture: Mapping[str, Iterable[str]], turned: Container[str] = ()
) -> tuple[dict[str, Any], list[GrammarError], list[Symbol]]:
    """The named lengths, and the extremes of each room type and its pieces, in metres.

    ``{"lengths": {name: m}, "rooms": {type: extremes}, "pieces": {type: {piece: extremes}}, "turning":
    {type: m}}``, where extremes are ``[least width, greatest width, least depth, greatest depth]``; an error
    for each clause that is of no use; and the clauses that are absent, named as in ``Conflict``. Pieces that
    may be ``turned`` need no wall as long as they are.
    """
    wanted = [
        Term("furniture", type_, [Term("piece", p, "true" if p in turned else "false") for p in pieces])
        for type_, pieces in furniture.items()
    ]
    report = placer.ask("grammar_lengths", wanted, LENGTHS)
    wrong: list[Any] = []
    absent: list[Symbol] = []

    def used(kind: str, names: Iterable[str], value: Any) -> Any:
        if value is None:
            absent.append(Function(kind, [Function(name) for name in names]))
        elif isinstance(value, dict):
            wrong.append(value["wrong"])
        return value

    named = {name: used("length", [name], value) for name, value in report["lengths"]}
    rooms, extents = {}, {}
    for type_, room, each in report["types"]:
        rooms[type_] = used("size", [type_], room)
        extents[type_] = {piece: used("size", [type_, piece], extent) for piece, extent in each}
    found = {"lengths": named, "rooms": rooms, "pieces": extents, "turning": dict(report["turning"])}
    return found, _first_at_each_place(wrong), absent


def disagreements(
    placer: Placer, types: Mapping[str, bool], joints: Iterable[Term], units: bool, most_rooms: int
) -> list[GrammarError]:
    """What is wrong with lengths that only some grammars state, and between lengths: ``agreement.pl``.

    ``types`` have a size, each with whether such rooms have windows; ``joints`` are terms
    ``opening(Type,Other)`` and ``part(Type,Whole)``; houses are with or without units.
    """
    topology = Term("topology", placer.kind_of_walls, "true" if units else "false", most_rooms)
    rooms = [Term("room", type_, "true" if lit else "false") for type_, lit in types.items()]
    return _first_at_each_place(placer.ask("grammar_disagreements", topology, rooms, joints))


def metres(placer: Placer, types: Iterable[str], pieces: Iterable[str] = ()) -> dict[str, Any]:
    """Return the lengths and areas that clauses state for these room types and pieces, in metres and square
    metres: see ``promised.pl``.
    """
    return placer.ask("grammar_metres", LENGTHS, list(types), list(pieces))


def size_clauses(placer: Placer) -> list[tuple[str, str, str, int, int]]:
    """Predicate, name, file, line and column of each clause that gives a room or piece type its size."""
    return [tuple(row) for row in placer.ask("grammar_sized")]


def typical_lengths(placer: Placer, types: Iterable[str]) -> dict[Symbol, Reason]:
    """Return the typical clauses of sizes, areas and the width of doors, named as in ``Conflict``."""
    of_types = ("size", "room_area", "whole_area", "window_size")
    clauses = [Function(name, [Function(each)]) for name in of_types for each in sorted(types)]
    clauses += [Function(name) for name in ("house_size", "house_area", "unit_depth")]
    clauses.append(DOOR_WIDTH)
    found = {clause: placer.reason(*place) for clause, place in placer.origins(clauses).items()}
    return {clause: reason for clause, reason in found.items() if reason.typical}


def wall_lengths(placer: Placer, types: Iterable[str], openings: Iterable[Term]) -> list[Any]:
    """How much wall a door takes, how much rooms share that share one, how much wall each of the openings
    (terms ``opening(Type,Other)``) takes by which clauses, the extremes of each room type's size, how thick
    inner walls are, metres, and the clauses of widths of doors: ``plans.pl``.
    """
    return placer.ask("plan_lengths", types, openings)


def brief_lengths(placer: Placer, types: Iterable[str], openings: Iterable[Term]) -> list[Any]:
    """As ``wall_lengths``, of sizes and areas as they are stated, of which nothing is left out."""
    return placer.ask("brief_lengths", types, openings)


def area_bounds(placer: Placer, types: Iterable[str]) -> list[Any]:
    """The least and greatest area of the house; type, areas and widths of each type of room. In metres
    and square metres, and empty where no area of the house is stated: ``totals.pl``.
    """
    return placer.ask("house_areas", types)


def unit_depths(placer: Placer) -> tuple[float, float] | None:
    """How deep units may be, metres; None where no clause bounds it."""
    range_ = placer.ask("unit_depths")
    return range_ and tuple(range_)


def _first_at_each_place(wrong: Iterable[Sequence[Any]]) -> list[GrammarError]:
    """Errors of ``[file, line, column, text]``: one clause may be wrong in each of several types of room."""
    errors = {}
    for file, line, column, text in wrong:
        errors.setdefault((file, line, column), GrammarError(text, file, line, column))
    return list(errors.values())
