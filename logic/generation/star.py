"""Stars: rooms around a main room, each with one door to the main room.

Stage 1 samples types and sides, then the furniture of each room. Stage 2 places all of it at once.
"""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import msgspec
from clingo import Function, Number

from vitruvius.logic.errors import LimitReached
from vitruvius.logic.generation.feasibility import Feasibility
from vitruvius.logic.generation.loop import Maker, NoLayout, Stages, Work, made
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Rect
from vitruvius.logic.house.star import Star
from vitruvius.logic.language.loaded import LoadedGrammar
from vitruvius.logic.layout.account import FURNITURE, LAYOUT, REMEDIES
from vitruvius.logic.layout.program import Nogood, Program, TooMany
from vitruvius.logic.layout.terms import to_furnish
from vitruvius.logic.placement.layout import Layout
from vitruvius.logic.placement.placer import Failure, Infeasible, Misfit
from vitruvius.logic.placement.plan import StarPlan
from vitruvius.logic.placement.prolog import Term
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.spelling import article

MOST_MISFITS = 200
"""Number of failures of sampled rooms to fit together, though others might, before a house fails."""

MOST_AREAS = 300
"""Number of sampled types and sides without a permitted area, though others might have one."""


def star_maker(loaded: LoadedGrammar, feasibility: Feasibility) -> Maker:
    """Return the generator of stars by one grammar."""

    def star(request: HouseRequest, work: Work) -> tuple[House, Layout]:
        loaded.programs.begin()
        draft = StarDraft(loaded, feasibility, request, work)
        return made(Stages(draft.sample, draft.place, draft.built, draft.learn))

    return Maker(feasibility, star, lambda request: loaded.programs.rooms_for(request)[0])


class StarDraft:
    """Star in progress: its stages, and the nogoods learned from their failures.

    The nogoods are forgotten after the house, so that no other house depends on them.
    """

    def __init__(
        self, loaded: LoadedGrammar, feasibility: Feasibility, request: HouseRequest, work: Work
    ) -> None:
        """Begin without failures."""
        self._loaded, self._feasibility, self._request, self._work = loaded, feasibility, request, work
        self._placer, self._programs = loaded.placer, loaded.programs
        self.unfurnishable: set[str] = set()
        """Room types that cannot be furnished."""
        self.orders: list[Nogood] = []
        """Orders of the rooms that do not fit between the fixed rooms, at any sizes."""
        self.nogoods: dict[Program, list[Nogood]] = defaultdict(list)
        """Truth values of atoms, by program: no layout has all of these values."""
        self.unfurnished = 0
        """Number of rooms without places for their furniture."""
        self.misfits = 0

    def sample(self) -> Layout:
        """Sample a furnished layout outside the nogoods. Raises ``NoLayout`` if none is left."""
        while True:
            unfurnished = self._sample_rooms()
            furnished = self._refurnished(unfurnished, range(self._request.rooms))
            if furnished is not None:
                return furnished

    def place(self, layout: Layout) -> StarPlan:
        """Return the places of rooms and furniture: see ``Placer.place``."""
        minimal = self.unfurnished > 1
        return self._placer.place(layout, self._work.rng, self._work.inferences, minimal=minimal)

    def built(self, layout: Layout, plan: StarPlan) -> tuple[House, Layout]:
        """Return the house, and its layout with sizes."""
        return house(plan, layout, self._request), _sized(layout, plan.sizes)

    def learn(self, layout: Layout, failure: Failure) -> Layout | None:
        """Exclude an order of rooms, or furniture; return the layout with other furniture, or None."""
        match failure:
            case Misfit():
                self._work.spend(failure.inferences)
                self._learn_misfit(failure, layout)
            case Infeasible():
                self._work.spend_in_vain(failure.inferences)
                for number, conflict in failure.conflicts.items():
                    self._placer.account.refuted(conflict.clauses, furniture=True)
                    program, _ = self._programs.furniture_for(layout.rooms[number].type.name, self._request)
                    self.nogoods[program].append(conflict.atoms)
                    self.unfurnished += 1
                return self._refurnished(layout, failure.conflicts)
        return None

    def _sample_rooms(self) -> Layout:
        """Return a layout without furniture, and without the room types that cannot have any."""
        request, account = self._request, self._placer.account
        program, assumed = self._programs.rooms_for(request)
        without = [atom for type_ in sorted(self.unfurnishable) for atom in to_furnish(type_, request.rooms)]
        while True:
            account.at(LAYOUT, "the types and sides of the rooms (clingo)")
            atoms = program.sample(self._work.rng, assumed, without, self.nogoods[program])
            if atoms is None:
                raise NoLayout(request, self._feasibility, self.unfurnishable, self.orders)
            account.sampled()
            layout = Layout.unfurnished(atoms, request.fixed)
            conflict = self._loaded.has_area and self._placer.area_conflict(
                layout, request.fixed, sorted(self._loaded.furniture)
            )
            if not conflict:
                return layout
            account.refuted(conflict.clauses)
            self.nogoods[program].append(conflict.atoms)
            if len(self.nogoods[program]) > MOST_AREAS:
                raise LimitReached(f"{MOST_AREAS} times {self._misfit()}. {account.refutations}")

    def _refurnished(self, layout: Layout, numbers: Iterable[int]) -> Layout | None:
        """Return the layout with new furniture in these rooms.

        If a room type can have no furniture, note the type and return None.
        """
        rooms, work = list(layout.rooms), self._work
        for number in numbers:
            if rooms[number].fixed:
                continue
            type_ = rooms[number].type.name
            program, assumed = self._programs.furniture_for(type_, self._request, rng=work.rng)
            self._placer.account.at(FURNITURE, f"the furniture of {article(type_)} (clingo)")
            try:
                furniture = program.sample(work.rng, assumed, nogoods=self.nogoods[program])
            except TooMany:
                ease = REMEDIES[FURNITURE]
                raise LimitReached(f"no furniture of {article(type_)} was found in time: {ease}") from None
            if furniture is None:
                self.unfurnishable.add(type_)
                return None
            rooms[number] = replace(rooms[number], furniture=furniture, seed=work.seed())
        return Layout(rooms, layout.corners)

    def _learn_misfit(self, proof: Misfit, layout: Layout) -> None:
        """Exclude an infeasible order of the rooms. Raises ``LimitReached`` after many failures."""
        request, account = self._request, self._placer.account
        of_area = self._loaded.has_area and not request.fixed
        account.refuted([Function("house_area")] if of_area else ())
        if proof.infeasible:
            order = {Function("side", [Number(room.number), room.side]): True for room in layout.rooms}
            for room in layout.rooms:
                if room.fixed:
                    number = request.fixed.index(room.fixed)
                    order[Function("numbered", [Number(number), Number(room.number)])] = True
            order |= dict.fromkeys(layout.corners, True)
            self.orders.append(order)
            self.nogoods[self._programs.rooms_for(request)[0]].append(order)
            return
        self.misfits += 1
        if self.misfits == MOST_MISFITS:
            raise LimitReached(f"{MOST_MISFITS} times {self._misfit()}. {account.refutations}")

    def _misfit(self) -> str:
        """Return a message about rooms that do not fit, with advice."""
        area = "the sampled rooms left the main room an area outside house_area/2"
        if not self._request.fixed:
            return f"{area}, but others might fit: try another seed, another number of rooms, or wider bounds"
        between = "the sampled rooms did not fit between the fixed rooms"
        found = (
            f"{between}, or {area.removeprefix('the sampled rooms ')}" if self._loaded.has_area else between
        )
        return f"{found}, but smaller ones might: try another seed, fewer rooms or smaller types"


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


def _moved(rect: Any, x: float, y: float) -> Any:
    """Return a moved rectangle with all that it holds."""
    changes: dict[str, Any] = {"x": rect.x + x, "y": rect.y + y}
    if hasattr(rect, "children"):
        changes["children"] = tuple(_moved(child, x, y) for child in rect.children)
    if hasattr(rect, "door"):
        changes["door"] = _moved(rect.door, x, y)
    return msgspec.structs.replace(rect, **changes)
