"""From a request to a house: the two stages, and what goes between them."""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib.metadata import version
from math import ceil, floor
from typing import Any

import clingo
import msgspec
import numpy as np
from clingo import Function, Number, Symbol

from logic.audit import audit
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
        audit(grammar.asp)
        probe = Program(grammar.asp, {"rooms": 1}, [("house", [])])
        self.types = sorted(_name(symbol.arguments[0]) for symbol in probe.atoms("type", 1))
        for symbol in probe.atoms("wrong", 2):
            raise GrammarError(f"{symbol.arguments[0]}: {symbol.arguments[1].string}", grammar.directory)
        if not self.types:
            raise GrammarError("no room type: state type/1 in a .lp file", grammar.directory)
        self._placer = Placer(grammar)
        self._furnishing = self._furnishing_programs(probe)
        programs = [probe, *self._furnishing.values()]
        self._unknown_atoms = set.intersection(*(set(program.remarks) for program in programs))
        for program in programs:
            self._refuse_remarks(program)
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
        with Refutations() as refuted:
            layout = self.layout(request, rng, refuted)
            while True:
                try:
                    plan = self.place(layout, rng, inferences, least=refuted.count > 1)
                    return self._as_house(plan, request, seed, index)
                except Refuted as proof:
                    inferences -= proof.inferences
                    if inferences <= 0:
                        raise LimitReached(f"house {index} reached its limit of inferences") from None
                    for number, clash in proof.clashes.items():
                        refuted.add(self._furnishing[layout.rooms[number].type.name], clash.atoms)
                    again = self._refurnished(layout, proof.clashes, rng, refuted)
                    layout = again or self.layout(request, rng, refuted)

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
            program = self._furnishing[type_]
            furniture = program.draw(rng, guard=refuted.guards.get(program))
            if furniture is None:
                refuted.unfurnishable.add(type_)
                return None
            rooms[number] = replace(rooms[number], furniture=furniture, seed=int(rng.integers(2**63)))
        return Layout(rooms, layout.corners)

    def place(
        self, layout: Layout, rng: np.random.Generator, inferences: int, least: bool = True
    ) -> dict[str, Any]:
        """Stage 2: see ``Placer.place``."""
        return self._placer.place(layout, rng, inferences, least)

    def _draw_rooms(self, request: Request, rng: np.random.Generator, refuted: "Refutations") -> Layout:
        """A layout without furniture, and without the types of room that cannot have any."""
        program, wishes = self._housing_program(request)
        atoms = program.draw(rng, wishes, _rooms_of(refuted.unfurnishable, request))
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
            self._refuse_remarks(program)
            self._housing[request.rooms, wishes] = program
        granted = [Function("granted", [Function("wish", term)]) for term in terms]
        return self._housing[request.rooms, wishes], granted

    def _unsatisfiable(
        self, request: Request, program: Program, wishes: Sequence[Symbol], refuted: "Refutations"
    ) -> Unsatisfiable:
        """The proof in words: the least part of what is wished and of what is refuted that clashes."""
        bare = _minimal(
            sorted(refuted.unfurnishable), lambda types: program.possible(wishes, _rooms_of(types, request))
        )
        clash = _minimal(wishes, lambda some: program.possible(some, _rooms_of(bare, request)))
        counts = [atom.arguments[0].arguments for atom in clash]
        wanted = " and ".join(f"{count} of type {type_}" for type_, count in counts) or "every house"
        why = f"its rules exclude {wanted} among {request.rooms} rooms"
        advice = "Ask for other counts or more rooms" if counts else "Change its .lp files"
        if bare:
            why += f" where none is of type {' or '.join(bare)}, which cannot be furnished"
            advice = "Change their sizes and clearances, or their furniture"
        return Unsatisfiable(
            f"no house of {self._grammar.name} has {request}: {why}. {advice}",
            (
                f"rooms={request.rooms}",
                *(f"types {type_}={count}" for type_, count in counts),
                *(f"no room of type {type_} can be furnished" for type_ in bare),
            ),
        )

    def _furnishing_programs(self, probe: Program) -> dict[str, Program]:
        """For each type the program that furnishes a room, with the extremes of its lengths as facts."""
        furniture: dict[str, list[str]] = {type_: [] for type_ in self.types}
        for symbol in probe.atoms("may", 4):
            furniture[_name(symbol.arguments[0])].append(_name(symbol.arguments[1]))
        for symbol in [*probe.atoms("beside", 4), *probe.atoms("around", 4)]:
            piece, companion = map(_name, symbol.arguments[:2])
            for pieces in furniture.values():
                if piece in pieces and companion not in pieces:
                    pieces.append(companion)
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
            parts = [("room", []), *named, reach, *extents]
            programs[type_] = Program(self._grammar.asp, {"this_room": type_}, parts)
        return programs

    def _refuse_remarks(self, program: Program) -> None:
        """What clingo only remarks on, and passes over, is an error where it is in the grammar's files.

        That an atom is in no rule's head is none by itself: a program holds the rules of one stage.
        """
        for remark in program.remarks:
            error = placed_error(remark)
            if str(error.file) in map(str, self._grammar.asp) and (
                remark in self._unknown_atoms or "does not occur in any rule head" not in remark
            ):
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


class Refutations:
    """What is refuted for one house. It ends with that house, so that no other depends on it."""

    def __init__(self) -> None:
        """Begin with nothing refuted."""
        self.unfurnishable: set[str] = set()
        self.guards: dict[Program, int] = {}
        self.count = 0

    def add(self, program: Program, atoms: Mapping[Symbol, bool]) -> None:
        """No layout of the program in which just these atoms hold, or fail, has a solution."""
        self.count += 1
        if program not in self.guards:
            self.guards[program] = program.guard()
        program.refute(self.guards[program], atoms)

    def __enter__(self) -> "Refutations":
        """Begin the work on a house."""
        return self

    def __exit__(self, *_: object) -> None:
        """Forget all that is refuted."""
        for program, guard in self.guards.items():
            program.forget(guard)


def _minimal(parts: Sequence[Any], possible: Callable[[Sequence[Any]], bool]) -> list[Any]:
    """Parts that are together impossible, and possible with any one of them taken away."""
    kept = list(parts)
    for part in parts:
        fewer = [other for other in kept if other is not part]
        if not possible(fewer):
            kept = fewer
    return kept


def _rooms_of(types: Iterable[str], request: Request) -> list[Symbol]:
    """The atoms that say that some room is of one of these types."""
    return [
        Function("room", [Number(number), Function(type_)])
        for type_ in sorted(types)
        for number in range(request.rooms)
    ]


def _name(symbol: Symbol) -> str:
    """A type's name: a word in lower case, the same term for clingo and for Prolog, and a word in files."""
    if not re.fullmatch("[a-z][A-Za-z0-9_]*", str(symbol)):
        raise GrammarError(f"{symbol}: a type is named by a word that begins in lower case, as in bedroom")
    return symbol.name


def _millimetres(extremes: Sequence[float]) -> list[Symbol]:
    """Least and greatest lengths in turn, as whole millimetres that exclude none of them."""
    bounds = [floor, ceil] * (len(extremes) // 2)
    return [Number(bound(1000 * metres)) for bound, metres in zip(bounds, extremes, strict=True)]
