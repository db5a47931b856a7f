"""Q-network: the value of each action, from the rays and the memory."""

from collections.abc import Iterator
from contextlib import contextmanager

import torch
from torch import Tensor, nn

from vitruvius.agent.policies.memory import Memory
from vitruvius.sim.actions import ACTIONS

WINDOW, STRIDE = 5, 2
"""Number of neighbouring rays that a filter reads, and of rays from one window to the next."""


@contextmanager
def seeded(seed: int) -> Iterator[None]:
    """Make first weights within the block a function of the seed; torch's generator keeps its state."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(seed)
        yield


class QNetwork(nn.Module):
    """Convolution over neighbouring rays, then two layers of 128 with LayerNorm: about 57,000 parameters.

    The same small filter serves every ray, as an edge looks the same wherever it stands. LayerNorm makes
    Q-learning stable without a target network (Gallici et al. 2024, section 3).
    """

    def __init__(
        self,
        rays: int = 40,
        channels: int = 2,
        half_lives: tuple[float, ...] = (1, 4, 16, 64),
        width: int = 128,
        actions: int = ACTIONS,
    ) -> None:
        """Draw first weights from torch's generator: see ``seeded``."""
        super().__init__()
        self.shape, self.actions = (rays, channels, half_lives), actions
        self.memory = Memory(half_lives, actions)
        # A convolution as a matrix product of overlapping windows: torch's own is slower on a CPU.
        self.look = nn.Linear(WINDOW * channels, 16)
        self.judge = nn.Sequential(
            nn.Linear(16 * ((rays - WINDOW) // STRIDE + 1) + self.memory.signals * len(half_lives), width),
            nn.LayerNorm(width),
            nn.ReLU(inplace=True),
            nn.Linear(width, width),
            nn.LayerNorm(width),
            nn.ReLU(inplace=True),
            nn.Linear(width, actions),
        )

    def forward(self, observation: Tensor, memory: Tensor) -> Tensor:
        """Return Q-values (B, A), in discounted targets.

        ``observation`` (B, R, C) has distance/range and is_target, ``memory`` is (B, M, S).
        """
        channels = observation.shape[2]
        windows = observation.flatten(1).unfold(1, WINDOW * channels, STRIDE * channels)
        seen = self.look(windows).relu_().flatten(1)
        return self.judge(torch.cat([seen, memory.flatten(1)], dim=1))
