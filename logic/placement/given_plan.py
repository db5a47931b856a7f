"""What lengths forbid in a plan of the user's, and where its doors and windows are."""

from collections.abc import Iterable, Sequence

import msgspec
from clingo import Symbol, parse_term

from logic.house.parts import OUTSIDE
from logic.placement.placer import Placer
from logic.placement.plan import PlanDoor, PlanWindow
from logic.placement.prolog import Term
from logic.request.own_plan import OwnPlan


def plan_faults(
    placer: Placer, plan: OwnPlan, types: Iterable[str], openings: Iterable[Term]
) -> list[tuple[Symbol, tuple[Symbol, ...]]]:
    """What the lengths forbid in a user's plan: facts of ``own.lp``, each with its clauses. ``openings`` are
    terms ``opening(Type,Other)``.
    """
    rooms = [
        Term("room", number, float(room.width), float(room.height)) for number, room in enumerate(plan.rooms)
    ]
    west, north, east, south = plan.outline
    size = Term("size", float(east - west), float(south - north))
    doors = []
    for door in plan.doors:
        if wall := plan.wall_of(door):
            behind = wall.side if wall.behind is None else wall.behind
            doors.append(Term("door", wall.room, behind, float(door.length)))
    found = placer.ask("own_plan_faults", size, rooms, _walls(plan), doors, types, openings)
    return [(parse_term(fact), tuple(map(parse_term, clauses))) for fact, clauses in found]


def openings(
    placer: Placer, plan: OwnPlan, layout: Sequence[Symbol], seed: int
) -> tuple[list[PlanDoor], list[PlanWindow]]:
    """Doors and windows with their places in a plan of the user's, metres: see ``own_plan.pl``."""
    types = [Term("-", *atom.arguments) for atom in layout if atom.name == "room"]
    found = placer.ask("own_openings", layout, types, _walls(plan), seed)
    return msgspec.convert((found["doors"], found["windows"]), tuple[list[PlanDoor], list[PlanWindow]])


def _walls(plan: OwnPlan) -> list[Term]:
    return [
        Term(
            "wall",
            wall.room,
            wall.side,
            OUTSIDE if wall.behind is None else wall.behind,
            *map(float, (wall.place, wall.start, wall.end)),
        )
        for wall in plan.walls
    ]
