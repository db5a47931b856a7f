"""Known plans from which briefs are read: rooms of generated houses, and of random dissections."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from benchmarks.briefs.boxes import Box, around, contact, outer_parts, shared
from vitruvius.logic import generate
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import OUTSIDE, Door, Room, Window

DOORWAY = 0.92
"""Length of wall that a door of a plan has, in metres. It is more than the 0.9 m that ours take, with
margins."""

LEAST_VOID = 1.0
"""Smallest side of a void, in metres, as in ``docs/briefs.md``."""

LEAST_ROOM = 1.5
"""Smallest side of a room of a random dissection, in metres."""

PINWHEEL = 0.5
"""Probability that five or more rooms of a random dissection begin with a pinwheel, which no cut goes
through."""


@dataclass(frozen=True)
class KnownPlan:
    """Boxes on a grid of centimetres, which with the voids tile a rectangle; doors are pairs of boxes."""

    boxes: tuple[Box, ...]
    types: tuple[str, ...]
    doors: tuple[tuple[int, int], ...]
    entrance: int
    voids: tuple[Box, ...] = ()
    windows: tuple[tuple[int, str], ...] = ()
    """Boxes and sides that have a window."""

    @property
    def outline(self) -> Box:
        """Rectangle around the plan."""
        return around(self.boxes)

    def pairs(self, least: float, most: float) -> list[tuple[int, int]]:
        """Return the pairs of rooms that share from ``least`` to ``most`` metres of wall."""
        return [
            (one, other)
            for other in range(len(self.boxes))
            for one in range(other)
            if least <= contact(self.boxes[one], self.boxes[other]) <= most
        ]

    def outer(self, room: int, least: float = DOORWAY) -> list[str]:
        """Return the sides of a room with an outer wall of ``least`` metres, the longest wall first."""
        walls = [side for side, low, high in self._outer_walls(room) if high - low >= least]
        return list(dict.fromkeys(walls))

    def _outer_walls(self, room: int) -> list[tuple[str, float, float]]:
        """Return the outer walls of a room, the longest first: at the outline, or at a void in its rim.

        A court, a void inside the plan, is not outside.
        """
        courts = [void for void in self.voids if not self._in_rim(void)]
        walls = outer_parts((*self.boxes, *courts), room)
        return sorted(walls, key=lambda wall: wall[1] - wall[2])

    def _in_rim(self, void: Box) -> bool:
        return any(abs(a - b) < 1e-9 for a, b in zip(void, self.outline, strict=True))

    def house(self, names: list[str]) -> House:
        """Return the plan as a house whose rooms have these names."""
        rooms = [
            Room(west, north, east - west, south - north, name, type_, ())
            for (west, north, east, south), name, type_ in zip(self.boxes, names, self.types, strict=True)
        ]
        doors = [
            _door(self.boxes[one], self.boxes[other], (names[one], names[other])) for one, other in self.doors
        ]
        side, low, high = self._outer_walls(self.entrance)[0]
        doors.append(_segment(self.boxes[self.entrance], side, low, high, (names[self.entrance], OUTSIDE)))
        windows = [self._window(room, side, names[room]) for room, side in self.windows]
        return House(tuple(rooms), tuple(doors), tuple(windows), topology="dissection")

    def _window(self, room: int, side: str, name: str) -> Window:
        """Return a window as wide as a door, in the longest part of an outer wall."""
        low, high = next((low, high) for at, low, high in self._outer_walls(room) if at == side)
        door = _segment(self.boxes[room], side, low, high, (name, OUTSIDE))
        return Window(door.x, door.y, door.width, door.height, name)


def _door(one: Box, other: Box, between: tuple[str, str]) -> Door:
    wall = shared(one, other)
    assert wall is not None
    side, low, high = wall
    return _segment(one, side, low, high, between)


def _segment(box: Box, side: str, low: float, high: float, between: tuple[str, str]) -> Door:
    """Return a door of 0.8 m in the middle of a wall."""
    start = (low + high) / 2 - 0.4
    if side in ("west", "east"):
        return Door(box[0 if side == "west" else 2], start, 0.0, 0.8, between)
    return Door(start, box[1 if side == "north" else 3], 0.8, 0.0, between)


# - of houses -----------------------------------------------------------------


def of_houses(grammar: str, rooms: int, seed: int) -> Iterator[KnownPlan]:
    """Yield plans of houses of a grammar, without end; houses whose plan cannot be read are skipped."""
    start = 0
    while True:
        for house in generate(rooms, grammar=grammar, seed=seed, start=start, count=16):
            if plan := of_house(house):
                yield plan
        start += 16


def of_house(house: House) -> KnownPlan | None:
    """Return the plan of a house, or None if a doorway or a void is too small, or a void is no rectangle."""
    west, north, _, _ = around(room.box for room in house.rooms)
    boxes = tuple(
        (
            round(room.box[0] - west, 2),
            round(room.box[1] - north, 2),
            round(room.box[2] - west, 2),
            round(room.box[3] - north, 2),
        )
        for room in house.rooms
    )
    places = {room.name: place for place, room in enumerate(house.rooms)}
    pairs = {
        tuple(sorted(places[name] for name in door.between)) for door in house.doors if not door.is_entrance
    }
    entrances = [
        places[name] for door in house.doors if door.is_entrance for name in door.between if name != OUTSIDE
    ]
    voids = _free(boxes)
    if voids is None or not entrances:
        return None
    doors = tuple((one, other) for one, other in sorted(pairs))
    plan = KnownPlan(boxes, tuple(room.type for room in house.rooms), doors, entrances[0], voids)
    wide = all(contact(boxes[one], boxes[other]) >= DOORWAY for one, other in doors)
    return plan if wide and plan.outer(plan.entrance) else None


def _free(boxes: tuple[Box, ...]) -> tuple[Box, ...] | None:
    """Return the free areas in the rectangle around boxes, as boxes; None if they are no boxes."""
    from shapely import box, unary_union

    rest = box(*around(boxes)).difference(
        unary_union([box(*each) for each in boxes]).buffer(1e-6, join_style="mitre")
    )
    parts = [part for part in getattr(rest, "geoms", [rest]) if part.area > 1e-4]
    found = []
    for part in parts:
        west, north, east, south = (round(each, 2) for each in part.bounds)
        if (
            min(east - west, south - north) < LEAST_VOID
            or abs((east - west) * (south - north) - part.area) > 1e-2
        ):
            return None
        found.append((west, north, east, south))
    return tuple(found)


# - random dissections --------------------------------------------------------


def of_dissection(rooms: int, rng: np.random.Generator) -> KnownPlan:
    """Return a random dissection of a rectangle with about 14 m² for each room; doors reach all its rooms."""
    while True:
        side = (rng.uniform(11, 17) * rooms) ** 0.5
        stretch = rng.uniform(0.85, 1.2)
        whole = (0.0, 0.0, round(side * stretch, 2), round(side / stretch, 2))
        boxes = dissected(whole, rooms, rng)
        if boxes is None:
            continue
        boxes = [boxes[place] for place in rng.permutation(rooms)]
        plain = KnownPlan(tuple(boxes), ("room",) * rooms, (), 0)
        outer = [room for room in range(rooms) if plain.outer(room)]
        doors = door_tree(plain, rng)
        if doors and outer:
            return KnownPlan(plain.boxes, plain.types, doors, int(rng.choice(outer)))


def dissected(
    box: Box, rooms: int, rng: np.random.Generator, least: float = LEAST_ROOM, digits: int = 2
) -> list[Box] | None:
    """Return a box cut into ``rooms`` boxes, at lines and as pinwheels of five; None if one is too small."""
    west, north, east, south = box
    if min(east - west, south - north) < least:
        return None
    if rooms == 1:
        return [box]
    x1, x2 = np.round(west + (east - west) * np.sort(rng.uniform(0.25, 0.75, 2)), digits).tolist()
    y1, y2 = np.round(north + (south - north) * np.sort(rng.uniform(0.25, 0.75, 2)), digits).tolist()
    if rooms >= 5 and rng.random() < PINWHEEL:
        arms = [(west, north, x2, y1), (x2, north, east, y2), (x1, y2, east, south), (west, y1, x1, south)]
        if rng.random() < 0.5:
            arms = [
                (x1, north, east, y1),
                (x2, y1, east, south),
                (west, y2, x2, south),
                (west, north, x1, y2),
            ]
        parts: list[Box] = [*arms, (x1, y1, x2, y2)]
    elif rng.random() * (east - west + south - north) < east - west:
        parts = [(west, north, x1, south), (x1, north, east, south)]
    else:
        parts = [(west, north, east, y1), (west, y1, east, south)]
    found: list[Box] = []
    for part, some in zip(parts, _shared_out(parts, rooms, rng), strict=True):
        inside = dissected(part, some, rng, least, digits)
        if inside is None:
            return None
        found += inside
    return found


def _shared_out(parts: list[Box], rooms: int, rng: np.random.Generator) -> list[int]:
    """Return the number of rooms of each part: one, and more in proportion to its area."""
    areas = np.array([(east - west) * (south - north) for west, north, east, south in parts])
    return (1 + rng.multinomial(rooms - len(parts), areas / areas.sum())).tolist()


def door_tree(
    plan: KnownPlan, rng: np.random.Generator, least: float = DOORWAY
) -> tuple[tuple[int, int], ...]:
    """Return random doors that reach all rooms, and a few more; no doors if walls are too short."""
    pairs = plan.pairs(least, np.inf)
    joined, doors, more = [{room} for room in range(len(plan.boxes))], [], []
    for place in rng.permutation(len(pairs)):
        one, other = pairs[place]
        if joined[one] is joined[other]:
            more.append((one, other))
            continue
        doors.append((one, other))
        joined[one] |= joined[other]
        for room in joined[other]:
            joined[room] = joined[one]
    if len(joined[0]) < len(plan.boxes):
        return ()
    return tuple(sorted(doors + more[: len(plan.boxes) // 5]))
