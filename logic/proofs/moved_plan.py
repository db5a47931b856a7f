"""Smallest change of a user's plan with which it satisfies the grammar's lengths: its lines move."""

from typing import TypeVar

import numpy as np
from clingo import Symbol
from msgspec.structs import replace

from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.generation.given_plan import given_plan_rules
from vitruvius.logic.generation.loop import NoLayout, Work
from vitruvius.logic.generation.shared_walls import PlanDraft
from vitruvius.logic.house.boxes import WALLS
from vitruvius.logic.house.parts import OUTSIDE, Door, Window
from vitruvius.logic.house.promises import Thickness
from vitruvius.logic.placement.given_plan import inner_span
from vitruvius.logic.placement.lengths import typical_lengths
from vitruvius.logic.placement.placer import Placer
from vitruvius.logic.placement.prolog import Term
from vitruvius.logic.proofs.answer import unsatisfiable
from vitruvius.logic.proofs.giving_way import giving_way
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.request.own_plan import OwnPlan, Wall

R = TypeVar("R", Door, Window)

MAX_LAYOUTS = 12
"""Number of choices of types, doors and windows to try if the plan leaves some of them open."""


def moved_plan(builder: Builder, request: HouseRequest, seed: int) -> OwnPlan | None:
    """Return the plan with its lines moved as little as possible in total, or None if none fits.

    Tries up to ``MAX_LAYOUTS`` layouts. Rooms may have any size. Typical rules give way, including all
    typical lengths. Raises ``Unsatisfiable`` if no lengths help.
    """
    builder.maker_of(request)  # raises for a plan that the grammar cannot have
    rules = [*typical_lengths(builder.placer, builder.loaded.furniture).values()]
    while True:
        builder = builder.giving_way(rules) if rules else builder
        try:
            return _moved(builder, request, np.random.default_rng(seed))
        except NoLayout as found:
            if not (rules := giving_way(found)):
                raise unsatisfiable(found) from None


def _moved(builder: Builder, request: HouseRequest, rng: np.random.Generator) -> OwnPlan | None:
    """Return the moved plan by the rules of a builder. Raises ``NoLayout``."""
    assert request.plan
    rules, plan = given_plan_rules(builder.grammar, builder.loaded, request.plan, of_any_size=True)
    work = Work(rng, request.inferences)
    draft = PlanDraft(rules, request, work, rules.assumed(request, work))
    best, least = None, float("inf")
    lines = _lines(plan)
    for _ in range(MAX_LAYOUTS):
        if places := _places(builder.placer, plan, draft.sample(), lines):
            *found, _ = places
            off = sum(np.abs(np.subtract(a, b)).sum() for a, b in zip(found, lines, strict=True))
            if off < least - 1e-6:
                best, least = places, off
    return best and _on_lines(plan, best[:2], best[2], builder.placer.wall_thickness)


def _places(
    placer: Placer, plan: OwnPlan, layout: list[Symbol], lines: tuple[list[float], list[float]]
) -> tuple[list[float], list[float], float] | None:
    """Return the places of the lines in x and in y for a layout, and the width of its doors, metres."""
    of_rooms = [[at[side][1] for side in ("west", "east", "north", "south")] for at in plan.lines]
    rooms = [Term("room", number, *some) for number, some in enumerate(of_rooms)]
    walls = []
    for wall in plan.walls:
        along = lines[1 - WALLS.index(wall.side) % 2]
        ends = [int(np.argmin(np.abs(np.array(along) - end))) for end in (wall.start, wall.end)]
        behind = OUTSIDE if wall.behind is None else wall.behind
        walls.append(Term("wall", wall.room, wall.side, behind, *ends))
    return placer.ask("own_plan_moved", layout, Term("lines", *lines), rooms, walls)


def _lines(plan: OwnPlan) -> tuple[list[float], list[float]]:
    """Return the places of the lines in x and in y, metres, by their numbers."""
    found: tuple[dict[int, float], dict[int, float]] = {}, {}
    for room, lines in zip(plan.rooms, plan.lines, strict=True):
        for k, side in enumerate(WALLS):
            found[k % 2][lines[side][1]] = room.box[k]
    return [found[0][at] for at in sorted(found[0])], [found[1][at] for at in sorted(found[1])]


def _on_lines(
    plan: OwnPlan, lines: tuple[list[float], list[float]], least: float, thick: Thickness | None
) -> OwnPlan:
    """Return the plan on other lines.

    Doors and windows move with their walls; doors have a least width, metres.
    """
    rooms = []
    for room, at in zip(plan.rooms, plan.lines, strict=True):
        west, north, east, south = (round(lines[k % 2][at[side][1]], 12) for k, side in enumerate(WALLS))
        rooms.append(replace(room, x=west, y=north, width=east - west, height=south - north))
    empty = OwnPlan(tuple(rooms))
    doors = [_in_wall(empty, plan.wall_of(door), door, thick, least) for door in plan.doors]
    windows = [_in_wall(empty, plan.wall_around(window), window, thick) for window in plan.windows]
    return replace(plan, rooms=empty.rooms, doors=tuple(doors), windows=tuple(windows))


def _in_wall(plan: OwnPlan, old: Wall | None, opening: R, thick: Thickness | None, least: float = 0.0) -> R:
    """Return a door or window, moved into its previous wall."""
    assert old
    k = WALLS.index(old.side) % 2
    same = [
        wall for wall in plan.walls if (wall.room, wall.side, wall.behind) == (old.room, old.side, old.behind)
    ]
    wall = max(same, key=lambda each: min(each.end, old.end) - max(each.start, old.start))
    first, last = inner_span(plan, wall, thick)
    length = min(max(opening.length, least), last - first)
    start = max(first, min(opening.box[1 - k], last - length))
    x, y, width, height = (start, wall.place, length, 0.0) if k else (wall.place, start, 0.0, length)
    return replace(opening, x=x, y=y, width=width, height=height)
