"""What a plan by a topology of the user's own must be in the end, whatever its rules say.

Rooms lie side by side, leave no gap, and have doors, windows and the entrance where these lead. Rules
keep most of it (``rules/shared_walls/topology.lp``). That rooms fill a plan is no linear constraint, so it is
looked at in each plan, by the same geometry as in the check.
"""

from collections.abc import Iterator
from itertools import chain

from logic.checking.shared_walls import plan_doors, plan_rooms, plan_windows
from logic.house.house import House
from logic.house.promises import Promises
from logic.language.loaded import LoadedGrammar

NO_PLAN = (
    "a house of {rooms} rooms by this topology is no plan: {fault}: rooms fill what they enclose, and of two "
    "lines one comes first by the rooms between them or by court/2: see docs/plans.md"
)


def require_tiling(house: House, loaded: LoadedGrammar) -> None:
    """Raise ``GrammarError`` at the rules that lay out the rooms where these are no plan."""
    for fault in _faults(house):
        raise loaded.topology_error(NO_PLAN.format(rooms=len(house.rooms), fault=fault))


def _faults(house: House) -> Iterator[str]:
    nothing = Promises()
    return chain(plan_rooms(house, nothing), plan_doors(house, nothing), plan_windows(house, nothing))
