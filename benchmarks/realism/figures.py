"""What is measured of a plan, whoever made it: rooms, doors and walls alone, by the names of types."""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from logic.house.boxes import Box
from logic.house.house import House
from logic.request.own_plan import OwnPlan

SHARED = 0.1
"""Metres of a wall that two rooms share at least that share one."""


@dataclass(frozen=True)
class PlanFigures:
    """The figures of one plan."""

    rooms: tuple[tuple[str, float, float], ...]
    """Of each room its type, its area (m²), and its longer side over its shorter one."""
    doors: int
    """Between rooms."""
    adjacent: Counter[tuple[str, str]]
    """How many pairs of rooms share a wall, by their types in order."""

    @property
    def types(self) -> Counter[str]:
        """How many rooms there are of each type."""
        return Counter(type_ for type_, *_ in self.rooms)

    @property
    def area(self) -> float:
        """Square metres of all rooms."""
        return sum(area for _, area, _ in self.rooms)

    @property
    def doors_a_room(self) -> float:
        """Doors between rooms, over rooms."""
        return self.doors / len(self.rooms)

    def share(self, type_: str) -> float:
        """What of the area rooms of a type have."""
        return sum(area for each, area, _ in self.rooms if each == type_) / self.area


def measured(plan: House | OwnPlan) -> PlanFigures:
    """The figures of a house or of a given plan."""
    rooms = tuple(
        (room.type, room.area, max(room.width, room.height) / min(room.width, room.height))
        for room in plan.rooms
    )
    pairs = Counter[tuple[str, str]]()
    for one, other in combinations(plan.rooms, 2):
        if _shared(one.box, other.box) >= SHARED - 1e-6:
            first, second = sorted((one.type, other.type))
            pairs[first, second] += 1
    return PlanFigures(rooms, sum(not door.is_entrance for door in plan.doors), pairs)


def _shared(one: Box, other: Box) -> float:
    """Metres of wall that two boxes share: where they touch one way, their overlap the other way."""
    gaps = [max(one[k], other[k]) - min(one[k + 2], other[k + 2]) for k in (0, 1)]
    return max((-gaps[1 - k] for k in (0, 1) if abs(gaps[k]) < 1e-3), default=0.0)


def features(plans: Sequence[PlanFigures], types: Iterable[str]) -> NDArray[np.float64]:
    """A row a plan: rooms, area, doors; of each type how many, how large, how long; pairs that share a wall.

    ``types``: those of both sets. (plans, features), without a unit.
    """
    names = sorted(types)
    pairs = [(one, other) for i, one in enumerate(names) for other in names[i:]]
    return np.array([_row(plan, names, pairs) for plan in plans])


def _row(plan: PlanFigures, names: Sequence[str], pairs: Sequence[tuple[str, str]]) -> list[float]:
    row = [float(len(plan.rooms)), plan.area, plan.doors_a_room]
    for name in names:
        own = [(area, ratio) for type_, area, ratio in plan.rooms if type_ == name]
        mean = np.mean(own, axis=0) if own else np.zeros(2)
        row += [float(len(own)), *map(float, mean)]
    return row + [float(plan.adjacent[pair]) for pair in pairs]
