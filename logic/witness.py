"""Finds why a part of a house is as it is: the house is made again, and its layout asked for its reasons."""

from collections.abc import Iterable, Mapping

from clingo import Function, Number, Symbol, parse_term

from logic.builder import Builder
from logic.errors import HouseFileError, Reason
from logic.house import House
from logic.instead import Search
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
        self._builder, self._request = builder, Request.read(made.request)
        self._rooms, _ = builder.programs.rooms_for(self._request)
        self._rooms.models = []
        for program in builder.programs.all_furniture(self._request):
            program.models = []
        again, self._layout = builder.made(self._request, made.seed, made.index, inferences)
        if (again.floor, again.rooms) != (house.floor, house.rooms):
            why = f"it was edited, or made by other versions ({made.versions})"
            if made.versions == builder.versions:
                why = "it was edited"
            raise HouseFileError(f"its rules make another house of seed {made.seed}, index {made.index}: {why}")
        self._house = again

    def why(self, target: str, room: int | None, piece: int | str | None) -> Why:
        """Why a room, its piece of this index in the file's order, its ``door``, or the main room is as it is."""
        if room is None:
            return self._main_room(target)
        layout = self._layout.rooms[room]
        if layout.fixed:
            return self._room(target, layout, "", (), ())
        if piece is None or piece == "door":
            lengths, tight = self._lengths(layout, Function(piece or "room"))
            return self._room(target, layout, piece, lengths, tight)
        return self._piece(target, layout, int(piece))

    def _room(
        self, target: str, layout: RoomLayout, part: str | None, lengths: tuple[Length, ...], tight: tuple[Bound, ...]
    ) -> Why:
        """Why a room, or its door, is of its type and on its side."""
        number = Number(layout.number)
        type_, side = Function("room", [number, layout.type]), Function("side", [number, layout.side])
        shown, model = self._rooms.models[-1]  # the last one sampled is the house's
        support = Support(self._rooms, model)
        relaxed, statements = self._builder.prover.house(self._request, laws=True)
        about = f"a {layout.type} on the {layout.side} side of the main room"
        if layout.fixed:
            about += "; the request keeps it (keep), so its sizes, its door and its furniture are another house's"
        if part == "door":
            about = f"to {about}"
            return Why(target, f"{about} ({self._origin()})", support.trees([type_, side]), (), lengths, tight)

        search = Search(relaxed, statements, lambda some: relaxed.model(some) is not None, support.chosen, shown)
        choices = search.choices(support.variables([number]))
        choices = [self._furnishable(each) if each.name == f"type({number})" else each for each in choices]
        sides = [each for each in self._rooms.atoms("side", 2) if each.arguments[0] == number]
        choices.append(search.of_atom(side, sides))
        return Why(target, f"{about} ({self._origin()})", support.trees([type_, side]), tuple(choices), lengths, tight)

    def _piece(self, target: str, layout: RoomLayout, index: int) -> Why:
        """Why a piece or a companion stands where it does."""
        pieces = self._builder.placer.pieces(layout)
        type_, atom = pieces[index]
        program, _ = self._builder.programs.furniture_for(layout.type.name, self._request)
        (model,) = [model for shown, model in program.models if shown is layout.furniture]
        support = Support(program, model)
        piece, hand = atom.arguments[:2], atom.arguments[3:] if atom.name == "with" else []
        atoms = [atom]
        if atom.name == "on":
            of_piece = [each for each in layout.furniture if each.arguments[:2] == piece and each.name != "with"]
            atoms += [each for each in of_piece if each != atom]
        relaxed, statements, possible = self._builder.prover.furniture(self._request, layout.type.name, laws=True)
        search = Search(relaxed, statements, possible, support.chosen, layout.furniture)
        choices = search.choices(support.variables([*piece, *hand]))
        lengths, tight = self._lengths(layout, atom)
        about = f"a {type_} in {target.partition('.')[0]}, a {layout.type}"
        return Why(target, f"{about} ({self._origin()})", support.trees(atoms), tuple(choices), lengths, tight)

    def _origin(self) -> str:
        made = self._house.provenance
        return f"{made.grammar}, seed {made.seed}, house {made.index}" if made else ""

    def _furnishable(self, choice: Choice) -> Choice:
        """A choice of a room's type, where those that cannot be furnished are not possible."""

        def judged(other: Alternative) -> Alternative:
            if self._builder.prover.is_furnishable(self._request, other.value):
                return other
            return Alternative(other.value, False, (), (Reason(f"no {other.value} can be furnished"),))

        return Choice(choice.name, choice.value, tuple(map(judged, choice.instead)))

    def _lengths(self, layout: RoomLayout, target: Symbol) -> tuple[tuple[Length, ...], tuple[Bound, ...]]:
        """The lengths of a target in a room, and the bounds on it that are tight."""
        found = self._builder.placer.bounds(layout, target)
        types, atoms = zip(*self._builder.placer.pieces(layout), strict=True)
        names = dict(zip(map(str, atoms), part_names(types), strict=True))
        lengths = [
            Length(name, value, least, greatest, self._reasons(no_less), self._reasons(no_more))
            for name, value, least, no_less, greatest, no_more in found["lengths"]
        ]
        fixed = {length.name for length in lengths if length.greatest - length.least < 1e-6}
        tight = [
            Bound(_in_words(terms, relation, constant, names), self._reasons(reasons))
            for terms, relation, constant, reasons in found["binding"]
            if not (len(terms) == 1 and terms[0][2] in fixed)  # what has one value says why there
        ]
        return tuple(lengths), tuple(tight)

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
