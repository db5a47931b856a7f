"""Environments that are kept for later: their state as arrays, and pickling."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from vitruvius.sim.actions import HEADINGS
from vitruvius.sim.config import Config
from vitruvius.sim.environment.outputs import Outputs
from vitruvius.sim.environment.passing import Standing
from vitruvius.sim.environment.pictures import Pictures
from vitruvius.sim.geometry import Geometry
from vitruvius.sim.world.arrays import COUNTERS, HEADING, HOUSE
from vitruvius.sim.world.phases import SAMPLE
from vitruvius.sim.world.world import World

SPACES = "observation_space", "action_space", "single_observation_space", "single_action_space"

KEPT = (*SPACES, "_np_random", "_np_random_seed", "_spec")
"""Attributes that a pickled environment keeps in addition to its arguments and its state. Spaces are among
them, because they sample at random."""


MARGIN_M = 1.0
"""Distance by which a body may be outside its house: in a wall, after a collision that ends the episode."""


def require_state(
    state: dict[str, Any], own: dict[str, np.ndarray], geometries: Sequence[Geometry], config: Config
) -> None:
    """Raise ``ValueError`` for a state that environments in houses of these ``geometries`` cannot reach.

    ``own`` is the current state of the environments.
    """
    kinds = {name: (array.dtype.str, array.shape) for name, array in own.items()}
    given = {name: np.asarray(array) for name, array in state.items()}
    if {name: (array.dtype.str, array.shape) for name, array in given.items()} != kinds:
        raise ValueError(f"the state has other dtypes or shapes: this environment has {kinds}")
    reals, wholes = given["reals"].astype(np.float64), given["wholes"]
    house, place = wholes[:, HOUSE], reals[:, :2]
    if strange := house[(house < 0) | (house >= len(geometries))].tolist():
        raise ValueError(
            f"the state belongs to other houses: a robot is in house {strange[0]}, and there "
            f"are {len(geometries)}"
        )
    if config.drives:
        if not (np.isfinite(given["speeds"]).all() and np.isfinite(reals[:, HEADING]).all()):
            raise ValueError("the state is invalid: a speed or a heading is not a finite number")
    else:
        cells = wholes[:, COUNTERS:]
        place = place + config.step * cells[:, :2]  # cells are relative to the start: some are negative
        headings = np.concatenate([given.get("past_cells", cells)[:, 2], cells[:, 2]])
        if not ((headings >= 0) & (headings < len(HEADINGS))).all():
            raise ValueError("the state is invalid: a robot has no heading")
    if not (_inside(house, place, geometries) and np.isfinite(reals).all()):
        raise ValueError("the state is invalid: a robot or a target is outside its house")
    if not np.isfinite(given.get("others", reals)).all():
        raise ValueError("the state is invalid: a target is outside its house")
    for name in ("odometer", "past_reals"):
        if not np.isfinite(given.get(name, reals)).all():
            raise ValueError(f"the state is invalid: {name} has a value that is not a finite number")
    if "next_wholes" in given:
        _require_guide(given["next_wholes"], given["next_reals"].astype(np.float64), geometries, config)


def _inside(house: np.ndarray, place: np.ndarray, geometries: Sequence[Geometry]) -> bool:
    """Return True if all places (n, 2) are in their houses (n,), or at most ``MARGIN_M`` outside."""
    known, which = np.unique(house, return_inverse=True)
    bounds = np.array([geometries[k].bounds for k in known]).reshape(-1, 4)[which]
    return bool(((bounds[:, :2] - MARGIN_M <= place) & (place <= bounds[:, 2:] + MARGIN_M)).all())


def _require_guide(
    wholes: np.ndarray, reals: np.ndarray, geometries: Sequence[Geometry], config: Config
) -> None:
    """Raise ``ValueError`` for options of next episodes that ``set_next`` would refuse."""
    house, given = wholes[:, 0], ~np.isnan(reals[:, 0])
    cells, place = wholes[given, 1:], reals[given, :2]
    if config.drives:
        turned = np.isfinite(reals[given, HEADING])
    else:
        place, turned = place + config.step * cells[:, :2], cells[:, 2] // len(HEADINGS) == 0
    known = (house >= given + SAMPLE) & (house < len(geometries))
    halves = np.isnan(reals[:, 2]) != np.isnan(reals[:, 3])
    lost = not known.all() or np.isinf(reals).any() or halves.any()
    if lost or not _inside(house[given], place, geometries):
        raise ValueError("the state belongs to other houses: a next episode would begin outside these houses")
    if not turned.all():
        raise ValueError("the state is invalid: a next episode would begin without a heading")


class KeepsState:
    """Mixin for environments whose state can be read, set and pickled."""

    world: World
    closed: bool
    _passing: Standing
    _pictures: Pictures
    _outputs: Outputs
    _arguments: dict[str, Any]
    _ready: bool

    @property
    def state(self) -> dict[str, np.ndarray]:
        """Copies of everything that the next steps depend on, except the houses.

        Setting the state continues every environment bit for bit, in this or another environment with the
        same arguments.
        """
        seen = {"flags": self._outputs.flags(), "observation": self._outputs.rays()}
        return self.world.state | self._passing.state | seen

    @state.setter
    def state(self, state: dict[str, np.ndarray]) -> None:
        state = dict(state)
        with self._passing.unless_refused():
            if self._passing.go_on_from(state):
                self._pictures.forget()
            require_state(state, self.state, self.world.bank.geometries, self.world.config)
        self.world.state = state
        for name in ("flags", "observation"):
            array = self.world.arrays[name]
            array.fill(np.ascontiguousarray(state[name]).view(array.dtype).ravel())
        self._ready = True

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the arguments and the state.

        The loaded environment continues bit for bit, with its random numbers.
        """
        houses = self._passing.rotation or self.world.houses
        arguments = self._arguments | {"houses": houses, "targets": self.world.task}
        state = self.state if self._ready else None
        kept = {name: self.__dict__[name] for name in KEPT if name in self.__dict__}
        return remade, (type(self), arguments, kept, state, self.closed)


def remade(
    kind: type,
    arguments: dict[str, Any],
    kept: dict[str, Any],
    state: dict[str, np.ndarray] | None,
    closed: bool,
) -> Any:
    """Return an environment from its pickled parts."""
    envs = kind(**arguments)
    envs.__dict__.update(kept)
    if state is not None:
        if "next_wholes" in state:
            envs.world.guide(state["next_wholes"], state["next_reals"])
        envs.state = state
    if closed:
        envs.close()
    return envs
