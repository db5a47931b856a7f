"""Plans: houses whose rooms share walls, of any topology but a star.

Stage 1 samples types, walls, doors and windows at once. Stage 2 places them (``walls.pl``). Then the rooms
are furnished at these sizes (``logic.generation.furnish``).
"""

import math
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple, TypeVar

from clingo import Symbol
from msgspec import structs

from vitruvius.logic.errors import LimitReached, RequestError
from vitruvius.logic.generation.feasibility import Feasibility
from vitruvius.logic.generation.furnish import Furnished, GivenRoom, Unfurnishable, furnished
from vitruvius.logic.generation.loop import Maker, NoLayout, Stages, Work, made
from vitruvius.logic.generation.movable_doors import Refuted
from vitruvius.logic.generation.tiling import require_tiling
from vitruvius.logic.grammar import DISSECTION, GUARD, Grammar
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Rect
from vitruvius.logic.language.loaded import LoadedGrammar
from vitruvius.logic.layout.account import LAYOUT, PROOF
from vitruvius.logic.layout.program import Nogood, Program, TooMany
from vitruvius.logic.layout.programs import Programs
from vitruvius.logic.layout.terms import granted, room_requirements, to_furnish, wall_facts
from vitruvius.logic.placement.lengths import brief_lengths
from vitruvius.logic.placement.placer import Failure, Infeasible
from vitruvius.logic.placement.plan import Pieces, Plan
from vitruvius.logic.placement.prolog import Term
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.spelling import article, numbered

MOST_TRIES = 200
"""Number of layouts with a room that cannot be furnished at its size, though it might at another size."""

FREE_FROM = 11
"""Least number of rooms with which each house of a dissection has a program of its own.

The search of this program begins with the sampled picks and continues in an order that clasp learns. To take
the picks one after the other is up to ten times slower.
"""

MOST_REFUTED = 60
"""Number of layouts to refute in a proof that a room, undecided at its size, is impossible at any size."""

LARGER = "another seed, or larger rooms (room_size/3, room_area/3)"
"""Advice for rooms that cannot be furnished."""

WIDER = "give them a wider range of areas (room_area/3)"
"""Advice for areas of rooms that cannot be decided."""

NO_FIXED = "keep: these are rooms of a star, which do not share walls: leave out keep"

R = TypeVar("R", bound=Rect)


class Assumed(NamedTuple):
    """Program of the rooms of a house, and the atoms that are assumed to hold and to fail."""

    program: Program
    holds: Sequence[Symbol]
    fails: Sequence[Symbol] = ()


class Making(NamedTuple):
    """Origin of a plan: the program and layout of stage 1, and the origin of the furniture by room number."""

    program: Program
    layout: list[Symbol]
    furniture: dict[int, Furnished]


class Furnishing(NamedTuple):
    """Furnished plan: the pieces of each of its rooms, and its origin."""

    plan: Plan
    pieces: list[Pieces]
    making: Making


@dataclass(frozen=True)
class PlanRules:
    """Rules of the plans of one topology, of one brief, or in one plan."""

    grammar: Grammar
    loaded: LoadedGrammar
    feasibility: Feasibility
    programs: Programs
    advice: str = LARGER
    """Advice for rooms that cannot be furnished."""
    rooms: str = "the rooms"
    """Words for the rooms in a message about undecided layouts."""
    wider: str = WIDER
    """Advice for areas of rooms that cannot be decided."""

    def assumed(self, request: HouseRequest, work: Work, is_free: bool = False) -> Assumed:
        """Return the program of a request's rooms, for one house if its search is free: see ``FREE_FROM``."""
        if request.fixed:
            raise RequestError(NO_FIXED)
        self.programs.begin()
        is_free |= DISSECTION in self.grammar.topology and request.rooms >= FREE_FROM
        if not is_free:
            return Assumed(*self.programs.rooms_for(request))
        program = self.programs.house(request, int(work.rng.integers(2**31)))
        return Assumed(program, [granted(each) for each in room_requirements(request)])


class PlanDraft:
    """Plan in progress: its stages, and the nogoods learned from their failures."""

    def __init__(self, rules: PlanRules, request: HouseRequest, work: Work, assumed: Assumed) -> None:
        """Begin without failures."""
        self.rules, self.request, self.work, self.assumed = rules, request, work, assumed
        self.placer = rules.loaded.placer
        self.nogoods: list[Nogood] = []
        self.undecided: list[Nogood] = []
        """Nogoods of layouts whose areas were neither found nor refuted."""
        self.unfurnishable: set[str] = set()
        """Room types that cannot be furnished at any size."""
        self.failures = 0
        """Number of plans with a room that cannot be furnished."""

    def layout(self, known: Sequence[Nogood] = ()) -> list[Symbol] | None:
        """Sample a layout outside the nogoods, among them ``known`` ones; None if there is none."""
        program, holds, fails = self.assumed
        without = [
            atom for type_ in sorted(self.unfurnishable) for atom in to_furnish(type_, self.request.rooms)
        ]
        self.placer.account.at(LAYOUT, "types, walls and doors of the rooms (clingo)")
        layout = program.sample(self.work.rng, holds, [*without, *fails], [*known, *self.nogoods])
        if layout is not None:
            self.placer.account.sampled()
        return layout

    def sample(self) -> list[Symbol]:
        """Sample a layout. Raises ``no_layout`` if there is none."""
        layout = self.layout()
        if layout is None:
            raise self.no_layout()
        return layout

    def no_layout(self, refuted: Sequence[Refuted] = ()) -> Exception:
        """Return the error for a request without a layout outside the nogoods and the ``refuted`` rooms."""
        if self.undecided:
            return LimitReached(
                f"{numbered(len(self.undecided), 'arrangement')} of {self.rules.rooms} could not be decided, "
                f"and all others are impossible: {self.rules.wider}"
            )
        return NoLayout(self.request, self.rules.feasibility, self.unfurnishable, refuted=refuted)

    def place(self, layout: list[Symbol], given: Iterable[Term] = (), thorough: bool = False) -> Plan:
        """Return walls, doors and windows with their places: see ``Placer.walls``."""
        plan = self.placer.walls(layout, self.work.seed(), self.work.inferences, given, thorough)
        self.work.spend(plan.inferences)
        return self.joined(layout, plan)

    def joined(self, layout: list[Symbol], plan: Plan) -> Plan:
        """Return a plan with parts of rooms joined. Raises ``GrammarError`` for rooms that form no plan."""
        parts = [atom.arguments for atom in layout if atom.name == "part_of"]
        plan.join({part.number: whole.number for part, whole in parts})
        grammar = self.rules.grammar
        if GUARD in grammar.topology:  # the user's own topology, whose rooms may not form a plan
            no_pieces: list[Pieces] = [()] * len(plan.rooms)
            require_tiling(plan.house(no_pieces, grammar.topology_name), layout, self.rules.loaded)
        return plan

    def furnish(self, layout: list[Symbol], plan: Plan) -> Furnishing:
        """Return a plan with the pieces of its rooms. Raises as ``furnish.furnished`` does."""
        rooms = [given_room(plan, number) for number in range(self.request.rooms)]
        how: dict[int, Furnished] = {}
        work = self.work
        pieces = furnished(
            rooms, self.rules.programs, self.placer, work.rng, work.inferences, self.request, how
        )
        hubs = [f"R{atom.arguments[0]}" for atom in layout if atom.name == "hub"]
        plan.hub = hubs[0] if len(hubs) == 1 else ""
        return Furnishing(plan, pieces, Making(self.assumed.program, layout, how))

    def learn(self, _: list[Symbol], failure: Failure) -> None:
        """Exclude walls without places, and a room type that cannot be furnished at any size."""
        match failure:
            case Infeasible():
                conflict = failure.conflicts[0]
                self.nogoods.append(conflict.atoms)
                if failure.undecided:
                    self.undecided.append(conflict.atoms)
                self.placer.account.refuted(conflict.clauses)
                self.work.spend_in_vain(failure.inferences)
            case Unfurnishable():
                self._learn_unfurnishable(failure)

    def _learn_unfurnishable(self, failure: Unfurnishable) -> None:
        type_, account = failure.room.type, self.placer.account
        account.unfurnished(type_, failure.decided)
        # The room failed at this size with these doors. If it fails at any size with one door, exclude it.
        account.at(PROOF, f"whether {article(type_)} can be furnished at any size")
        most = math.inf if failure.decided else MOST_REFUTED
        with suppress(TooMany):
            if not self.rules.feasibility.is_furnishable(self.request, type_, most):
                self.unfurnishable.add(type_)
        self.failures += 1
        if self.failures == MOST_TRIES:
            raise LimitReached(
                f"after {MOST_TRIES} attempts, some room could not be furnished at its sampled size (most "
                f"recently {failure.room.name}, {failure}), but other sizes might work: try "
                f"{self.rules.advice}. {account.refutations}"
            )


def plan_maker(rules: PlanRules) -> Maker:
    """Return the generator of the plans of a topology."""

    def plan(request: HouseRequest, work: Work) -> tuple[House, Making]:
        draft = PlanDraft(rules, request, work, rules.assumed(request, work))
        return house(rules, made(Stages(draft.sample, draft.place, draft.furnish, draft.learn)))

    return Maker(rules.feasibility, plan, lambda request: rules.programs.rooms_for(request)[0])


def exact_areas_maker(grammar: Grammar, loaded: LoadedGrammar) -> Maker:
    """Return the generator of plans whose rooms may have any size that their areas allow.

    Other plans use a convex part of these sizes (``areas.pl``), which takes less time. If that part contains
    no house, this generator searches all sizes. The grammar must not have units or areas of several rooms.
    """
    facts = wall_facts(*brief_lengths(loaded.placer, loaded.furniture, loaded.openings))
    feasibility = Feasibility(grammar, loaded.placer, loaded.lengths, facts, thorough=True)
    rules = PlanRules(grammar, loaded, feasibility, loaded.programs_of(grammar, [fact for fact, _ in facts]))

    def plan(request: HouseRequest, work: Work) -> tuple[House, Making]:
        draft = PlanDraft(rules, request, work, rules.assumed(request, work))
        place = partial(draft.place, thorough=True)
        return house(rules, made(Stages(draft.sample, place, draft.furnish, draft.learn)))

    return Maker(feasibility, plan, lambda request: rules.programs.rooms_for(request)[0])


def house(rules: PlanRules, done: Furnishing) -> tuple[House, Making]:
    """Return the house of a furnished plan, and its origin."""
    return done.plan.house(done.pieces, rules.grammar.topology_name), done.making


def given_room(plan: Plan, place: int) -> GivenRoom:
    """Return a room of a plan for furniture, with its entrance as the first door."""
    room, half = plan.rooms[place], plan.half_wall
    doors = [at_face(door, room, half) for door in plan.doors_of(place)]
    windows = [at_face(window, room, half) for window in plan.windows_of(place)]
    alike = [each for each in plan.rooms if each.type == room.type]
    largest = room is max(alike, key=lambda each: each.width * each.height)
    drawn, name = plan.drawn_windows, plan.name(place)
    return GivenRoom(room.type, room, doors, windows, room.pieces, drawn, largest, name)


def at_face(segment: R, room: Rect, half: float) -> R:
    """Return a door or window, ``half`` metres outside a room, moved to the face of the room's wall."""
    if not half:
        return segment
    axis = int(segment.height == 0)
    at = min(room.box[axis::2], key=lambda face: abs(face - segment.box[axis]))
    return structs.replace(segment, **{"xy"[axis]: at})
