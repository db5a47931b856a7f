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
        return {**self._placer.own_openings(self.plan, layout, seed), "rooms": rooms, "inferences": 0}


def _meetings(plan: OwnPlan) -> Walls:
    """Which rooms share walls, and which sides are outer walls, wholly or in part."""
    found = {}
    for wall in plan.walls:
        side = Function("outside", [Number(wall.room), Function(wall.side)])
        found[
            side if wall.behind is None else Function("touch", [Number(wall.room), Number(wall.behind)])
        ] = ()
    return list(found.items())
