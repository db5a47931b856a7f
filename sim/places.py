"""Where an episode may start and where targets may lie: places of a house's lattice, found once at packing.

A target's place is one that the body can itself come to, and whose whole square is free floor; or where a
task puts it, if the body can pick it up there.
"""

from dataclasses import dataclass

import numpy as np

from logic import House
from sim.backend import Lattice
from sim.config import Config
from sim.geometry import TOLERANCE, Geometry
from sim.survey import Survey
from sim.tasks import Box, FixedTask, Task

NORTH = 2
"""The heading of the start nearest to the main room's middle."""


@dataclass(frozen=True)
class Places:
    """Where a house's episodes start and its targets lie, in steps east and south of its lattice's origin."""

    starts: np.ndarray
    """(n, 2) int32."""
    targets: np.ndarray
    """(m, 2) float32: whole steps, but for targets at given places. In the order of their steps east."""
    heading: int = -1
    """That of all starts, in eighths of a turn; -1 for any."""
    given: bool = False
    """Whether the targets are at given places."""

    def spread(self, pitch: int) -> np.ndarray:
        """Which targets lie on a grid of ``pitch`` steps, (k,) int: all given ones, or one at least."""
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
    task: Task | FixedTask,
    start: np.ndarray | None = None,
) -> Places:
    """Find a house's starts and a task's targets from what the body can do there.

    Bodies start at the cell ``start`` (i, j, heading), where the task gives one. Else they start in the main
    room of a star, in the hub of another house, or as ``House.start`` says.

    Raises ``ValueError`` where the body has nowhere to stand there, where it cannot come to a room
    in which the task has targets, or where a target has nowhere to lie.
    """
    free = survey.part > 0
    if start is not None:
        i, j, heading = start.tolist()
        starts = np.zeros_like(free)
        starts[i, j] = free[i, j]
        if not starts.any():
            raise ValueError("the body cannot turn where the task starts")
        reached = survey.part == survey.part[i, j]
    else:
        body = max(config.body) / 2
        starts = free & _within(geometry.floor, body, lattice) & ~_touched(geometry.rooms, body, lattice)
        if not starts.any():
            raise ValueError(f"the body has nowhere to stand in {_name(house.start.box, house)}")
        # Of parts of the house that no path joins, the body lives in the one with most of that room.
        reached = survey.part == np.bincount(survey.part[starts]).argmax()
        starts &= reached
        heading = -1 if config.random_start else NORTH
        if not config.random_start:
            starts = _nearest(starts, geometry.floor, lattice)
    given = isinstance(task, FixedTask)
    if given:
        targets = _given(house, lattice, reached, config, task)
    else:
        targets = _free(house, geometry, lattice, reached, config, task)
    return Places(np.argwhere(starts).astype(np.int32), targets.astype(np.float32), heading, given)


def _given(
    house: House, lattice: Lattice, reached: np.ndarray, config: Config, task: FixedTask
) -> np.ndarray:
    """Where the task puts its targets, (m, 2) steps, from the westernmost on."""
    points, half = np.array(task.positions(house), np.float64).reshape(-1, 2), config.target / 2
    if not len(points):
        raise ValueError(f"{task} gives no place for a target")
    for x, y in points:
        if not (reached & _touched(np.array([[x, y, half, half]]), config.body[0] / 2, lattice)).any():
            raise ValueError(f"the body cannot pick up a target at ({x:.3f}, {y:.3f}) m")
    return (points[np.argsort(points[:, 0])] - lattice.origin) / lattice.pitch


def _free(
    house: House, geometry: Geometry, lattice: Lattice, reached: np.ndarray, config: Config, task: Task
) -> np.ndarray:
    """The lattice's places where targets may lie in the task's spaces, (m, 2) steps."""
    spaces, boxes = list(task.spaces(house)), [room.box for room in house.rooms if room is not house.start]
    if not spaces:
        types = ", ".join(sorted({room.type for room in house.counted}))
        raise ValueError(f"it has no room for the targets of {task}: there are {types}")
    half, body = config.target / 2, max(config.body) / 2
    clear = reached & ~_touched(geometry.solids, half, lattice)
    main = clear & _within(geometry.floor, half, lattice) & ~_touched(geometry.rooms, half, lattice)
    inside = main.copy()
    for room in geometry.rooms:
        inside |= clear & _within(room, half, lattice)
    chosen = np.zeros_like(clear)
    for space in spaces:
        row = (
            np.array([space[0] + space[2], space[1] + space[3], space[2] - space[0], space[3] - space[1]]) / 2
        )
        if space in boxes and not (reached & _within(row, body, lattice)).any():
            raise ValueError(f"the body cannot reach {_name(space, house)}")
        chosen |= (main if space == house.start.box else inside) & _within(row, half, lattice)
    if not chosen.any():
        where = ", ".join(_name(space, house) for space in spaces)
        raise ValueError(f"no target fits on free floor that the body can reach in {where}")
    return np.argwhere(chosen)


def _name(space: Box, house: House) -> str:
    """A space in words."""
    names = {room.box: f"room {room.name} ({room.type})" for room in reversed(house.rooms)}
    if house.is_star:
        names = {house.main.box: "the main room"} | {room.box: names[room.box] for room in house.secondary}
    return names.get(space, f"the rectangle {space}")


def _within(box: np.ndarray, margin: float, lattice: Lattice) -> np.ndarray:
    """Places (X, Y) where a square of half side ``margin`` lies inside a box; touching is inside."""
    inside = np.zeros(lattice.shape, bool)
    inside[_slices(box, -margin + TOLERANCE, lattice)] = True
    return inside


def _touched(boxes: np.ndarray, margin: float, lattice: Lattice) -> np.ndarray:
    """Places (X, Y) where a square of half side ``margin`` overlaps one of the boxes; touching does not."""
    touched = np.zeros(lattice.shape, bool)
    for box in boxes:
        touched[_slices(box, margin - TOLERANCE, lattice)] = True
    return touched


def _slices(box: np.ndarray, grow: float, lattice: Lattice) -> tuple[slice, slice]:
    """The lattice's places inside a box (x, y, half width, half height) whose halves grow by ``grow``."""
    low = np.ceil((box[:2] - box[2:] - grow - lattice.origin) / lattice.pitch).astype(int)
    high = np.floor((box[:2] + box[2:] + grow - lattice.origin) / lattice.pitch).astype(int) + 1
    i, j = (slice(max(0, a), max(0, b)) for a, b in zip(low, high, strict=True))
    return i, j


def _nearest(start: np.ndarray, floor: np.ndarray, lattice: Lattice) -> np.ndarray:
    """Only the start that is nearest to the floor's middle, the first of equals."""
    where = np.argwhere(start)
    away = lattice.origin + lattice.pitch * where - floor[:2]
    one = np.zeros_like(start)
    one[tuple(where[(away**2).sum(axis=1).argmin()])] = True
    return one
