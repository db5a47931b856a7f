"""Where an episode may start and where targets may lie: places of a house's lattice, found once at packing.

A target's place is one that the body can itself come to, and whose whole square is free floor.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from sim.backend import Lattice
from sim.body import HEADINGS
from sim.config import Config
from sim.geometry import TOLERANCE, Geometry
from sim.survey import DIAGONAL, STRAIGHT

TARGETS = ("main", "secondary", "mixed")
"""Where targets lie: wholly in the main room, wholly in one of the others, or in either."""


@dataclass(frozen=True)
class Places:
    """A house's starts (n, 2) and targets (m, 2), int32: steps east and south of its lattice's origin."""

    starts: np.ndarray
    targets: np.ndarray


def places(geometry: Geometry, lattice: Lattice, survey: np.ndarray, config: Config, targets: str) -> Places:
    """Find a house's starts and targets from what the body can do there.

    Raises ``ValueError`` where the body has nowhere to stand in the main room or a target nowhere to lie.
    """
    free = (survey & STRAIGHT > 0) & (survey & DIAGONAL > 0)
    body = max(config.body) / 2
    start = free & _within(geometry.floor, body, lattice) & ~_touched(geometry.rooms, body, lattice)
    if not start.any():
        raise ValueError("the body has nowhere to stand in the main room")
    # Of parts of the house that no way joins, the body lives in the one with most of the main room.
    part = _parts(free, survey)
    reached = part == np.bincount(part[start]).argmax()

    half = config.target / 2
    clear = reached & ~_touched(geometry.solids, half, lattice)
    main = clear & _within(geometry.floor, half, lattice) & ~_touched(geometry.rooms, half, lattice)
    secondary = np.zeros_like(clear)
    for room in geometry.rooms:
        secondary |= clear & _within(room, half, lattice)
    chosen = {"main": main, "secondary": secondary, "mixed": main | secondary}[targets]
    if not chosen.any():
        where = {"main": "the main room", "secondary": "its secondary rooms", "mixed": "the house"}[targets]
        raise ValueError(f"no target fits on free floor that the body can reach in {where}")
    start &= reached
    if not config.random_start:
        start = _nearest(start, geometry.floor, lattice)
    return Places(np.argwhere(start).astype(np.int32), np.argwhere(chosen).astype(np.int32))


def _parts(free: np.ndarray, survey: np.ndarray) -> np.ndarray:
    """Label the places that ways join: (X, Y) int, places that are not free alone. Turning is always free."""
    number = np.arange(free.size).reshape(free.shape)
    sources, sinks = [], []
    for heading in range(4):  # the other four go the same ways back
        i, j = np.nonzero(free & (survey >> heading & 1 > 0))
        i_next, j_next = i + HEADINGS[heading, 0], j + HEADINGS[heading, 1]
        inside = (i_next >= 0) & (j_next >= 0) & (i_next < free.shape[0]) & (j_next < free.shape[1])
        i, j, i_next, j_next = i[inside], j[inside], i_next[inside], j_next[inside]
        joined = free[i_next, j_next]
        sources.append(number[i[joined], j[joined]])
        sinks.append(number[i_next[joined], j_next[joined]])
    source, sink = np.concatenate(sources), np.concatenate(sinks)
    graph = coo_array((np.ones(len(source), np.int8), (source, sink)), shape=(free.size, free.size))
    return connected_components(graph, directed=False)[1].reshape(free.shape)


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
    """Only the start that is nearest to the main room's middle, the first of equals."""
    where = np.argwhere(start)
    away = lattice.origin + lattice.pitch * where - floor[:2]
    one = np.zeros_like(start)
    one[tuple(where[(away**2).sum(axis=1).argmin()])] = True
    return one
