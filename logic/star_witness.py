"""Why a part of a star is as it is: a room, its door, a piece, the main room."""

from functools import cache, cached_property

import msgspec
from clingo import Function, Number

from logic.alternatives import Search
from logic.errors import Reason
from logic.fixed import fixed_rooms
from logic.house import House
from logic.parts import Provenance
from logic.placement import RoomLayout
from logic.support import Support
from logic.targets import Part, target_in
from logic.why import Length, Why
from logic.witness import Witness


class StarWitness(Witness):
    """A star that is made again."""

    def why(self, target: str) -> Why:
        """Why a room, its door, a piece or the main room is as it is."""
        room, part = target_in(self._house, target)
        if room is None:
            return self._main_room(target)
        layout = self._layout.rooms[room]
        if isinstance(part, int) and not layout.fixed:
            return self._piece(target, layout, part, *self._of_furniture(room))
        return self._room(target, layout, part)

    def _made_again(self, made: Provenance, inferences: int) -> House:
        programs = self._builder.programs
        self._rooms, _ = programs.rooms_for(self._request)
        for program in (self._rooms, *programs.all_furniture(self._request)):
            program.models = []
        again, self._layout = self._builder.made(self._request, made.seed, made.index, inferences)
        return again

    def _room(self, target: str, layout: RoomLayout, part: Part) -> Why:
        """Why a room has its type and side, or its door its place; any part of a fixed room."""
        number = Number(layout.number)
        type_, side = Function("room", [number, layout.type]), Function("side", [number, layout.side])
        support, search = self._of_rooms
        about = f"a {layout.type} on the {layout.side} side of the main room"
        if part is not None:
            about = f"in R{layout.number}, {about}"
        if layout.fixed:
            about += "; the request keeps it (keep) with its sizes, its door and its furniture"
        why = Why(target, f"{about} ({self._origin})", support.trees([type_, side]))
        if not layout.fixed:
            lengths, tight = self._lengths(layout, Function("room" if part is None else "door"))
            why = msgspec.structs.replace(why, lengths=lengths, tight=tight)
        if part is None:
            choices = search.choices(support.variables([number]))
            choices = [
                self._furnishable(self._builder.prover, each) if each.name == f"type({number})" else each
                for each in choices
            ]
            sides = [each for each in self._rooms.atoms("side", 2) if each.arguments[0] == number]
            why = msgspec.structs.replace(why, choices=(*choices, search.of_atom(side, sides)))
        return why

    @cached_property
    def _of_rooms(self) -> tuple[Support, Search]:
        """What supports the layout of the rooms, and what could be instead."""
        shown, model = (self._rooms.models or [])[-1]  # the last one sampled is the house's
        support = Support(self._rooms, model)
        relaxed, statements = self._builder.prover.house(self._request, laws=True)
        possible = lambda some: relaxed.model(some) is not None  # noqa: E731 (as prover.furniture returns it)
        return support, Search(relaxed, statements, possible, support.chosen, shown)

    @cache  # noqa: B019 (a witness is asked about one house)
    def _of_furniture(self, room: int) -> tuple[Support, Search]:
        """The same for the furniture of a room."""
        layout = self._layout.rooms[room]
        program, _ = self._builder.programs.furniture_for(layout.type.name, self._request)
        (model,) = [model for shown, model in program.models or [] if shown is layout.furniture]
        support = Support(program, model)
        relaxed = self._builder.prover.furniture(self._request, layout.type.name, laws=True)
        return support, Search(*relaxed, support.chosen, layout.furniture)

    def _main_room(self, target: str) -> Why:
        """Why the main room has its sizes: rules/main_room.pl."""
        floor, rooms = self._house.main, fixed_rooms(self._house)
        about = f"the main room, {floor.width:.3f} by {floor.height:.3f} m ({self._origin})"
        if self._request.fixed:
            return Why(target, f"{about}, between the rooms that the request keeps (keep)")
        found = self._builder.placer.main_bounds(rooms, self._layout.corners, floor.width)
        gaps = self._reasons([("clause", "length(room_gap)"), ("clause", "length(door_clearance)")])
        largest = max(rooms, key=lambda room: room.width * room.depth).room
        file, line = found["law"]
        words = (
            f"at least as large as any room (here a {largest.type} of {largest.area:.1f} m2), at most twice "
        )
        law = Reason(f"{words}as long as wide and as the least area that fits", file, line, 1)

        def length(name: str, value: float, *sides: str) -> Length:
            least, greatest = found[name]
            side = max(sides, key=lambda each: found["walls"][each])
            wall = found["walls"][side]
            rooms_there = (*gaps, Reason(f"the rooms on the {side} side, which take {wall:.3f} m"))
            no_less = rooms_there if abs(wall - least) < 1e-6 else (law,)
            return Length(name, value, least, greatest, no_less, (law,))

        width = length("width", floor.width, "north", "south")
        height = length("height", floor.height, "east", "west")
        return Why(target, about, lengths=(width, height))
