"""Houses by a brief: the rooms that the brief names, in any dissection of an outline.

Each house has a program of its own, for which clasp learns an order of search. With doors, areas and sizes
given, a layout is hard to find by sampled picks one after the other.
"""

from contextlib import suppress
from enum import Enum

from clingo import Symbol
from msgspec import structs

from vitruvius.logic.errors import RequestError
from vitruvius.logic.generation.feasibility import Feasibility
from vitruvius.logic.generation.loop import Maker, NoLayout, Stages, Work, made
from vitruvius.logic.generation.shared_walls import Making, PlanDraft, PlanRules, house
from vitruvius.logic.grammar import Grammar
from vitruvius.logic.house.house import House
from vitruvius.logic.language.loaded import OUTDOOR_AREA, LoadedGrammar
from vitruvius.logic.layout.terms import ASKED_DOORS, brief_facts, wall_facts
from vitruvius.logic.placement.lengths import brief_lengths, metres
from vitruvius.logic.placement.plan import Plan, PlanRoom
from vitruvius.logic.request.brief import Brief
from vitruvius.logic.request.house_request import HouseRequest

MAX_UNDECIDED_LAYOUTS = 1
"""Number of undecided layouts of a house after which all layouts are decided thoroughly, which is slower."""

ADVICE = "another seed, larger rooms, or fewer lines in the brief"


class Deciding(Enum):
    """Ways to decide if a layout has areas that the brief permits."""

    QUICKLY = "quickly"
    THOROUGHLY = "thoroughly"
    """See ``Placer.walls``."""


def brief_maker(grammar: Grammar, loaded: LoadedGrammar, brief: Brief, thorough: bool = False) -> Maker:
    """Return the generator of the houses of one brief. ``thorough`` decides all layouts thoroughly."""
    _require_possible(grammar, loaded, brief)
    own = grammar.for_brief()
    on_request = not grammar.names_contacts
    facts = wall_facts(*brief_lengths(loaded.placer, loaded.furniture, loaded.openings))
    symbols = [fact for fact, _ in facts]
    symbols += brief_facts(brief, on_request, symbols)
    facts += [(fact, ()) for fact in brief_facts(brief, on_request)]
    feasibility = Feasibility(own, loaded.placer, loaded.lengths, facts, thorough=thorough)
    ways = [loaded.programs_of(own, symbols)]
    if not (brief.is_alone or brief.other_doors):
        # No doors beyond those of the brief, if the grammar's rules permit that.
        ways.insert(0, loaded.programs_of(own, [*symbols, ASKED_DOORS]))
    *few_doors, rules = (
        PlanRules(
            own,
            loaded,
            feasibility,
            each,
            ADVICE,
            "the brief's rooms",
            "give the areas a wider range (tolerance)",
        )
        for each in ways
    )
    deciding = Deciding.THOROUGHLY if thorough else Deciding.QUICKLY

    def by_brief(request: HouseRequest, work: Work) -> tuple[House, Making]:
        for some in few_doors:
            with suppress(NoLayout):
                return _made(some, brief, request, work, deciding)
        return _made(rules, brief, request, work, deciding)

    return Maker(feasibility, by_brief, lambda request: loaded.programs.rooms_for(request)[0])


def _made(
    rules: PlanRules, brief: Brief, request: HouseRequest, work: Work, deciding: Deciding
) -> tuple[House, Making]:
    """Return a house by a brief, with the names of the brief."""
    draft = BriefDraft(PlanDraft(rules, request, work, rules.assumed(request, work, is_free=True)), deciding)
    done = made(Stages(draft.sample, draft.place, draft.plan.furnish, draft.plan.learn))
    name_rooms(done.plan.rooms, brief)
    return house(rules, done)


def name_rooms(rooms: list[PlanRoom], brief: Brief) -> None:
    """Give rooms the names of a brief, and its labels as types."""
    for place, room in enumerate(brief.rooms):
        as_named = {"name": room.name, "type": room.label or rooms[place].type}
        rooms[place] = structs.replace(rooms[place], **as_named)


class BriefDraft:
    """House by a brief, in progress.

    Undecided layouts become available again, to be decided thoroughly, after many of them or if no other
    layouts are left.
    """

    def __init__(self, plan: PlanDraft, deciding: Deciding) -> None:
        """Begin without undecided layouts."""
        self.plan, self.deciding = plan, deciding

    def sample(self) -> list[Symbol]:
        """Sample a layout. Raises as ``PlanDraft.sample`` does."""
        plan = self.plan
        if self.deciding is Deciding.QUICKLY:
            if len(plan.undecided) < MAX_UNDECIDED_LAYOUTS:
                layout = plan.layout()
                if layout is not None:
                    return layout
                if not plan.undecided:
                    raise plan.no_layout()
            plan.nogoods = [each for each in plan.nogoods if each not in plan.undecided]
            plan.undecided, self.deciding = [], Deciding.THOROUGHLY
        return plan.sample()

    def place(self, layout: list[Symbol]) -> Plan:
        """Return walls, doors and windows with their places: see ``Placer.walls``."""
        return self.plan.place(layout, thorough=self.deciding is Deciding.THOROUGHLY)


def _require_possible(grammar: Grammar, loaded: LoadedGrammar, brief: Brief) -> None:
    """Raise ``RequestError`` for a grammar that states what a brief cannot keep."""
    if loaded.depths:
        raise RequestError(f"brief: houses of the grammar {grammar.name} have units: choose another grammar")
    if loaded.has_area and brief.outline.voids:
        raise RequestError(
            f"brief: outline.voids: the grammar {grammar.name} states house_area/2, which applies only to "
            "rectangular houses: leave out the voids, or choose another grammar"
        )
    if loaded.has_area and loaded.outdoor:
        raise RequestError(f"brief: {OUTDOOR_AREA.format(grammar.name)}")
    if metres(loaded.placer, loaded.furniture)["wholes"]:
        raise RequestError(
            f"brief: the grammar {grammar.name} states whole_area/3, the area of rooms with their parts, "
            "which a brief cannot satisfy: state the areas in the brief, and choose a grammar without this "
            "clause"
        )
    if loaded.has_area and loaded.placer.wall_thickness:
        raise RequestError(
            f"brief: the grammar {grammar.name} states house_area/2 and wall_thickness/2, and a brief does "
            "not support both: choose another grammar"
        )
