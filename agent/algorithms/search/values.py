"""Labels: worth of each view of a window in the true house, which training knows."""

import numpy as np
import torch
from torch import Tensor

from vitruvius.agent.algorithms.search.maps import MapReader
from vitruvius.agent.algorithms.search.windows import PLACES, SCALE
from vitruvius.agent.baselines.posterior import KNOWN
from vitruvius.agent.baselines.views import ViewValues
from vitruvius.agent.planner import Planner
from vitruvius.agent.planner.core.frame import AXES, quarters
from vitruvius.sim import HouseVectorEnv


class TrueValues:
    """Expected values of views in E environments, by exact posteriors over target places and shortest paths.

    Places begin at the lattice's views, so this class sets the reader's ``phase``.
    """

    def __init__(self, envs: HouseVectorEnv, planner: Planner) -> None:
        """Survey the houses of these environments, which ``planner`` maps.

        Raises ``ValueError`` for closed doors.
        """
        self.world, count = envs.unwrapped.world, envs.num_envs
        self.steps = round(planner.cell / self.world.config.step)
        self.pitch = self.steps * planner.config.viewpoint_pitch
        self.views = ViewValues(envs, PLACES, self.pitch)
        self.start, self.quarter = np.zeros((count, 2), int), np.zeros(count, int)

    def watch(self, begun: np.ndarray, reader: MapReader) -> None:
        """Update the posteriors with what the bodies see.

        Maps begin where the bodies are now, in environments (n,) int that ``begun``.
        """
        self.views.watch()
        if len(begun):
            poses, _, houses = self.world.describe()
            for e in begun:
                lattice = self.world.lattices[houses[e]]
                place = np.rint((poses[e, :2] - lattice.origin) / self.world.config.step).astype(int)
                self.start[e], self.quarter[e] = place, quarters(poses[e, 2])
                # Nodes are some steps apart: choose those nearest to the lattice's views.
                east, south = AXES[self.quarter[e]] @ (place // self.steps)
                reader.phase[e] = -np.array([south, east]) % reader.pitch

    @property
    def state(self) -> dict[str, Tensor]:
        """Copies of all that the next labels depend on."""
        arrays = {name: torch.from_numpy(self.views.arrays[name].numpy()) for name in POSTERIOR}
        return arrays | {name: torch.from_numpy(getattr(self, name).copy()) for name in FRAMES}

    @state.setter
    def state(self, state: dict[str, Tensor]) -> None:
        for name in POSTERIOR:
            self.views.arrays[name].fill(state[name].numpy())
        for name in FRAMES:
            setattr(self, name, state[name].numpy())

    def read(self, environments: np.ndarray, corners: np.ndarray) -> Tensor:
        """Return the worth of the views in windows with these corners, (n, 8, G, G) float32.

        Values are in targets per ``SCALE`` steps, in these environments (n,).
        """
        axes = AXES[self.quarter[environments]]  # (n, 2, 2): east and south in the house
        corner = self.start[environments] + self.steps * (corners[:, ::-1, None] * axes).sum(1)
        corner -= corner % self.pitch
        frames = np.column_stack([corner, self.quarter[environments]])
        return torch.from_numpy(SCALE * self.views.read(environments, frames))

    def known(self, environments: np.ndarray) -> np.ndarray:
        """Return a mask (n,) bool of environments whose target was in sight: there is nothing to value."""
        return self.views.arrays["notes"].view()[environments, KNOWN] > 0


POSTERIOR = "left", "notes", "last"
FRAMES = "start", "quarter"
