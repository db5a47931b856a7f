"""Houses in a plan of the user: stage 1 chooses walls for doors and windows, stage 2 places them.

Conflicts of the plan with the grammar's lengths are known before stage 1, room by room, so that a proof names
the room and the clause.
"""

from collections.abc import Collection
from enum import Enum

from clingo import Function, Number, Symbol

from vitruvius.logic.errors import LimitReached, RequestError
from vitruvius.logic.generation.feasibility import Feasibility, HouseFacts
from vitruvius.logic.generation.furnish import Unfurnishable
from vitruvius.logic.generation.loop import Maker, Stages, Work, made
from vitruvius.logic.generation.movable_doors import MOST_LAYOUTS, LooseRoom, OneDoor, Refuted
from vitruvius.logic.generation.shared_walls import (
    Furnishing,
    Making,
    PlanDraft,
    PlanRules,
    at_face,
    given_room,
    house,
)
from vitruvius.logic.grammar import Grammar
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import OUTSIDE, Door, Rect
from vitruvius.logic.language.loaded import OUTDOOR_AREA, LoadedGrammar
from vitruvius.logic.layout.account import FURNITURE
from vitruvius.logic.layout.program import TooMany
from vitruvius.logic.layout.terms import granted, own_requirements
from vitruvius.logic.placement.given_plan import inner_span, openings, plan_faults, within_walls
from vitruvius.logic.placement.lengths import metres as lengths_of
from vitruvius.logic.placement.plan import Plan, PlanDoor, PlanRoom, PlanWindow, sides
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.request.own_plan import OwnPlan

PATIENCE = 5
"""Number of failures of rooms at sampled places of their doors before a search for better places begins."""

ADVICE = "another seed, a larger room, less furniture, or doors and windows elsewhere"


class DoorPlaces(Enum):
    """Source of the places of the doors of a room that failed."""

    SAMPLED = "sampled"
    SEARCHED = "searched"
    """Search for places that permit the furniture."""
    UNKNOWN = "unknown"
    """Sampled again: a search reached its limit, so no other search follows in this house."""


def given_plan_maker(grammar: Grammar, loaded: LoadedGrammar, plan: OwnPlan) -> Maker:
    """Return the generator of houses in one plan."""
    rules, own = given_plan_rules(grammar, loaded, plan)

    def in_plan(request: HouseRequest, work: Work) -> tuple[House, Making]:
        draft = GivenPlanDraft(PlanDraft(rules, request, work, rules.assumed(request, work)), own)
        return house(rules, made(Stages(draft.sample, draft.place, draft.furnish, draft.draft.learn)))

    return Maker(rules.feasibility, in_plan, lambda request: rules.programs.rooms_for(request)[0])


def given_plan_rules(
    grammar: Grammar, loaded: LoadedGrammar, plan: OwnPlan, of_any_size: bool = False
) -> tuple[PlanRules, OwnPlan]:
    """Return the rules of houses in a plan, and the plan within its walls.

    The rules include, as facts, the parts of the plan that violate the grammar's lengths, unless the rooms
    are ``of_any_size``.
    """
    if loaded.has_area and loaded.outdoor:
        raise RequestError(f"plan: {OUTDOOR_AREA.format(grammar.name)}")
    if loaded.depths:
        raise RequestError(
            f"plan: {grammar.name} has units, which given plans do not support: choose another grammar"
        )
    if lengths_of(loaded.placer, loaded.furniture)["doors"]:
        why = "states door_width/3, widths by the types of both rooms, which given plans do not support"
        raise RequestError(f"plan: the grammar {grammar.name} {why}: leave these clauses out")
    rules, plan = grammar.for_own_plan(), within_walls(plan, loaded.placer.wall_thickness)
    types = sorted(loaded.furniture)
    faults = [] if of_any_size else plan_faults(loaded.placer, plan, types, loaded.openings)
    facts: HouseFacts = [*_meetings(plan), *faults]
    feasibility = Feasibility(rules, loaded.placer, loaded.lengths, facts, placed=True)
    programs = loaded.programs_of(rules, [fact for fact, _ in facts])
    return PlanRules(rules, loaded, feasibility, programs, ADVICE), plan


class GivenPlanDraft:
    """House in a plan, in progress."""

    def __init__(self, draft: PlanDraft, plan: OwnPlan) -> None:
        """Begin without refuted rooms."""
        self.draft, self.plan = draft, plan
        self.placer, self.programs, self.work = draft.placer, draft.rules.programs, draft.work
        self.doors = DoorPlaces.SAMPLED
        self.refuted: list[Refuted] = []
        self.too_small: dict[tuple[int, str], list[Refuted]] = {}

    def sample(self) -> list[Symbol]:
        """Sample a layout. Raises ``NoLayout`` with the refuted rooms if there is none."""
        layout = self.draft.layout()
        if layout is None:
            raise self.draft.no_layout(self.refuted)
        return layout

    def furnish(self, layout: list[Symbol], plan: Plan) -> Furnishing:
        """Return the furniture as for any plan.

        After several failures a room gets doors that permit furniture.
        """
        try:
            return self.draft.furnish(layout, plan)
        except Unfurnishable as failure:
            if self.draft.failures + 1 >= PATIENCE and self.doors is DoorPlaces.SAMPLED:
                self.doors = DoorPlaces.SEARCHED
            if self.doors is not DoorPlaces.SEARCHED or not self._moved(plan, layout, failure.place):
                raise
        return self.draft.furnish(layout, plan)

    def place(self, layout: list[Symbol]) -> Plan:
        """Return the plan's own rooms with their types, and doors and windows in their walls."""
        types = {atom.arguments[0].number: str(atom.arguments[1]) for atom in layout if atom.name == "room"}
        thick = self.placer.wall_thickness
        half = thick.inner / 2 if thick else 0.0
        rooms = [
            PlanRoom(
                *sides(room.grown(-half)),
                number,
                types[number],
                room.name,
                room.children if room.name in self.plan.kept else None,
            )
            for number, room in enumerate(self.plan.rooms)
        ]
        # The plan's own doors and windows stay in their places.
        outer = self._outer_doors(layout)
        loose = [atom for atom in layout if not (outer and atom.name == "garden")]
        plan = Plan(rooms, *openings(self.placer, self.plan, loose, self.work.seed()), wall_thickness=thick)
        kept = {frozenset(door.between): door for door in self.plan.doors if not door.is_entrance}
        kept |= {frozenset(door.between): door for door in outer[:1]}
        opened = [{each.number for each in atom.arguments} for atom in layout if atom.name == "open_to"]
        plan.doors = [
            PlanDoor(
                *sides(kept.get(frozenset(plan.between(door)), door)), door.between, {*door.between} in opened
            )
            for door in plan.doors
        ]
        numbers = {room.name: room.number for room in rooms}
        for door in outer[1:]:
            (name,) = {*door.between} - {OUTSIDE}
            plan.doors.append(PlanDoor(*sides(door), (numbers[name], OUTSIDE)))
        if self.plan.windows:
            plan.windows = [PlanWindow(*sides(window), numbers[window.room]) for window in self.plan.windows]
            plan.drawn_windows = True
        return self.draft.joined(layout, plan)

    def _outer_doors(self, layout: list[Symbol]) -> list[Door]:
        """Return the doors of the plan that lead outside, first the entrance: the widest in its side."""
        at = next(
            ((str(a.arguments[1]), a.arguments[0].number) for a in layout if a.name == "entrance"), None
        )
        outer = [(door, wall) for door in self.plan.doors if (wall := self.plan.wall_of(door))]
        outer = [(door, wall) for door, wall in outer if wall.behind is None]
        outer.sort(key=lambda each: ((each[1].side, each[1].room) != at, -each[0].length))
        return [door for door, _ in outer]

    def _moved(self, plan: Plan, layout: list[Symbol], place: int) -> bool:
        """Return True if a room's doors can move to places where it can be furnished.

        If there are no such places, the room is refuted.
        """
        doors = plan.doors_of(place)
        spans = [self._span(plan, door) for door in doors]
        if any(door.opening and span for door, span in zip(doors, spans, strict=True)):
            return False  # It may also have another width.
        spans = [span and at_face(span, plan.rooms[place], plan.half_wall) for span in spans]
        room = LooseRoom(given_room(plan, place), spans)
        furniture: list[Symbol] | None = None
        doors_elsewhere = f"the furniture of {room.room}, its doors elsewhere (clingo and CLP(Q))"
        self.placer.account.at(FURNITURE, doors_elsewhere)
        for windows in (False, True):
            try:
                furniture = room.furniture(
                    self.programs, self.placer, self.work.rng, self.draft.request, windows
                )
            except LimitReached:
                self.doors = DoorPlaces.UNKNOWN
                return False
            if furniture is None:
                refuted = self._anywhere(plan, place) or [
                    self._refutation(plan, layout, place, room, windows)
                ]
                self.refuted += refuted
                self.draft.nogoods += [each.atoms for each in refuted]
                return False
        starts = self.placer.loose_starts(room.loose_term(furniture or ()), self.work.seed())
        moved: dict[PlanDoor, tuple[float, float, float, float]] = {}
        for door, rect in zip(doors, room.moved(starts), strict=True):
            x, y = (rect.x, door.y) if door.width > door.height else (door.x, rect.y)
            moved[door] = x, y, rect.width, rect.height
        plan.doors = [PlanDoor(*moved.get(door, sides(door)), door.between) for door in plan.doors]
        return True

    def _span(self, plan: Plan, door: PlanDoor) -> Rect | None:
        """Return the part of a wall in which a door may stand, or None for a door of the user's plan."""
        between = plan.between(door)
        if {*between} in [{*kept.between} for kept in self.plan.doors]:
            return None
        wall = self.plan.wall_of(Door(*sides(door), between))
        assert wall
        start, end = inner_span(self.plan, wall, self.placer.wall_thickness)
        length = end - start
        if door.width > door.height:
            return Rect(start, wall.place, length, 0.0)
        return Rect(wall.place, start, 0.0, length)

    def _anywhere(self, plan: Plan, place: int) -> list[Refuted]:
        """Return proofs that a room has no furniture at its size, wherever its doors and windows are.

        The list is empty if the room may have furniture.
        """
        room, name = given_room(plan, place), plan.name(place)
        if (place, room.type) not in self.too_small:
            atoms = {Function("room", [Number(place), Function(room.type)]): True}
            grants = self._granted({place}, "drawn")
            axes = "x" if room.rect.width == room.rect.height else "xy"
            refuted = [Refuted(name, OneDoor(room, axis), False, atoms, grants) for axis in axes]
            never = not self.draft.rules.feasibility.depends_on_doors(room.type) and not any(
                self._may_be_furnished(each) for each in refuted
            )
            self.too_small[place, room.type] = refuted if never else []
        return self.too_small[place, room.type]

    def _may_be_furnished(self, room: Refuted) -> bool:
        """Return True if a layout fits in a room, or if this is unknown after ``MOST_LAYOUTS`` layouts."""
        question, statements = self.draft.rules.feasibility.furniture(
            self.draft.request, room.room.room.type, room=room
        )
        try:
            return question.possible(statements, MOST_LAYOUTS)
        except TooMany:
            return True

    def _refutation(
        self,
        plan: Plan,
        layout: list[Symbol],
        place: int,
        room: LooseRoom,
        windows: bool,
    ) -> Refuted:
        """Return the refuted choice of stage 1, and the parts of the user's plan that the proof uses."""
        program, number = self.programs.rooms_for(self.draft.request)[0], Number(place)
        held = {Function(atom.name, atom.arguments[:2]) for atom in layout}
        atoms = {Function("room", [number, Function(room.room.type)]): True}
        for name in ("door", "entrance", "garden", "window")[: 3 + windows]:
            atoms |= {atom: atom in held for atom in program.atoms(name, 2) if number in atom.arguments}
        near = {place, *(each for door in plan.doors_of(place) for each in door.between)}
        if OUTSIDE in near:
            near |= {wall.behind for wall in self.plan.walls if wall.room == place}
        grants = self._granted(near, "drawn") + self._granted({place}, "joined")
        return Refuted(plan.name(place), room, windows, atoms, grants)

    def _granted(self, rooms: Collection[int | str], kind: str) -> tuple[Symbol, ...]:
        """Return statements of the user's plan on places of rooms (``drawn``) or their doors (``joined``)."""
        numbers = {Number(each) for each in rooms if isinstance(each, int)}
        own = own_requirements(self.plan)
        return tuple(
            granted(each)
            for each in own
            if each.name == kind and not numbers.isdisjoint(each.arguments[: 1 if kind == "drawn" else 2])
        )


def _meetings(plan: OwnPlan) -> HouseFacts:
    """Return facts about walls and parts of rooms.

    The facts state the rooms that share walls, the parts of other rooms, the sides that are outer walls,
    wholly or in part, and the sides with windows.
    """
    found = []
    for wall in plan.walls:
        room = Number(wall.room)
        if wall.behind is None:
            found.append(Function("outside", [room, Function(wall.side)]))
        else:
            found.append(Function("touch", [room, Number(wall.behind)]))
    for door in plan.doors:
        wall = plan.wall_of(door)
        if wall and wall.behind is not None:
            kind = "leafless" if door.opening else "leaf"
            found.append(Function(kind, [Number(wall.room), Number(wall.behind)]))
    numbers = {room.name: number for number, room in enumerate(plan.rooms)}
    for number, room in enumerate(plan.rooms):
        if room.part_of:
            found.append(Function("said_part", [Number(number), Number(numbers[room.part_of])]))
    panes = [wall for window in plan.windows if (wall := plan.wall_around(window))]
    found += [Function("pane", [Number(wall.room), Function(wall.side)]) for wall in panes]
    found += [
        Function("pane_toward", [Number(wall.room), Number(wall.behind)])
        for wall in panes
        if wall.behind is not None
    ]
    return [(fact, ()) for fact in dict.fromkeys(found)]
