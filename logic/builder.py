"""From a request to a house: the two stages, and what goes between them."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib.metadata import version
from math import ceil, floor
from typing import Any

import clingo
import msgspec
import numpy as np
from clingo import Function, Number, Symbol, SymbolType

from logic.errors import GrammarError, LimitReached, RequestError, Unsatisfiable
from logic.grammar import Grammar
from logic.house import House, Provenance, Rect, Room
from logic.layout import Program
from logic.messages import placed_error
from logic.placement import Layout, Placer, Refuted, RoomLayout


@dataclass(frozen=True)
class Request:
    """What a house must have: its number of secondary rooms, and exact counts of room types."""

    rooms: int
    types: Mapping[str, int] = field(default_factory=dict)

    def __str__(self) -> str:
        """In words, as in ``3 rooms, 2 of type bedroom``."""
        rooms = f"{self.rooms} room{'s' if self.rooms != 1 else ''}"
        return ", ".join([rooms, *(f"{count} of type {type_}" for type_, count in self.types.items())])


class Builder:
    """Makes houses of one grammar; it grounds each program once and keeps it."""

    def __init__(self, grammar: Grammar) -> None:
        """Load the grammar's files; raises ``GrammarError`` for the first thing wrong with them."""
        self._grammar = grammar
        self._placer = Placer(grammar)
        probe = Program(grammar.asp, {"rooms": 1}, [("house", [])])
        for symbol in probe.atoms("wrong", 2):
            raise GrammarError(f"{symbol.arguments[0]}: {symbol.arguments[1].string}", grammar.directory)
        self.types = sorted(_name(symbol.arguments[0]) for symbol in probe.atoms("type", 1))
        if not self.types:
            raise GrammarError("no room type: state type/1 in a .lp file", grammar.directory)
        self._furnishing = self._furnishing_programs(probe)
        self._refuse_unknown_atoms(probe, *self._furnishing.values())
        self._housing: dict[tuple[int, tuple[tuple[str, int], ...]], Program] = {}
        self.versions = {
            "vitruvius": version("vitruvius"),
            "clingo": clingo.__version__,
            "swi-prolog": self._placer.version(),
        }

    def house(self, request: Request, seed: int, index: int, inferences: int) -> House:
        """Make house ``index``: a function of the grammar, the request, the seed and the index.

        Raises ``RequestError`` for an unknown type, ``Unsatisfiable`` where it is proved that there is no
        such house, ``LimitReached`` past so many Prolog inferences.
        """
        rng = np.random.default_rng([seed, index])
        refuted = Refutations()
        layout = self.layout(request, rng, refuted)
        while True:
            try:
                plan = self.place(layout, rng, inferences)
                return self._as_house(plan, request, seed, index)
            except Refuted as proof:
                inferences -= proof.inferences
                if inferences <= 0:
                    raise LimitReached(f"{request}: house {index} reached its limit of inferences") from None
                refuted.learn(layout, proof.rooms)
                layout = self._refurnished(layout, proof.rooms, rng, refuted) or self.layout(
                    request, rng, refuted
                )

    def layout(
        self, request: Request, rng: np.random.Generator, refuted: "Refutations | None" = None
    ) -> Layout:
        """Stage 1: draw a layout that is not refuted yet; raises ``Unsatisfiable`` where none is left."""
        refuted = refuted or Refutations()
        while True:
            bare = self._draw_rooms(request, rng, refuted)
            furnished = self._refurnished(bare, range(request.rooms), rng, refuted)
            if furnished is not None:
                return furnished

    def _refurnished(
        self, layout: Layout, numbers: Iterable[int], rng: np.random.Generator, refuted: "Refutations"
    ) -> Layout | None:
        """The layout with new furniture in these rooms; None, learnt, where a type of room can have none."""
        rooms = list(layout.rooms)
        for number in numbers:
            type_ = rooms[number].type.name
            furniture = self._furnishing[type_].draw(rng, (), refuted.furniture(type_))
            if furniture is None:
                refuted.unfurnishable.add(type_)
                return None
            rooms[number] = replace(rooms[number], furniture=furniture)
        return Layout(rooms, layout.corners)

    def place(self, layout: Layout, rng: np.random.Generator, inferences: int) -> dict[str, Any]:
        """Stage 2: see ``Placer.place``."""
        return self._placer.place(layout, rng, inferences)

    def _draw_rooms(self, request: Request, rng: np.random.Generator, refuted: "Refutations") -> Layout:
        """A layout without furniture, and without the types of room that cannot have any."""
        program, wishes = self._housing_program(request)
        nogoods = [
            [Function("room", [Number(number), Function(type_)])]
            for type_ in sorted(refuted.unfurnishable)
            for number in range(request.rooms)
        ]
        atoms = program.draw(rng, wishes, nogoods)
        if atoms is None:
            raise self._unsatisfiable(request, program, wishes, refuted)
        types = {atom.arguments[0].number: atom.arguments[1] for atom in atoms if atom.name == "room"}
        sides = {atom.arguments[0].number: atom.arguments[1] for atom in atoms if atom.name == "side"}
        rooms = [RoomLayout(number, types[number], sides[number], ()) for number in sorted(types)]
        return Layout(rooms, [atom for atom in atoms if atom.name == "corner"])

    def _housing_program(self, request: Request) -> tuple[Program, list[Symbol]]:
        wishes = tuple(sorted(request.types.items()))
        for type_, _ in wishes:
            if type_ not in self.types:
                known = ", ".join(self.types)
                raise RequestError(f"{self._grammar.name} has no room type {type_}: it has {known}")
        terms = [[Function(type_), Number(count)] for type_, count in wishes]
        if (request.rooms, wishes) not in self._housing:
            parts = [("house", []), *(("wish", term) for term in terms)]
            program = Program(self._grammar.asp, {"rooms": request.rooms}, parts)
            self._housing[request.rooms, wishes] = program
        granted = [Function("granted", [Function("wish", term)]) for term in terms]
        return self._housing[request.rooms, wishes], granted

    def _unsatisfiable(
        self, request: Request, program: Program, wishes: Sequence[Symbol], refuted: "Refutations"
    ) -> Unsatisfiable:
        """The proof in words: the least part of the request that clashes with the grammar's rules."""
        if refuted.unfurnishable:
            bare = ", ".join(sorted(refuted.unfurnishable))
            reasons = tuple(
                f"no room of type {type_} can be furnished" for type_ in sorted(refuted.unfurnishable)
            )
            why = f"its sizes and clearances leave no way to furnish: {bare}. Change them in its .pl files"
        else:
            clash = [atom.arguments[0].arguments for atom in program.clash(wishes)]
            reasons = (f"rooms={request.rooms}", *(f"types {type_}={count}" for type_, count in clash))
            wanted = " and ".join(f"{count} of type {type_}" for type_, count in clash)
            why = f"its rules exclude {wanted or 'every house'} among {request.rooms} rooms"
            why += ". Ask for other counts or more rooms" if clash else ""
        return Unsatisfiable(f"no house of {self._grammar.name} has {request}: {why}", reasons)

    def _furnishing_programs(self, probe: Program) -> dict[str, Program]:
        """For each type the program that furnishes a room, with the extremes of its lengths as facts."""
        furniture: dict[str, list[str]] = {type_: [] for type_ in self.types}
        for symbol in probe.atoms("may", 4):
            furniture[symbol.arguments[0].name].append(_name(symbol.arguments[1]))
        lengths = self._placer.lengths(furniture)
        named = [
            ("length", [Function(name), Number(floor(1000 * m))]) for name, m in lengths["lengths"].items()
        ]
        programs = {}
        for type_ in self.types:
            reach = ("reach", [Function(type_), *_millimetres(lengths["rooms"][type_])])
            extents = [
                ("extent", [Function(f), *_millimetres(x)]) for f, x in lengths["pieces"][type_].items()
            ]
            programs[type_] = Program(
                self._grammar.asp, {"this": type_}, [("room", []), *named, reach, *extents]
            )
        return programs

    def _refuse_unknown_atoms(self, *programs: Program) -> None:
        """An atom of the grammar that no program derives is a misspelling: clingo only remarks on it."""
        for remark in sorted(set.intersection(*(set(program.remarks) for program in programs))):
            error = placed_error(remark)
            if str(error.file) in map(str, self._grammar.asp):
                raise error

    def _as_house(self, plan: dict[str, Any], request: Request, seed: int, index: int) -> House:
        provenance = Provenance(
            grammar=self._grammar.name,
            grammar_hash=self._grammar.hash,
            request={"rooms": request.rooms, "types": dict(request.types)},
            seed=seed,
            index=index,
            versions=self.versions,
        )
        rooms = tuple(msgspec.convert(plan["rooms"], list[Room]))
        return House(msgspec.convert(plan["floor"], Rect), rooms, provenance=provenance)


@dataclass
class Refutations:
    """What stage 2 has refuted for one house. It stays with that house, so that no other depends on it."""

    unfurnishable: set[str] = field(default_factory=set)
    _furniture: dict[str, list[Sequence[Symbol]]] = field(default_factory=dict)

    def furniture(self, type_: str) -> list[Sequence[Symbol]]:
        """The refuted furnishings of a type of room: nogoods of its program."""
        return self._furniture.get(type_, [])

    def learn(self, layout: Layout, rooms: Sequence[int]) -> None:
        """These rooms of a layout have no solution, so no room of their type has with this furniture."""
        for room in layout.rooms:
            if room.number in rooms:
                self._furniture.setdefault(room.type.name, []).append(room.furniture)


def _name(symbol: Symbol) -> str:
    """A type's name: a word in lower case, the same term for clingo and for Prolog, and a word in files."""
    if symbol.type != SymbolType.Function or symbol.arguments or symbol.negative:
        raise GrammarError(f"{symbol}: a type is named by a word that begins in lower case, as in bedroom")
    return symbol.name


def _millimetres(extremes: Sequence[float]) -> list[Symbol]:
    """Least and greatest lengths in turn, as whole millimetres that exclude none of them."""
    bounds = [floor, ceil] * (len(extremes) // 2)
    return [Number(bound(1000 * metres)) for bound, metres in zip(bounds, extremes, strict=True)]
