"""The agent's memory: exponential moving averages of what it did and where it saw the target.

The rays of one moment are not enough: a body that sees no target turns to and fro for ever, as left and
right have the same value, or spins on one spot of a large room. The averages end both, and cost little: for
each of a few half-lives, how much of late was spent turning left, turning right, going forward (or on each
other action), bumping into something, and seeing the target on the left and on the right.

Axes: E environments, M half-lives, S signals: 6 of three actions.
"""

import torch
from torch import Tensor, nn

from sim.actions import ACTIONS


class Memory(nn.Module):
    """Averages with some half-lives, in steps: a signal that lasts brings its averages from 0 towards 1."""

    def __init__(self, half_lives: tuple[float, ...], actions: int = ACTIONS) -> None:
        """Keep an average of each signal for each half-life."""
        super().__init__()
        self.actions, self.signals = actions, actions + 3
        self.decay: Tensor
        self.register_buffer("decay", 0.5 ** (1 / torch.tensor(half_lives, dtype=torch.float32)[:, None]))

    def empty(self, environments: int) -> Tensor:
        """Empty memories (E, M, S) float32: zeros."""
        return self.decay.new_zeros(environments, len(self.decay), self.signals)

    def forward(
        self, memory: Tensor, observation: Tensor, blocked: Tensor, actions: Tensor, ended: Tensor
    ) -> Tensor:
        """Memories (E, M, S) after a step, from those before it.

        ``actions`` (E,) int64 were chosen at ``observation`` (E, R, C), the move before that was ``blocked``
        (E,) bool or not. Where ``ended`` (E,) bool, the step began another episode: its memory is empty.
        """
        rays = observation.shape[1]
        sides = observation[..., -1].unflatten(1, (2, rays // 2)).amax(-1)
        each = torch.arange(self.actions, device=actions.device)
        signals = torch.cat([actions[:, None] == each, blocked[:, None], sides], dim=1)
        averages = torch.lerp(signals[:, None], memory, self.decay)
        return averages.masked_fill_(ended[:, None, None], 0.0)
