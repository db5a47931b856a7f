"""Figures of a plan from any source: rooms, doors and walls only, by the names of types."""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from vitruvius.logic.house.boxes import Box
from vitruvius.logic.house.house import House
from vitruvius.logic.request.own_plan import OwnPlan

SHARED = 0.1
"""Smallest length of wall, in metres, at which two rooms count as sharing a wall."""


@dataclass(frozen=True)
class PlanFigures:
    """Figures of one plan."""

    rooms: tuple[tuple[str, float, float], ...]
    """For each room its type, its area (m²), and the ratio of its longer to its shorter side."""
    doors: int
    """Number of doors between rooms."""
    adjacent: Counter[tuple[str, str]]
    """Number of pairs of rooms that share a wall, by their types in order."""

    @property
    def types(self) -> Counter[str]:
        """Number of rooms of each type."""
        return Counter(type_ for type_, *_ in self.rooms)

    @property
    def area(self) -> float:
        """Total area of the rooms, in square metres."""
        return sum(area for _, area, _ in self.rooms)

    @property
    def doors_a_room(self) -> float:
        """Number of doors between rooms, per room."""
        return self.doors / len(self.rooms)

    def share(self, type_: str) -> float:
        """Return the fraction of the area that rooms of a type have."""
        return sum(area for each, area, _ in self.rooms if each == type_) / self.area


def measured(plan: House | OwnPlan) -> PlanFigures:
    """Return the figures of a house or of a given plan."""
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
    """Return the length of the wall that two boxes share, in metres.

    It is their overlap along the side where they touch.
    """
    gaps = [max(one[k], other[k]) - min(one[k + 2], other[k + 2]) for k in (0, 1)]
    return max((-gaps[1 - k] for k in (0, 1) if abs(gaps[k]) < 1e-3), default=0.0)


def features(plans: Sequence[PlanFigures], types: Iterable[str]) -> NDArray[np.float64]:
    """Return a row of features for each plan, (plans, features), without a unit.

    Features are rooms, area, doors; for each type number, area and proportions of its rooms; and pairs that
    share a wall. ``types``: those of both sets.
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
