"""Requirements on a plan by a topology of the user, whatever its rules state.

Rooms lie side by side, leave no gap, and have doors, windows and the entrance in the right walls. Rules
ensure most of it (``rules/shared_walls/topology.lp``). That rooms fill a plan is no linear constraint, so
each plan is examined by the geometry of the check.
"""

from collections import Counter
from collections.abc import Iterable

from clingo import Symbol

from vitruvius.logic.house.house import House
from vitruvius.logic.house.promises import Promises
from vitruvius.logic.language.loaded import LoadedGrammar

NO_PLAN = (
    "a house of {rooms} rooms by this topology is not a valid plan: {fault}: rooms must fill the outline, "
    "and a room between two lines, or court/2, must state which line comes first: see docs/plans.md"
)

OF_PLANS = ("rooms", "doors", "windows")
"""Names of the checks that a plan must pass."""


def require_tiling(house: House, layout: Iterable[Symbol], loaded: LoadedGrammar) -> None:
    """Raise ``GrammarError`` if the rooms of a layout form no plan, at the rules that cause it."""
    from vitruvius.logic.checking.check import faults  # It imports shapely, which no other house needs.

    for fault in faults(house, Promises(), OF_PLANS):
        named = {*fault.rooms}
        edges = [atom for atom in layout if atom.name == "edge"]
        edges = [atom for atom in edges if f"R{atom.arguments[0]}" in named] or edges
        why = NO_PLAN.format(rooms=len(house.rooms), fault=fault.text)
        raise loaded.rules.topology_error(why, _apart(edges, len(named)) or edges)


def _apart(edges: Iterable[Symbol], rooms: int) -> list[Symbol]:
    """Return the edges that can put rooms in a wrong place.

    They exclude those of the outline, which bounds all rooms, and those of several rooms that lie on one line
    with the same side.
    """
    sides = Counter(tuple(map(str, atom.arguments[1:])) for atom in edges)
    return [
        atom
        for atom in edges
        if not atom.arguments[2].match("outline", 1)
        and not sides[tuple(map(str, atom.arguments[1:]))] == rooms > 1
    ]
