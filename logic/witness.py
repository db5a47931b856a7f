"""Finds why a part of a house is as it is: the house is made again, and its layout asked for its reasons."""

from collections.abc import Iterable, Mapping
from functools import cache, cached_property

import msgspec
from clingo import Function, Number, Symbol, parse_term

from logic.alternatives import Search
from logic.builder import Builder
from logic.errors import HouseFileError, Reason, RequestError, Unsatisfiable
from logic.fixed import fixed_rooms
from logic.house import House
from logic.placement import RoomLayout
from logic.proof import located
from logic.request import Request
from logic.support import Support
from logic.why import Alternative, Bound, Choice, Length, Why, part_names


class Witness:
    """A house that is made again, with all that held while it was."""

    def __init__(self, builder: Builder, house: House, inferences: int) -> None:
        """Make the house again from its provenance. Raises ``HouseFileError`` where it comes out another."""
        made = house.provenance
        assert made is not None
        if builder.grammar.shares_walls:
            raise RequestError(f"why: it is known of stars alone yet, not of a {house.topology}")
        self._builder, self._request, self._house = builder, Request.read(made.request), house
        self._origin = f"{made.grammar}, seed {made.seed}, house {made.index}"
        self._rooms, _ = builder.programs.rooms_for(self._request)
        for program in (self._rooms, *builder.programs.all_furniture(self._request)):
            program.models = []
        again, why = None, "it was edited"
        try:
            again, self._layout = builder.made(self._request, made.seed, made.index, inferences)
        except (RequestError, Unsatisfiable) as error:
            why = str(error)
        if again is None or (again.rooms, again.doors) != (house.rooms, house.doors):
            if made.versions != builder.versions:
                why = f"it was made by other versions, {made.versions}, not {builder.versions}"
            if made.grammar_hash != builder.grammar.hash:
                place = builder.grammar.directory
                why = f"others than those in {place} and the core made it: name its own by --grammar"
            raise HouseFileError(f"the rules do not make this house of {self._origin}: {why}")

    def why(self, target: str, room: int | None, part: int | str | None) -> Why:
        """Why a room, its ``door``, its piece of this index in the file, or the main room is as it is."""
        if room is None:
            return self._main_room(target)
        layout = self._layout.rooms[room]
        if isinstance(part, int) and not layout.fixed:
            return self._piece(target, layout, part)
        return self._room(target, layout, part)

    def _room(self, target: str, layout: RoomLayout, part: int | str | None) -> Why:
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
                self._furnishable(each) if each.name == f"type({number})" else each for each in choices
            ]
            sides = [each for each in self._rooms.atoms("side", 2) if each.arguments[0] == number]
            why = msgspec.structs.replace(why, choices=(*choices, search.of_atom(side, sides)))
        return why

    def _piece(self, target: str, layout: RoomLayout, index: int) -> Why:
        """Why a piece or a companion stands where it does."""
        type_, atom = self._builder.placer.pieces(layout)[index]
        support, search = self._of_furniture(layout.number)
        piece = atom.arguments[:2]
        if atom.name == "with":
            atoms, subject = [atom], [*piece, atom.arguments[3]]
        else:
            own = [each for each in layout.furniture if each.arguments[:2] == piece and each.name != "with"]
            atoms, subject = [atom, *(each for each in own if each != atom)], piece
        choices = tuple(search.choices(support.variables(subject)))
        lengths, tight = self._lengths(layout, atom)
        about = f"a {type_} in R{layout.number}, a {layout.type} ({self._origin})"
        return Why(target, about, support.trees(atoms), choices, lengths, tight)

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

    def _furnishable(self, choice: Choice) -> Choice:
        """A choice of a room's type, where those that cannot be furnished are not possible."""

        def judged(other: Alternative) -> Alternative:
            if self._builder.prover.is_furnishable(self._request, other.value):
                return other
            return Alternative(other.value, False, (), (Reason(f"no {other.value} can be furnished"),))

        return Choice(choice.name, choice.value, tuple(map(judged, choice.instead)))

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

    def _lengths(self, layout: RoomLayout, target: Symbol) -> tuple[tuple[Length, ...], tuple[Bound, ...]]:
        """The lengths of a target in a room, and the bounds on it that are tight."""
        found = self._builder.placer.bounds(layout, target)
        types, atoms = zip(*self._builder.placer.pieces(layout), strict=True)
        names = dict(zip(map(str, atoms), part_names(types), strict=True))
        lengths = tuple(
            Length(name, value, least, greatest, self._reasons(no_less), self._reasons(no_more))
            for name, value, least, no_less, greatest, no_more in found["lengths"]
        )
        # A length without another value says why itself.
        single = [length.name for length in lengths if length.greatest - length.least < 1e-6]
        tight = tuple(
            Bound(_in_words(terms, relation, constant, names), self._reasons(reasons))
            for terms, relation, constant, reasons in found["binding"]
            if not (len(terms) == 1 and terms[0][2] in single)
        )
        return lengths, tight

    def _reasons(self, reasons: Iterable[tuple[str, str]]) -> tuple[Reason, ...]:
        """Reasons as SWI-Prolog gives them: clauses by their places, then what holds and what does not."""
        clauses = [parse_term(text) for kind, text in reasons if kind == "clause"]
        places = self._builder.placer.origins(clauses)
        found = [located(*places[clause]) for clause in clauses if clause in places]
        found += [Reason(text) for kind, text in reasons if kind == "holds"]
        return (*found, *(Reason(f"not {text}") for kind, text in reasons if kind == "fails"))


def _in_words(
    terms: Iterable[tuple[float, str, str]], relation: str, constant: float, names: Mapping[str, str]
) -> str:
    """A sum that is at most zero, or zero, with what is negative on the other side."""
    sides: dict[bool, list[str]] = {True: [], False: []}
    for factor, thing, what in terms:
        number = "" if abs(factor) == 1 else f"{abs(factor):.4g} "
        sides[factor > 0].append(f"{number}{names.get(thing, thing)}.{what}")
    if abs(constant) > 1e-9:
        sides[constant > 0].append(f"{abs(constant):.4g}")
    left, right = (" + ".join(sides[positive]) or "0" for positive in (True, False))
    return f"{left} {'=' if relation == '=' else '<='} {right}"
