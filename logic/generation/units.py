"""Houses of units, such as buildings of flats: each unit is a separate plan, entered from a public room.

The depths of units are sampled. The rules decide which units there are and where (the program ``units`` of a
topology). Then come the rooms of each unit, which permit any length between two bounds. Therefore all units
are placed together within their bounds, and then the walls of each unit at its own size. A layout that is
impossible for a unit at its depth is excluded for all similar units. So the time is linear in the number of
units.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from clingo import Function, Symbol
from msgspec import structs

from vitruvius.logic.errors import LimitReached, RequestError
from vitruvius.logic.generation.furnish import Furnished
from vitruvius.logic.generation.loop import Maker, NoUnits, Stages, Work, made
from vitruvius.logic.generation.shared_walls import (
    MOST_TRIES,
    NO_FIXED,
    Assumed,
    Furnishing,
    Making,
    PlanDraft,
    PlanRules,
)
from vitruvius.logic.generation.unit import (
    LIKENESS,
    SIDES,
    Unit,
    UnitsFeasibility,
    barred_units,
    is_of,
    units_of,
)
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Rect
from vitruvius.logic.layout.account import LAYOUT
from vitruvius.logic.layout.program import Nogood, Program
from vitruvius.logic.placement.placer import Failure, Infeasible
from vitruvius.logic.placement.plan import Pieces, Plan
from vitruvius.logic.placement.prolog import Term
from vitruvius.logic.request.house_request import HouseRequest

RETRIES = 4
"""Number of solutions of a unit's layout in which rooms are furnished before another layout is sampled."""


class Impossible(Failure):
    """A unit has no layout left: at its depth, if ``unit`` is given, or at its size."""

    def __init__(self, unit: "Unit | None" = None) -> None:
        """Set the unit that has no layout at its depth, if any."""
        super().__init__()
        self.unit = unit


class UnitMaking(NamedTuple):
    """Unit of a house, and the origin of its rooms."""

    unit: Unit
    making: Making


class UnitsMaking(NamedTuple):
    """Origin of a house of units: that of its plan, and those of its units in the order of their rooms."""

    program: Program
    layout: list[Symbol]
    units: list[UnitMaking]
    furniture: Mapping[int, Furnished] = {}


class Placed(NamedTuple):
    """Public rooms and boxes of units with their places, and the drafts of the units."""

    whole: Plan
    units: "list[UnitDraft]"


class UnitDraft:
    """Unit in progress: ``measure`` finds its range of lengths, ``complete`` furnishes it in its place."""

    def __init__(self, rules: PlanRules, unit: Unit, work: Work) -> None:
        """Begin without failures."""
        self.unit, self._rules, self._work = unit, rules, work
        program, assumed = rules.programs.unit_for(unit.request)
        known = unit.known([atom.arguments[0] for atom in program.atoms("step", 1)])
        self._assumed = Assumed(program, [*assumed, *known[True]], known[False])
        self._measuring = self._draft()
        """Draft whose nogoods are layouts that are infeasible at the unit's depth, at any length."""
        self._first: list[Symbol] = []
        self.range = (0.0, 0.0)
        """Least and greatest length of the unit in its first layout, metres."""

    def _draft(self) -> PlanDraft:
        return PlanDraft(self._rules, self.unit.request, self._work, self._assumed)

    def measure(self) -> None:
        """Sample the first layout of the rooms, and find the ``range`` of its length."""
        draft, unit, work = self._measuring, self.unit, self._work

        def sample() -> list[Symbol]:
            layout = draft.layout()
            if layout is None:
                raise Impossible(unit)
            return layout

        def place(layout: list[Symbol]) -> tuple[float, float]:
            work.seed()  # Unused: sampled so that the random numbers after it stay the same.
            found = draft.placer.unit_range(layout, unit.axis, unit.depth, work.inferences)
            work.spend(found.inferences)
            return found.range

        stages = Stages(sample, place, lambda *found: found, draft.learn)
        self._first, self.range = made(stages)

    def complete(self, box: Rect) -> Furnishing:
        """Return the furnished unit in its place, metres."""
        draft, retries = self._draft(), iter(range(RETRIES))
        west, north, east, south = box.box
        places = (west, east, north, south)
        lines = [Function("outline", [Function(side)]) for side in SIDES]
        given = [Term("at", line, float(place)) for line, place in zip(lines, places, strict=True)]

        def sample() -> list[Symbol]:
            if not (draft.nogoods or draft.unfurnishable) and next(retries, None) is not None:
                return self._first
            layout = draft.layout(self._measuring.nogoods)
            if layout is None:
                raise Impossible
            return layout

        def place(layout: list[Symbol]) -> Plan:
            return draft.place(layout, given)

        return made(Stages(sample, place, draft.furnish, draft.learn))


class UnitsDraft:
    """House of units, in progress."""

    def __init__(self, rules: PlanRules, choice: UnitsFeasibility, request: HouseRequest, work: Work) -> None:
        """Begin without failures. ``choice``: the rules of the choice of units."""
        self.rules, self.choice, self.request, self.work = rules, choice, request, work
        self.placer, self.barred = rules.loaded.placer, barred_units(rules.programs, request)
        self.program, self._assumed = rules.programs.units_for(request, self.barred)
        self._tries = 0
        self._begin()

    def _begin(self) -> None:
        """Begin again with other depths of units."""
        low, high = self.rules.loaded.depths or (0.0, 0.0)
        self.depths = defaultdict[Symbol, float](lambda: float(self.work.rng.uniform(low, high)))
        """Depth of each group of units, metres, sampled at the first access."""
        self.refuted: list[Nogood] = []
        """Nogoods of layouts in which the rooms of a unit do not fit at its depth."""

    def sample(self) -> list[Symbol]:
        """Sample a layout of units. Raises ``NoUnits`` if there is none at any depth."""
        while True:
            if self._tries == MOST_TRIES:
                raise LimitReached(
                    f"after {MOST_TRIES} attempts, the rooms of some unit did not fit, but others might: "
                    f"try another seed, or other depths (unit_depth/1). {self.placer.account.refutations}"
                )
            self._tries += 1
            self.placer.account.at(LAYOUT, "the units of the house (clingo)")
            layout = self.program.sample(self.work.rng, self._assumed, nogoods=self.refuted)
            if layout is not None:
                return layout
            if not self.refuted:
                of_unit = self.rules.feasibility
                raise NoUnits(self.request, self.choice, unit=of_unit, barred=self.barred)
            self._begin()

    def place(self, layout: list[Symbol]) -> Placed:
        """Return the units with their places, and the public rooms."""
        units = [
            UnitDraft(self.rules, unit, self.work) for unit in units_of(layout, self.request, self.depths)
        ]
        waiting = set(units)
        failures = 0

        def measured() -> list[Term]:
            for each in units:
                if each in waiting:
                    each.measure()
            return [
                Term("size", each.unit.number, each.unit.axis, each.unit.depth, *map(float, each.range))
                for each in units
            ]

        def placed(sizes: list[Term]) -> Plan:
            whole = self.placer.walls(layout, self.work.seed(), self.work.inferences, sizes)
            self.work.spend(whole.inferences)
            return whole

        def learn(_: list[Term], failure: Failure) -> None:
            nonlocal waiting, failures
            assert isinstance(failure, Infeasible)
            self.work.spend(failure.inferences)
            conflict = failure.conflicts[0]
            self.placer.account.refuted(conflict.clauses)
            numbers = {atom.arguments[0].number for atom in conflict.atoms if atom.name == "unit"}
            waiting = {each for each in units if each.unit.number in numbers}
            failures += 1
            if failures == MOST_TRIES:
                raise Impossible

        return made(Stages(measured, placed, lambda _, whole: Placed(whole, units), learn))

    def furnish(self, layout: list[Symbol], placed: Placed) -> tuple[House, UnitsMaking]:
        """Return the house with the rooms of each unit in its place, furnished, and its origin."""
        whole, units = placed
        boxes = {room.number: room for room in whole.rooms}
        rooms = [room for room in whole.rooms if room.type != "unit"]
        plan = Plan(rooms, whole.doors, whole.windows, hub="R0", wall_thickness=whole.wall_thickness)
        pieces: list[Pieces] = [() for _ in rooms]
        makings = []
        for each in units:
            done = each.complete(boxes[each.unit.number])
            _append(plan, done.plan, each.unit.public)
            pieces += done.pieces
            makings.append(UnitMaking(each.unit, done.making))
        house = plan.house(pieces, self.rules.grammar.topology_name)
        return house, UnitsMaking(self.program, layout, makings)

    def learn(self, layout: list[Symbol], failure: Failure) -> None:
        """Exclude a unit whose rooms do not fit at its depth, or begin again with other depths."""
        assert isinstance(failure, Impossible)
        if failure.unit:
            self.refuted += alike(self.program, failure.unit, layout)
        else:
            self._begin()


def units_maker(rules: PlanRules) -> Maker:
    """Return the generator of houses of units."""
    choice = UnitsFeasibility(rules.grammar, rules.loaded)

    def stated(request: HouseRequest) -> Program:
        # The program of the units has no typical facts, but those of their rooms have.
        sizes = rules.programs.unit_sizes(request.rooms)
        return rules.programs.rooms(sizes[0]) if sizes else rules.programs.units_for(request)[0]

    def of_units(request: HouseRequest, work: Work) -> tuple[House, UnitsMaking]:
        if request.fixed:
            raise RequestError(NO_FIXED)
        rules.programs.begin()
        draft = UnitsDraft(rules, choice, request, work)
        return made(Stages(draft.sample, draft.place, draft.furnish, draft.learn))

    return Maker(rules.feasibility, of_units, stated, choice)


def alike(program: Program, unit: Unit, layout: Sequence[Symbol]) -> Iterator[Nogood]:
    """Yield nogoods that exclude every unit of a house that resembles this unit of a layout.

    Units with other numbers are excluded, too.
    """
    known = {atom for name, arity in LIKENESS.items() for atom in program.atoms(name, arity)}
    stated = [(atom.name, *atom.arguments[1:]) for atom in layout if is_of(atom, unit)]
    lacks = [("inner", Function(side)) for side in SIDES if side not in unit.inner]
    for number in sorted({atom.arguments[0] for atom in known if atom.name == "unit"}):
        holds = [Function(name, [number, *others]) for name, *others in stated]
        if known.issuperset(holds):
            yield dict.fromkeys(holds, True) | {
                Function(name, [number, other]): False for name, other in lacks
            }


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
