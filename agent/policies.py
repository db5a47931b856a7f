"""Policies: what turns an array of observations into an array of actions."""

from typing import Protocol

import torch
from torch import Tensor
from torch.nn.functional import one_hot

from agent.actions import ACTIONS
from agent.avoidance import Layer, random_preference, subsume
from agent.network import QNetwork
from agent.planner import Planner
from sim.config import DEFAULT, Config

DEFERENCE = 0.1
"""How much better than the action that a map advises another must look to a network for it to be preferred,
in targets. Actions differ by a hundredth or so, and what a network knows of them is no better: without this
it dithers where any action would do if it were kept to. At 0.03 an agent with its whole budget found 0.09 of
the oracle's targets less in secondary rooms of 320 validation houses, one with a tenth of it 0.59 less.
"""


class Policy(Protocol):
    """Anything that acts. It counts how often its avoidance layer overruled what it would have done."""

    interventions: int

    def begin(self, environments: int) -> None:
        """Forget: an episode begins in so many environments."""
        ...

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Actions (E,) int64 for observations (E, R, C); ``blocked`` (E,) bool: the last move was."""
        ...


class Tracker:
    """Keeps a map of each environment for a policy, which tells it its actions."""

    def __init__(self, world: Config) -> None:
        """Make maps for worlds of this configuration."""
        self.world = world
        self.planner = Planner(world, 1)

    def begin(self, environments: int) -> None:
        """Forget: an episode begins in so many environments."""
        if len(self.planner.advice) != environments:
            self.planner = Planner(self.world, environments)
        self.actions = torch.zeros(environments, dtype=torch.int64)
        self.fresh = torch.ones(environments, dtype=torch.bool)

    def look(self, observation: Tensor, blocked: Tensor) -> Planner:
        """The maps, with what the last actions led to."""
        self.planner.step(observation, blocked, self.actions, self.fresh)
        self.fresh.fill_(False)
        return self.planner


class Stack:
    """Behaviours one over the other, the highest first: each chooses among what those above it leave, and is
    not heard where it wants nothing of that. ``Stack(shield, Explore(tracker))`` over a network is Brooks's
    avoid over explore over the rest.
    """

    def __init__(self, *layers: Layer) -> None:
        """Stack these layers."""
        self.layers = layers

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Which actions (E, A) bool are left."""
        left = self.layers[0](observation, blocked)
        for layer in self.layers[1:]:
            wanted = left & layer(observation, blocked)
            left = torch.where(wanted.any(-1, keepdim=True), wanted, left)
        return left


class Explore:
    """A layer: while no target is known, go where one may hide."""

    def __init__(self, tracker: Tracker) -> None:
        """Read the maps that a policy keeps with ``tracker``."""
        self.tracker = tracker

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """What the map advises (E, A) bool, or anything where a target is known."""
        planner = self.tracker.planner
        return one_hot(planner.advice, ACTIONS).bool() | ~planner.seeks[:, None]


class QPolicy:
    """The network's best allowed action, or now and then a random allowed one."""

    def __init__(
        self,
        network: QNetwork,
        avoidance: Layer,
        generator: torch.Generator,
        epsilon: float = 0.01,
        forward: float = 0.93,
        tracker: Tracker | None = None,
    ) -> None:
        """Act by ``network`` under ``avoidance``; ``epsilon`` is the share of random actions.

        A hundredth is what a body needs to leave a loop that it does not know it is in. ``tracker`` keeps
        the maps that the network or a layer reads; a network that reads them has one of the default world.
        """
        self.network, self.avoidance, self.generator = network, avoidance, generator
        self.epsilon, self.forward, self.interventions = epsilon, forward, 0
        self.remembered = network.memory.empty(0)
        self.reads = bool(network.shape[3])
        self.tracker = tracker or (Tracker(DEFAULT) if self.reads else None)

    def begin(self, environments: int) -> None:
        """Forget: an episode begins in so many environments."""
        self.interventions = 0
        self.remembered = self.network.memory.empty(environments)
        if self.tracker:
            self.tracker.begin(environments)

    @torch.no_grad()
    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Actions (E,) int64 for observations (E, R, C); ``blocked`` (E,) bool: the last move was."""
        planner = self.tracker.look(observation, blocked) if self.tracker else None
        q = self.network(observation, self.remembered, planner.features if planner and self.reads else None)
        if planner and self.reads:
            q = deferring(q, planner.advice)
        preference = explore(q, chances(q.shape[:1], self.generator, self.epsilon, self.forward))
        actions = subsume(preference, self.avoidance(observation, blocked))
        self.interventions += int((actions != preference.argmax(-1)).sum())
        same = torch.zeros(len(actions), dtype=torch.bool)
        self.remembered = self.network.memory(self.remembered, observation, blocked, actions, same)
        if self.tracker:
            self.tracker.actions = actions
        return actions


class Explorer:
    """The map's advice under avoidance, without learning: to the target that was seen, or else to where one
    may hide.
    """

    def __init__(self, avoidance: Layer, world: Config = DEFAULT) -> None:
        """Explore worlds of this configuration under ``avoidance``."""
        self.avoidance, self.interventions = avoidance, 0
        self.tracker = Tracker(world)

    def begin(self, environments: int) -> None:
        """Forget: an episode begins in so many environments."""
        self.interventions = 0
        self.tracker.begin(environments)

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Actions (E,) int64 for observations (E, R, C); ``blocked`` (E,) bool: the last move was."""
        advice = self.tracker.look(observation, blocked).advice
        actions = subsume(one_hot(advice, ACTIONS).float(), self.avoidance(observation, blocked))
        self.interventions += int((actions != advice).sum())
        self.tracker.actions = actions
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


def deferring(q: Tensor, advice: Tensor) -> Tensor:
    """Preferences (..., A): the Q-values, with ``DEFERENCE`` more for what a map advises (...) int64."""
    return q + DEFERENCE * _only(advice)


def chances(
    shape: tuple[int, ...], generator: torch.Generator, epsilon: float, forward: float, guided: float = 0.0
) -> tuple[Tensor, Tensor, Tensor]:
    """What chance has in store for acts of this shape, as ``explore`` takes it, of one act or of many.

    Which are random (..., 1) bool, a share ``epsilon``; which of these the map's advice decides (..., 1)
    bool, a share ``guided``; and the preferences (..., A) of the rest, ``forward`` in that share.
    """
    device = generator.device
    kept = torch.rand(2, *shape, 1, generator=generator, device=device)
    instead = random_preference(torch.empty(*shape, ACTIONS, device=device), generator, forward)
    return kept[0] < epsilon, kept[1] < guided, instead


def explore(q: Tensor, chance: tuple[Tensor, Tensor, Tensor], advice: Tensor | None = None) -> Tensor:
    """Preferences (..., A): the Q-values, or where ``chance`` will have it those of a random action, or of
    what a map advises (...) int64.
    """
    chosen, guided, instead = chance
    if advice is not None:
        instead = torch.where(guided, _only(advice), instead)
    return torch.where(chosen, instead, q)


def _only(advice: Tensor) -> Tensor:
    """1 for the advised action (...) int64 and 0 for the others, (..., A) float32."""
    return (advice[..., None] == torch.arange(ACTIONS, device=advice.device)).float()
