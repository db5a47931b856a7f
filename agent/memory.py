"""The agent's memory: fading traces of what it did and where it saw the target.

A look at the rays alone does not say enough: a body that sees no target turns to and fro for ever, as left
and right are worth the same, or spins on one spot of a large room. Traces break both, and cost little: for
each of a few half-lives, how much of late was spent turning left, turning right, going forward, bumping into
something, and seeing the target on the left and on the right. A map of the house would be more.

Axes: E environments, M half-lives, 6 signals.
"""

import torch
from torch import Tensor, nn

from agent.actions import ACTIONS

SIGNALS = 6
MIRROR = (1, 0, 2, 3, 5, 4)
"""Where each signal's mirror image stands."""


class Memory(nn.Module):
    """Traces with some half-lives, in steps: a signal that lasts brings its traces from 0 towards 1."""

    def __init__(self, half_lives: tuple[float, ...]) -> None:
        """Keep as many traces of each signal as there are half-lives."""
        super().__init__()
        self.decay: Tensor
        self.register_buffer("decay", 0.5 ** (1 / torch.tensor(half_lives, dtype=torch.float32)[:, None]))

    def empty(self, environments: int) -> Tensor:
        """Memories (E, M, 6) float32 of nothing."""
        return self.decay.new_zeros(environments, len(self.decay), SIGNALS)

    def forward(
        self, memory: Tensor, observation: Tensor, blocked: Tensor, actions: Tensor, ended: Tensor
    ) -> Tensor:
        """Memories (E, M, 6) after a step, from those before it.

        ``actions`` (E,) int64 were chosen at ``observation`` (E, R, C), the move before that was ``blocked``
        (E,) bool or not. Where ``ended`` (E,) bool, the step began another episode: nothing is left.
        """
        rays = observation.shape[1]
        sides = observation[..., -1].unflatten(1, (2, rays // 2)).amax(-1)
        each = torch.arange(ACTIONS, device=actions.device)
        signals = torch.cat([actions[:, None] == each, blocked[:, None], sides], dim=1)
        faded = torch.lerp(signals[:, None], memory, self.decay)
        return faded.masked_fill_(ended[:, None, None], 0.0)


def mirrored_memory(memory: Tensor) -> Tensor:
    """The same memories (B, M, 6) in a mirror."""
    return memory.index_select(-1, torch.tensor(MIRROR, device=memory.device))
