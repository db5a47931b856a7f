"""Results of a grammar's lengths by themselves: extremes, areas, contradictions."""

from collections.abc import Container, Iterable, Mapping, Sequence
from typing import Any

from clingo import Function, Symbol

from vitruvius.logic.errors import GrammarError, Reason
from vitruvius.logic.grammar import LENGTHS
from vitruvius.logic.placement.placer import Placer
from vitruvius.logic.placement.prolog import Term

DOOR_WIDTH = Function("length", [Function("door_width")])
"""Clause of the width of doors, by its name as in ``Conflict``."""


def stated_lengths(
    placer: Placer, furniture: Mapping[str, Iterable[str]], turned: Container[str] = ()
) -> tuple[dict[str, Any], list[GrammarError], list[Symbol]]:
    """Return the named lengths, and the extremes of each room type and its pieces, in metres.

    The first value is ``{"lengths": {name: m}, "rooms": {type: extremes}, "pieces": {type: {piece:
    extremes}}, "turning": {type: m}}``. Extremes are ``[least width, greatest width, least depth, greatest
    depth]``. The second value has an error for each useless clause. The third lists the absent clauses, named
    as in ``Conflict``. Pieces that may be ``turned`` need no wall of their length.
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
    """Return errors for lengths that only some grammars state, and for contradictions: ``agreement.pl``.

    ``types`` have a size, each with True if such rooms have windows. ``joints`` are terms
    ``opening(Type,Other)`` and ``part(Type,Whole)``. Houses are with or without ``units``.
    """
    topology = Term("topology", placer.kind_of_walls, "true" if units else "false", most_rooms)
    rooms = [Term("room", type_, "true" if lit else "false") for type_, lit in types.items()]
    return _first_at_each_place(placer.ask("grammar_disagreements", topology, rooms, joints))


def metres(placer: Placer, types: Iterable[str], pieces: Iterable[str] = ()) -> dict[str, Any]:
    """Return the lengths and areas that clauses state for these room types and pieces.

    Units are metres and square metres: see ``promises.pl``.
    """
    return placer.ask("promised_metres", LENGTHS, list(types), list(pieces))


def size_clauses(placer: Placer) -> list[tuple[str, str, str, int, int]]:
    """Return predicate, name, file, line and column of each clause that sizes a room or piece type."""
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
    """Return the lengths of walls, metres, that stage 1 needs: ``plans.pl``.

    In order: the wall that a door takes; the wall that two adjacent rooms share; for each opening (terms
    ``opening(Type,Other)``) the wall that it takes, with its clauses; the extremes of each room type's size;
    the thickness of inner walls; and the clauses of widths of doors.
    """
    return placer.ask("plan_lengths", types, openings)


def brief_lengths(placer: Placer, types: Iterable[str], openings: Iterable[Term]) -> list[Any]:
    """Return the same as ``wall_lengths``, with all stated sizes and areas and nothing left out."""
    return placer.ask("brief_lengths", types, openings)


def area_bounds(placer: Placer, types: Iterable[str]) -> list[Any]:
    """Return the least and greatest area of the house, and the type, areas and widths of each room type.

    Units are metres and square metres. The result is empty if no area of the house is stated: ``totals.pl``.
    """
    return placer.ask("house_areas", types)


def unit_depths(placer: Placer) -> tuple[float, float] | None:
    """Return the least and greatest depth of units, metres, or None if no clause limits it."""
    range_ = placer.ask("unit_depths")
    return range_ and tuple(range_)


def _first_at_each_place(wrong: Iterable[Sequence[Any]]) -> list[GrammarError]:
    """Return errors of ``[file, line, column, text]``, one at each place.

    One clause may be wrong in several room types.
    """
    errors = {}
    for file, line, column, text in wrong:
        errors.setdefault((file, line, column), GrammarError(text, file, line, column))
    return list(errors.values())
