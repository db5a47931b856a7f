"""Units of a house: the atoms on which the rooms of a unit depend, and the infeasible units."""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from clingo import Function, Number, Symbol
from msgspec.structs import replace

from vitruvius.logic.errors import Reason
from vitruvius.logic.generation.feasibility import Feasibility, option
from vitruvius.logic.grammar import Grammar
from vitruvius.logic.language.loaded import LoadedGrammar
from vitruvius.logic.layout.programs import Programs
from vitruvius.logic.layout.relaxed import Relaxed, Statement
from vitruvius.logic.layout.terms import granted, parts, requirements, shared_requirements
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.spelling import numbered

SIDES = ("west", "east", "north", "south")

LIKENESS = {"unit": 2, "share": 3, "way": 3, "deep": 3, "inner": 2}
"""Names and arities of the atoms that state all that the rooms of a unit depend on."""


@dataclass(frozen=True)
class Unit:
    """Unit of a layout of units.

    ``axis``: the axis of its depth (metres). ``public``: number of the public room at its side ``access``,
    from which the unit is entered. ``inner``: its sides that are not outer walls.
    """

    number: int
    request: HouseRequest
    axis: str
    depth: float
    public: int
    access: str
    inner: frozenset[str]

    def __str__(self) -> str:
        """Return the unit in words, as in ``6 rooms, 7.30 m deep along y, entered from its south side``."""
        rooms = numbered(self.request.rooms, "room")
        return f"{rooms}, {self.depth:.2f} m deep along {self.axis}, entered from its {self.access} side"

    def known(self, steps: Sequence[Symbol]) -> dict[bool, list[Symbol]]:
        """Return the atoms of ``units.lp`` that hold for the unit, and those that fail, with these steps."""
        atoms: dict[bool, list[Symbol]] = {True: [], False: []}
        for name, some in (("inner", self.inner), ("access", {self.access})):
            for side in SIDES:
                atoms[side in some].append(Function(name, [Function(side)]))
        for axis in "xy":
            for step in steps:
                beyond = 1000 * self.depth - step.number
                for name, holds in (("atmost", beyond <= 0), ("atleast", beyond >= 0)):
                    atoms[axis == self.axis and holds].append(Function(name, [Function(axis), step]))
        return atoms


def units_of(layout: Sequence[Symbol], request: HouseRequest, depths: Mapping[Symbol, float]) -> list[Unit]:
    """Return the units of a layout, with equal depths in each group, and the request of each."""
    stated = defaultdict[tuple[str, int], list[Any]](list)
    for atom in layout:
        first, *others = atom.arguments
        if first.type.name == "Number":
            stated[atom.name, first.number].append(others)
    units = []
    for atom in layout:
        if atom.name != "unit":
            continue
        number, rooms = (argument.number for argument in atom.arguments)
        (side, public), (axis, group) = stated["way", number][0], stated["deep", number][0]
        types = {type_.name: (share.number, share.number) for type_, share in stated["share", number]}
        inner = frozenset(other.name for (other,) in stated["inner", number])
        asked = replace(request, rooms=rooms, types=types)
        units.append(Unit(number, asked, axis.name, depths[group], public.number, side.name, inner))
    return units


def is_of(atom: Symbol, unit: Unit) -> bool:
    """Return True if an atom describes the unit."""
    return atom.name in LIKENESS and atom.arguments[0] == Number(unit.number)


def barred_units(programs: Programs, request: HouseRequest) -> dict[Symbol, HouseRequest]:
    """Return the units of a house that are infeasible at all lengths, by the atoms that exclude them.

    A unit is given by its number of rooms, or also by its number of rooms of one requested type.
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
