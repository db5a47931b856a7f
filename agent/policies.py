"""Policies: what turns an array of observations into an array of actions."""

from typing import Protocol

import torch
from torch import Tensor

from agent.avoidance import Layer, random_preference, subsume
from agent.network import QNetwork


class Policy(Protocol):
    """Anything that acts. It counts how often its avoidance layer overruled what it would have done."""

    interventions: int

    def begin(self, environments: int) -> None:
        """Forget: an episode begins in so many environments."""
        ...

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Actions (E,) int64 for observations (E, R, C); ``blocked`` (E,) bool: the last move was."""
        ...


class QPolicy:
    """The network's best allowed action, or now and then a random allowed one."""

    def __init__(
        self,
        network: QNetwork,
        avoidance: Layer,
        generator: torch.Generator,
        epsilon: float = 0.01,
        forward: float = 0.93,
    ) -> None:
        """Act by ``network`` under ``avoidance``; ``epsilon`` is the share of random actions.

        A hundredth is what a body needs to leave a loop that it does not know it is in.
        """
        self.network, self.avoidance, self.generator = network, avoidance, generator
        self.epsilon, self.forward, self.interventions = epsilon, forward, 0
        self.remembered = network.memory.empty(0)

    def begin(self, environments: int) -> None:
        """Forget: an episode begins in so many environments."""
        self.interventions = 0
        self.remembered = self.network.memory.empty(environments)

    @torch.no_grad()
    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Actions (E,) int64 for observations (E, R, C); ``blocked`` (E,) bool: the last move was."""
        preference = explore(
            self.network(observation, self.remembered), self.generator, self.epsilon, self.forward
        )
        actions = subsume(preference, self.avoidance(observation, blocked))
        self.interventions += int((actions != preference.argmax(-1)).sum())
        same = torch.zeros(len(actions), dtype=torch.bool)
        self.remembered = self.network.memory(self.remembered, observation, blocked, actions, same)
        return actions


class RandomPolicy:
    """The paper's random walk, 93 % forward, under avoidance: what exploring without learning achieves."""

    def __init__(self, avoidance: Layer, generator: torch.Generator, forward: float = 0.93) -> None:
        """Walk by chance under ``avoidance``."""
        self.avoidance, self.generator, self.forward, self.interventions = avoidance, generator, forward, 0

    def begin(self, environments: int) -> None:
        """Forget: an episode begins in so many environments."""
        self.interventions = 0

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Actions (E,) int64 for observations (E, R, C); ``blocked`` (E,) bool: the last move was."""
        allowed = self.avoidance(observation, blocked)
        preference = random_preference(allowed, self.generator, self.forward)
        actions = subsume(preference, allowed)
        self.interventions += int((actions != preference.argmax(-1)).sum())
        return actions


def explore(q: Tensor, generator: torch.Generator, epsilon: float, forward: float) -> Tensor:
    """Preferences (E, A): the Q-values, replaced in a share ``epsilon`` of the rows by a random action's."""
    chosen = torch.rand(q.shape[0], 1, generator=generator, device=q.device) < epsilon
    return torch.where(chosen, random_preference(q, generator, forward), q)
