"""Independent check that a house keeps its promises, in plain geometry.

The check reads only coordinates and shares nothing with the rules that generated the house. Its standard is
data: the promises of the grammar, which each house carries.
"""

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator
from itertools import islice
from typing import Any, NamedTuple

import numpy as np

from vitruvius.logic.checking.fault import Fault
from vitruvius.logic.checking.figures import figure, number
from vitruvius.logic.checking.grid import broken_cells, cell_of, off_grid, on_grid
from vitruvius.logic.checking.names import named
from vitruvius.logic.checking.openings import plan_corners, plan_doors, plan_windows
from vitruvius.logic.checking.room import (
    blocked_fronts,
    misplaced,
    no_turning,
    overlapping,
    unfurnished,
    wrong_arrangement,
    wrong_counts,
    wrong_fronts,
    wrong_sizes,
)
from vitruvius.logic.checking.rows import uneven_rows
from vitruvius.logic.checking.shared_walls import (
    plan_degrees,
    plan_outline,
    plan_parts,
    plan_rooms,
    plan_sizes,
    plan_units,
)
from vitruvius.logic.checking.star import (
    star_doors,
    star_main_room,
    star_rooms,
    star_shape,
    star_sides,
    star_sizes,
)
from vitruvius.logic.checking.walking import impassable, unentered
from vitruvius.logic.house.boxes import TOLERANCE
from vitruvius.logic.house.house import House
from vitruvius.logic.house.promises import Promises
from vitruvius.logic.house.topology_kinds import Kind

MAX_VIOLATIONS = 1000
"""Largest number of violations that are listed for a house. Crowded pieces and doors have millions."""

STAR, ORIGINAL, SHARED_WALLS = {Kind.STAR}, {Kind.ORIGINAL}, {Kind.SHARED_WALLS}
STARS, OURS, EVERY = STAR | ORIGINAL, STAR | SHARED_WALLS, {*Kind}


class Check(NamedTuple):
    """Check of houses or of rooms."""

    name: str
    kinds: Collection[Kind]
    """Kinds of houses to which the check applies."""
    faults: Callable[..., Iterable[Any]]
    """Function from a house and promises to faults (``Fault``).

    In ``IN_A_ROOM`` it is a function from a house, a room and promises to texts.
    """


def _area(house: House, promises: Promises) -> Iterator[Fault]:
    """Yield a fault if the rooms together are too small or too large."""
    if promises.house_area:
        least, most = promises.house_area
        whole = sum(room.area for room in house.rooms if room.type not in promises.outdoor)
        if not least - TOLERANCE <= whole <= most + TOLERANCE:
            area = figure(whole, least, most)
            yield Fault(f"house: is of {area} m² ({number(least)} to {number(most)})")


def _types(house: House, promises: Promises) -> Iterator[Fault]:
    """Yield a fault for each unknown room type, and for too few rooms of the basic types."""
    types = Counter(room.type for room in house.counted)
    for room in house.counted:
        if promises.counts and room.type not in promises.counts:
            known = ", ".join(promises.counts)
            yield Fault(f"{named(room)} is none of the room types ({known})", (room.name,))
    basic = sum(types[kind] for kind in promises.basic)
    if promises.basic and basic < 2 <= types.total():
        some = ", ".join(promises.basic)
        yield Fault(f"house: has {basic} rooms of the basic types (at least 2 of {some})")
    if types.total() >= len(promises.basic):
        for kind in promises.basic:
            if not types[kind]:
                yield Fault(f"house: has no {kind} (at least 1 from {len(promises.basic)} rooms on)")


def _in_rooms(house: House, promises: Promises) -> Iterator[Fault]:
    """Yield the faults of each room by itself."""
    asked = [check for check in IN_A_ROOM if house.kind in check.kinds]
    for room in house.counted:
        for check in asked:
            said = check.faults(house, room, promises)
            yield from (Fault(f"{named(room)}: {fault}", (room.name,)) for fault in said)


IN_A_ROOM = (
    Check("furnished", STAR, unfurnished),
    Check("pieces", EVERY, misplaced),
    Check("overlaps", EVERY, overlapping),
    Check("facing", OURS, wrong_fronts),
    Check("sizes", STAR, star_sizes),
    Check("sizes", SHARED_WALLS, wrong_sizes),
    Check("counts", OURS, wrong_counts),
    Check("arrangement", OURS, wrong_arrangement),
    Check("fronts", OURS, blocked_fronts),
    Check("turning", OURS, no_turning),
    Check("even rows", OURS, uneven_rows),
)

CHECKS = (
    Check("grid", EVERY, off_grid),
    Check("cells", STARS, broken_cells),
    Check("doors", STARS, star_doors),
    Check("rooms", STARS, star_rooms),
    Check("rooms", SHARED_WALLS, plan_rooms),
    Check("same size", SHARED_WALLS, plan_sizes),
    Check("area", EVERY, _area),
    Check("outline", SHARED_WALLS, plan_outline),
    Check("doors", SHARED_WALLS, plan_doors),
    Check("degrees", SHARED_WALLS, plan_degrees),
    Check("corners", SHARED_WALLS, plan_corners),
    Check("parts", SHARED_WALLS, plan_parts),
    Check("units", SHARED_WALLS, plan_units),
    Check("windows", SHARED_WALLS, plan_windows),
    Check("types", EVERY, _types),
    Check("sides", STAR, star_sides),
    Check("furniture", EVERY, _in_rooms),
    Check("ways", ORIGINAL, unentered),
    Check("ways", OURS, impassable),
    Check("shape", STARS, star_shape),
    Check("main room", STAR, star_main_room),
)
"""All checks, in the order of their faults in the answer.

The paper's constraints judge the original's houses: rooms may be empty. These houses do not promise the
direction of a front, the width of passages, or the least area of the main room.
"""


def violations(house: House, promises: Promises) -> list[str]:
    """Return the promises that a house breaks, in words, each with its room, pieces and lengths.

    After ``MAX_VIOLATIONS`` the list ends with a line that states that there are more.
    """
    # GEOS divides by zero if an offset of two parallel edges has no corner, and continues; NumPy would warn.
    with np.errstate(divide="ignore", invalid="ignore"):
        found = [fault.text for fault in islice(faults(house, promises), MAX_VIOLATIONS + 1)]
    if len(found) > MAX_VIOLATIONS:
        found[-1] = f"house: has more than {MAX_VIOLATIONS:,} violations, and the rest are not listed"
    return found


def faults(house: House, promises: Promises, names: Collection[str] = ()) -> Iterator[Fault]:
    """Yield the promises that a house breaks.

    ``names``: names of the checks to run; all checks if empty.
    """
    if cell := cell_of(house):
        promises = on_grid(promises, cell)
    asked = (check for check in CHECKS if house.kind in check.kinds and (not names or check.name in names))
    for check in asked:
        yield from check.faults(house, promises)
