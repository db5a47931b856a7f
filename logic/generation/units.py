"""Houses of units, as buildings of flats: each unit is a separate plan, entered from a public room.

The depths of units are sampled. The rules decide which units there are and where (the program ``units`` of a
topology). Then come the rooms of each unit, which permit any length between two bounds. Therefore all units
are placed together within their bounds, and then the walls of each unit at its own size. A layout that is
impossible for a unit at its depth is excluded for all similar units. So the time is linear in the number of
units.
"""

from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from clingo import Function, Number, Symbol
from msgspec import structs

from vitruvius.logic.errors import LimitReached
from vitruvius.logic.generation.barred_units import UnitsFeasibility, barred_units
from vitruvius.logic.generation.evidence import NoUnits
from vitruvius.logic.generation.feasibility import Feasibility
from vitruvius.logic.generation.shared_walls import MOST_TRIES, Making, SharedWallsMaker
from vitruvius.logic.grammar import Grammar
from vitruvius.logic.house.parts import Rect
from vitruvius.logic.language.loaded import LoadedGrammar
from vitruvius.logic.layout.account import LAYOUT
from vitruvius.logic.layout.program import Nogood, Program
from vitruvius.logic.placement.placer import Infeasible
from vitruvius.logic.placement.plan import Pieces, Plan, UnitRange
from vitruvius.logic.placement.prolog import Term
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.spelling import numbered

SIDES = ("west", "east", "north", "south")

RETRIES = 4
"""Number of solutions of a unit's layout in which rooms are furnished before another layout is sampled."""


LIKENESS = {"unit": 2, "share": 3, "way": 3, "deep": 3, "inner": 2}
"""Names and arities of the atoms that state all that the rooms of a unit depend on."""


class Impossible(Exception):
    """A unit has no layout left: at its depth, if ``unit`` is given, or at its size."""

    def __init__(self, unit: "Unit | None" = None) -> None:
        """Set the unit that has no layout at its depth, if any."""
        super().__init__()
        self.unit = unit


@dataclass(frozen=True)
class Unit:
    """Unit of a layout of units.

    ``axis``: the axis of its depth (metres). ``public``: number of the room from which one enters it through
    its side ``access``. ``inner``: its sides that are no outer walls.
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


class UnitMaker(SharedWallsMaker):
    """Generator of the rooms of one unit: first ``measured``, then ``complete`` at its place."""

    def __init__(self, grammar: Grammar, loaded: LoadedGrammar, feasibility: Feasibility, unit: Unit) -> None:
        """Set the unit."""
        super().__init__(grammar, loaded, feasibility)
        self.unit = unit
        self.range = (0.0, 0.0)
        """Least and greatest length of the unit in its layout, metres."""
        self._place: list[Term] = []
        self._first: list[Symbol] = []
        self._retries = 0
        self._infeasible: list[Nogood] = []
        """Layouts that are infeasible at its depth, at any length."""

    def measured(self, rng: np.random.Generator, inferences: int) -> int:
        """Sample a layout and find the ``range`` of its length. Return the inferences left."""
        self._place, self._retries = [], 0
        found, self._first, left = self._solved(
            self._range, self.unit.request, rng, inferences, self._infeasible
        )
        self.range = found.range
        return left

    def within(self, box: Rect) -> None:
        """Set the unit's place, metres."""
        west, north, east, south = box.box
        places = (west, east, north, south)
        lines = [Function("outline", [Function(side)]) for side in SIDES]
        self._place = [Term("at", line, float(place)) for line, place in zip(lines, places, strict=True)]
        self._retries = RETRIES

    def _layout(
        self,
        request: HouseRequest,
        rng: np.random.Generator,
        nogoods: list[Nogood],
        unfurnishable: Collection[str],
    ) -> list[Symbol]:
        if self._retries and not nogoods and not unfurnishable:
            self._retries -= 1
            return self._first
        excluded = nogoods if nogoods is self._infeasible else [*self._infeasible, *nogoods]
        return super()._layout(request, rng, excluded, unfurnishable)

    def _no_layout(self, request: HouseRequest, unfurnishable: Collection[str]) -> Exception:
        return Impossible(None if self._place else self.unit)

    def _program(self, request: HouseRequest) -> tuple[Program, list[Symbol], list[Symbol]]:
        program, assumed = self._programs.unit_for(request)
        known = self.unit.known([atom.arguments[0] for atom in program.atoms("step", 1)])
        return program, [*assumed, *known[True]], known[False]

    def _walls(self, request: HouseRequest, layout: list[Symbol], seed: int, inferences: int) -> Plan:
        return self._placer.walls(layout, seed, inferences, self._place)

    def _range(self, request: HouseRequest, layout: list[Symbol], seed: int, inferences: int) -> UnitRange:
        return self._placer.unit_range(layout, self.unit.axis, self.unit.depth, inferences)


class UnitsMaker(SharedWallsMaker):
    """Generator of houses of units by one grammar. ``making`` is the origin of the last house's units."""

    units: Sequence[UnitMaker] = ()
    """Generators of the units, in the order of their rooms."""

    def __init__(self, grammar: Grammar, loaded: LoadedGrammar, feasibility: Feasibility) -> None:
        """Set the rules."""
        super().__init__(grammar, loaded, feasibility)
        self.units_feasibility = UnitsFeasibility(grammar, loaded)
        self._parts = grammar, loaded, feasibility
        self._depths = loaded.depths or (0.0, 0.0)

    def complete(
        self, request: HouseRequest, rng: np.random.Generator, inferences: int
    ) -> tuple[Plan, list[Pieces], int]:
        """Return a plan of all rooms, first the public ones, then unit by unit, and each room's pieces."""
        depths, refuted = self._sampled_depths(rng), list[Nogood]()
        for _ in range(MOST_TRIES):
            layout = self._units(request, rng, refuted)
            if layout is not None:
                units = _units_of(layout, request, depths)
                try:
                    whole, makers, inferences = self._placed(layout, units, rng, inferences)
                    made = self._with_rooms(whole, makers, rng, inferences)
                    self.making, self.units = Making(self.stated(request), layout, {}), makers
                    return made
                except Impossible as none:
                    if none.unit:
                        refuted += self._alike(none.unit, layout, request)
                        continue
            depths, refuted = self._sampled_depths(rng), []
        raise LimitReached(
            f"{MOST_TRIES} times a unit had no rooms that fit, though others might: try another seed, or "
            f"other depths (unit_depth/1). {self._placer.account.refutations}"
        )

    def stated(self, request: HouseRequest) -> Program:
        """Return the program of the units."""
        return self._programs.units_for(request, barred_units(self._programs, request))[0]

    def _sampled_depths(self, rng: np.random.Generator) -> Mapping[Symbol, float]:
        """Return the depth of each group of units, metres, sampled at the first access."""
        low, high = self._depths
        return defaultdict[Symbol, float](lambda: float(rng.uniform(low, high)))

    def _alike(self, unit: Unit, layout: Sequence[Symbol], request: HouseRequest) -> Iterator[Nogood]:
        """Yield nogoods that exclude every unit of a house that resembles this unit of a layout.

        Units with other numbers are excluded, too.
        """
        program = self.stated(request)
        known = {atom for name, arity in LIKENESS.items() for atom in program.atoms(name, arity)}
        stated = [(atom.name, *atom.arguments[1:]) for atom in layout if _is_of(atom, unit)]
        lacks = [("inner", Function(side)) for side in SIDES if side not in unit.inner]
        for number in sorted({atom.arguments[0] for atom in known if atom.name == "unit"}):
            holds = [Function(name, [number, *others]) for name, *others in stated]
            if known.issuperset(holds):
                yield dict.fromkeys(holds, True) | {
                    Function(name, [number, other]): False for name, other in lacks
                }

    def _units(
        self, request: HouseRequest, rng: np.random.Generator, refuted: Sequence[Nogood]
    ) -> list[Symbol] | None:
        """Return a layout of units, or None if there is none outside the refuted layouts."""
        program, assumed = self._programs.units_for(request, barred_units(self._programs, request))
        self._placer.account.at(LAYOUT, "the units of the house (clingo)")
        layout = program.sample(rng, assumed, nogoods=refuted)
        if layout is None and not refuted:
            barred = barred_units(self._programs, request)
            raise NoUnits(request, self.units_feasibility, unit=self.feasibility, barred=barred)
        return layout

    def _placed(
        self, layout: list[Symbol], units: Sequence[Unit], rng: np.random.Generator, inferences: int
    ) -> tuple[Plan, list[UnitMaker], int]:
        """Return the units with their places, and the public rooms."""
        makers = [UnitMaker(*self._parts, unit) for unit in units]
        waiting = set(makers)
        for _ in range(MOST_TRIES):
            for maker in makers:
                if maker in waiting:
                    inferences = maker.measured(rng, inferences)
            sizes = [
                Term("size", each.unit.number, each.unit.axis, each.unit.depth, *map(float, each.range))
                for each in makers
            ]
            try:
                whole = self._placer.walls(layout, int(rng.integers(2**63)), inferences, sizes)
                return whole, makers, inferences - whole.inferences
            except Infeasible as proof:
                inferences -= proof.inferences
                self._placer.account.refuted(proof.conflicts[0].clauses)
                atoms = proof.conflicts[0].atoms
                conflict = {atom.arguments[0].number for atom in atoms if atom.name == "unit"}
                waiting = {maker for maker in makers if maker.unit.number in conflict}
        raise Impossible

    def _with_rooms(
        self,
        whole: Plan,
        makers: Sequence[UnitMaker],
        rng: np.random.Generator,
        inferences: int,
    ) -> tuple[Plan, list[Pieces], int]:
        """Return the public rooms and the rooms of each unit in its place, furnished."""
        boxes = {room.number: room for room in whole.rooms}
        rooms = [room for room in whole.rooms if room.type != "unit"]
        plan = Plan(rooms, whole.doors, whole.windows, hub="R0", wall_thickness=whole.wall_thickness)
        pieces: list[Pieces] = [() for _ in rooms]
        for maker in makers:
            maker.within(boxes[maker.unit.number])
            part, inside, inferences = maker.complete(maker.unit.request, rng, inferences)
            _append(plan, part, maker.unit.public)
            pieces += inside
        return plan, pieces, inferences


def _units_of(layout: Sequence[Symbol], request: HouseRequest, depths: Mapping[Symbol, float]) -> list[Unit]:
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
        asked = structs.replace(request, rooms=rooms, types=types)
        units.append(Unit(number, asked, axis.name, depths[group], public.number, side.name, inner))
    return units


def _is_of(atom: Symbol, unit: Unit) -> bool:
    """Return True if an atom describes the unit."""
    return atom.name in LIKENESS and atom.arguments[0] == Number(unit.number)


def _append(plan: Plan, part: Plan, public: int) -> None:
    """Add the rooms of a unit to a plan, after the existing rooms."""
    first = len(plan.rooms)

    def placed(end: int | str) -> int | str:
        return public if isinstance(end, str) else end + first

    for room in part.rooms:
        whole = None if room.part_of is None else room.part_of + first
        plan.rooms.append(structs.replace(room, part_of=whole))
    plan.doors += [structs.replace(door, between=tuple(map(placed, door.between))) for door in part.doors]
    plan.windows += [structs.replace(window, room=window.room + first) for window in part.windows]
