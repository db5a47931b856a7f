# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportCallIssue=false
# pyright: reportOptionalCall=false, reportIndexIssue=false, reportArgumentType=false
"""Maps that are told what they could not know of a house, to see what that would be worth to an explorer.

Each kind of ``TOLD`` has the ones before it too. ``benchmarks.explorers`` plays them by ``--told``.
"""

from typing import Any

import numpy as np
from torch import Tensor

from agent.planner import BITS, Planner
from agent.planner.belief import SURE, Belief
from agent.planner.cells import FLAGS, NEAR, OCCUPIED, SOLID
from agent.planner.kernel import step_kernel
from agent.policies import Tracker
from agent.world import make_worlds
from benchmarks.odds import BESIDE, SIDE, Truth
from sim import HouseVectorEnv
from sim.runtime import ti

FLOOR, ROOMS, WALLS = TOLD = "floor", "rooms", "walls"
"""Which of the ground that was never seen is floor, where targets may lie in some room; in which rooms they
do lie; and what a map of the whole house shows to be occupied, solid and near, but none of it as seen."""

ELSEWHERE = 15
"""What floor in other rooms counts, of ``SURE``: it may be a way to those. 5 and 30 do as well."""


class Teller(Tracker):
    """Keeps maps of environments and tells them of their houses, when an episode begins. All maps that this
    process makes from now on ask it.
    """

    microseconds = np.nan
    """What its maps cost tells nothing."""

    def __init__(self, envs: HouseVectorEnv, what: str) -> None:
        """Tell one of ``TOLD``; walls after an episode from the same starts, when asked to ``remember``."""
        self.ground = ti.field(ti.u8, shape=envs.num_envs << 2 * BITS)
        Belief.odds = _told(self.ground)  # pyright: ignore[reportAttributeAccessIssue]
        step_kernel.cache_clear()  # a kernel keeps what it was compiled with
        super().__init__(envs.config)
        self.envs, self.walls = envs.unwrapped, None
        anywhere = make_worlds(envs.unwrapped.houses, 1, "mixed")
        anywhere.reset(seed=0)
        self.counts = [(anywhere, SURE)] if what == FLOOR else [(anywhere, ELSEWHERE), (envs, SURE)]

    def begin(self, environments: int) -> None:
        """Forget, and be told of the houses that the bodies are in."""
        super().begin(environments)
        info = self.envs.info()
        poses, houses = info["pose"], info["house"]
        ground = np.zeros((environments, SIDE, SIDE), np.uint8)
        for envs, count in self.counts:
            truth = Truth(envs, poses, self.planner.cell)
            for e, house in enumerate(map(int, houses)):
                away, _ = truth.trees[house].query(truth.where(e, NODES), distance_upper_bound=BESIDE)
                ground[e, ::2, ::2][(away < BESIDE).reshape(SIDE // 2, -1)] = count
        self.ground.from_numpy(ground.ravel())

    def look(self, observation: Tensor, blocked: Tensor) -> Planner:
        """The maps, with what the last actions led to, and at first with the walls."""
        first = bool(self.fresh.all())
        found = super().look(observation, blocked)
        if first and self.walls is not None:
            self.planner.arrays["cells"].view()[:] |= self.walls
            self.planner.arrays["news"].view()[:] = 1
        return found

    def remember(self) -> None:
        """Take the walls from the maps as they are, for episodes that begin where this one began."""
        self.walls = self.planner.arrays["cells"].numpy() & np.uint16(OCCUPIED | SOLID | NEAR)


def _nodes() -> np.ndarray:
    """Every other node along both axes, in the order of a map: its way (n, 2) east and south of the start."""
    axis = (np.arange(0, SIDE, 2) + SIDE // 2) % SIDE - SIDE // 2
    return np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)


NODES = _nodes()


def _told(ground: Any) -> Any:
    """``Belief.odds`` where the ground that was never seen is known."""

    @ti.func
    def odds(self, cells: ti.template(), base, x, y):
        count = SURE
        if ti.cast(cells[base + self.grid.at(x, y)], ti.i32) < 1 << FLAGS:
            count = ti.cast(ground[base + self.grid.at(x, y)], ti.i32)
        return count

    return odds
