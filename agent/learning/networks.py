"""Q-network of a config: the built-in network, or a user-defined module."""

from typing import Any

import torch
from torch import Tensor, nn

from vitruvius.agent.learning.config import QLearningConfig
from vitruvius.agent.learning.simulator import actions, simulator
from vitruvius.agent.policies.memory import Memory
from vitruvius.agent.policies.network import QNetwork, seeded
from vitruvius.logic.errors import RequestError
from vitruvius.sim.allowed import imported


def q_network(config: QLearningConfig) -> "QNetwork | OwnNetwork":
    """Return a new network; its weights are a function of the seed.

    Raises ``RequestError`` for a ``module`` that is not allowed, does not exist or is no Q-network.
    """
    world = simulator(config)
    shape = world.rays, world.channels, config.half_lives
    with seeded(config.seed):
        if not config.module:
            return QNetwork(*shape, actions=actions(config))
        return OwnNetwork(config.module, *shape, actions=actions(config))


class OwnNetwork(nn.Module):
    """User-defined module as a Q-network, with the memory of past actions, collisions and sightings.

    ``Class(rays, channels, remembered, actions)`` creates the module; the arguments are whole numbers. The
    module maps observations (B, R, C) and memories (B, M), both float32, to Q-values (B, A).
    """

    def __init__(
        self, name: str, rays: int, channels: int, half_lives: tuple[float, ...], actions: int
    ) -> None:
        """Import the class and create the module. Raises ``RequestError`` if this fails."""
        super().__init__()
        self.shape, self.actions = (rays, channels, half_lives), actions
        self.memory = Memory(half_lives, actions)
        remembered = self.memory.signals * len(half_lives)
        try:
            make: Any = imported(name)
            self.judge = make(rays, channels, remembered, actions)
            if not isinstance(self.judge, nn.Module):
                raise TypeError("it is not a torch.nn.Module")
            with torch.no_grad():
                q = self.judge(torch.zeros(2, rays, channels), torch.zeros(2, remembered))
            if q.shape != (2, actions):
                raise ValueError(
                    f"it returns shape {tuple(q.shape)} for two observations, not (2, {actions})"
                )
        except (ImportError, AttributeError, TypeError, ValueError, RuntimeError) as error:
            reason = str(error).partition("\n")[0]
            raise RequestError(f"module {name} cannot be used: {reason}") from None

    def forward(self, observation: Tensor, memory: Tensor) -> Tensor:
        """Return Q-values (B, A) of observations (B, R, C) and memories (B, M, S)."""
        return self.judge(observation, memory.flatten(1))
