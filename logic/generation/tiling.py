"""What a plan by a topology of the user's own must be in the end, whatever its rules say.

Rooms lie side by side, leave no gap, and have doors, windows and the entrance where these lead. Rules
keep most of it (``rules/shared_walls/topology.lp``). That rooms fill a plan is no linear constraint, so it is
looked at in each plan, by the same geometry as in the check.
"""

from collections import Counter
from collections.abc import Iterable

from clingo import Symbol

from logic.checking.check import faults
from logic.house.house import House
from logic.house.promises import Promises
from logic.language.loaded import LoadedGrammar

NO_PLAN = (
    "a house of {rooms} rooms by this topology is no plan: {fault}: rooms fill what they enclose, and of two "
    "lines one comes first by the rooms between them or by court/2: see docs/plans.md"
)

OF_PLANS = ("rooms", "doors", "windows")
"""Of the check's, what is asked of a plan."""


def require_tiling(house: House, layout: Iterable[Symbol], loaded: LoadedGrammar) -> None:
    """Raise ``GrammarError`` if the rooms of a layout are no plan, at the rules that lay them out so."""
    for fault in faults(house, Promises(), OF_PLANS):
        named = {*fault.rooms}
        edges = [atom for atom in layout if atom.name == "edge"]
        edges = [atom for atom in edges if f"R{atom.arguments[0]}" in named] or edges
        why = NO_PLAN.format(rooms=len(house.rooms), fault=fault.text)
        raise loaded.rules.topology_error(why, _apart(edges, len(named)) or edges)


def _apart(edges: Iterable[Symbol], rooms: int) -> list[Symbol]:
    """The edges that can bring rooms where they must not be: not those of the outline, which bounds all, nor
    those of several rooms that lie on one line with the same side.
    """
    sides = Counter(tuple(map(str, atom.arguments[1:])) for atom in edges)
    return [
        atom
        for atom in edges
        if not atom.arguments[2].match("outline", 1)
        and not sides[tuple(map(str, atom.arguments[1:]))] == rooms > 1
    ]
