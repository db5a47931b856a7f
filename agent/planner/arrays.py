"""The planner's arrays, as kernels take them and functions pass them on.

All are in one dimension, one environment after the other. ``base`` is where an environment's cells begin;
arrays with a number for each block of 2 by 2 cells, each tile or each viewpoint begin at a fixed part of it.
"""

from typing import Any, NamedTuple

from sim.runtime import ti

Shorts, Bytes = ti.types.ndarray(ti.u16, 1), ti.types.ndarray(ti.u8, 1)
Floats, Wholes = ti.types.ndarray(ti.f32, 1), ti.types.ndarray(ti.i32, 1)
Words, Longs = ti.types.ndarray(ti.u64, 1), ti.types.ndarray(ti.i64, 1)


class Memory(NamedTuple):
    """What a planner keeps of E environments, besides their states."""

    cells: Any
    """(E, S S) uint16: the occupancy map (``occupancy.py``)."""

    distance: Any
    """(E, S S) uint16: nodes from the goal (``paths.py``)."""

    queue: Any
    """(E, S S) uint16, or int32 where that is more than 2^16: nodes that the last search reached, or lists
    of a choice (``candidates.py``)."""

    dirty: Any
    """(E, tiles) uint8: the tiles in which something changed since the last choice."""

    reached: Any
    """(E, R) int32: how far each ray reached in the last sweep (``visibility.py``)."""

    tiles: Any
    """(E, 7, tiles) uint64: the distance field's words (``reachability.py``)."""

    odds: Any
    """(E, S S / 4) uint8: what each block counts as a candidate, as computed last (``candidates.py``)."""

    candidates: Any
    """(E, S S / 4) uint8: what each counts in this choice, and whether it was tried (``viewpoints.py``)."""

    gains: Any
    """(E, S S / pitch^2) uint16: the information gain of each viewpoint, as computed last."""

    evidence: Any
    """(E, S S) uint8, or one number where nothing errs: how surely cells are occupied (``occupancy.py``)."""

    last: Any
    """(E, R) float32, or one number where no action slips: the last look's distances (``scan.py``)."""

    prior: Any
    """(E, S S / 4) uint16, or one number: what is believed of a block, if that is given (``belief.py``)."""

    offers: Any
    """(E, K, ``OFFER``) float32, or one number: the viewpoints that may be taken (``offers.py``)."""

    offered: Any
    """(E, ``CHOICE``) float32, or a few numbers: how many, and what else a choice is among."""


class Tables(NamedTuple):
    """What follows from the body and its rays, the same for all environments."""

    directions: Any
    """(8, R, 2) float32: where each ray ends at each heading, cells east and south of the eye."""

    clear: Any
    """(2, R) float32: parts of its range that each ray must reach for a step to be free, by heading's parity.
    """

    starts: Any
    """(32, 2 R) int32: where each list of ``fan`` begins (``visibility.py``)."""

    skips: Any
    """(32, R, bands) int32: how many cells of each ray's list lie nearer than each band."""

    fan: Any
    """(n,) int32: the cells behind each ray, nearest first."""

    views: Any
    """(8, rays, places) int32: the places on a view's rays (``viewpoints.py``)."""
