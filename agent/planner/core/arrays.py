"""Arrays of a planner, as kernels take them and functions pass them on.

All arrays have one dimension, with one environment after the other. ``base`` is the first of an environment's
cells. Arrays with a number for each block of 2 by 2 cells, each tile or each viewpoint begin at a fixed
fraction of ``base``.
"""

from typing import NamedTuple

from vitruvius.sim.runtime import Bytes, Floats, Ints, Shorts, Words, ti

Nodes = ti.types.ndarray(ndim=1)
"""Array of nodes: see ``number_type``."""


class PlannerArrays(NamedTuple):
    """Arrays that a planner keeps for E environments, besides their states."""

    cells: Shorts
    """(E, S S) uint16: the occupancy map (``occupancy.py``)."""

    distance: Shorts
    """(E, S S) uint16: nodes from the goal (``paths.py``)."""

    queue: Nodes
    """(E, S S) uint16, or int32 if S S is more than 2^16: nodes that the last path search reached, or lists
    of a choice (``candidates.py``)."""

    dirty: Bytes
    """(E, tiles) uint8: 1 for tiles in which something changed since the last choice."""

    reached: Ints
    """(E, R) int32: distance that each ray reached in the last sweep (``visibility.py``)."""

    tiles: Words
    """(E, 7, tiles) uint64: words of the distance field (``reachability.py``)."""

    odds: Bytes
    """(E, S S / 4) uint8: weight of each block as a candidate, as last computed (``candidates.py``)."""

    candidates: Bytes
    """(E, S S / 4) uint8: weight of each block in this choice, and a bit for those tried (``choice.py``)."""

    gains: Shorts
    """(E, S S / pitch^2) uint16: information gain of each viewpoint, as last computed."""

    evidence: Bytes
    """(E, S S) uint8: evidence that each cell is occupied (``occupancy.py``); one number if nothing errs."""

    last: Floats
    """(E, R) float32: distances of the last look (``scan.py``); one number if no action slips."""

    prior: Shorts
    """(E, S S / 4) uint16: given belief about each block (``belief.py``); one number without a prior."""


class PlannerTables(NamedTuple):
    """Tables that follow from the body and its rays, the same for all environments."""

    directions: Floats
    """(8, R, 2) float32: end of each ray at each heading, cells east and south of the eye."""

    clear: Floats
    """(2, R) float32: fraction of its range that each ray must reach for a step to be free, by the heading's
    parity."""

    starts: Ints
    """(32, 2 R) int32: first index of each list of ``fan`` (``visibility.py``)."""

    skips: Ints
    """(32, R, bands) int32: number of cells of each ray's list that lie nearer than each band."""

    fan: Ints
    """(n,) int32: the cells behind each ray, nearest first."""

    views: Ints
    """(8, rays, places) int32: the places on a view's rays (``choice.py``)."""
