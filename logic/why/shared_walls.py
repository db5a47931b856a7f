"""Explanations of parts of a plan: a room, a door, the entrance, a window, a piece."""

import dataclasses
import math
from collections.abc import Iterator
from functools import cache, cached_property

import msgspec
from clingo import Function, Number, Symbol

from vitruvius.logic.errors import Reason
from vitruvius.logic.generation.movable_doors import LooseRoom, Refuted
from vitruvius.logic.generation.shared_walls import Making
from vitruvius.logic.generation.units import UnitsMaking
from vitruvius.logic.house.house import House
from vitruvius.logic.house.part_names import Part, target_in
from vitruvius.logic.house.parts import OUTSIDE, Door, Provenance, Window
from vitruvius.logic.placement.bounds import open_lengths, opening_lengths, wall_bounds
from vitruvius.logic.placement.given_plan import inner_span
from vitruvius.logic.request.own_plan import OwnPlan, Wall
from vitruvius.logic.spelling import article
from vitruvius.logic.why.alternatives import Search
from vitruvius.logic.why.answer import Length, Why
from vitruvius.logic.why.support import Support
from vitruvius.logic.why.witness import Lengths, Witness

MAX_OTHER_CHOICES = 5
"""Largest number of other choices that an alternative lists as necessary changes."""


class PlanWitness(Witness):
    """Plan that is generated again."""

    OUTLINED = False
    """True if the plan cannot be larger or smaller."""

    ENTRANCE = "the entrance"
    """Name of the door that leads outside."""

    def parts(self, target: str, until: float = math.inf) -> Iterator[Why]:
        """Yield the explanation of a room, a door, the entrance, a window or a piece."""
        yield from self._parts(target, *target_in(self._house, target), until)

    def _parts(self, target: str, room: int | None, part: Part, until: float) -> Iterator[Why]:
        if isinstance(part, Door):
            yield from (self._entrance if part.is_entrance else self._door)(target, part, until)
            return
        assert room is not None
        if isinstance(part, Window):
            yield from self._window(target, room, part, until)
        elif part is None:
            yield from self._room(target, room, until)
        elif room not in self._making.furniture:
            about = f"in {self._named(self._house.rooms[room].name)}; the request keeps it (keep)"
            yield Why(target, f"{about} ({self._origin})")
        else:
            assert isinstance(part, int)
            layout, search = self._making.furniture[room].layout, lambda: self._search_in(room)
            yield from self._piece(target, layout, part, self._support_in(room), search, until)

    def _made_again(self, made: Provenance) -> House:
        self._maker = self._builder.maker_of(self._request)
        arguments = self._request, made.seed, made.index
        self._builder.house(*arguments)
        # The programs of rooms with these doors are now known, so that they store all atoms the second time.
        for making in self._makings():
            for program in (making.program, *(each.program for each in making.furniture.values())):
                program.models = []
        again = self._builder.house(*arguments)
        self._making = self._builder.origin
        return again

    def _makings(self) -> Iterator[Making | UnitsMaking]:
        """Yield the origins of the last house, and of its units."""
        yield self._builder.origin

    def _room(self, target: str, room: int, until: float) -> Iterator[Why]:
        """Yield the explanation of a room's type and of the lines of its walls."""
        rect, number, support = self._house.rooms[room], Number(room), self._support
        about = f"{article(rect.type)}, {rect.width:.3f} by {rect.height:.3f} m ({self._origin})"
        if self._request.plan:
            about += "; the plan says where it is"
        atoms = [each for name in ("room", "runs", "edge") for each in self._atoms(name, number)]
        own = [each for each in support.variables([number]) if len(each.arguments) == 1]

        why = Why(target, about, support.trees(atoms))
        variables = sorted(own, key=lambda each: each.name != "type")
        lengths, search = lambda: self._room_lengths(room), lambda: self._search
        for part in self._answer(why, support, variables, lengths, search, until):
            types = (
                self._furnishable(self._maker.feasibility, each)
                for each in part.choices
                if each.name == f"type({number})"
            )
            yield msgspec.structs.replace(part, choices=tuple(types) or part.choices)

    def _room_lengths(self, room: int) -> Lengths:
        """Return the lengths of a room."""
        if self._request.plan:
            return (), ()
        found = wall_bounds(self._builder.placer, self._making.layout, self._house.rooms, room, self.OUTLINED)
        return self._bounds(found, {})

    def _door(self, target: str, door: Door, until: float) -> Iterator[Why]:
        """Yield the explanation of the door between two rooms."""
        names = [room.name for room in self._house.rooms]
        one, other = (Number(names.index(name)) for name in door.between)
        (atom,) = [each for each in self._atoms("door", one) if each.arguments[1] == other]
        by_it = Function("from", [one, other]) in self._model
        variable = Function("entry", [one]) if by_it else Function("also", [one, other])
        kind = "opening" if door.opening else "door"
        about = f"the {kind} between {' and '.join(self._named(name) for name in door.between)}"
        return self._opening(target, about, [atom], [variable], door, until)

    def _entrance(self, target: str, door: Door, until: float) -> Iterator[Why]:
        """Explain why the house is entered there, or why a gate leads to the garden there."""
        (name,) = (name for name in door.between if name != OUTSIDE)
        room = Number([room.name for room in self._house.rooms].index(name))
        if door in self._house.garden_doors:
            gates, about = self._atoms("garden", room), f"a door to the garden, from {self._named(name)}"
            return self._opening(target, about, gates, [Function("gate", [room])], door, until)
        about, atoms = f"{self.ENTRANCE}, into {self._named(name)}", self._atoms("entrance", room)
        sides = [Function("entrance", [each.arguments[1]]) for each in atoms]
        variables = [Function("entrance"), Function("entry", [room]), *sides]
        return self._opening(target, about, atoms, variables, door, until)

    def _window(self, target: str, room: int, window: Window, until: float) -> Iterator[Why]:
        """Yield the explanation of a window in a wall."""
        side = Function(self._wall(window).side)
        atom = Function("window", [Number(room), side])
        about = f"a window in the {side} wall of {self._named(window.room)}"
        return self._opening(target, about, [atom], [atom], window, until)

    def _opening(
        self,
        target: str,
        about: str,
        atoms: list[Symbol],
        variables: list[Symbol],
        opening: Door | Window,
        until: float,
    ) -> Iterator[Why]:
        support, plan = self._support, self._request.plan
        given = plan and opening in (plan.doors if isinstance(opening, Door) else plan.windows)
        if given:
            about += "; the plan has it there"
        why = Why(target, f"{about} ({self._origin})", support.trees(atoms))
        own = [each for each in variables if each in support.chosen.picks]
        return self._answer(
            why,
            support,
            own,
            lambda: (() if given else self._opening_lengths(opening), ()),
            lambda: self._search,
            until,
        )

    def _opening_lengths(self, opening: Door | Window) -> tuple[Length, Length]:
        """Return the range of the length of a door or window in its wall, and that of its place."""
        wall = self._wall(opening)
        type_ = self._house.rooms[wall.room].type
        ends = opening.between if isinstance(opening, Door) else (OUTSIDE,)
        names = [name for name in ends if name != self._house.rooms[wall.room].name]
        other = OUTSIDE if names[0] == OUTSIDE else self._house.room(names[0]).type
        found = opening_lengths(self._builder.placer, type_, other, wall.start, wall.end)
        axis = "y" if wall.side in ("west", "east") else "x"
        place = Reason(f"a wall from {axis} {wall.start:.3f} to {wall.end:.3f} m")
        if isinstance(opening, Door) and opening.opening:
            one, other = (self._house.room(name) for name in opening.between)
            wide, margin, near = wall.end - wall.start, 0.0, (place,)
            if self._house.whole(one) is self._house.whole(other):
                least, greatest, clauses = wide, wide, ()
            else:
                least, greatest, clauses = open_lengths(self._builder.placer, (one.type, other.type), wide)
            no_less = no_more = self._reasons([("clause", each) for each in clauses])
            if greatest > wide - 1e-6:
                no_more = near
            if least > wide - 1e-6:
                no_less = near
        elif isinstance(opening, Door):
            margin, least, greatest = found["margin"], found["door"], found["door"]
            near = (*self._clause("length(door_margin)"), place)
            no_less = no_more = self._clause(found["clause"])
        else:
            margin, (least, greatest) = found["frame"], found["window"]
            near = (*self._clause("length(window_margin)"), place)
            no_less = no_more = self._clause(f"window_size({type_})")
            if greatest > wall.end - wall.start - 2 * margin - 1e-6:
                no_more = near
        low, high = wall.start + margin, wall.end - margin - opening.length
        length = Length("width", opening.length, least, greatest, no_less, no_more)
        return length, Length(axis, getattr(opening, axis), low, high, near, near)

    def _clause(self, clause: str) -> tuple[Reason, ...]:
        return self._reasons([("clause", clause)])

    def _wall(self, opening: Door | Window) -> Wall:
        """Return the part of a wall that a door or window may lie in."""
        plan = OwnPlan(self._house.tiles)
        wall = plan.wall_of(opening) if isinstance(opening, Door) else plan.wall_around(opening)
        assert wall is not None
        start, end = inner_span(plan, wall, self._house.wall_thickness)
        return dataclasses.replace(wall, start=start, end=end)

    def _named(self, name: str) -> str:
        return f"{name}, {article(self._house.room(name).type)}"

    def _atoms(self, name: str, room: Symbol) -> list[Symbol]:
        """Return the layout's atoms with this name and the room as first argument."""
        return [each for each in self._making.layout if each.name == name and each.arguments[0] == room]

    @cached_property
    def _model(self) -> list[Symbol]:
        """All atoms that held when the walls were chosen."""
        kept = self._making.program.models or []
        return next(model for shown, model in reversed(kept) if shown is self._making.layout)

    @cached_property
    def _support(self) -> Support:
        """Support of the layout of the rooms."""
        return Support(self._making.program, self._model)

    @cached_property
    def _search(self) -> Search:
        """Search for alternatives."""
        relaxed, statements = self._maker.feasibility.house(self._request, laws=True)
        question = self._maker.feasibility.of_rooms(relaxed, self._request)
        return Search(question, statements, self._support.chosen, self._making.layout, MAX_OTHER_CHOICES)

    @cache  # noqa: B019 (a witness is asked about one house)
    def _support_in(self, room: int) -> Support:
        """Return the support of the furniture of a room."""
        how = self._making.furniture[room]
        (model,) = [model for shown, model in how.program.models or [] if shown is how.layout.furniture]
        return Support(how.program, model)

    @cache  # noqa: B019
    def _search_in(self, room: int) -> Search:
        """Return the search for alternatives to the furniture of a room."""
        how = self._making.furniture[room]
        fixed = LooseRoom(how.room, [None] * len(how.room.doors))
        given = Refuted(self._house.rooms[room].name, fixed, True, {}, ())
        asked = self._maker.feasibility.furniture(self._request, how.room.type, laws=True, room=given)
        return Search(*asked, self._support_in(room).chosen, how.layout.furniture, MAX_OTHER_CHOICES)
