"""Q-network of the paper, which ends in a softmax."""

from itertools import pairwise

import numpy as np
import torch
from torch import Tensor, nn

from vitruvius.agent.algorithms.paper.config import PaperConfig
from vitruvius.agent.learning.simulator import simulator
from vitruvius.agent.policies.memory import Memory
from vitruvius.agent.policies.network import seeded
from vitruvius.sim.actions import ACTIONS


class PaperNetwork(nn.Module):
    """Layers of the original: 25 units for each ray with shared weights, then 50, 100, 50, 25, 3.

    The network has 61,653 parameters. Its softmax cannot represent its targets: sums of rewards, which exceed
    1, for three actions whose values need not add up to 1.
    """

    def __init__(self, rays: int = 40, channels: int = 3, next_by: float | None = None) -> None:
        """Draw first weights from torch's generator.

        ``next_by``: degrees from each ray to the next if the network reads the next ray's angle at a ray, as
        the original's simulator wrote it; None if it reads the ray's own angle.
        """
        super().__init__()
        self.next_by = next_by
        self.shape, self.actions = (rays, channels, ()), ACTIONS
        self.memory = Memory(())  # empty, so that the network is called as the other networks are
        widths = (25 * rays, 50, 100, 50, 25)
        hidden = [(nn.Linear(a, b), nn.ReLU()) for a, b in pairwise(widths)]
        self.layers = nn.Sequential(
            *(nn.Linear(channels, 25), nn.ReLU(), nn.Flatten()),
            *(layer for pair in hidden for layer in pair),
            *(nn.Linear(widths[-1], ACTIONS), nn.Softmax(dim=1)),
        )

    @classmethod
    def of(cls, config: PaperConfig) -> "PaperNetwork":
        """Return a new network for the config's simulator; its weights are a function of the seed."""
        world = simulator(config)
        first, second = np.rad2deg(world.ray_angles[:2]).tolist()
        with seeded(config.seed):
            network = cls(world.rays, world.channels, second - first if config.angles == "next" else None)
            if config.initialisation == "glorot":
                network.apply(_as_keras)
        return network

    def forward(self, observation: Tensor, memory: Tensor | None = None) -> Tensor:
        """Return what stands for Q-values (B, A), from observations (B, R, C) alone."""
        if self.next_by is not None:
            observation = torch.cat(
                [next_angles(observation[..., :1], self.next_by), observation[..., 1:]], -1
            )
        return self.layers(observation)


def _as_keras(layer: nn.Module) -> None:
    """Give a dense layer the first weights that Keras uses (Glorot and Bengio 2010)."""
    if isinstance(layer, nn.Linear):
        nn.init.xavier_uniform_(layer.weight)
        nn.init.zeros_(layer.bias)


def next_angles(angle: Tensor, by: float) -> Tensor:
    """Return the next ray's angle at each ray, from the rays' own (B, R, 1) in units of 359 degrees.

    ``by`` is the angle from each ray to the next, degrees.
    """
    last = (angle[:, -1:] * 359 + by) % 360 / 359
    return torch.cat([angle[:, 1:], last], 1)
