"""Plans: houses whose rooms share walls, of any topology but a star.

Stage 1 samples types, walls, doors and windows at once. Stage 2 places them (``walls.pl``). Then the rooms
are furnished at these sizes (``logic.generation.furnish``).
"""

import math
from collections.abc import Callable, Collection, Sequence
from contextlib import suppress
from typing import NamedTuple, TypeVar

import numpy as np
from clingo import Symbol
from msgspec import structs

from vitruvius.logic.errors import LimitReached, OutOfInferences, RequestError
from vitruvius.logic.generation.evidence import NoLayout
from vitruvius.logic.generation.furnish import Furnished, GivenRoom, Unfurnishable, furnished
from vitruvius.logic.generation.maker import Maker
from vitruvius.logic.generation.tiling import require_tiling
from vitruvius.logic.grammar import DISSECTION, GUARD
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Rect
from vitruvius.logic.layout.account import LAYOUT, PROOF
from vitruvius.logic.layout.program import Nogood, Program, TooMany
from vitruvius.logic.layout.terms import granted, room_requirements, to_furnish
from vitruvius.logic.placement.placer import Infeasible
from vitruvius.logic.placement.plan import Pieces, Plan, UnitRange
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.spelling import article

MOST_TRIES = 200
"""Number of layouts with a room that cannot be furnished at its size, though it might at another size."""

FREE_FROM = 11
"""Least number of rooms with which each house of a dissection has a program of its own.

The search of this program begins with the sampled picks and continues in an order that clasp learns. To take
the picks one after the other is up to ten times slower.
"""

MOST_REFUTED = 60
"""Number of layouts to refute in a proof that a room, undecided at its size, is impossible at any size."""

S = TypeVar("S", Plan, UnitRange)
R = TypeVar("R", bound=Rect)


class Making(NamedTuple):
    """Origin of a plan: the program and layout of stage 1, and the origin of the furniture by room number."""

    program: Program
    layout: list[Symbol]
    furniture: dict[int, Furnished]


class SharedWallsMaker(Maker):
    """Generator of plans by one grammar."""

    advice = "another seed, or larger rooms (room_size/3, room_area/3)"
    """Advice for rooms that cannot be furnished."""

    making: Making | None = None
    _one_house: Program | None = None
    """Program of the house at work, if it has one of its own."""
    _undecided: Sequence[Nogood] = ()
    """Nogoods of layouts whose areas were neither found nor refuted."""

    def made(self, request: HouseRequest, rng: np.random.Generator, inferences: int) -> House:
        """See ``Maker.made``."""
        if request.fixed:
            raise RequestError("keep: these are rooms of a star, which do not share walls: leave keep out")
        self._programs.begin()
        free = self._searches_freely(request)
        self._one_house = self._programs.house(request, int(rng.integers(2**31))) if free else None
        plan, pieces, _ = self.complete(request, rng, inferences)
        return plan.house(pieces, self.grammar.topology_name)

    def complete(
        self, request: HouseRequest, rng: np.random.Generator, inferences: int
    ) -> tuple[Plan, list[Pieces], int]:
        """Return a plan, the pieces of each of its rooms, and the inferences left.

        Raises as ``made`` does.
        """
        nogoods: list[Nogood] = []
        unfurnishable: set[str] = set()
        last = ""
        for _ in range(MOST_TRIES):
            plan, layout, inferences = self.unfurnished(request, rng, inferences, nogoods, unfurnishable)
            try:
                pieces = self._furnished(request, plan, layout, nogoods, rng, inferences)
            except Unfurnishable as proof:
                last = f"{plan.name(proof.place)}, {proof}"
                self._placer.account.unfurnished(proof.room.type, proof.decided)
                # Infeasible at this size and with these doors, or with one door at any size and then
                # everywhere.
                self._placer.account.at(
                    PROOF, f"whether {article(proof.room.type)} can be furnished at any size"
                )
                most = math.inf if proof.decided else MOST_REFUTED
                with suppress(TooMany):
                    if not self.feasibility.is_furnishable(request, proof.room.type, most):
                        unfurnishable.add(proof.room.type)
                continue
            hubs = [f"R{atom.arguments[0]}" for atom in layout if atom.name == "hub"]
            plan.hub = hubs[0] if len(hubs) == 1 else ""
            return plan, pieces, inferences
        raise LimitReached(
            f"{MOST_TRIES} times a room could not be furnished at its size (the last time {last}), though it "
            f"might be otherwise: try {self.advice}. {self._placer.account.refutations}"
        )

    def unfurnished(
        self,
        request: HouseRequest,
        rng: np.random.Generator,
        inferences: int,
        nogoods: list[Nogood],
        unfurnishable: Collection[str] = (),
    ) -> tuple[Plan, list[Symbol], int]:
        """Return a plan without furniture and without some room types, its layout, and the inferences left.

        The nogoods receive the layouts that stage 2 refutes.
        """
        plan, layout, left = self._solved(self._walls, request, rng, inferences, nogoods, unfurnishable)
        parts = [atom.arguments for atom in layout if atom.name == "part_of"]
        plan.join({part.number: whole.number for part, whole in parts})
        if GUARD in self.grammar.topology:  # the user's own topology, whose rooms may not form a plan
            no_pieces: list[Pieces] = [()] * len(plan.rooms)
            require_tiling(plan.house(no_pieces, self.grammar.topology_name), layout, self._loaded)
        return plan, layout, left

    def _solved(
        self,
        solve: Callable[[HouseRequest, list[Symbol], int, int], S],
        request: HouseRequest,
        rng: np.random.Generator,
        inferences: int,
        nogoods: list[Nogood],
        unfurnishable: Collection[str] = (),
    ) -> tuple[S, list[Symbol], int]:
        """Return the first solution of stage 2, its layout, and the inferences left."""
        while True:
            layout = self._layout(request, rng, nogoods, unfurnishable)
            try:
                solved = solve(request, layout, int(rng.integers(2**63)), inferences)
            except Infeasible as proof:
                inferences -= proof.inferences
                nogoods.append(proof.conflicts[0].atoms)
                if proof.undecided:
                    self._undecided = [*self._undecided, nogoods[-1]]
                self._placer.account.refuted(proof.conflicts[0].clauses)
            else:
                return solved, layout, inferences - solved.inferences
            if inferences <= 0:
                raise OutOfInferences

    def _no_layout(self, request: HouseRequest, unfurnishable: Collection[str]) -> Exception:
        """Return the error for a request without a layout outside the nogoods."""
        return NoLayout(request, self.feasibility, unfurnishable)

    def _furnished(
        self,
        request: HouseRequest,
        plan: Plan,
        layout: list[Symbol],
        nogoods: list[Nogood],
        rng: np.random.Generator,
        inferences: int,
    ) -> list[Pieces]:
        """Return the pieces of each room of a plan. Raises as ``furnish.furnished`` does."""
        rooms = [given_room(plan, number) for number in range(request.rooms)]
        how: dict[int, Furnished] = {}
        pieces = furnished(rooms, self._programs, self._placer, rng, inferences, request, how)
        self.making = Making(self._program(request)[0], layout, how)
        return pieces

    def _layout(
        self,
        request: HouseRequest,
        rng: np.random.Generator,
        nogoods: list[Nogood],
        unfurnishable: Collection[str],
    ) -> list[Symbol]:
        """Return a layout outside the nogoods, without rooms of some types."""
        program, holds, fails = self._program(request)
        without = [atom for type_ in sorted(unfurnishable) for atom in to_furnish(type_, request.rooms)]
        self._placer.account.at(LAYOUT, "types, walls and doors of the rooms (clingo)")
        layout = program.sample(rng, holds, [*without, *fails], nogoods)
        if layout is None:
            raise self._no_layout(request, unfurnishable)
        self._placer.account.sampled()
        return layout

    def _program(self, request: HouseRequest) -> tuple[Program, list[Symbol], list[Symbol]]:
        """Return the program of the rooms, and the assumptions that hold and that do not."""
        if self._one_house is not None:
            return self._one_house, [granted(each) for each in room_requirements(request)], []
        return *self._programs.rooms_for(request), []

    def _searches_freely(self, request: HouseRequest) -> bool:
        return DISSECTION in self.grammar.topology and request.rooms >= FREE_FROM

    def _walls(self, request: HouseRequest, layout: list[Symbol], seed: int, inferences: int) -> Plan:
        """Return walls, doors and windows with their places: see ``Placer.walls``."""
        return self._placer.walls(layout, seed, inferences)


def given_room(plan: Plan, place: int) -> GivenRoom:
    """Return a room of a plan for furniture, with its entrance as the first door."""
    room, half = plan.rooms[place], plan.half_wall
    doors = [at_face(door, room, half) for door in plan.doors_of(place)]
    windows = [at_face(window, room, half) for window in plan.windows_of(place)]
    alike = [each for each in plan.rooms if each.type == room.type]
    largest = room is max(alike, key=lambda each: each.width * each.height)
    return GivenRoom(room.type, room, doors, windows, room.pieces, plan.drawn_windows, largest)


def at_face(segment: R, room: Rect, half: float) -> R:
    """Return a door or window, ``half`` metres outside a room, moved to the face of the room's wall."""
    if not half:
        return segment
    axis = int(segment.height == 0)
    at = min(room.box[axis::2], key=lambda face: abs(face - segment.box[axis]))
    return structs.replace(segment, **{"xy"[axis]: at})
