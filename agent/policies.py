"""Policies: what turns an array of observations into an array of actions."""

from typing import Protocol

import torch
from torch import Tensor
from torch.nn.functional import one_hot

from agent.avoidance import Layer, random_preference, subsume
from agent.map import Map
from agent.network import QNetwork
from agent.pqn import ACTIONS
from sim.config import DEFAULT, Config


class Policy(Protocol):
    """Anything that acts. It counts how often its avoidance layer overruled what it would have done."""

    interventions: int

    def begin(self, environments: int) -> None:
        """Forget: an episode begins in so many environments."""
        ...

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Actions (E,) int64 for observations (E, R, C); ``blocked`` (E,) bool: the last move was."""
        ...


class Surveyor:
    """Keeps a map of each environment for a policy, which tells it its actions."""

    def __init__(self, world: Config) -> None:
        """Make maps for worlds of this configuration."""
        self.world, self.map = world, Map(world, 1)

    def begin(self, environments: int) -> None:
        """Forget: an episode begins in so many environments."""
        if len(self.map.advice) != environments:
            self.map = Map(self.world, environments)
        self.actions = torch.zeros(environments, dtype=torch.int64)
        self.fresh = torch.ones(environments, dtype=torch.bool)

    def look(self, observation: Tensor, blocked: Tensor) -> Map:
        """The maps, with what the last actions led to."""
        self.map.step(observation, blocked, self.actions, self.fresh)
        self.fresh.fill_(False)
        return self.map


class QPolicy:
    """The network's best allowed action, or now and then a random allowed one."""

    def __init__(
        self,
        network: QNetwork,
        avoidance: Layer,
        generator: torch.Generator,
        epsilon: float = 0.01,
        forward: float = 0.93,
        world: Config = DEFAULT,
    ) -> None:
        """Act by ``network`` under ``avoidance``; ``epsilon`` is the share of random actions.

        A hundredth is what a body needs to leave a loop that it does not know it is in. A network that reads
        a map has one of the ``world`` that it is in.
        """
        self.network, self.avoidance, self.generator = network, avoidance, generator
        self.epsilon, self.forward, self.interventions = epsilon, forward, 0
        self.remembered = network.memory.empty(0)
        self.surveyor = Surveyor(world) if network.shape[3] else None

    def begin(self, environments: int) -> None:
        """Forget: an episode begins in so many environments."""
        self.interventions = 0
        self.remembered = self.network.memory.empty(environments)
        if self.surveyor:
            self.surveyor.begin(environments)

    @torch.no_grad()
    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Actions (E,) int64 for observations (E, R, C); ``blocked`` (E,) bool: the last move was."""
        features = self.surveyor.look(observation, blocked).features if self.surveyor else None
        q = self.network(observation, self.remembered, features)
        preference = explore(q, self.generator, self.epsilon, self.forward)
        actions = subsume(preference, self.avoidance(observation, blocked))
        self.interventions += int((actions != preference.argmax(-1)).sum())
        same = torch.zeros(len(actions), dtype=torch.bool)
        self.remembered = self.network.memory(self.remembered, observation, blocked, actions, same)
        if self.surveyor:
            self.surveyor.actions = actions
        return actions


class Explorer:
    """The map's advice under avoidance, without learning: to the target that was seen, or else to where one
    may hide.
    """

    def __init__(self, avoidance: Layer, world: Config = DEFAULT) -> None:
        """Explore worlds of this configuration under ``avoidance``."""
        self.avoidance, self.interventions, self.surveyor = avoidance, 0, Surveyor(world)

    def begin(self, environments: int) -> None:
        """Forget: an episode begins in so many environments."""
        self.interventions = 0
        self.surveyor.begin(environments)

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Actions (E,) int64 for observations (E, R, C); ``blocked`` (E,) bool: the last move was."""
        advice = self.surveyor.look(observation, blocked).advice
        actions = subsume(one_hot(advice, ACTIONS).float(), self.avoidance(observation, blocked))
        self.interventions += int((actions != advice).sum())
        self.surveyor.actions = actions
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


def explore(
    q: Tensor,
    generator: torch.Generator,
    epsilon: float,
    forward: float,
    advice: Tensor | None = None,
    guided: float = 0.0,
) -> Tensor:
    """Preferences (E, A): the Q-values, replaced in a share ``epsilon`` of the rows by a random action's, or
    in a share ``guided`` of these by the action that a map advises (E,) int64.
    """
    chosen = torch.rand(q.shape[0], 1, generator=generator, device=q.device) < epsilon
    instead = random_preference(q, generator, forward)
    if advice is not None:
        follow = torch.rand(q.shape[0], 1, generator=generator, device=q.device) < guided
        instead = torch.where(follow, one_hot(advice, ACTIONS).to(q.dtype), instead)
    return torch.where(chosen, instead, q)
