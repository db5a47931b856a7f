"""Planners of E environments: their maps, goals and advice."""

import numpy as np
import torch
from torch import Tensor

from vitruvius.agent.planner.core.arrays import PlannerArrays
from vitruvius.agent.planner.core.config import TUNED, PlannerConfig
from vitruvius.agent.planner.core.state import AT, NONE, SIZE, TARGET
from vitruvius.agent.planner.driving.setup import driving_setup
from vitruvius.agent.planner.lattice.setup import lattice_setup
from vitruvius.agent.planner.mapping.occupancy import FLAGS, NEAR, OCCUPIED, SOLID, TILE
from vitruvius.agent.planner.setup import require_time
from vitruvius.agent.planner.viewpoints.belief import COUNT
from vitruvius.agent.planner.viewpoints.reachability import SIDE, UNKNOWN
from vitruvius.logic.errors import RequestError
from vitruvius.sim.config import Config
from vitruvius.sim.runtime import Launch

UNSEEN, FREE, TAKEN = range(3)
"""Values of ``Planner.occupancy``."""

GIVEN = {"prior"}
"""Arrays of ``PlannerArrays`` that code outside the planner writes."""

STATE = (*(name for name in PlannerArrays._fields if name not in GIVEN), "states", "advice")
"""Names of the arrays that the next steps of all planners depend on."""


class Planner:
    """Planners of E environments, which one kernel advances together.

    A planner stores the step at which it last saw each cell (half a body wide), the cells that are occupied,
    and the target that it has seen. Its goal is that target. Without a known target, the goal is the
    viewpoint that shows most candidates for its cost. Candidates are places where a target may lie and that
    were not seen since the last pick-up.
    """

    advice: Tensor
    """Way to the goal, in the same memory after every step.

    For bodies on a lattice it is the action, (E,) int64. For bodies that drive it is the course, (E, 2)
    float32: the radians to turn to the left, and the metres after which the body should stand, negative if it
    should not stop.
    """

    def __init__(
        self,
        world: Config,
        environments: int,
        config: PlannerConfig = TUNED,
        prior: bool = False,
        led: bool = False,
    ) -> None:
        """Make planners for E environments of the configuration ``world``; an episode begins in each.

        ``prior``: the planner does not estimate the weights of unseen places and which of them block sight.
        It reads both from the array ``prior``, which a network or a study that knows the house fills.
        ``led``: the planner chooses no viewpoint. A planner without a goal (``lost``) gets one from ``lead``.

        Raises ``ValueError`` for episodes with more steps than a cell can store, and for the reasons of
        ``driving_setup``.
        """
        require_time(world)
        kind = driving_setup if world.drives else lattice_setup
        setup = kind(world, config, environments, prior, led)
        self.world, self.config = world, config
        self.cell, self.body, self.arrays = setup.cell, setup.body, setup.arrays
        self._launch = Launch(setup.step, self.arrays)
        self._lead = Launch(setup.lead, self.arrays) if setup.lead else None
        tensors = {name: array.tensor(array.dtype, array.shape) for name, array in self.arrays.items()}
        self._given = [tensors[name] for name in ("observation", "blocked", setup.moved, "begun")]
        self._states = tensors["states"].view(-1, SIZE)
        self._kept = (*STATE, *setup.kept)
        advice = tensors["advice"]
        self.advice = advice.view(environments, 2) if world.drives else advice

    def step(self, observation: Tensor, blocked: Tensor, moved: Tensor, begun: Tensor) -> None:
        """Take the result of an action: ``observation`` (E, R, C) and ``blocked`` (E,) bool.

        ``moved`` is the action (E,) int64, or for bodies that drive their poses (E, 3): x, y in metres and
        heading in radians. Where ``begun`` (E,) bool is true, the observation is the first of an episode and
        the action is ignored.
        """
        for held, now in zip(self._given, (observation, blocked, moved, begun), strict=True):
            held.copy_(now.reshape(-1))
        self._launch()

    @property
    def lost(self) -> Tensor:
        """Mask (E,) bool of the planners without a goal: they have no viewpoint and know no target."""
        return self.read("kind") == NONE

    def lead(self, environments: np.ndarray, goals: np.ndarray) -> None:
        """Give viewpoints to planners that are ``led``, in these environments (n,) int.

        ``goals`` (n, 3) int has the node, the heading there, and the approximate length of the path in nodes.
        The advice follows the viewpoints.
        """
        if self._lead is None:
            raise ValueError("these planners choose their own viewpoints: create them with led=True")
        given = self.arrays["goals"].view().reshape(-1, 3)
        given[:] = -1
        given[environments] = goals
        self._lead()

    def choose_again(self, environments: np.ndarray) -> None:
        """Choose a viewpoint again in the next step, in these environments (n,) int."""
        self.read("plan_age")[torch.from_numpy(environments)] = self.config.replan_interval

    @property
    def state(self) -> dict[str, Tensor]:
        """Copies of all arrays that the next steps depend on, which can be assigned again later."""
        return {name: torch.from_numpy(self.arrays[name].numpy()) for name in self._kept}

    @state.setter
    def state(self, state: dict[str, Tensor]) -> None:
        if set(state) != set(self._kept):
            raise RequestError(
                "the planners' state was saved by another revision of agent.planner: start a new run"
            )
        for name in self._kept:
            self.arrays[name].fill(state[name].numpy())

    def read(self, name: str) -> Tensor:
        """Return one number (E,) int32 of all states, by its name in ``agent.planner.core.state``."""
        return self._states[:, AT[name]]

    @property
    def seeks(self) -> Tensor:
        """Mask (E,) bool of the planners that know no target, so that they must search for one."""
        return self.read("kind") != TARGET

    @property
    def seen(self) -> Tensor:
        """Number (E,) int32 of cells that were seen in this episode."""
        return self.read("seen")

    def pose(self, environment: int) -> tuple[float, float, int]:
        """Return the planner's estimate of the eye: cells east and south of its start, and its heading.

        The frame's axes lie along the walls. The frame's east is such that the episode began at heading 0, or
        at 1 if the first heading was diagonal. If no wall was in sight at first, the frame may begin again at
        the first wall.
        """
        x, y, heading = (int(self.read(name)[environment]) for name in ("x", "y", "heading"))
        return x / 2, y / 2, heading

    def goal(self, environment: int) -> tuple[float, float] | None:
        """Return the goal in cells east and south of the start, None without a goal.

        The goal is the estimated place of the target if one is known, otherwise a viewpoint.
        """
        if self.read("kind")[environment] == NONE:
            return None
        if self.read("kind")[environment] == TARGET:
            x, y = self._states[environment, AT["target"] : AT["target"] + 2].view(torch.float32).tolist()
            return x, y
        side = 1 << self.config.map_bits
        y, x = divmod(int(self.read("goal")[environment]), side)
        return float((x + side // 2) % side - side // 2), float((y + side // 2) % side - side // 2)

    def occupancy(self, environment: int) -> np.ndarray:
        """Return cells (S, S) uint8, south by east: unseen, free or taken.

        The start is a corner in the middle.
        """
        cells = self._map("cells", environment)
        return np.where(cells & OCCUPIED, TAKEN, np.where(cells >> FLAGS, FREE, UNSEEN)).astype(np.uint8)

    def last_seen(self, environment: int) -> np.ndarray:
        """Return the steps (S, S) at which cells were last seen, 0 for never; placed as ``occupancy``."""
        return (self._map("cells", environment) & (OCCUPIED - 1)) >> FLAGS

    def unseen_floor(self, environment: int) -> np.ndarray:
        """Return the weight of places never seen as candidates, (S / 2, S / 2) uint8, from 0 to ``CERTAIN``.

        A weight states how likely a place of two by two cells of ``occupancy`` is free floor. It is 0 where
        it was not computed.
        """
        tiles, half = 1 << self.config.map_bits - TILE, 1 << self.config.map_bits - 2
        blocks = self.arrays["odds"].view().reshape(-1, tiles, tiles, SIDE, SIDE)[environment]
        odds = np.roll(blocks.swapaxes(1, 2).reshape(2 * half, 2 * half), (half, half), axis=(0, 1))
        return np.where(odds == UNKNOWN, 0, odds)

    def foreseen(self, environment: int) -> np.ndarray:
        """Return the weights of the prior (S / 2, S / 2) uint8, two by two cells of ``occupancy`` each."""
        half = 1 << self.config.map_bits - 1
        blocks = self.arrays["prior"].view().reshape(-1, half, half)[environment]
        return (np.roll(blocks, (half // 2, half // 2), axis=(0, 1)) & COUNT).astype(np.uint8)

    def paths(self, environment: int) -> np.ndarray:
        """Return path lengths (S, S) in nodes from the goal, 65535 if unknown; placed as ``occupancy``."""
        return self._map("distance", environment)

    def _map(self, name: str, environment: int) -> np.ndarray:
        """Return an array of one environment (S, S), rolled so that the start is in the middle."""
        side = 1 << self.config.map_bits
        one = self.arrays[name].view().reshape(-1, side, side)[environment]
        return np.roll(one, (side // 2, side // 2), axis=(0, 1))

    @property
    def walls(self) -> np.ndarray:
        """Bits of the maps' cells that tell occupied, solid and near, without the step; (E S S,) uint16."""
        return self.arrays["cells"].numpy() & np.uint16(OCCUPIED | SOLID | NEAR)

    def add_walls(self, walls: np.ndarray) -> None:
        """Add ``walls`` from other maps of the same episodes, for studies of their value."""
        self.arrays["cells"].view()[:] |= walls
        self.arrays["dirty"].view()[:] = 1
