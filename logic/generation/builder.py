"""From a request to a house: the two stages, and the data between them."""

from collections.abc import Iterable
from dataclasses import replace
from importlib.metadata import version
from typing import Any
from weakref import WeakKeyDictionary

import clingo
import msgspec
import numpy as np

from vitruvius.logic.errors import LimitReached, OutOfInferences, Reason, RequestError
from vitruvius.logic.generation.brief import brief_maker
from vitruvius.logic.generation.feasibility import Feasibility
from vitruvius.logic.generation.given_plan import given_plan_maker
from vitruvius.logic.generation.loop import Maker, Work
from vitruvius.logic.generation.promises import labelled, promises_of, with_openings
from vitruvius.logic.generation.shared_walls import PlanRules, exact_areas_maker, plan_maker
from vitruvius.logic.generation.star import star_maker
from vitruvius.logic.generation.units import units_maker
from vitruvius.logic.grammar import Grammar
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Provenance
from vitruvius.logic.house.promises import Promises
from vitruvius.logic.language.loaded import LoadedGrammar
from vitruvius.logic.layout.program import Program
from vitruvius.logic.placement.lengths import metres
from vitruvius.logic.request.brief import Brief
from vitruvius.logic.request.counts import known
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.request.own_plan import OwnPlan
from vitruvius.logic.spelling import unknown


class Builder:
    """Generator of houses of one grammar. It grounds each program once and keeps it."""

    def __init__(self, grammar: Grammar, cell: float = 0.0, loaded: LoadedGrammar | None = None) -> None:
        """Load the grammar's files, without clingo's remarks, unless they are loaded.

        ``cell`` is the side of a grid's cell in metres, 0 for none. Raises ``GrammarError`` for the first
        mistake.
        """
        self.grammar = grammar
        self.loaded = loaded or LoadedGrammar(grammar, cell, remarks=False)
        if self.loaded.errors:
            raise self.loaded.errors[0]
        self.placer, self.programs = self.loaded.placer, self.loaded.programs
        self.account = self.placer.account
        self._gave_way: dict[tuple[Reason, ...], Builder] = {}
        self.at_work = self
        """Builder that made the last house: this builder, or one without some typical rules."""
        if cell and self.loaded.depths:
            raise RequestError("cell: houses of units do not support a grid: leave cell out")
        feasibility = Feasibility(grammar, self.placer, self.loaded.lengths, self.loaded.house_facts)
        if grammar.shares_walls:
            rules = PlanRules(grammar, self.loaded, feasibility, self.programs)
            self.maker = (units_maker if self.loaded.depths else plan_maker)(rules)
        else:
            self.maker = star_maker(self.loaded, feasibility)
        self._of_given: tuple[Brief | OwnPlan, Maker] | None = None
        self.origin: Any = None
        """Origin of the last house: its layout and programs."""
        self._promises = WeakKeyDictionary[Program | Maker, Promises]()
        self.versions = {
            "vitruvius": version("vitruvius"),
            "clingo": clingo.__version__,
            "swi-prolog": self.placer.version(),
        }

    def giving_way(self, rules: Iterable[Reason]) -> "Builder":
        """Return the builder of the same grammar without these typical rules, which now does the work."""
        left_out = tuple(sorted({*self.grammar.gave_way, *rules}, key=str))
        if left_out not in self._gave_way:
            grammar = replace(self.grammar, gave_way=left_out)
            self._gave_way[left_out] = Builder(grammar, self.loaded.placer.cell)
        self.at_work = self._gave_way[left_out]
        self.at_work.begin()
        return self.at_work

    def begin(self) -> None:
        """Begin another answer, with the grammar's lengths."""
        self.at_work = self
        self.placer.load()
        self.account.begin()

    def house(self, request: HouseRequest, seed: int, index: int, thorough: bool = False) -> House:
        """Generate house ``index``, a function of the grammar, the request, the seed and the index.

        ``thorough`` considers all sizes that areas allow, and requires ``decides_areas``.

        Raises ``RequestError`` for an unknown type, ``NoLayout`` if there is provably no such house, and
        ``LimitReached`` after the request's number of Prolog inferences.
        """
        self.account.begin()
        try:
            maker = self._thorough_maker(request) if thorough else self.maker_of(request)
            work = Work(np.random.default_rng([seed, index]), request.inferences)
            made, self.origin = maker.made(request, work)
        except OutOfInferences:
            late = f"house {index} reached its limit of {request.inferences} inferences"
            raise LimitReached(f"{late}: raise it with --inferences. {self.account}") from None
        return msgspec.structs.replace(made, provenance=self._provenance(request, seed, index))

    def decides_areas(self, request: HouseRequest) -> bool:
        """Return True if houses of a request can have all sizes that the areas of their rooms allow.

        That holds without a grid, a given plan, units, and areas of several rooms together.
        """
        several = self.loaded.has_area or metres(self.placer, self.loaded.furniture)["wholes"]
        return not (
            several or request.plan or request.cell or self.loaded.depths or not self.grammar.shares_walls
        )

    def _thorough_maker(self, request: HouseRequest) -> Maker:
        if request.brief:
            return brief_maker(self.grammar, self.loaded, request.brief, thorough=True)
        return exact_areas_maker(self.grammar, self.loaded)

    def maker_of(self, request: HouseRequest) -> Maker:
        """Return the generator of the houses of a request, for a plan or a brief if it has one."""
        if request.given and not self.grammar.shares_walls:
            raise RequestError(
                f"{'plan' if request.plan else 'brief'}: a house of the grammar {self.grammar.name} is a "
                "star around a main room: use a grammar whose rooms share walls, as --grammar home"
            )
        self.require_known(request)
        given = request.given
        if given is None:
            return self.maker
        if self._of_given is None or self._of_given[0] != given:
            rules = self.grammar, self.loaded
            made = brief_maker(*rules, given) if isinstance(given, Brief) else given_plan_maker(*rules, given)
            self._of_given = given, made
        return self._of_given[1]

    def require_known(self, request: HouseRequest) -> None:
        """Raise ``RequestError`` for types and pieces that the grammar does not have."""
        furniture = self.loaded.furniture
        if request.rooms > self.loaded.most_rooms and not request.given:
            raise RequestError(
                f"rooms: a house of the grammar {self.grammar.name} has at most {self.loaded.most_rooms}, by "
                f"its topology, not {request.rooms}"
            )
        for type_ in (*request.types, *(fixed.room.type for fixed in request.fixed)):
            known("room type", type_, furniture)
        for room in request.plan.rooms if request.plan else ():
            if room.type and room.type not in furniture:
                raise RequestError(f"plan: {room.name}: {unknown('room type', room.type, furniture)}")
        for number, room in enumerate(request.brief.rooms if request.brief else ()):
            if room.type and room.type not in furniture:
                raise RequestError(
                    f"brief: rooms[{number}] ({room.name}): {unknown('room type', room.type, furniture)}"
                )
        for name in request.furniture:
            type_, _, piece = name.rpartition(".")
            if type_:
                known("room type", type_, furniture)
            pieces = [furniture[type_]] if type_ else furniture.values()
            known("piece", piece, {each for room in pieces for each in room})

    def promises(self, request: HouseRequest, of_brief: Program | None = None) -> Promises:
        """Return the promises of the houses of a request.

        ``of_brief``: program of a house by its brief. No other program has the facts of the brief.
        """
        maker = self.maker_of(request)
        program = of_brief or maker.stated(request)
        key = maker if request.brief else program
        if key not in self._promises:
            pieces = sorted({piece for pieces in self.loaded.furniture.values() for piece in pieces})
            found = self.loaded.extremes, metres(self.placer, self.loaded.furniture, pieces)
            self._promises[key] = promises_of(
                program, *found, self.grammar.shares_walls, stated=bool(request.brief or request.plan)
            )
        stated = self._promises[key]
        if request.plan and any(door.opening for door in request.plan.doors):
            stated = with_openings(stated, request.plan)
        labels = {room.label for room in request.brief.rooms if room.label} if request.brief else ()
        return labelled(stated, labels) if labels else stated

    def _provenance(self, request: HouseRequest, seed: int, index: int) -> Provenance:
        return Provenance(
            grammar=self.grammar.name,
            grammar_hash=self.grammar.hash,
            request=request.to_dict(),
            seed=seed,
            index=index,
            versions=self.versions,
            promises=self.promises(request, self.origin.program if request.brief else None),
            gave_way=tuple(map(self.grammar.cited, self.grammar.gave_way)),
        )
