"""Houses by a brief: the rooms that the brief names, in any dissection of an outline.

Each house has a program of its own, for which clasp learns an order of search. With doors, areas and sizes
given, a layout is hard to find by sampled picks one after the other.
"""

from collections.abc import Collection
from contextlib import suppress

import numpy as np
from clingo import Symbol
from msgspec import structs

from vitruvius.logic.errors import LimitReached, RequestError
from vitruvius.logic.generation.evidence import NoLayout
from vitruvius.logic.generation.feasibility import Feasibility
from vitruvius.logic.generation.shared_walls import SharedWallsMaker
from vitruvius.logic.grammar import Grammar
from vitruvius.logic.house.house import House
from vitruvius.logic.language.loaded import OUTDOOR_AREA, LoadedGrammar
from vitruvius.logic.layout.program import Nogood, Program
from vitruvius.logic.layout.programs import Programs
from vitruvius.logic.layout.terms import ASKED_DOORS, brief_facts, wall_facts
from vitruvius.logic.placement.lengths import brief_lengths, metres
from vitruvius.logic.placement.plan import Pieces, Plan
from vitruvius.logic.request.brief import Brief
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.spelling import numbered

MAX_UNDECIDED_LAYOUTS = 1
"""Number of undecided layouts of a house after which all layouts are decided thoroughly, which is slower."""


class BriefMaker(SharedWallsMaker):
    """Generator of the houses of one brief by one grammar."""

    advice = "another seed, larger rooms, or fewer lines in the brief"

    def __init__(self, grammar: Grammar, loaded: LoadedGrammar, brief: Brief, thorough: bool = False) -> None:
        """Derive the facts of the brief for stage 1. ``thorough``: see ``Placer.walls``."""
        if loaded.depths:
            raise RequestError(f"brief: houses of the grammar {grammar.name} have units: take another")
        if loaded.has_area and brief.outline.voids:
            raise RequestError(
                f"brief: outline.voids: the grammar {grammar.name} states house_area/2, which holds of whole "
                "rectangles: leave out the voids, or take another grammar"
            )
        if loaded.has_area and loaded.outdoor:
            raise RequestError(f"brief: {OUTDOOR_AREA.format(grammar.name)}")
        if metres(loaded.placer, loaded.furniture)["wholes"]:
            raise RequestError(
                f"brief: the grammar {grammar.name} states whole_area/3, the area of rooms with their parts, "
                "which a brief cannot keep: say the areas in the brief, and take a grammar without it"
            )
        if loaded.has_area and loaded.placer.wall_thickness:
            raise RequestError(
                f"brief: the grammar {grammar.name} states house_area/2 and wall_thickness/2, and no brief "
                "has both: take another grammar"
            )
        self.brief = brief
        rules = grammar.for_brief()
        on_request = not grammar.names_contacts
        facts = wall_facts(*brief_lengths(loaded.placer, loaded.furniture, loaded.openings))
        symbols = [fact for fact, _ in facts]
        symbols += brief_facts(brief, on_request, symbols)
        facts += [(fact, ()) for fact in brief_facts(brief, on_request)]
        super().__init__(
            rules, loaded, Feasibility(rules, loaded.placer, loaded.lengths, facts, thorough=thorough)
        )
        self._all_doors = loaded.programs_of(rules, symbols)
        self._few_doors = None
        if not (brief.is_alone or brief.other_doors):
            self._few_doors = loaded.programs_of(rules, [*symbols, ASKED_DOORS])

    def made(self, request: HouseRequest, rng: np.random.Generator, inferences: int) -> House:
        """Return a furnished house: see ``Maker.made``.

        The house has no doors beyond those of the brief, if the grammar's rules permit that.
        """
        if self._few_doors:
            with suppress(NoLayout):
                return self._made_by(self._few_doors, request, rng, inferences)
        return self._made_by(self._all_doors, request, rng, inferences)

    def _made_by(
        self, programs: Programs, request: HouseRequest, rng: np.random.Generator, inferences: int
    ) -> House:
        self._programs = programs
        self._undecided, self._thorough = (), self.feasibility.thorough
        return super().made(request, rng, inferences)

    def stated(self, request: HouseRequest) -> Program:
        """Return the program of the last house if there is one, since no other program has its facts."""
        return self._one_house or super().stated(request)

    def _layout(
        self,
        request: HouseRequest,
        rng: np.random.Generator,
        nogoods: list[Nogood],
        unfurnishable: Collection[str],
    ) -> list[Symbol]:
        """Return a layout as for any plan.

        Undecided layouts become available again, to be decided thoroughly, after many of them or if no other
        layouts are left.
        """
        if self._thorough or len(self._undecided) < MAX_UNDECIDED_LAYOUTS:
            try:
                return super()._layout(request, rng, nogoods, unfurnishable)
            except LimitReached:
                if self._thorough:
                    raise
        nogoods[:] = [each for each in nogoods if each not in self._undecided]
        self._undecided, self._thorough = (), True
        return super()._layout(request, rng, nogoods, unfurnishable)

    def _walls(self, request: HouseRequest, layout: list[Symbol], seed: int, inferences: int) -> Plan:
        """Place walls as for any plan, but thoroughly once ``_layout`` has no other layouts."""
        return self._placer.walls(layout, seed, inferences, thorough=self._thorough)

    def _no_layout(self, request: HouseRequest, unfurnishable: Collection[str]) -> Exception:
        if self._undecided:
            return LimitReached(
                f"{numbered(len(self._undecided), 'arrangement')} of the brief's rooms could not be decided, "
                "and all others are impossible: give its areas a wider range (tolerance)"
            )
        return super()._no_layout(request, unfurnishable)

    def complete(
        self, request: HouseRequest, rng: np.random.Generator, inferences: int
    ) -> tuple[Plan, list[Pieces], int]:
        """Return a plan as for any request, with the names of the brief."""
        plan, pieces, left = super().complete(request, rng, inferences)
        for place, room in enumerate(self.brief.rooms):
            as_named = {"name": room.name, "type": room.label or plan.rooms[place].type}
            plan.rooms[place] = structs.replace(plan.rooms[place], **as_named)
        return plan, pieces, left

    def _searches_freely(self, request: HouseRequest) -> bool:
        return True
