"""Where an episode may start and where targets may lie: places of a house's lattice, found once at packing.

A target's place is one that the body can itself come to, and whose whole square is free floor.
"""

from dataclasses import dataclass

import numpy as np

from logic import House
from sim.backend import Lattice
from sim.config import Config
from sim.geometry import TOLERANCE, Geometry
from sim.survey import Survey
from sim.tasks import Box, Task


@dataclass(frozen=True)
class Places:
    """A house's starts (n, 2) and targets (m, 2), int32: steps east and south of its lattice's origin."""

    starts: np.ndarray
    targets: np.ndarray


def places(
    house: House, geometry: Geometry, lattice: Lattice, survey: Survey, config: Config, task: Task
) -> Places:
    """Find a house's starts and a task's targets from what the body can do there.

    Bodies start in the main room of a star, in the hub of another house, or as ``House.start`` says.

    Raises ``ValueError`` where the body has nowhere to stand there, where it cannot come to a room
    in which the task has targets, or where a target has nowhere to lie.
    """
    free = survey.part > 0
    body = max(config.body) / 2
    start = free & _within(geometry.floor, body, lattice) & ~_touched(geometry.rooms, body, lattice)
    if not start.any():
        raise ValueError(f"the body has nowhere to stand in {_name(house.start.box, house)}")
    # Of parts of the house that no path joins, the body lives in the one with most of that room.
    reached = survey.part == np.bincount(survey.part[start]).argmax()

    spaces, boxes = list(task.spaces(house)), [room.box for room in house.rooms if room is not house.start]
    if not spaces:
        types = ", ".join(sorted({room.type for room in house.counted}))
        raise ValueError(f"it has no room for the targets of {task}: there are {types}")
    half = config.target / 2
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
    start &= reached
    if not config.random_start:
        start = _nearest(start, geometry.floor, lattice)
    return Places(np.argwhere(start).astype(np.int32), np.argwhere(chosen).astype(np.int32))


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
