"""From a request to a house: the two stages, and what goes between them."""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import replace
from importlib.metadata import version
from typing import Any

import clingo
import msgspec
import numpy as np
from clingo import Function, Number, Symbol

from logic.errors import LimitReached, OutOfInferences, RequestError
from logic.generation.given_plan import OwnPlanner
from logic.generation.promised import promised
from logic.generation.shared_walls import Planner
from logic.generation.units import UnitsPlanner
from logic.grammar import Grammar
from logic.house.house import House
from logic.house.parts import Provenance, Rect
from logic.house.promises import Promises
from logic.house.star import Star, StarRoom
from logic.language.loaded import LoadedGrammar
from logic.layout.account import FURNITURE, LAYOUT
from logic.layout.program import Nogood, Program
from logic.layout.terms import to_furnish
from logic.placement.placer import Infeasible, Layout, Misfit, RoomLayout
from logic.proofs.proof import Prover
from logic.request.request import Request, known
from logic.spelling import unknown

MOST_MISFITS = 200
"""How often sampled rooms may fail to fit between the fixed rooms, though others might fit."""


class Builder:
    """Makes houses of one grammar; it grounds each program once and keeps it."""

    def __init__(self, grammar: Grammar, cell: float = 0.0, loaded: LoadedGrammar | None = None) -> None:
        """Load the grammar's files, unless they are; raises ``GrammarError`` for the first thing wrong.

        ``cell`` is the side of a grid's cell in metres, 0 for none.
        """
        self.grammar = grammar
        self.loaded = loaded or LoadedGrammar(grammar, cell)
        if self.loaded.errors:
            raise self.loaded.errors[0]
        self.placer, self.programs = self.loaded.placer, self.loaded.programs
        self.account = self.placer.account
        self.prover = Prover(grammar, self.placer, self.loaded.lengths, self.loaded.walls)
        if cell and self.loaded.depths:
            raise RequestError("cell: units of a house lie on no grid yet: leave cell out")
        planner = UnitsPlanner if self.loaded.depths else Planner
        self.planner = planner(grammar, self.loaded, self.prover)
        self._own: OwnPlanner | None = None
        self._promises: dict[Program, Promises] = {}
        self.versions = {
            "vitruvius": version("vitruvius"),
            "clingo": clingo.__version__,
            "swi-prolog": self.placer.version(),
        }

    def house(self, request: Request, seed: int, index: int, inferences: int) -> House:
        """Make house ``index``: a star, see ``made``, or a plan, see ``plans.py``."""
        self.account.begin()
        try:
            if not (request.plan or self.grammar.shares_walls):
                return self.made(request, seed, index, inferences)[0]
            planner = self.planner_of(request)
            plan = planner.made(request, np.random.default_rng([seed, index]), inferences)
            return msgspec.structs.replace(plan, provenance=self._provenance(request, seed, index))
        except OutOfInferences:
            late = f"house {index} reached its limit of {inferences} inferences: raise it with --inferences"
            raise LimitReached(f"{late}. {self.account}") from None

    def planner_of(self, request: Request) -> Planner:
        """Who makes the plans of a request: where it gives their rooms, see ``own_planner.py``."""
        if not self.grammar.shares_walls:
            raise RequestError(
                f"plan: a house of the grammar {self.grammar.name} is a star around a main room: take rules "
                "for rooms that share walls, as --grammar home"
            )
        self.require_known(request)
        if request.plan is None:
            return self.planner
        if self._own is None or self._own.plan != request.plan:
            self._own = OwnPlanner(self.grammar, self.loaded, request.plan)
        return self._own

    def made(self, request: Request, seed: int, index: int, inferences: int) -> tuple[House, Layout]:
        """Star ``index``, a function of the grammar, the request, the seed and the index; and its layout.

        Raises ``RequestError`` for an unknown type, ``Unsatisfiable`` where it is proved that there is no
        such house, ``LimitReached`` past this number of Prolog inferences.
        """
        rng = np.random.default_rng([seed, index])
        self.require_known(request)
        nogoods = Nogoods()
        layout = self.layout(request, rng, nogoods)
        while True:
            try:
                plan = self.place(layout, rng, inferences, minimal=nogoods.count > 1)
                return self._as_house(plan, layout, request, seed, index), layout
            except Misfit as proof:
                inferences -= proof.inferences
                self._learn_misfit(proof, layout, request, nogoods)
                layout = self.layout(request, rng, nogoods)
            except Infeasible as proof:
                inferences -= proof.inferences
                if inferences <= 0:
                    raise OutOfInferences from None
                for number, conflict in proof.conflicts.items():
                    self.account.refuted(conflict.clauses, furniture=True)
                    program, _ = self.programs.furniture_for(layout.rooms[number].type.name, request)
                    nogoods.add(program, conflict.atoms)
                again = self._refurnished(request, layout, proof.conflicts, rng, nogoods)
                layout = again or self.layout(request, rng, nogoods)

    def layout(self, request: Request, rng: np.random.Generator, nogoods: "Nogoods | None" = None) -> Layout:
        """Stage 1: sample a layout outside the nogoods; raises ``Unsatisfiable`` where none is left."""
        nogoods = nogoods or Nogoods()
        while True:
            bare = self._sample_rooms(request, rng, nogoods)
            furnished = self._refurnished(request, bare, range(request.rooms), rng, nogoods)
            if furnished is not None:
                return furnished

    def place(
        self, layout: Layout, rng: np.random.Generator, inferences: int, minimal: bool = True
    ) -> dict[str, Any]:
        """Stage 2: see ``Placer.place``."""
        return self.placer.place(layout, rng, inferences, minimal)

    def _sample_rooms(self, request: Request, rng: np.random.Generator, nogoods: "Nogoods") -> Layout:
        """A layout without furniture, and without the types of room that cannot have any."""
        program, assumed = self.programs.rooms_for(request)
        self.account.at(LAYOUT, "the types and sides of the rooms (clingo)")
        without = [
            atom for type_ in sorted(nogoods.unfurnishable) for atom in to_furnish(type_, request.rooms)
        ]
        atoms = program.sample(rng, assumed, without, nogoods.of[program])
        if atoms is None:
            raise self.prover.unsatisfiable(request, nogoods.unfurnishable, nogoods.orders)
        self.account.sampled()
        named = defaultdict[str, list[Symbol]](list)
        for atom in atoms:
            named[atom.name].append(atom)
        types, sides = (
            {atom.arguments[0].number: atom.arguments[1] for atom in named[name]} for name in ("room", "side")
        )
        fixed = {
            atom.arguments[1].number: request.fixed[atom.arguments[0].number] for atom in named["numbered"]
        }
        rooms = [
            RoomLayout(number, type_, sides[number], (), fixed=fixed.get(number))
            for number, type_ in sorted(types.items())
        ]
        return Layout(rooms, named["corner"])

    def _refurnished(
        self,
        request: Request,
        layout: Layout,
        numbers: Iterable[int],
        rng: np.random.Generator,
        nogoods: "Nogoods",
    ) -> Layout | None:
        """The layout with new furniture in these rooms; None, learnt, where a type of room can have none."""
        rooms = list(layout.rooms)
        for number in numbers:
            if rooms[number].fixed:
                continue
            type_ = rooms[number].type.name
            program, assumed = self.programs.furniture_for(type_, request)
            self.account.at(FURNITURE, f"the furniture of a {type_} (clingo)")
            furniture = program.sample(rng, assumed, nogoods=nogoods.of[program])
            if furniture is None:
                nogoods.unfurnishable.add(type_)
                return None
            rooms[number] = replace(rooms[number], furniture=furniture, seed=int(rng.integers(2**63)))
        return Layout(rooms, layout.corners)

    def _learn_misfit(self, proof: Misfit, layout: Layout, request: Request, nogoods: "Nogoods") -> None:
        """Exclude an infeasible order of the rooms; raises ``LimitReached`` after many failures."""
        self.account.refuted(())
        if proof.infeasible:
            order = {Function("side", [Number(room.number), room.side]): True for room in layout.rooms}
            for room in layout.rooms:
                if room.fixed:
                    number = request.fixed.index(room.fixed)
                    order[Function("numbered", [Number(number), Number(room.number)])] = True
            order |= dict.fromkeys(layout.corners, True)
            nogoods.orders.append(order)
            nogoods.add(self.programs.rooms_for(request)[0], order)
            return
        nogoods.misfits += 1
        if nogoods.misfits == MOST_MISFITS:
            raise LimitReached(
                f"{MOST_MISFITS} times the sampled rooms did not fit between the fixed rooms, though "
                "smaller ones might: try another seed, fewer rooms or smaller types. "
                f"{self.account.refutations}"
            )

    def require_known(self, request: Request) -> None:
        """Refuse names of types and pieces that the grammar does not have."""
        furniture = self.loaded.furniture
        if request.rooms > self.loaded.most_rooms and not request.plan:
            raise RequestError(
                f"rooms: a house of the grammar {self.grammar.name} has at most {self.loaded.most_rooms}, by "
                f"its topology, not {request.rooms}"
            )
        for type_ in (*request.types, *(fixed.room.type for fixed in request.fixed)):
            known("room type", type_, furniture)
        for room in request.plan.rooms if request.plan else ():
            if room.type and room.type not in furniture:
                raise RequestError(f"plan: {room.name}: {unknown('room type', room.type, furniture)}")
        for name in request.furniture:
            type_, _, piece = name.rpartition(".")
            if type_:
                known("room type", type_, furniture)
            pieces = [furniture[type_]] if type_ else furniture.values()
            known("piece", piece, {each for room in pieces for each in room})

    def _as_house(
        self, plan: dict[str, Any], layout: Layout, request: Request, seed: int, index: int
    ) -> House:
        floor = msgspec.convert(plan["floor"], Rect)
        planned = [msgspec.convert(room, StarRoom | None) for room in plan["rooms"]]
        if request.fixed:
            floor, *planned = (rect and _moved(rect, *plan["corner"]) for rect in (floor, *planned))
        rooms = tuple(
            room.fixed.room if room.fixed else new for room, new in zip(layout.rooms, planned, strict=True)
        )
        return House.of_star(Star(floor, rooms), provenance=self._provenance(request, seed, index))

    def promises(self, request: Request) -> Promises:
        """What the houses of a request promise."""
        stars = not self.grammar.shares_walls
        program = self.programs.rooms_for(request)[0] if stars else self.planner_of(request).stated(request)
        if program not in self._promises:
            found = self.loaded.extremes, self.placer.metres(self.loaded.furniture)
            self._promises[program] = promised(program, *found, self.grammar.shares_walls)
        return self._promises[program]

    def _provenance(self, request: Request, seed: int, index: int) -> Provenance:
        return Provenance(
            grammar=self.grammar.name,
            grammar_hash=self.grammar.hash,
            request=request.to_dict(),
            seed=seed,
            index=index,
            versions=self.versions,
            promises=self.promises(request),
        )


class Nogoods:
    """What is proved infeasible for one house. It ends with that house, so that no other depends on it."""

    def __init__(self) -> None:
        """Begin with none."""
        self.unfurnishable: set[str] = set()
        """Types of room that cannot be furnished."""
        self.orders: list[Nogood] = []
        """Orders of the rooms that do not fit between the fixed rooms, whatever the sizes."""
        self.of: dict[Program, list[Nogood]] = defaultdict(list)
        self.count = 0
        self.misfits = 0

    def add(self, program: Program, atoms: Nogood) -> None:
        """No layout of the program in which just these atoms hold, or fail, has a solution."""
        self.count += 1
        self.of[program].append(atoms)


def _moved(rect: Any, x: float, y: float) -> Any:
    """A rectangle moved, with all that it holds."""
    changes: dict[str, Any] = {"x": rect.x + x, "y": rect.y + y}
    if hasattr(rect, "children"):
        changes["children"] = tuple(_moved(child, x, y) for child in rect.children)
    if hasattr(rect, "door"):
        changes["door"] = _moved(rect.door, x, y)
    return msgspec.structs.replace(rect, **changes)
