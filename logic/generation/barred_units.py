"""Unit sizes that are infeasible, and the unit program that excludes them."""

from collections.abc import Iterable
from functools import cache

from clingo import Function, Number, Symbol

from vitruvius.logic.errors import Reason
from vitruvius.logic.generation.feasibility import Feasibility, option
from vitruvius.logic.grammar import Grammar
from vitruvius.logic.language.loaded import LoadedGrammar
from vitruvius.logic.layout.programs import Programs
from vitruvius.logic.layout.relaxed import Relaxed, Statement
from vitruvius.logic.layout.terms import granted, parts, requirements, shared_requirements
from vitruvius.logic.request.house_request import HouseRequest


def barred_units(programs: Programs, request: HouseRequest) -> dict[Symbol, HouseRequest]:
    """Return the units of a house that are infeasible at all lengths: requirements ``barred``, and the units.

    These are units with a number of rooms, and units with a number of rooms of one requested type.
    """
    types, sizes = tuple(sorted(request.types)), programs.unit_sizes(request.rooms)
    return {atom: unit for size in sizes for atom, unit in _barred(programs, size, types)}


@cache
def _barred(programs: Programs, size: int, types: tuple[str, ...]) -> list[tuple[Symbol, HouseRequest]]:
    """Return the infeasible units with this number of rooms."""
    program, _ = programs.unit_for(HouseRequest(size, dict.fromkeys(types, (0, 0))))
    if not program.possible():
        return [(Function("barred", [Number(size)]), HouseRequest(size))]
    units = [HouseRequest(size, {type_: (n, n)}) for type_ in types for n in range(size + 1)]
    asked = [(unit, requirements("among", unit.types)) for unit in units]
    return [
        (Function("barred", [Number(size), *required.arguments[:2]]), unit)
        for unit, (required,) in asked
        if not program.possible([granted(required)])
    ]


class UnitsFeasibility(Feasibility):
    """Units of a house, as a program whose statements may be left out."""

    def __init__(self, grammar: Grammar, loaded: LoadedGrammar) -> None:
        """Set the rules."""
        super().__init__(grammar, loaded.placer, loaded.lengths, placed=True)
        self._programs = loaded.programs

    def house(
        self, request: HouseRequest, unfurnishable: Iterable[str] = (), laws: bool = False
    ) -> tuple[Relaxed, list[Statement]]:
        """Return the program of the units, and all statements that may be left out of it."""
        required, barred = shared_requirements(request), barred_units(self._programs, request)
        relaxed = Relaxed(
            self.source,
            {"rooms": request.rooms},
            [("units", []), *parts([*required, *barred])],
            laws=laws,
        )
        statements = list(relaxed.statements)
        asked = [(reason, each) for reason, each in zip(option_reasons(request), required, strict=True)]
        asked += [(no_unit(unit), each) for each, unit in barred.items()]
        statements += [relaxed.choice(reason, [granted(each)]) for reason, each in asked]
        return relaxed, statements


def option_reasons(request: HouseRequest) -> list[Reason]:
    """Return a request's choices of room types, as on the command line."""
    return [option("--type", name, request.types) for name in sorted(request.types)]


def no_unit(unit: HouseRequest) -> Reason:
    """Return the statement that there is no such unit."""
    return Reason(f"no unit has {unit}")
