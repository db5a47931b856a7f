"""Briefs that a known plan keeps at their limits: a house exists.

The plan is a random tiling on a grid of decimetres, by cuts and by pinwheels, some with a void. Each length
and area of the brief comes from the plan: exact, or as the least or the greatest value.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from benchmarks.briefs.bank import BriefEntry
from benchmarks.briefs.boxes import SIDES, Box, area, around
from benchmarks.briefs.make import Json, proven
from benchmarks.briefs.plans import LEAST_VOID, KnownPlan, dissected, door_tree

DOORWAY, WINDOWED, CONTACT, LEAST_ROOM = 0.9, 1.0, 0.1, 0.9
"""Least lengths in metres: wall with a door, wall with a window, wall of neighbours, side of a room."""

ROUNDING = 1e-9
"""Rounding error of a difference of two coordinates, in metres."""

WHAT, HOW = ("sizes", "areas", "mixed"), ("exact", "limits")
"""Quantities that a brief bounds, and the kinds of bounds."""

WALLS_EVERY = 15
"""Number of briefs from one brief of ``WALLS`` to the next."""

WALLS = (
    KnownPlan(
        ((0.0, 0.0, 3.0, 3.0), (3.0, 0.0, 5.0, 3.0), (0.0, 3.0, 2.1, 6.0), (2.1, 3.0, 5.0, 6.0)),
        ("room",) * 4,
        ((0, 1), (0, 2), (0, 3)),
        0,
    ),
    KnownPlan(
        ((0.0, 0.0, 3.0, 3.0), (3.0, 0.0, 5.0, 3.0), (0.0, 3.0, 2.9, 6.0), (2.9, 3.0, 5.0, 6.0)),
        ("room",) * 4,
        ((0, 1), (0, 2), (1, 3)),
        0,
    ),
    KnownPlan(
        ((2.0, 0.0, 2.9, 3.1), (0.0, 0.0, 2.0, 3.1), (2.9, 0.0, 5.0, 3.1), (0.0, 3.1, 5.0, 6.0)),
        ("room",) * 4,
        ((0, 3), (1, 3), (2, 3)),
        0,
    ),
    KnownPlan(
        ((0.0, 0.0, 3.0, 1.9), (0.0, 1.9, 3.0, 5.0), (3.0, 2.0, 5.0, 5.0)),
        ("room",) * 3,
        ((0, 1), (1, 2)),
        0,
        ((3.0, 0.0, 5.0, 2.0),),
    ),
)
"""Plans with a wall of the least length: for a door, neighbours, the entrance, an outer wall at a void."""


def planted(number: int, least: int = 2, most: int = 6) -> BriefEntry:
    """Return brief ``number``, with ``least`` to ``most`` boxes; the kinds of briefs take turns."""
    if number % WALLS_EVERY == 0:
        return _of_walls(number, WALLS[number // WALLS_EVERY % len(WALLS)])
    rng = np.random.default_rng([56, number])
    what, how = WHAT[number % 3], HOW[number // 3 % 2]
    plan = _tiling(int(rng.integers(least, most + 1)), rng)
    brief = _read_off(plan, how == "exact", what, rng)
    name = f"planted-{number}"
    return proven(BriefEntry(name, "dissection", f"{what}, {how}", brief, "house"), plan)


def _of_walls(number: int, walls: KnownPlan) -> BriefEntry:
    """Return a brief with the exact sizes of a plan that has a wall of the least length."""
    names = [f"Room {place}" for place in range(1, len(walls.boxes) + 1)]
    sides = [[round(box[2] - box[0], 1), round(box[3] - box[1], 1)] for box in walls.boxes]
    rooms: list[Json] = [
        {"name": name, "size": [[side, side] for side in some]}
        for name, some in zip(names, sides, strict=True)
    ]
    if walls.voids:
        rooms[1]["outside"] = ["east"]
    near = walls.pairs(CONTACT - ROUNDING, np.inf)
    brief: Json = {
        "rooms": rooms,
        "doors": [[names[one], names[other]] for one, other in walls.doors],
        "next_to": [[names[one], names[other]] for one, other in near],
        "entrance": {"room": names[0], "side": walls.outer(0, DOORWAY - ROUNDING)[0]},
        "outline": _outline(walls, True, np.random.default_rng(0)) | {"width": 5, "depth": walls.outline[3]},
    }
    return proven(BriefEntry(f"planted-{number}", "dissection", "walls, exact", brief, "house"), walls)


def _tiling(boxes: int, rng: np.random.Generator) -> KnownPlan:
    """Return a random plan of ``boxes`` boxes, one of which may be a void; doors reach all rooms."""
    while True:
        side, stretch = (rng.uniform(4, 12) * boxes) ** 0.5, rng.uniform(0.7, 1.4)
        whole = (0.0, 0.0, round(side * stretch, 1), round(side / stretch, 1))
        found = dissected(whole, boxes, rng, LEAST_ROOM, 1)
        if found is None:
            continue
        found = [found[place] for place in rng.permutation(boxes)]
        voids: list[Box] = []
        if boxes > 1 and rng.random() < 0.3 and _may_be_void(found[0], found[1:]):
            voids, found = found[:1], found[1:]
        plain = KnownPlan(tuple(found), ("room",) * len(found), (), 0, tuple(voids))
        doors = door_tree(plain, rng, DOORWAY - ROUNDING)
        entrances = [room for room in range(len(found)) if plain.outer(room, DOORWAY - ROUNDING)]
        if entrances and (doors or len(found) == 1):
            plan = KnownPlan(plain.boxes, plain.types, doors, int(rng.choice(entrances)), plain.voids)
            return replace(plan, windows=tuple(_windows(plan, rng)))


def _windows(plan: KnownPlan, rng: np.random.Generator) -> Iterator[tuple[int, str]]:
    """Yield a window for some rooms, but none beside the entrance."""
    way_in = plan.entrance, plan.outer(plan.entrance, DOORWAY - ROUNDING)[0]
    for room in range(len(plan.boxes)):
        sides = [side for side in plan.outer(room, WINDOWED - ROUNDING) if (room, side) != way_in]
        if sides and rng.random() < 0.2:
            yield room, sides[0]


def _may_be_void(void: Box, rooms: list[Box]) -> bool:
    """Return True for a box that is as large as a void must be, and takes no whole side of the outline."""
    is_large = min(void[2] - void[0], void[3] - void[1]) >= LEAST_VOID - ROUNDING
    return is_large and around(rooms) == around([void, *rooms])


def _read_off(plan: KnownPlan, exact: bool, what: str, rng: np.random.Generator) -> Json:
    """Return a brief whose limits are lengths and areas of a plan."""
    names = [f"Room {number}" for number in range(1, len(plan.boxes) + 1)]
    entrance = plan.outer(plan.entrance, DOORWAY - ROUNDING)[0]
    rooms = []
    for number, box in enumerate(plan.boxes):
        room: Json = {"name": names[number]}
        if what != "areas" and rng.random() < 0.7:
            sides = [_span(box[2] - box[0], exact, rng), _span(box[3] - box[1], exact, rng)]
            room["size"] = sides if rng.random() < 0.7 else sides[::-1]
        if what != "sizes" and rng.random() < 0.7:
            room["area"] = _span(area(box), exact, rng)
        outer = plan.outer(number, CONTACT - ROUNDING)
        if outer and rng.random() < 0.3:
            room["outside"] = [outer[0]] if rng.random() < 0.7 else True
        lit = [side for room, side in plan.windows if room == number]
        rooms.append(room | ({"windows": lit} if lit else {}))
    outline = _outline(plan, exact, rng)
    brief: Json = {"rooms": rooms} | ({"outline": outline} if outline else {})
    if rng.random() < 0.2:
        brief["area"] = _span(sum(map(area, plan.boxes)), exact, rng)
    if rng.random() < 0.8:
        brief["doors"] = [[names[one], names[other]] for one, other in plan.doors]
    if rng.random() < 0.5:
        side = {"side": entrance} if rng.random() < 0.5 else {}
        brief["entrance"] = {"room": names[plan.entrance], **side}
    near, far = plan.pairs(CONTACT - ROUNDING, np.inf), plan.pairs(-np.inf, 0)
    for key, pairs in (("next_to", near), ("apart", far)):
        some = [[names[one], names[other]] for one, other in pairs if rng.random() < 0.3]
        brief |= {key: some} if some else {}
    return brief


def _outline(plan: KnownPlan, exact: bool, rng: np.random.Generator) -> Json:
    west, north, east, south = plan.outline
    found: Json = {
        key: _span(length, exact, rng)
        for key, length in (("width", east - west), ("depth", south - north))
        if rng.random() < 0.6
    }
    voids = []
    for void in plan.voids:
        at = [side for side, a, b in zip(SIDES, void, plan.outline, strict=True) if a == b]
        one: Json = {"width": round(void[2] - void[0], 1), "depth": round(void[3] - void[1], 1)}
        if len(at) == 2:
            one["corner"] = "-".join(sorted(at, key=("north", "south", "west", "east").index))
        else:
            one |= {"x": round(void[0] - west, 1), "y": round(void[1] - north, 1)}
        voids.append(one)
    return found | ({"voids": voids} if voids else {})


def _span(value: float, exact: bool, rng: np.random.Generator) -> list[float]:
    """Return a range that begins or ends at a length or an area, or does both if ``exact``."""
    value = round(value, 4)
    share = rng.uniform(0.02, 0.5)
    ends = [value, value], [value, round(value * (1 + share), 4)], [round(value * (1 - share), 4), value]
    return ends[0 if exact else rng.integers(1, 3)]
