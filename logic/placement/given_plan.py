"""Conflicts of a user's plan with lengths, and the places of its doors and windows."""

from collections.abc import Iterable, Sequence
from typing import TypeVar

import msgspec
from clingo import Symbol, parse_term

from vitruvius.logic.house.boxes import TOLERANCE, WALLS
from vitruvius.logic.house.parts import OUTSIDE, Door, Window
from vitruvius.logic.house.promises import Thickness
from vitruvius.logic.placement.placer import Placer
from vitruvius.logic.placement.plan import PlanDoor, PlanWindow
from vitruvius.logic.placement.prolog import Term
from vitruvius.logic.request.own_plan import OwnPlan, Wall

Opening = TypeVar("Opening", Door, Window)


def within_walls(plan: OwnPlan, thick: Thickness | None) -> OwnPlan:
    """Return the plan with its doors and windows moved out of the walls across, which are ``thick``.

    Each moves along its own wall, and is shortened if that wall is too short.
    """

    def fitted(opening: Opening, wall: Wall | None) -> Opening:
        if wall is None:
            return opening
        (start, end), axis = inner_span(plan, wall, thick), 1 - WALLS.index(wall.side) % 2
        length = min(opening.length, end - start)
        at = min(max(opening.box[axis], start), end - length)
        if max(abs(at - opening.box[axis]), opening.length - length) <= TOLERANCE or length <= TOLERANCE:
            return opening
        return msgspec.structs.replace(opening, **{"xy"[axis]: at, ("width", "height")[axis]: length})

    doors = tuple(fitted(door, plan.wall_of(door)) for door in plan.doors)
    windows = tuple(fitted(window, plan.wall_around(window)) for window in plan.windows)
    return msgspec.structs.replace(plan, doors=doors, windows=windows) if thick else plan


def plan_faults(
    placer: Placer, plan: OwnPlan, types: Iterable[str], openings: Iterable[Term]
) -> list[tuple[Symbol, tuple[Symbol, ...]]]:
    """Return the conflicts of a user's plan with lengths: facts of ``own.lp``, each with its clauses.

    ``openings`` are terms ``opening(Type,Other)``.
    """
    thick = placer.wall_thickness.inner if placer.wall_thickness else 0.0
    rooms = [
        Term("room", number, float(room.width - thick), float(room.height - thick))
        for number, room in enumerate(plan.rooms)
    ]
    west, north, east, south = plan.outline
    size = Term("size", float(east - west - thick), float(south - north - thick))
    doors = []
    for door in plan.doors:
        if wall := plan.wall_of(door):
            behind = wall.side if wall.behind is None else wall.behind
            doors.append(Term("door", wall.room, behind, float(door.length)))
    found = placer.ask("own_plan_faults", size, rooms, _walls(placer, plan), doors, types, openings)
    return [(parse_term(fact), tuple(map(parse_term, clauses))) for fact, clauses in found]


def openings(
    placer: Placer, plan: OwnPlan, layout: Sequence[Symbol], seed: int
) -> tuple[list[PlanDoor], list[PlanWindow]]:
    """Return doors and windows with their places in a user's plan, metres: see ``own_plan.pl``."""
    types = [Term("-", *atom.arguments) for atom in layout if atom.name == "room"]
    found = placer.ask("own_openings", layout, types, _walls(placer, plan), seed)
    return msgspec.convert((found["doors"], found["windows"]), tuple[list[PlanDoor], list[PlanWindow]])


def inner_span(plan: OwnPlan, wall: Wall, thick: Thickness | None) -> tuple[float, float]:
    """Return the start and end of a wall of a plan between the faces of the walls across, metres.

    The rooms of the plan meet in the middle of walls with this thickness.
    """
    if thick is None:
        return wall.start, wall.end
    axis, box = 1 - WALLS.index(wall.side) % 2, plan.rooms[wall.room].box
    half = thick.inner / 2

    def across(own: float, end: float) -> float:
        """Return the distance from an end of the wall to the face of the wall across there, metres.

        If an outer wall ends but its side goes on, the wall across is an outer wall.
        """
        whole = wall.behind is not None or abs(own - end) <= TOLERANCE
        return half if whole else thick.outer - half

    return wall.start + across(box[axis], wall.start), wall.end - across(box[axis + 2], wall.end)


def _walls(placer: Placer, plan: OwnPlan) -> list[Term]:
    return [
        Term(
            "wall",
            wall.room,
            wall.side,
            OUTSIDE if wall.behind is None else wall.behind,
            *map(float, (wall.place, *inner_span(plan, wall, placer.wall_thickness))),
        )
        for wall in plan.walls
    ]
