"""The planner's arrays, as kernels take them and functions pass them on.

All are in one dimension, one environment after the other. ``base`` is where an environment's cells begin;
arrays with a number for each block of 2 by 2 cells, each tile or each viewpoint begin at a fixed part of it.
"""

from typing import NamedTuple

from sim.runtime import Bytes, Floats, Ints, Shorts, Words, ti

Nodes = ti.types.ndarray(ndim=1)
"""Of nodes: see ``number_type``."""


class PlannerArrays(NamedTuple):
    """What a planner keeps of E environments, besides their states."""

    cells: Shorts
    """(E, S S) uint16: the occupancy map (``occupancy.py``)."""

    distance: Shorts
    """(E, S S) uint16: nodes from the goal (``paths.py``)."""

    queue: Nodes
    """(E, S S) uint16, or int32 where that is more than 2^16: nodes that the last search reached, or lists
    of a choice (``candidates.py``)."""

    dirty: Bytes
    """(E, tiles) uint8: the tiles in which something changed since the last choice."""

    reached: Ints
    """(E, R) int32: how far each ray reached in the last sweep (``visibility.py``)."""

    tiles: Words
    """(E, 7, tiles) uint64: the distance field's words (``reachability.py``)."""

    odds: Bytes
    """(E, S S / 4) uint8: what each block counts as a candidate, as computed last (``candidates.py``)."""

    candidates: Bytes
    """(E, S S / 4) uint8: what each counts in this choice, and whether it was tried (``choice.py``)."""

    gains: Shorts
    """(E, S S / pitch^2) uint16: the information gain of each viewpoint, as computed last."""

    evidence: Bytes
    """(E, S S) uint8, or one number where nothing errs: how surely cells are occupied (``occupancy.py``)."""

    last: Floats
    """(E, R) float32, or one number where no action slips: the last look's distances (``scan.py``)."""

    prior: Shorts
    """(E, S S / 4) uint16, or one number: what is believed of a block, if that is given (``belief.py``)."""


class PlannerTables(NamedTuple):
    """What follows from the body and its rays, the same for all environments."""

    directions: Floats
    """(8, R, 2) float32: where each ray ends at each heading, cells east and south of the eye."""

    clear: Floats
    """(2, R) float32: parts of its range that each ray must reach for a step to be free, by heading's parity.
    """

    starts: Ints
    """(32, 2 R) int32: where each list of ``fan`` begins (``visibility.py``)."""

    skips: Ints
    """(32, R, bands) int32: how many cells of each ray's list lie nearer than each band."""

    fan: Ints
    """(n,) int32: the cells behind each ray, nearest first."""

    views: Ints
    """(8, rays, places) int32: the places on a view's rays (``choice.py``)."""
