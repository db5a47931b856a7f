"""Stars: rooms around a main room, each with one door to the main room.

Stage 1 samples types and sides, then the furniture of each room. Stage 2 places all of it at once.
"""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import msgspec
import numpy as np
from clingo import Function, Number

from vitruvius.logic.errors import LimitReached, OutOfInferences
from vitruvius.logic.generation.evidence import NoLayout
from vitruvius.logic.generation.maker import Maker
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Rect
from vitruvius.logic.house.star import Star
from vitruvius.logic.layout.account import EASE, FURNITURE, LAYOUT
from vitruvius.logic.layout.program import Nogood, Program, TooMany
from vitruvius.logic.layout.terms import to_furnish
from vitruvius.logic.placement.layout import Layout
from vitruvius.logic.placement.placer import Infeasible, Misfit
from vitruvius.logic.placement.plan import StarPlan
from vitruvius.logic.placement.prolog import Term
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.spelling import article

MOST_MISFITS = 200
"""Number of failures of sampled rooms to fit together, though others might, before a house fails."""

MOST_AREAS = 300
"""Number of sampled types and sides without a permitted area, though others might have one."""


class StarMaker(Maker):
    """Generator of stars by one grammar."""

    making: Layout | None = None
    """Layout of the last house."""

    def made(self, request: HouseRequest, rng: np.random.Generator, inferences: int) -> House:
        """See ``Maker.made``."""
        nogoods = Nogoods()
        self._programs.begin()
        layout = self.layout(request, rng, nogoods)
        while True:
            try:
                plan = self._placer.place(layout, rng, inferences, minimal=nogoods.unfurnished > 1)
                self.making = _sized(layout, plan.sizes)
                return house(plan, layout, request)
            except Misfit as proof:
                inferences -= proof.inferences
                self._learn_misfit(proof, layout, request, nogoods)
                layout = self.layout(request, rng, nogoods)
            except Infeasible as proof:
                inferences -= proof.inferences
                if inferences <= 0:
                    raise OutOfInferences from None
                for number, conflict in proof.conflicts.items():
                    self._placer.account.refuted(conflict.clauses, furniture=True)
                    program, _ = self._programs.furniture_for(layout.rooms[number].type.name, request)
                    nogoods.add(program, conflict.atoms)
                    nogoods.unfurnished += 1
                again = self._refurnished(request, layout, proof.conflicts, rng, nogoods)
                layout = again or self.layout(request, rng, nogoods)

    def layout(
        self, request: HouseRequest, rng: np.random.Generator, nogoods: "Nogoods | None" = None
    ) -> Layout:
        """Sample a layout of stage 1 outside the nogoods. Raises ``NoLayout`` if none is left."""
        nogoods = nogoods or Nogoods()
        while True:
            unfurnished = self._sample_rooms(request, rng, nogoods)
            furnished = self._refurnished(request, unfurnished, range(request.rooms), rng, nogoods)
            if furnished is not None:
                return furnished

    def _sample_rooms(self, request: HouseRequest, rng: np.random.Generator, nogoods: "Nogoods") -> Layout:
        """Return a layout without furniture, and without the room types that cannot have any."""
        program, assumed = self._programs.rooms_for(request)
        without = [
            atom for type_ in sorted(nogoods.unfurnishable) for atom in to_furnish(type_, request.rooms)
        ]
        while True:
            self._placer.account.at(LAYOUT, "the types and sides of the rooms (clingo)")
            atoms = program.sample(rng, assumed, without, nogoods.of[program])
            if atoms is None:
                raise NoLayout(request, self.feasibility, nogoods.unfurnishable, nogoods.orders)
            self._placer.account.sampled()
            layout = Layout.unfurnished(atoms, request.fixed)
            conflict = self._loaded.has_area and self._placer.area_conflict(
                layout, request.fixed, sorted(self._loaded.furniture)
            )
            if not conflict:
                return layout
            self._placer.account.refuted(conflict.clauses)
            nogoods.add(program, conflict.atoms)
            if len(nogoods.of[program]) > MOST_AREAS:
                raise LimitReached(
                    f"{MOST_AREAS} times {self._misfit(request)}. {self._placer.account.refutations}"
                )

    def _refurnished(
        self,
        request: HouseRequest,
        layout: Layout,
        numbers: Iterable[int],
        rng: np.random.Generator,
        nogoods: "Nogoods",
    ) -> Layout | None:
        """Return the layout with new furniture in these rooms.

        If a room type can have no furniture, add the type to the nogoods and return None.
        """
        rooms = list(layout.rooms)
        for number in numbers:
            if rooms[number].fixed:
                continue
            type_ = rooms[number].type.name
            program, assumed = self._programs.furniture_for(type_, request, rng=rng)
            self._placer.account.at(FURNITURE, f"the furniture of {article(type_)} (clingo)")
            try:
                furniture = program.sample(rng, assumed, nogoods=nogoods.of[program])
            except TooMany:
                ease = EASE[FURNITURE]
                raise LimitReached(
                    f"no furniture of {article(type_)} was found in time: to ease it, {ease}"
                ) from None
            if furniture is None:
                nogoods.unfurnishable.add(type_)
                return None
            rooms[number] = replace(rooms[number], furniture=furniture, seed=int(rng.integers(2**63)))
        return Layout(rooms, layout.corners)

    def _learn_misfit(self, proof: Misfit, layout: Layout, request: HouseRequest, nogoods: "Nogoods") -> None:
        """Exclude an infeasible order of the rooms. Raises ``LimitReached`` after many failures."""
        of_area = self._loaded.has_area and not request.fixed
        self._placer.account.refuted([Function("house_area")] if of_area else ())
        if proof.infeasible:
            order = {Function("side", [Number(room.number), room.side]): True for room in layout.rooms}
            for room in layout.rooms:
                if room.fixed:
                    number = request.fixed.index(room.fixed)
                    order[Function("numbered", [Number(number), Number(room.number)])] = True
            order |= dict.fromkeys(layout.corners, True)
            nogoods.orders.append(order)
            nogoods.add(self._programs.rooms_for(request)[0], order)
            return
        nogoods.misfits += 1
        if nogoods.misfits == MOST_MISFITS:
            raise LimitReached(
                f"{MOST_MISFITS} times {self._misfit(request)}. {self._placer.account.refutations}"
            )

    def _misfit(self, request: HouseRequest) -> str:
        """Return a message about rooms that do not fit, with advice."""
        area = "the sampled rooms did not leave the main room the area that is left of house_area/2"
        if not request.fixed:
            return f"{area}, though others might: try another seed, number of rooms, or wider bounds"
        between = "the sampled rooms did not fit between the fixed rooms"
        found = (
            f"{between}, or {area.removeprefix('the sampled rooms ')}" if self._loaded.has_area else between
        )
        return f"{found}, though smaller ones might: try another seed, fewer rooms or smaller types"


def _sized(layout: Layout, sizes: Iterable[Sequence[Any]]) -> Layout:
    """Return a layout with room sizes that fit the area of the house: number, width, depth."""
    given = {number: Term("size", float(width), float(depth)) for number, width, depth in sizes}
    return replace(
        layout, rooms=[replace(room, given=given.get(room.number, room.given)) for room in layout.rooms]
    )


def house(plan: StarPlan, layout: Layout, request: HouseRequest) -> House:
    """Return the house of a layout with the places from stage 2."""
    floor: Rect = _moved(plan.floor, *plan.corner) if request.fixed else plan.floor
    planned = [room and _moved(room, *plan.corner) for room in plan.rooms] if request.fixed else plan.rooms
    rooms = [room.fixed.room if room.fixed else new for room, new in zip(layout.rooms, planned, strict=True)]
    return House.of_star(Star(floor, tuple(filter(None, rooms))))


class Nogoods:
    """Proofs of infeasibility for one house. They end with that house, so that no other depends on them."""

    def __init__(self) -> None:
        """Begin without proofs."""
        self.unfurnishable: set[str] = set()
        """Room types that cannot be furnished."""
        self.orders: list[Nogood] = []
        """Orders of the rooms that do not fit between the fixed rooms, at any sizes."""
        self.of: dict[Program, list[Nogood]] = defaultdict(list)
        self.unfurnished = 0
        """Number of rooms without places for their furniture."""
        self.misfits = 0

    def add(self, program: Program, atoms: Nogood) -> None:
        """Exclude all layouts of the program in which just these atoms hold, or fail."""
        self.of[program].append(atoms)


def _moved(rect: Any, x: float, y: float) -> Any:
    """Return a moved rectangle with all that it holds."""
    changes: dict[str, Any] = {"x": rect.x + x, "y": rect.y + y}
    if hasattr(rect, "children"):
        changes["children"] = tuple(_moved(child, x, y) for child in rect.children)
    if hasattr(rect, "door"):
        changes["door"] = _moved(rect.door, x, y)
    return msgspec.structs.replace(rect, **changes)
