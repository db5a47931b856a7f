"""Plans whose rooms may have any size that their areas allow.

Other plans use a convex part of these sizes (``areas.pl``), which takes less time. If that part contains no
house, this module searches all sizes.
"""

from collections.abc import Collection

from clingo import Symbol

from vitruvius.logic.errors import LimitReached
from vitruvius.logic.generation.feasibility import Feasibility
from vitruvius.logic.generation.shared_walls import SharedWallsMaker
from vitruvius.logic.grammar import Grammar
from vitruvius.logic.language.loaded import LoadedGrammar
from vitruvius.logic.layout.terms import wall_facts
from vitruvius.logic.placement.lengths import brief_lengths
from vitruvius.logic.placement.plan import Plan
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.spelling import numbered


class ExactAreasMaker(SharedWallsMaker):
    """Generator of plans by a grammar without units and without areas of several rooms together."""

    def __init__(self, grammar: Grammar, loaded: LoadedGrammar) -> None:
        """Give stage 1 the sizes as the grammar states them."""
        facts = wall_facts(*brief_lengths(loaded.placer, loaded.furniture, loaded.openings))
        super().__init__(
            grammar, loaded, Feasibility(grammar, loaded.placer, loaded.lengths, facts, thorough=True)
        )
        symbols = [fact for fact, _ in facts]
        self._programs = loaded.programs_of(grammar, symbols)

    def _walls(self, request: HouseRequest, layout: list[Symbol], seed: int, inferences: int) -> Plan:
        return self._placer.walls(layout, seed, inferences, thorough=True)

    def _no_layout(self, request: HouseRequest, unfurnishable: Collection[str]) -> Exception:
        if self._undecided:
            return LimitReached(
                f"{numbered(len(self._undecided), 'arrangement')} of the rooms could not be decided, and all "
                "others are impossible: give them a wider range of areas (room_area/3)"
            )
        return super()._no_layout(request, unfurnishable)
