"""A recurrent network that sees rays and has no map, and its policy.

Axes: T steps of a window, E environments, S signals, A actions, W numbers of the recurrent layer.
"""

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from agent.avoidance import Layer, subsume
from sim.actions import ACTIONS
from sim.config import DEFAULT

CODE = 128
"""Numbers that encode an observation."""


class RaysNetwork(nn.Module):
    """A recurrent layer (GRU) over codes of what the body senses; an actor and a critic that read it."""

    def __init__(self, width: int, rays: int = 2 * DEFAULT.rays) -> None:
        """Draw first weights from torch's generator."""
        super().__init__()
        self.code = nn.Sequential(
            nn.Linear(rays + ACTIONS + 1, CODE), nn.ReLU(), nn.Linear(CODE, CODE), nn.ReLU()
        )
        self.memory = nn.GRU(CODE, width)
        self.actor, self.critic = (
            nn.Sequential(nn.Linear(width + CODE, CODE), nn.ReLU(), nn.Linear(CODE, outputs))
            for outputs in (ACTIONS, 1)
        )

    def forward(self, signals: Tensor, memory: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Logits (T, E, A) of actions and values (T, E) by signals (T, E, S) and a memory (1, E, W); the
        memory after them. No gradient of the values reaches the memory.
        """
        codes = self.code(signals)
        kept, memory = self.memory(codes, memory)
        read = torch.cat([codes, kept], 2)
        return self.actor(read), self.critic(read.detach())[..., 0], memory


def sensed(observation: Tensor, blocked: Tensor, actions: Tensor) -> Tensor:
    """What the network reads (E, S): rays (E, R, C), the last actions (E,), and whether they were blocked."""
    return torch.cat([observation.flatten(1), F.one_hot(actions, ACTIONS), blocked[:, None]], 1)


class RaysPolicy:
    """The policy of a network that has no map."""

    def __init__(self, network: RaysNetwork, avoidance: Layer, drawn: bool, seed: int = 0) -> None:
        """Act by the likeliest action, or by one that is ``drawn``."""
        self.network, self.avoidance, self.drawn, self.interventions = network, avoidance, drawn, 0
        self.generator = torch.Generator().manual_seed(seed)

    def begin(self, environments: int) -> None:
        """See ``Policy``."""
        self.memory = torch.zeros(1, environments, self.network.memory.hidden_size)
        self.actions, self.interventions = torch.zeros(environments, dtype=torch.int64), 0

    @torch.no_grad()
    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """See ``Policy``."""
        signals = sensed(observation, blocked, self.actions)[None]
        logits, _, self.memory = self.network(signals, self.memory)
        preference, self.allowed = logits[0], self.avoidance(observation, blocked)
        if self.drawn:
            noise = torch.empty_like(preference).exponential_(generator=self.generator)
            preference = preference - noise.log()
        self.actions = subsume(preference, self.allowed)
        self.interventions += int((self.actions != preference.argmax(1)).sum())
        return self.actions
