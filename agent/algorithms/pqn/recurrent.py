"""Q-network that learns what to remember: a gated recurrent unit (Cho et al. 2014, arXiv:1406.1078).

The unit replaces the exponential moving averages (``memory``) and has the same interface. Its memory is
learned, by gradients through the steps of a rollout, as in the recurrent PQN of Gallici et al. 2024
(arXiv:2407.04811, section 5).

Axes: T steps, E environments, H numbers of the hidden state.
"""

import torch
from torch import Tensor, nn

from vitruvius.sim.actions import ACTIONS

CODE, HIDDEN = 64, 64
"""Sizes of an observation's code and of the hidden state."""


class Recurrence(nn.Module):
    """Hidden state after an action: a function of the state before, the observation, action and collision."""

    def __init__(self, rays: int, channels: int, actions: int = ACTIONS) -> None:
        """Draw first weights from torch's generator."""
        super().__init__()
        self.actions = actions
        self.code = nn.Sequential(
            nn.Flatten(), nn.Linear(rays * channels, CODE), nn.LayerNorm(CODE), nn.ReLU()
        )
        self.cell = nn.GRUCell(CODE + actions + 1, HIDDEN)

    def empty(self, environments: int) -> Tensor:
        """Return empty memories (E, H) float32: zeros."""
        return self.cell.weight_hh.new_zeros(environments, HIDDEN)

    def forward(
        self, memory: Tensor, observation: Tensor, blocked: Tensor, actions: Tensor, ended: Tensor
    ) -> Tensor:
        """Return memories (E, H) after a step, as ``agent.policies.memory.Memory.forward`` does."""
        signals = self.signals(observation, blocked, actions)
        return self.cell(signals, memory).masked_fill(ended[:, None], 0.0)

    def signals(self, observation: Tensor, blocked: Tensor, actions: Tensor) -> Tensor:
        """Return the unit's inputs (..., CODE + A + 1).

        ``observation`` is (..., R, C); ``blocked`` and ``actions`` are (...).
        """
        codes = self.code(observation.flatten(0, -3)).unflatten(0, observation.shape[:-2])
        acts = nn.functional.one_hot(actions, self.actions)
        return torch.cat([codes, acts, blocked[..., None]], dim=-1)

    def unrolled(
        self, memory: Tensor, observation: Tensor, blocked: Tensor, actions: Tensor, ended: Tensor
    ) -> Tensor:
        """Return memories (T, E, H) at each of T states, from the first (E, H), so that gradients flow.

        ``observation`` (T, E, R, C), ``blocked`` (T, E) and ``actions`` (T, E) belong to these states. Where
        ``ended`` (T, E) is true, the step from a state began another episode.
        """
        signals = self.signals(observation, blocked, actions)
        memories = [memory]
        for t in range(len(signals) - 1):
            memories.append(self.cell(signals[t], memories[t]).masked_fill(ended[t, :, None], 0.0))
        return torch.stack(memories)


class RecurrentQNetwork(nn.Module):
    """Convolution over neighbouring rays, then two layers that read it and the hidden state.

    The convolution is that of ``policies.network``. The network has about 94,000 parameters.
    """

    def __init__(self, rays: int = 40, channels: int = 2, width: int = 128, actions: int = ACTIONS) -> None:
        """Draw first weights from torch's generator."""
        super().__init__()
        self.shape, self.actions = (rays, channels, ()), actions
        self.memory = Recurrence(rays, channels, actions)
        self.look = nn.Conv1d(channels, 16, kernel_size=5, stride=2)
        self.judge = nn.Sequential(
            nn.Linear(16 * ((rays - 5) // 2 + 1) + HIDDEN, width),
            nn.LayerNorm(width),
            nn.ReLU(),
            nn.Linear(width, width),
            nn.LayerNorm(width),
            nn.ReLU(),
            nn.Linear(width, actions),
        )

    def forward(self, observation: Tensor, memory: Tensor) -> Tensor:
        """Return Q-values (B, A) of observations (B, R, C) and memories (B, H)."""
        seen = torch.relu(self.look(observation.transpose(1, 2))).flatten(1)
        return self.judge(torch.cat([seen, memory], dim=1))
