"""Places of a house's lattice where episodes start and targets lie, found once during packing.

A target may lie at a place that the body can reach and whose whole square is free floor. A task may also name
a target's place, if the body can pick up the target there.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vitruvius.logic import House
from vitruvius.sim.backends.backend import Lattice
from vitruvius.sim.config import Config
from vitruvius.sim.geometry import TOLERANCE, Geometry
from vitruvius.sim.tasks.furniture import WeightedTask
from vitruvius.sim.tasks.survey import Survey
from vitruvius.sim.tasks.tasks import AnyTask, Box, FixedTask, Task, has_targets

NORTH = 2
"""Heading of the start nearest to the main room's middle."""

NOWHERE = 1e6
"""Coordinate of the placeholder target of a task without targets, in steps: no body and no ray gets there."""

LISTED = 4096
"""Approximate number of entries in a house's list of places, if some places are drawn more often than
others."""


@dataclass(frozen=True)
class Region:
    """Some of a house's targets, and the probability that the next target is one of them, uniformly."""

    targets: np.ndarray
    """(n,) int: rows of ``Places.targets``."""
    share: float
    """Probability that the next target is drawn from the region."""


@dataclass(frozen=True)
class Places:
    """Starts and targets of a house, in steps east and south of its lattice's origin."""

    starts: np.ndarray
    """(n, 2) int32."""
    targets: np.ndarray
    """(m, 2) float32: whole steps, except for targets at given places. Sorted from west to east."""
    heading: int = -1
    """Heading of all starts, in eighths of a turn; -1 for a random heading."""
    given: bool = False
    """True if the task gives the places of the targets."""
    regions: tuple[Region, ...] = ()
    """Regions of a weighted task; empty if all targets are equally probable."""
    counts: np.ndarray | None = None
    """(m,) int: number of entries of each target in the list from which the next is drawn; one by default."""
    stages: tuple[np.ndarray, ...] = ()
    """Rows of ``targets`` from which each stage's target is drawn, for a task with an order."""

    @property
    def listed(self) -> np.ndarray:
        """(n, 2) float32: the list from which the next target is drawn uniformly."""
        return self.targets if self.counts is None else np.repeat(self.targets, self.counts, axis=0)

    def spread(self, pitch: int) -> np.ndarray:
        """Return rows of targets on a grid of ``pitch`` steps, (k,) int: all given ones, or at least one."""
        chosen = np.flatnonzero((self.targets % pitch == 0).all(axis=1))
        if self.given:
            return np.arange(len(self.targets))
        return chosen if len(chosen) else np.zeros(1, int)


def places(
    house: House,
    geometry: Geometry,
    lattice: Lattice,
    survey: Survey,
    config: Config,
    task: AnyTask,
    start: np.ndarray | None = None,
) -> Places:
    """Find a house's starts and a task's targets from what the body can do there.

    Bodies start at the task's cell ``start`` (i, j, heading), in the task's ``start_spaces``, or by default
    in ``House.start``, such as the main room or the hub.

    Raises ``ValueError`` if there is no free place for a body to start, if the body cannot reach a room in
    which the task has targets, or if there is no free place for a target.
    """
    spaces = getattr(task, "start_spaces", lambda house: [])(house)
    starts, reached, heading = _starts(house, geometry, lattice, survey, config, start, spaces)
    first = np.argwhere(starts).astype(np.int32)
    if isinstance(task, FixedTask):
        targets, rows = _given(house, lattice, reached, config, task)
        stages = tuple(rows[:, None]) if getattr(task, "in_order", False) else ()
        return Places(first, targets.astype(np.float32), heading, True, stages=stages)
    room = _Room(house, geometry, lattice, reached, config)
    if isinstance(task, WeightedTask):
        return Places(first, *_weighted(room, task, heading))
    if in_stages := getattr(task, "stages", None):
        fits = [_free(room, list(spaces), task).ravel() for spaces in in_stages(house)]
        union = np.flatnonzero(np.logical_or.reduce(fits))
        stages = tuple(np.searchsorted(union, np.flatnonzero(each)) for each in fits)
        targets = np.column_stack(np.unravel_index(union, reached.shape)).astype(np.float32)
        return Places(first, targets, heading, stages=stages)
    targets = np.argwhere(_free(room, list(task.spaces(house)), task)).astype(np.float32)
    if not has_targets(task):
        targets = np.full((1, 2), NOWHERE, np.float32)
    return Places(first, targets, heading)


def free_floor(
    house: House, geometry: Geometry, lattice: Lattice, survey: Survey, config: Config
) -> np.ndarray:
    """Return all free floor that the body can reach, (m, 2) float32 steps: the possible places of targets."""
    _, reached, _ = _starts(house, geometry, lattice, survey, config, None)
    room = _Room(house, geometry, lattice, reached, config)
    return np.argwhere(room.inside).astype(np.float32)


def _starts(
    house: House, geometry: Geometry, lattice: Lattice, survey: Survey, config: Config,
    start: np.ndarray | None, spaces: Sequence[Box] = (),
) -> tuple[np.ndarray, np.ndarray, int]:  # fmt: skip
    """Return masks (X, Y) bool of the starts and of all places within reach, and the starts' heading."""
    free = survey.part > 0
    if start is not None:
        i, j, heading = start.tolist()
        starts = np.zeros_like(free)
        starts[i, j] = free[i, j]
        if not starts.any():
            raise ValueError("the robot cannot turn where the task starts")
        reached = survey.part == survey.part[i, j]
    else:
        body, usual = max(config.body) / 2, house.start.box
        spaces, starts = spaces or [usual], np.zeros_like(free)
        for space in spaces:
            outside = _touched(geometry.rooms, body, lattice) if space == usual else np.zeros_like(free)
            starts |= free & _within(_row(space), body, lattice) & ~outside
        if not starts.any():
            names = ", ".join(_name(space, house) for space in spaces)
            raise ValueError(f"the robot finds no place to stand in {names}")
        # If the house has parts that no path joins, the body is in the part with most of the room.
        reached = survey.part == np.bincount(survey.part[starts]).argmax()
        starts &= reached
        heading = -1 if config.random_start else NORTH
        if not config.random_start:
            starts = _nearest(starts, _row(spaces[0]), lattice)
    return starts, reached, heading


def _given(
    house: House, lattice: Lattice, reached: np.ndarray, config: Config, task: FixedTask
) -> tuple[np.ndarray, np.ndarray]:
    """Return the places of the task's targets, and the row of each target in the task's order (m,).

    The places (m, 2) are in steps, sorted from west to east.
    """
    points, half = np.array(task.positions(house), np.float64).reshape(-1, 2), config.target / 2
    if not len(points):
        raise ValueError(f"{task} names no place for a target")
    for x, y in points:
        if not (reached & _touched(np.array([[x, y, half, half]]), config.body[0] / 2, lattice)).any():
            raise ValueError(f"the robot cannot pick up a target at ({x:.3f}, {y:.3f}) m")
    order = np.argsort(points[:, 0])
    return (points[order] - lattice.origin) / lattice.pitch, np.argsort(order)


class _Room:
    """Places in a house where targets may lie."""

    def __init__(
        self, house: House, geometry: Geometry, lattice: Lattice, reached: np.ndarray, config: Config
    ) -> None:
        self.house, self.lattice, self.reached = house, lattice, reached
        self.half, self.body = config.target / 2, max(config.body) / 2
        clear = reached & ~_touched(geometry.solids, self.half, lattice)
        clear &= ~_crossed(geometry.slanted, self.half, lattice)
        self.main = clear & _within(geometry.floor, self.half, lattice)
        self.main &= ~_touched(geometry.rooms, self.half, lattice)
        self.inside = self.main.copy()
        for room in geometry.rooms:
            self.inside |= clear & _within(room, self.half, lattice)

    def fits(self, space: Box) -> np.ndarray:
        """Return a mask (X, Y) of the lattice's places where a target lies completely in a space."""
        free = self.main if space == self.house.start.box else self.inside
        return free & _within(_row(space), self.half, self.lattice)

    def is_reached(self, space: Box) -> bool:
        """Return True if the body can be completely in a space."""
        return bool((self.reached & _within(_row(space), self.body, self.lattice)).any())


def _free(room: _Room, spaces: list[Box], task: Task) -> np.ndarray:
    """Return a mask (X, Y) bool of the lattice's places where targets may lie in some spaces of a task."""
    house = room.house
    boxes = [each.box for each in house.rooms if each is not house.start]
    if not spaces:
        types = ", ".join(sorted({room.type for room in house.counted}))
        raise ValueError(f"it has no room that can hold the targets of {task}: its rooms are {types}")
    chosen = np.zeros_like(room.reached)
    for space in spaces:
        if space in boxes and not room.is_reached(space):
            raise ValueError(f"the robot cannot reach {_name(space, house)}")
        chosen |= room.fits(space)
    if not chosen.any():
        where = ", ".join(_name(space, house) for space in spaces)
        raise ValueError(f"no target fits on free floor that the robot can reach in {where}")
    return chosen


def _weighted(
    room: _Room, task: WeightedTask, heading: int
) -> tuple[np.ndarray, int, bool, tuple[Region, ...], np.ndarray]:
    """Return the fields of ``Places`` for a task with regions.

    A region with probability p has about p ``LISTED`` entries, at least one, spread evenly over its places in
    the order of the lattice. Some places have one entry more than others; if there are more places than
    entries, some have none.
    """
    found = [
        (np.logical_or.reduce([room.fits(box) for box in boxes]), weight)
        for boxes, weight in task.regions(room.house)
        if boxes
    ]
    found = [(fits.ravel().nonzero()[0], weight) for fits, weight in found if weight > 0 and fits.any()]
    if not found:
        raise ValueError(f"no target of {task} fits on free floor that the robot can reach")
    whole, counts = sum(weight for _, weight in found), np.zeros(room.reached.size, int)
    entries: list[np.ndarray] = []
    for fits, weight in found:
        number = max(1, round(LISTED * weight / whole))
        entries.append(fits[np.arange(number) * len(fits) // number])
        np.add.at(counts, entries[-1], 1)
    listed, length = counts.nonzero()[0], counts.sum()
    regions = tuple(Region(np.searchsorted(listed, np.unique(at)), len(at) / length) for at in entries)
    targets = np.stack(np.unravel_index(listed, room.reached.shape), axis=1).astype(np.float32)
    return targets, heading, False, regions, counts[listed]


def _row(box: Box) -> np.ndarray:
    """Return a box as its centre and half its sides, (4,)."""
    return np.array([box[0] + box[2], box[1] + box[3], box[2] - box[0], box[3] - box[1]]) / 2


def _name(space: Box, house: House) -> str:
    """Return a space in words."""
    names = {room.box: f"room {room.name} ({room.type})" for room in reversed(house.rooms)}
    if main := house.main_room:
        names = {main.box: "the main room"} | {room.box: names[room.box] for room in house.cut_from(main)}
    return names.get(space, "the rectangle ({:.2f}, {:.2f}, {:.2f}, {:.2f})".format(*space))


def _within(box: np.ndarray, margin: float, lattice: Lattice) -> np.ndarray:
    """Return a mask (X, Y) of the places where a square of half side ``margin`` is inside a box.

    The square may touch the box's sides.
    """
    inside = np.zeros(lattice.shape, bool)
    inside[_slices(box, -margin + TOLERANCE, lattice)] = True
    return inside


def _touched(boxes: np.ndarray, margin: float, lattice: Lattice) -> np.ndarray:
    """Return a mask (X, Y) of the places where a square of half side ``margin`` overlaps one of the boxes.

    Touching is not overlapping.
    """
    touched = np.zeros(lattice.shape, bool)
    for box in boxes:
        touched[_slices(box, margin - TOLERANCE, lattice)] = True
    return touched


def _crossed(walls: np.ndarray, margin: float, lattice: Lattice) -> np.ndarray:
    """Return a mask (X, Y) of the places where a square of half side ``margin`` overlaps a wall at an angle.

    ``walls`` (n, 6): see ``Geometry.slanted``.
    """
    crossed = np.zeros(lattice.shape, bool)
    for x, y, u, v, long, thick in walls:
        around = np.array([x, y, abs(u) * long + abs(v) * thick, abs(v) * long + abs(u) * thick])
        i, j = _slices(around, margin, lattice)
        columns, rows = (np.arange(size)[part] for size, part in zip(lattice.shape, (i, j), strict=True))
        east = lattice.origin[0] + lattice.pitch * columns[:, None] - x
        south = lattice.origin[1] + lattice.pitch * rows - y
        along, across = east * u + south * v, south * u - east * v
        reach = margin * (abs(u) + abs(v))
        crossed[i, j] |= (np.abs(along) < long + reach) & (np.abs(across) < thick + reach)
    return crossed


def _slices(box: np.ndarray, grow: float, lattice: Lattice) -> tuple[slice, slice]:
    """Return slices of a lattice: its places in a box (x, y, half width, half height) plus ``grow``."""
    low = np.ceil((box[:2] - box[2:] - grow - lattice.origin) / lattice.pitch).astype(int)
    high = np.floor((box[:2] + box[2:] + grow - lattice.origin) / lattice.pitch).astype(int) + 1
    i, j = (slice(max(0, a), max(0, b)) for a, b in zip(low, high, strict=True))
    return i, j


def _nearest(start: np.ndarray, floor: np.ndarray, lattice: Lattice) -> np.ndarray:
    """Return a mask with only the start nearest to the floor's middle; of equals, the first."""
    where = np.argwhere(start)
    away = lattice.origin + lattice.pitch * where - floor[:2]
    one = np.zeros_like(start)
    one[tuple(where[(away**2).sum(axis=1).argmin()])] = True
    return one
