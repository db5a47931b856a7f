"""Explanations of parts of a house of units: each unit is a plan, and the rest of the house is fixed."""

import math
from collections.abc import Iterator
from functools import cache, cached_property

from clingo import Number, parse_term
from msgspec import structs

from vitruvius.logic.errors import Reason
from vitruvius.logic.generation.shared_walls import Making
from vitruvius.logic.generation.units import UnitMaking, UnitsMaking
from vitruvius.logic.house.house import House
from vitruvius.logic.house.part_names import Part, target_in
from vitruvius.logic.house.parts import OUTSIDE, Door
from vitruvius.logic.why.alternatives import Search
from vitruvius.logic.why.answer import Derivation, Length, Why
from vitruvius.logic.why.shared_walls import MAX_OTHER_CHOICES, PlanWitness
from vitruvius.logic.why.witness import Lengths

OF_UNIT = ("unit", "way", "deep", "share")
"""Atoms of a unit that are derived for a question about one of its rooms."""


class UnitWitness(PlanWitness):
    """Unit of a house. Its rooms keep their names, and everything beyond its entrance counts as outside."""

    OUTLINED = True
    ENTRANCE = "the door of its unit"

    def __init__(self, of: "UnitsWitness", made: UnitMaking, house: House) -> None:
        """Set the unit, its rooms, and their origin."""
        self._builder, self._maker, self._request = of._builder, of._maker, made.unit.request
        self._unit, self._house, self._making, self._origin = made.unit, house, made.making, of._origin

    @cached_property
    def _search(self) -> Search:
        """Search for alternatives in a unit of this depth, between its neighbours."""
        unit, feasibility = self._unit, self._maker.feasibility
        relaxed, statements = feasibility.house(self._request, laws=True)
        known = unit.known([atom.arguments[0] for atom in self._making.program.atoms("step", 1)])
        place = relaxed.choice(Reason(f"{self.name}: {unit}"), known[True], known[False])
        question = feasibility.of_rooms(relaxed, self._request)
        return Search(
            question, [*statements, place], self._support.chosen, self._making.layout, MAX_OTHER_CHOICES
        )

    @property
    def name(self) -> str:
        """Name of the unit, from its first and last room."""
        return f"the unit of {self._house.rooms[0].name} to {self._house.rooms[-1].name}"


class UnitsWitness(PlanWitness):
    """House of units that is generated again, with the public rooms and the choice of units."""

    _making: UnitsMaking  # pyright: ignore[reportIncompatibleVariableOverride] - of a grammar of units

    def parts(self, target: str, until: float = math.inf) -> Iterator[Why]:
        """Yield the explanation of a room, a door, the entrance, a window or a piece."""
        room, part = target_in(self._house, target)
        if isinstance(part, str):
            yield from self._unit_itself(target, int(part.removeprefix("U")) - 1, until)
            return
        index = self._unit_of(room, part)
        if index is None:
            yield from self._parts(target, room, part, until)
            return
        unit, first = self._unit(index), self._firsts[index]
        if isinstance(part, Door):
            part = structs.replace(part, between=self._within(part, unit))
        found = unit._parts(target, None if room is None else room - first, part, until)
        if part is None:
            why, of = next(found), self._making.units[index].unit
            yield structs.replace(
                why,
                about=f"{why.about}; in {unit.name}, {of}; rules number its rooms from 0, which is "
                f"{unit._house.rooms[0].name}",
                derivations=(*why.derivations, *self._derived(of.number)),
            )
        yield from found

    def _unit_itself(self, target: str, index: int, until: float) -> Iterator[Why]:
        """Yield the explanation of a unit, with its number of rooms, its place and its depth."""
        unit = self._making.units[index].unit
        about = f"{self._unit(index).name}, {unit} ({self._origin})"
        depths, stated = self._builder.loaded.depths, self._reasons([("clause", "unit_depth")])
        assert depths is not None

        def lengths() -> Lengths:
            return (Length("depth", unit.depth, *depths, stated, stated),), ()

        why = Why(target, about, self._derived(unit.number))
        atoms = [parse_term(each.atom) for tree in why.derivations for each in tree.all() if each.options]
        picked = dict.fromkeys(atom.arguments[0] for atom in atoms if atom.name == "pick")
        variables = [each for each in picked if len(self._support.chosen.options[each]) > 1]
        yield from self._answer(why, self._support, variables, lengths, lambda: self._search, until)

    def _makings(self) -> Iterator[Making | UnitsMaking]:
        yield self._builder.origin
        yield from (each.making for each in self._builder.origin.units)

    @cached_property
    def _firsts(self) -> list[int]:
        """Index of each unit's first room."""
        last, firsts = len(self._house.rooms), []
        for made in reversed(self._making.units):
            last -= made.unit.request.rooms
            firsts.append(last)
        return firsts[::-1]

    def _unit_of(self, room: int | None, part: Part) -> int | None:
        """Return the index of a part's unit, or None for a part of public rooms alone."""
        places = [] if room is None else [room]
        if isinstance(part, Door):
            names = [each.name for each in self._house.rooms]
            places = [names.index(name) for name in part.between if name != OUTSIDE]
        within = [place for place, first in enumerate(self._firsts) if first <= max(places)]
        return within[-1] if within else None

    @cache  # noqa: B019 (a witness is asked about one house)
    def _unit(self, index: int) -> UnitWitness:
        """Return the witness of a unit by its index."""
        made, first = self._making.units[index], self._firsts[index]
        rooms = self._house.rooms[first : first + made.unit.request.rooms]
        names = {room.name for room in rooms}
        doors = (
            structs.replace(door, between=tuple(name if name in names else OUTSIDE for name in door.between))
            for door in self._house.doors
            if names & {*door.between}
        )
        windows = tuple(window for window in self._house.windows if window.room in names)
        house = House(
            rooms,
            tuple(doors),
            windows,
            topology=self._house.topology,
            wall_thickness=self._house.wall_thickness,
        )
        return UnitWitness(self, made, house)

    @staticmethod
    def _within(door: Door, unit: UnitWitness) -> tuple[str, ...]:
        """Return the names of the spaces that a door joins, as seen from its unit."""
        names = {room.name for room in unit._house.rooms}
        return tuple(name if name in names else OUTSIDE for name in door.between)

    def _derived(self, number: int) -> tuple[Derivation, ...]:
        """Return the derivation of a unit's number of rooms, its place and its share of the request."""
        return self._support.trees(atom for name in OF_UNIT for atom in self._atoms(name, Number(number)))

    def _room_lengths(self, room: int) -> Lengths:
        """Return no lengths, since those of public rooms follow from the units along them."""
        return (), ()

    @cached_property
    def _search(self) -> Search:
        """Search for alternatives among the units and the public rooms."""
        feasibility = self._maker.of_units
        assert feasibility
        relaxed, statements = feasibility.house(self._request, laws=True)
        question = feasibility.of_rooms(relaxed, self._request)
        return Search(question, statements, self._support.chosen, self._making.layout, MAX_OTHER_CHOICES)
