"""Explanations of parts of a star: a room, its door, a piece, the main room."""

import math
from collections.abc import Iterator
from functools import cache, cached_property

import msgspec
from clingo import Function, Number

from vitruvius.logic.errors import Reason
from vitruvius.logic.house.house import House
from vitruvius.logic.house.part_names import Part, target_in
from vitruvius.logic.house.parts import Provenance
from vitruvius.logic.placement.bounds import main_bounds
from vitruvius.logic.placement.layout import Layout, RoomLayout
from vitruvius.logic.request.fixed_rooms import fixed_rooms
from vitruvius.logic.spelling import article
from vitruvius.logic.why.alternatives import Search
from vitruvius.logic.why.answer import Length, Why
from vitruvius.logic.why.support import Support
from vitruvius.logic.why.witness import Lengths, Witness


class StarWitness(Witness):
    """Star that is generated again."""

    def parts(self, target: str, until: float = math.inf) -> Iterator[Why]:
        """Yield the explanation of a room, its door, a piece or the main room."""
        room, part = target_in(self._house, target)
        if room is None:
            yield self._main_room(target)
            return
        layout = self._layout.rooms[room]
        if isinstance(part, int) and not layout.fixed:
            search = lambda: self._search_in(room)  # noqa: E731
            yield from self._piece(target, layout, part, self._support_in(room), search, until)
        else:
            yield from self._room(target, layout, part, until)

    def _made_again(self, made: Provenance) -> House:
        programs = self._builder.programs
        self._rooms, _ = programs.rooms_for(self._request)
        for program in (self._rooms, *programs.all_furniture(self._request)):
            program.models = []
        again = self._builder.house(self._request, made.seed, made.index)
        self._layout: Layout = self._builder.origin
        return again

    def _room(self, target: str, layout: RoomLayout, part: Part, until: float) -> Iterator[Why]:
        """Yield the explanation of a room, of its door, or of a part of a fixed room."""
        number, support = Number(layout.number), self._support
        type_, side = Function("room", [number, layout.type]), Function("side", [number, layout.side])
        about = f"{article(str(layout.type))} on the {layout.side} side of the main room"
        if part is not None:
            about = f"in R{layout.number}, {about}"
        if layout.fixed:
            about += "; the request keeps it (keep) with its sizes, its door and its furniture"
        why = Why(target, f"{about} ({self._origin})", support.trees([type_, side]))
        variables, sides = [], []
        if part is None:
            variables = support.variables([number])
            sides = [each for each in self._rooms.atoms("side", 2) if each.arguments[0] == number]
            why = msgspec.structs.replace(why, others=len(sides) - 1)

        def lengths() -> Lengths:
            if layout.fixed:
                return (), ()
            if part is not None:
                return self._lengths(layout, Function("door"))
            others = sum(room.area for room in self._house.rooms) - self._house.counted[layout.number].area
            return self._lengths(layout, Function("room"), others)

        for found in self._answer(why, support, variables, lengths, lambda: self._search, until):
            types = (
                self._furnishable(self._builder.maker.feasibility, each)
                for each in found.choices
                if each.name == f"type({number})"
            )
            yield msgspec.structs.replace(found, choices=tuple(types) or found.choices)
        if sides:
            yield from self._tried(target, self._search.of_atom(side, sides, until))

    @cached_property
    def _support(self) -> Support:
        """Support of the layout of the rooms."""
        return Support(self._rooms, (self._rooms.models or [])[-1][1])  # the last one sampled is the house's

    @cached_property
    def _search(self) -> Search:
        """Search for alternatives."""
        relaxed, statements = self._builder.maker.feasibility.house(self._request, laws=True)
        question = self._builder.maker.feasibility.of_rooms(relaxed, self._request)
        return Search(question, statements, self._support.chosen, (self._rooms.models or [])[-1][0])

    @cache  # noqa: B019 (a witness is asked about one house)
    def _support_in(self, room: int) -> Support:
        """Return the support of the furniture of a room."""
        layout = self._layout.rooms[room]
        program, _ = self._builder.programs.furniture_for(layout.type.name, self._request)
        (model,) = [model for shown, model in program.models or [] if shown is layout.furniture]
        return Support(program, model)

    @cache  # noqa: B019
    def _search_in(self, room: int) -> Search:
        """Return the search for alternatives to the furniture of a room."""
        layout = self._layout.rooms[room]
        asked = self._builder.maker.feasibility.furniture(self._request, layout.type.name, laws=True)
        return Search(*asked, self._support_in(room).chosen, layout.furniture)

    def _main_room(self, target: str) -> Why:
        """Return the explanation of the main room's sizes: rules/star/main_room.pl."""
        floor, rooms = self._house.main, fixed_rooms(self._house)
        about = f"the main room, {floor.width:.3f} by {floor.height:.3f} m ({self._origin})"
        if self._request.fixed:
            return Why(target, f"{about}, between the rooms that the request keeps (keep)")
        found = main_bounds(self._builder.placer, rooms, self._layout.corners, floor.width)
        gaps = self._reasons([("clause", "length(room_gap)"), ("clause", "length(door_clearance)")])
        largest = max(rooms, key=lambda room: room.width * room.depth).room
        file, line = found["law"]
        here = article(largest.type)
        words = f"at least as large as any room (here {here} of {largest.area:.1f} m2), at most twice "
        law = Reason(f"{words}as long as wide and as the least area that fits", file, line, 1)
        taken = sum(room.width * room.depth for room in rooms)
        rest = (
            *self._reasons([("clause", "house_area")]),
            Reason(f"the rooms around it, which take {taken:.3f} m2"),
        )

        def length(name: str, value: float, *sides: str) -> Length:
            least, greatest = found[name]
            side = max(sides, key=lambda each: found["walls"][each])
            wall = found["walls"][side]
            rooms_there = (*gaps, Reason(f"the rooms on the {side} side, which take {wall:.3f} m"))
            lowest, highest = found["any"][name]
            law_or_rest = rest if least > lowest + 1e-6 else (law,)
            no_less = rooms_there if abs(wall - least) < 1e-6 else law_or_rest
            return Length(
                name, value, least, greatest, no_less, rest if greatest < highest - 1e-6 else (law,)
            )

        width = length("width", floor.width, "north", "south")
        height = length("height", floor.height, "east", "west")
        return Why(target, about, lengths=(width, height))
