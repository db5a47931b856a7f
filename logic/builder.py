"""From a request to a house: the two stages, and what goes between them."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache
from importlib.metadata import version
from math import ceil, floor
from typing import Any

import clingo
import msgspec
import numpy as np
from clingo import Function, Number, Symbol

from logic.errors import LimitReached
from logic.grammar import Grammar
from logic.house import House, Provenance, Rect, Room
from logic.layout import EVERY, Program
from logic.linter import Linter
from logic.messages import placed_error
from logic.placement import Cramped, Layout, Refuted, RoomLayout
from logic.proof import Prover, stays_for, wishes_for
from logic.request import Request, known

MOST_CRAMPED = 200
"""How often rooms that are drawn may fail to fit between those that stay, though others might."""


class Builder:
    """Makes houses of one grammar; it grounds each program once and keeps it."""

    def __init__(self, grammar: Grammar, cell: float = 0.0) -> None:
        """Load the grammar's files; raises ``GrammarError`` for the first thing wrong with them.

        ``cell`` is the side of a grid's cell in metres, 0 for none.
        """
        self._grammar = grammar
        linter = Linter(grammar, cell)
        if linter.errors:
            raise linter.errors[0]
        self.types = sorted(linter.furniture)
        self._placer, self._pieces = linter.placer, linter.furniture
        self._lengths = self._lengths_by_type(linter.lengths)
        probe = self._housing(1, ())
        for program in (probe, *(self._furnishing(type_) for type_ in self.types)):
            self._refuse_remarks(program)
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
        self._require_known(request)
        with Refutations() as refuted:
            layout = self.layout(request, rng, refuted)
            while True:
                try:
                    plan = self.place(layout, rng, inferences, least=refuted.count > 1)
                    return self._as_house(plan, layout, request, seed, index)
                except Cramped as proof:
                    inferences -= proof.inferences
                    self._note_cramped(proof, layout, request, refuted)
                    layout = self.layout(request, rng, refuted)
                except Refuted as proof:
                    inferences -= proof.inferences
                    if inferences <= 0:
                        raise LimitReached(f"house {index} reached its limit of inferences") from None
                    for number, clash in proof.clashes.items():
                        program, _ = self._furnishing_for(layout.rooms[number].type.name, request)
                        refuted.add(program, clash.atoms)
                    again = self._refurnished(request, layout, proof.clashes, rng, refuted)
                    layout = again or self.layout(request, rng, refuted)

    def layout(
        self, request: Request, rng: np.random.Generator, refuted: "Refutations | None" = None
    ) -> Layout:
        """Stage 1: draw a layout that is not refuted yet; raises ``Unsatisfiable`` where none is left."""
        refuted = refuted or Refutations()
        while True:
            bare = self._draw_rooms(request, rng, refuted)
            furnished = self._refurnished(request, bare, range(request.rooms), rng, refuted)
            if furnished is not None:
                return furnished

    def _refurnished(
        self,
        request: Request,
        layout: Layout,
        numbers: Iterable[int],
        rng: np.random.Generator,
        refuted: "Refutations",
    ) -> Layout | None:
        """The layout with new furniture in these rooms; None, learnt, where a type of room can have none."""
        rooms = list(layout.rooms)
        for number in numbers:
            if rooms[number].kept:
                continue
            type_ = rooms[number].type.name
            program, wishes = self._furnishing_for(type_, request)
            furniture = program.draw(rng, wishes, guard=refuted.guards.get(program))
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
        wishes = wishes_for("among", request.types)
        wishes |= stays_for(request.keep)
        program = self._housing(request.rooms, tuple(wishes.values()))
        granted, without = map(_granted, wishes.values()), _rooms_of(refuted.unfurnishable, request)
        atoms = program.draw(rng, granted, without, refuted.guards.get(program))
        if atoms is None:
            prover = Prover(self._grammar, self._placer, self._lengths)
            raise prover.unsatisfiable(request, refuted.unfurnishable, refuted.hopeless)
        types = {atom.arguments[0].number: atom.arguments[1] for atom in atoms if atom.name == "room"}
        sides = {atom.arguments[0].number: atom.arguments[1] for atom in atoms if atom.name == "side"}
        kept = {a.arguments[1].number: request.keep[a.arguments[0].number] for a in atoms if a.name == "kept"}
        rooms = [
            RoomLayout(number, types[number], sides[number], (), kept=kept.get(number))
            for number in sorted(types)
        ]
        return Layout(rooms, [atom for atom in atoms if atom.name == "corner"])

    def counts(self, request: Request, seconds: float) -> Iterator[tuple[str, int, bool]]:
        """How many layouts there are: of the rooms, and of the furniture of each type of room.

        A name, the number, and whether it is all of them: False where the seconds for each ran out.
        """
        self._require_known(request)
        wishes = tuple(wishes_for("among", request.types).values())
        program = Program(*self._housing_parts(request.rooms, wishes), arguments=EVERY)
        yield (str(request), *program.count(map(_granted, wishes), seconds))
        for type_ in self.types:
            granted = self._wants(type_, request)
            program = Program(*self._furnishing_parts(type_, granted), arguments=EVERY)
            yield (type_, *program.count(map(_granted, granted), seconds))

    def _note_cramped(self, proof: Cramped, layout: Layout, request: Request, refuted: "Refutations") -> None:
        """Exclude a hopeless order of the rooms; raises ``LimitReached`` after many that only did not fit."""
        refuted.cramped += not proof.hopeless
        if refuted.cramped == MOST_CRAMPED:
            raise LimitReached(
                f"{MOST_CRAMPED} times the rooms drawn did not fit between those that stay, though smaller "
                "ones might: try another seed, fewer rooms or smaller types"
            )
        if proof.hopeless:
            wishes = wishes_for("among", request.types) | stays_for(request.keep)
            sides = {Function("side", [Number(room.number), room.side]): True for room in layout.rooms}
            stays = {
                Function("kept", [Number(request.keep.index(room.kept)), Number(room.number)]): True
                for room in layout.rooms
                if room.kept
            }
            order = sides | stays | dict.fromkeys(layout.corners, True)
            refuted.hopeless.append(order)
            refuted.add(self._housing(request.rooms, tuple(wishes.values())), order)

    def _require_known(self, request: Request) -> None:
        """Refuse names of types and pieces that the grammar does not have."""
        for type_ in (*request.types, *(kept.room.type for kept in request.keep)):
            known("room type", type_, self.types)
        for name in request.furniture:
            type_, _, piece = name.rpartition(".")
            if type_:
                known("room type", type_, self.types)
            pieces = [self._pieces[type_]] if type_ else self._pieces.values()
            known("piece", piece, {each for room in pieces for each in room})

    @cache  # noqa: B019 (a builder lives as long as its process)
    def _housing(self, rooms: int, wishes: tuple[Symbol, ...]) -> Program:
        """The program of a house's rooms, with these wishes to be granted."""
        return Program(*self._housing_parts(rooms, wishes))

    def _housing_parts(self, rooms: int, wishes: tuple[Symbol, ...]) -> tuple[Any, ...]:
        parts = [("house", []), *((wish.name, wish.arguments) for wish in wishes)]
        return self._grammar.asp, {"rooms": rooms}, parts

    def _furnishing_for(self, type_: str, request: Request) -> tuple[Program, list[Symbol]]:
        """The program that furnishes a room of this type, and what is to be granted in it."""
        wishes = self._wants(type_, request)
        return self._furnishing(type_, wishes), [_granted(wish) for wish in wishes]

    def _wants(self, type_: str, request: Request) -> tuple[Symbol, ...]:
        """What a request wishes of the furniture in a room of this type."""
        wants = {name: n for name, n in request.wants(type_).items() if name in self._pieces[type_]}
        return tuple(wishes_for("has", wants).values())

    @cache  # noqa: B019
    def _furnishing(self, type_: str, wishes: tuple[Symbol, ...] = ()) -> Program:
        """The program of a room's furniture, with the extremes of its lengths as facts."""
        return Program(*self._furnishing_parts(type_, wishes))

    def _furnishing_parts(self, type_: str, wishes: tuple[Symbol, ...]) -> tuple[Any, ...]:
        facts = [(fact.name, fact.arguments) for fact, _ in self._lengths[type_]]
        parts = [("room", []), *facts, *((wish.name, wish.arguments) for wish in wishes)]
        return self._grammar.asp, {"this_room": type_}, parts

    def _lengths_by_type(self, lengths: dict[str, Any]) -> dict[str, list[tuple[Symbol, Symbol]]]:
        """For each room type what stage 1 knows of lengths, each fact with the clause that it comes from."""
        named = [
            (
                Function("length", [Function(name), Number(floor(1000 * m))]),
                Function("length", [Function(name)]),
            )
            for name, m in lengths["lengths"].items()
        ]
        facts = {}
        for type_ in self.types:
            kind = Function(type_)
            reach = Function("reach", [kind, *_millimetres(lengths["rooms"][type_])])
            facts[type_] = [*named, (reach, Function("size", [kind]))]
            for piece, extremes in lengths["pieces"][type_].items():
                extent = Function("extent", [Function(piece), *_millimetres(extremes)])
                facts[type_].append((extent, Function("size", [kind, Function(piece)])))
        return facts

    def _refuse_remarks(self, program: Program) -> None:
        """What clingo only remarks on, and passes over, is an error where it is in the grammar's files.

        That an atom is in no rule's head is none: a program holds the rules of one stage.
        """
        for remark in program.remarks:
            error = placed_error(remark)
            own = str(error.file) in map(str, self._grammar.asp)
            if own and "does not occur in any rule head" not in remark:
                raise error

    def _as_house(
        self, plan: dict[str, Any], layout: Layout, request: Request, seed: int, index: int
    ) -> House:
        provenance = Provenance(
            grammar=self._grammar.name,
            grammar_hash=self._grammar.hash,
            request=request.to_dict(),
            seed=seed,
            index=index,
            versions=self.versions,
        )
        floor = msgspec.convert(plan["floor"], Rect)
        planned = [msgspec.convert(room, Room | None) for room in plan["rooms"]]
        if request.keep:
            floor, *planned = (rect and _moved(rect, *plan["corner"]) for rect in (floor, *planned))
        rooms = tuple(
            room.kept.room if room.kept else new for room, new in zip(layout.rooms, planned, strict=True)
        )
        return House(floor, rooms, provenance=provenance)


class Refutations:
    """What is refuted for one house. It ends with that house, so that no other depends on it."""

    def __init__(self) -> None:
        """Begin with nothing refuted."""
        self.unfurnishable: set[str] = set()
        self.hopeless: list[Mapping[Symbol, bool]] = []
        self.guards: dict[Program, int] = {}
        self.count = 0
        self.cramped = 0

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


def _moved(rect: Any, x: float, y: float) -> Any:
    """A rectangle moved, with all that it holds."""
    changes: dict[str, Any] = {"x": rect.x + x, "y": rect.y + y}
    if hasattr(rect, "children"):
        changes["children"] = tuple(_moved(child, x, y) for child in rect.children)
    if hasattr(rect, "door"):
        changes["door"] = _moved(rect.door, x, y)
    return msgspec.structs.replace(rect, **changes)


def _granted(wish: Symbol) -> Symbol:
    return Function("granted", [wish])


def _rooms_of(types: Iterable[str], request: Request) -> list[Symbol]:
    """The atoms that say that some room of one of these types is to be furnished."""
    return [
        Function("bare", [Number(number), Function(type_)])
        for type_ in sorted(types)
        for number in range(request.rooms)
    ]


def _millimetres(extremes: Sequence[float]) -> list[Symbol]:
    """Least and greatest lengths in turn, as whole millimetres that exclude none of them."""
    bounds = [floor, ceil] * (len(extremes) // 2)
    return [Number(bound(1000 * metres)) for bound, metres in zip(bounds, extremes, strict=True)]
