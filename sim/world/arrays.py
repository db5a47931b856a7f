"""Table of the arrays of a world, in which all of them are listed once.

From the table come the arrays that a ``World`` allocates, the records that kernels take, the saved state, and
the page ``docs/arrays.md`` (``python -m vitruvius.sim.world.page``).
"""

from typing import Any

from vitruvius.sim.arrays import ArrayRow, Of
from vitruvius.sim.runtime import ti
from vitruvius.sim.world.distance_field import FIELD, PROFILE, TILES

NEXT_STEP, SAME_STEP, DISABLED = range(3)
"""Behaviour after an episode's end: the next step begins another episode, the same step does, or none
begins."""

HOUSE, TIME, FOUND, OVER, NUMBER, SEED = range(6)
"""Indices of these values among the integers of an environment's state. ``NUMBER`` is the number of the
episode. ``SEED`` has two integers."""

COUNTERS = SEED + 2
"""Number of these integers. For a body on a lattice, its cell follows: steps east, steps south, heading."""

HEADING = 4
"""Index of the heading of a body that drives among the reals of a state, after origin and target."""


SIZES = {
    "n": "a length that depends on the houses, or on the search for distances",
    "E": "environments",
    "R": "rays",
    "C": "columns of a ray; of two columns, both are one number of 64 bits",
    "X": "numbers of the parts of an observation other than rays",
    "L": "past steps that are kept: the latency and one more",
    "M": "numbers that the task's terms keep",
    "T": "coordinates of the targets after the first",
    "F": "rows of flags: 4 in the mode `SAME_STEP`, else 3",
    "A": "numbers of an action: 1, or V if actions are speeds",
    "V": "speeds of a command: 2, or 3 if bodies drive sideways",
    "W": "integers of a state: 7, and on a lattice 3 more",
    "P": "reals of a state: 4, and of bodies that drive 1 more",
}
"""Sizes in the table."""


def _drives(kind: Any) -> bool:
    return kind.config.drives


def _same(asked: Of = lambda kind: True) -> Of:
    """Return the condition that also needs the mode ``SAME_STEP``."""
    return lambda kind: kind.mode == SAME_STEP and asked(kind)


def _distance(kind: Any) -> bool:
    return kind.knows_distance


def _extras(kind: Any) -> bool:
    return bool(kind.config.extras)


def _memory(kind: Any) -> bool:
    return kind.terms.memory > 0


def _others(kind: Any) -> bool:
    return kind.at_once > 1


def _seen(kind: Any) -> Any:
    return ti.u64 if kind.pairs else ti.f32


BANK = (
    ArrayRow(
        "numbers", ti.f32, ("n",), unit="m",
        meaning="geometry of the houses, in the layout of a backend's `pack.py` or `layout.py`",
        written="packing", read="backend",
    ),
    ArrayRow(
        "indices", ti.i32, ("n",),
        meaning="position of each house in `numbers`, in the same layout", written="packing", read="backend",
    ),
    ArrayRow(
        "places", ti.i32, ("n",),
        meaning="starts and targets of each house: `HEADER` in `sim/world/place_table.py`",
        written="packing", read="episodes",
    ),
    ArrayRow(
        "surroundings", ti.i32, ("n",),
        meaning="rooms and pieces of each house: `sim/world/surroundings.py`",
        written="packing", read="terms, sensor", asked=lambda kind: kind.surveys,
    ),
    ArrayRow("limit", ti.i32, (1,), meaning="steps of an episode", written="creation", read="episodes"),
)  # fmt: skip
"""Arrays of the houses and the length of episodes, which a step only reads."""


STATE = (
    ArrayRow(
        "reals", ti.f32, ("E",), "P", unit="m, rad",
        meaning="origin of the body's lattice (x, y), or place of a body that drives; centre of the "
        "target (x, y); heading of a body that drives",
        written="reset, step", read="all", saved=True,
    ),
    ArrayRow(
        "wholes", ti.i32, ("E",), "W",
        meaning="house, steps in this episode, number of targets found plus 1, 1 if the episode has ended, "
        "number of the episode, seed (2); on a lattice the cell: steps east, steps south, eighths of a turn",
        written="reset, step, seeds", read="all", saved=True,
    ),
    ArrayRow(
        "speeds", ti.f32, ("E",), "V", unit="m/s, rad/s",
        meaning="speeds of a body that drives, as in a command", written="reset, step", read="motion, sensor",
        asked=_drives, saved=True,
    ),
    ArrayRow(
        "others", ti.f32, ("E", "T"), unit="m", meaning="centres of the targets after the first (x, y)",
        written="reset, step", read="episodes, sensor, infos", asked=_others, saved=True,
    ),
    ArrayRow(
        "memory", ti.f32, ("E", "M"), unit="the terms'", meaning="numbers that the task's terms keep",
        written="reset, step", read="terms, sensor, infos", asked=_memory, saved=True,
    ),
    ArrayRow(
        "rooms", ti.i32, ("E",), meaning="the body's last room, where the search for its room begins",
        written="step", read="step", asked=lambda kind: kind.sees_room,
    ),
    ArrayRow(
        "odometer", ti.f32, ("E",), 4, unit="m, rad",
        meaning="estimated place and turn since the start (x, y, turn, 0)",
        written="reset, step", read="sensor",
        asked=lambda kind: "odometry" in kind.config.observe, saved=True,
    ),
    ArrayRow(
        "past_reals", ti.f32, ("E", "L"), "P", unit="m, rad", meaning="`reals` of past steps",
        written="reset, step", read="sensor", asked=lambda kind: kind.config.latency > 0, saved=True,
    ),
    ArrayRow(
        "past_cells", ti.i32, ("E", "L"), 3, meaning="cells of past steps",
        written="reset, step", read="sensor",
        asked=lambda kind: kind.config.latency > 0 and not kind.config.drives, saved=True,
    ),
    ArrayRow(
        "next_wholes", ti.i32, ("E",), 4, meaning="`option_wholes` of episodes that begin automatically",
        written="`set_next`", read="step", asked=lambda kind: kind.guided, saved=True,
    ),
    ArrayRow(
        "next_reals", ti.f32, ("E",), "P", unit="m, rad",
        meaning="`option_reals` of episodes that begin automatically",
        written="`set_next`", read="step", asked=lambda kind: kind.guided, saved=True,
    ),
    ArrayRow(
        "extras", ti.f32, ("E", "X"), unit="see below", meaning="parts of the observation other than rays",
        written="reset, step", read="observation", asked=_extras, saved=True,
    ),
)  # fmt: skip
"""Arrays that the next steps depend on, and the last values that they write."""


DISTANCE = (
    ArrayRow(
        "fields", ti.i32, ("E",), FIELD, meaning="distance field of the target: `sim/world/geodesic.py`",
        written="reset, step, geodesic", read="episodes", asked=_distance,
    ),
    ArrayRow(
        "tiles", ti.i32, (TILES,), unit="actions", meaning="tiles of distance fields; the array grows",
        written="geodesic", read="episodes", asked=_distance,
    ),
    ArrayRow(
        "profiles", ti.i16, (1024, PROFILE), unit="actions", meaning="profiles of tiles; the array grows",
        written="geodesic", read="episodes", asked=_distance,
    ),
    ArrayRow(
        "known", ti.i32, (1024,), FIELD, meaning="fields by their numbers; the array grows",
        written="geodesic", read="episodes", asked=_distance,
    ),
    ArrayRow(
        "slots", ti.i32, ("n",), meaning="number of the field of each place of a lattice, -1 for none",
        written="geodesic", read="episodes", asked=_distance,
    ),
    ArrayRow(
        "pending", ti.i32, (1,), meaning="1 if an environment has a target without a field",
        written="reset, step, geodesic", read="geodesic", asked=_distance,
    ),
    ArrayRow(
        "distance", ti.i32, ("E",), unit="actions", meaning="distance to the target; -1 without a path",
        written="reset, step, geodesic", read="terms, sensor, infos", asked=_distance,
    ),
)  # fmt: skip
"""Arrays of the distance to the target, if a part of the observation, the info or the terms ask for it."""


LAST = (
    ArrayRow(
        "last_reals", ti.f32, ("E",), "P", unit="m, rad", meaning="`reals` at the end of the last episode",
        written="step", read="infos", asked=_same(),
    ),
    ArrayRow(
        "last_wholes", ti.i32, ("E",), "W", meaning="`wholes` at the end of the last episode",
        written="step", read="infos", asked=_same(),
    ),
    ArrayRow(
        "last_distance", ti.i32, ("E",), unit="actions", meaning="`distance` at the end of the last episode",
        written="step", read="infos", asked=_same(_distance),
    ),
    ArrayRow(
        "last_memory", ti.f32, ("E", "M"), unit="the terms'",
        meaning="`memory` at the end of the last episode",
        written="step", read="infos", asked=_same(_memory),
    ),
    ArrayRow(
        "last_others", ti.f32, ("E", "T"), unit="m", meaning="`others` at the end of the last episode",
        written="step", read="infos", asked=_same(_others),
    ),
    ArrayRow(
        "final_extras", ti.f32, ("E", "X"), unit="see below",
        meaning="`extras` at the end of the last episode",
        written="step", read="infos", asked=_same(_extras),
    ),
)  # fmt: skip
"""Arrays of an episode's last state, in ``SAME_STEP``: the same step begins the next episode."""


OUTPUTS = (
    ArrayRow(
        "action", lambda kind: ti.f32 if kind.commanded else ti.i64, ("E",), "A", unit="m/s, rad/s",
        meaning="number of the action, or speeds of the command", written="`step`", read="step",
    ),
    ArrayRow(
        "observation", _seen, ("E", "R", "C"), unit="see below", meaning="rays: `Config.columns`",
        written="reset, step", read="observation",
    ),
    ArrayRow(
        "final", _seen, ("E", "R", "C"), unit="see below",
        meaning="`observation` at the end of the last episode",
        written="step", read="infos", asked=_same(),
    ),
    ArrayRow("reward", ti.f32, ("E",), meaning="reward", written="step", read="`step`"),
    ArrayRow(
        "flags", ti.u8, ("F", "E"),
        meaning="terminated, truncated, blocked; in `SAME_STEP` also blocked in the last move of an "
        "ended episode",
        written="step", read="`step`, infos",
    ),
    ArrayRow(
        "prefetched", ti.i32, ("E",), meaning="no meaning: keeps the compiler from leaving out prefetches",
        written="step", asked=lambda kind: not kind.by_ray,
    ),
)  # fmt: skip
"""Action of a step, and its results."""


SHOWN = (
    ArrayRow(
        "pose", ti.f32, ("E", 3), unit="m, rad", meaning="the eye's place and the heading",
        written="step, describe", read="infos",
    ),
    ArrayRow(
        "target", ti.f32, ("E", 2), unit="m", meaning="centre of the target (x, y)",
        written="step, describe", read="infos",
    ),
    ArrayRow(
        "house", ti.i32, ("E",), meaning="number of the house", written="step, describe", read="infos",
    ),
)  # fmt: skip
"""Arrays of the info."""


OPTIONS = (
    ArrayRow(
        "option_wholes", ti.i32, ("E",), 4,
        meaning="house, or `SAMPLE`, or `KEEP`; on a lattice the cell of the start",
        written="`reset`", read="reset",
    ),
    ArrayRow(
        "option_reals", ti.f32, ("E",), "P", unit="m, rad",
        meaning="`reals` of the start; values that are NaN are sampled",
        written="`reset`", read="reset",
    ),
)  # fmt: skip
"""Options of a reset."""


TABLE = (*BANK, *STATE, *DISTANCE, *LAST, *OUTPUTS, *SHOWN, *OPTIONS)
"""All arrays, except those of overlays."""
