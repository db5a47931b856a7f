"""Memory of the agent: exponential moving averages of its actions, collisions and target sightings.

The rays of one moment are not enough. A body that sees no target turns back and forth for ever, as left and
right have the same value, or spins on one spot of a large room. The averages prevent both and cost little.
Each average has a half-life and states the recent share of one signal. The signals are turning left, turning
right, going forward (or each other action), colliding, and seeing the target on the left and on the right.

Axes: E environments, M half-lives, S signals: 6 for three actions.
"""

import torch
from torch import Tensor, nn

from vitruvius.sim.actions import ACTIONS


class Memory(nn.Module):
    """Averages with some half-lives, in steps: a constant signal moves its averages from 0 towards 1."""

    def __init__(self, half_lives: tuple[float, ...], actions: int = ACTIONS) -> None:
        """Keep an average of each signal for each half-life."""
        super().__init__()
        self.actions, self.signals = actions, actions + 3
        self.decay: Tensor
        self.register_buffer("decay", 0.5 ** (1 / torch.tensor(half_lives, dtype=torch.float32)[:, None]))

    def empty(self, environments: int) -> Tensor:
        """Return empty memories (E, M, S) float32: zeros."""
        return self.decay.new_zeros(environments, len(self.decay), self.signals)

    def forward(
        self, memory: Tensor, observation: Tensor, blocked: Tensor, actions: Tensor, ended: Tensor
    ) -> Tensor:
        """Return memories (E, M, S) after a step, from those before it.

        ``actions`` (E,) int64 were chosen at ``observation`` (E, R, C); ``blocked`` (E,) bool is that of the
        move before. Where ``ended`` (E,) bool is true, the step began another episode: its memory is empty.
        """
        rays = observation.shape[1]
        sides = observation[..., -1].unflatten(1, (2, rays // 2)).amax(-1)
        each = torch.arange(self.actions, device=actions.device)
        signals = torch.cat([actions[:, None] == each, blocked[:, None], sides], dim=1)
        averages = torch.lerp(signals[:, None], memory, self.decay)
        return averages.masked_fill_(ended[:, None, None], 0.0)
