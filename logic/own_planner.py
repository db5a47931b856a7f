"""Houses in a plan of the user's: stage 1 says which walls have doors and windows, stage 2 places them.

What the grammar's lengths forbid in the plan is known before, room by room, so that a proof names the room
and the clause.
"""

from typing import Any

import msgspec
from clingo import Function, Number, Symbol

from logic.grammar import Grammar
from logic.loaded import LoadedGrammar
from logic.own_plan import OwnPlan
from logic.plans import Planner
from logic.programs import Programs
from logic.proof import Prover, Walls
from logic.request import Request


class OwnPlanner(Planner):
    """Makes houses in one plan by one grammar."""

    advice = "another seed, a larger room, less furniture, or doors and windows elsewhere"

    def __init__(self, grammar: Grammar, loaded: LoadedGrammar, plan: OwnPlan) -> None:
        """Find what the grammar forbids in the plan."""
        self.plan = plan
        rules = grammar.for_own_plan()
        facts: Walls = [*_meetings(plan), *loaded.placer.own_plan_faults(plan, sorted(loaded.furniture))]
        prover = Prover(rules, loaded.placer, loaded.lengths, facts, placed=True)
        super().__init__(rules, loaded, prover)
        self._programs = Programs(rules, loaded.furniture, loaded.lengths, [fact for fact, _ in facts])

    def _walls(self, request: Request, layout: list[Symbol], seed: int, inferences: int) -> dict[str, Any]:
        """The plan's own rooms with their types, and doors and windows in their walls."""
        types = {atom.arguments[0].number: str(atom.arguments[1]) for atom in layout if atom.name == "room"}
        rooms = [
            {**msgspec.to_builtins(room), "number": number, "type": types[number]}
            for number, room in enumerate(self.plan.rooms)
        ]
        openings = self._placer.own_openings(self.plan, layout, seed)
        # What the plan has stays in its place.
        kept = {frozenset(door.between): msgspec.to_builtins(door) for door in self.plan.doors}
        for door in openings["doors"]:
            names = (each if isinstance(each, str) else rooms[each]["name"] for each in door["between"])
            door.update(kept.get(frozenset(names), {}) | {"between": door["between"]})
        if self.plan.windows:
            numbers = {room["name"]: room["number"] for room in rooms}
            openings["windows"] = [
                {**msgspec.to_builtins(window), "room": numbers[window.room]} for window in self.plan.windows
            ]
        return {**openings, "rooms": rooms, "inferences": 0}


def _meetings(plan: OwnPlan) -> Walls:
    """Which rooms share walls, which sides are outer walls, wholly or in part, and which have windows."""
    found = []
    for wall in plan.walls:
        room = Number(wall.room)
        if wall.behind is None:
            found.append(Function("outside", [room, Function(wall.side)]))
        else:
            found.append(Function("touch", [room, Number(wall.behind)]))
    panes = [wall for window in plan.windows if (wall := plan.wall_of(window))]
    found += [Function("pane", [Number(wall.room), Function(wall.side)]) for wall in panes]
    return [(fact, ()) for fact in dict.fromkeys(found)]
