"""Table ``places`` of a bank: the starts and targets of each house, as kernels read them."""

from collections.abc import Sequence

import numpy as np

from vitruvius.sim.backends.backend import Lattice
from vitruvius.sim.runtime import Array
from vitruvius.sim.tasks.places import Places

HEADER = 7
"""Number of integers in a house's header of the table ``places``: origin of the lattice (x, y as float32
bits), index of the first start, number of starts, index of the first target, number of targets, heading of
the starts (-1 for any). A start has 16 bits each for steps east and south; a target has two float32. For a
task with an order, the number of targets is minus the number of stages, and the index leads to the index and
number of each stage's targets."""


def place_table(lattices: Sequence[Lattice], places: Sequence[Places]) -> Array:
    """Return the table of houses with these lattices, starts and targets.

    The table has the number of houses, their headers (``HEADER``), then the starts and targets of each house.
    """
    header = np.zeros((len(places), HEADER), np.int32)
    at, rows = 1 + header.size, [np.array([len(places)], np.int32), header.reshape(-1)]
    for k, (lattice, here) in enumerate(zip(lattices, places, strict=True)):
        starts, targets = len(here.starts), len(here.listed)
        listed = here.listed.view(np.int32).ravel()
        if here.stages:
            targets, listed = -len(here.stages), _staged(here, at + starts)
        origin = np.asarray(lattice.origin, np.float32).view(np.int32)
        header[k] = (*origin, at, starts, at + starts, targets, here.heading)
        at += starts + len(listed)
        rows += [here.starts[:, 0] | here.starts[:, 1] << 16, listed]
    return Array.of(np.concatenate(rows))


def _staged(here: Places, at: int) -> np.ndarray:
    """Return the part of the table ``places`` for a house whose task has an order; the part begins at ``at``.

    The part has the index of the first target and the number of targets of each stage, then all targets.
    """
    counts = np.array([len(stage) for stage in here.stages])
    first = at + 2 * len(counts) + 2 * np.cumsum([0, *counts[:-1]])
    targets = here.targets[np.concatenate(here.stages)].view(np.int32)
    return np.concatenate([np.column_stack([first, counts]).ravel(), targets.ravel()]).astype(np.int32)
