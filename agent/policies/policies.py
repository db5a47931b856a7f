"""Policies: functions from an array of observations to an array of actions."""

from typing import NamedTuple, Protocol

import torch
from torch import Tensor
from torch.nn.functional import one_hot

from vitruvius.agent.avoidance import Layer, random_preference, subsume
from vitruvius.agent.planner import TUNED, Planner, PlannerConfig
from vitruvius.agent.policies.network import QNetwork
from vitruvius.sim.actions import ACTIONS, FORWARD
from vitruvius.sim.config import DEFAULT, Config

MIDDLE_RAYS = slice(18, 21)
"""Rays that make an exploring body of the original go forward if they see the target."""


class ActionChoice(NamedTuple):
    """Reasons for a policy's last actions, (E, A) each."""

    values: Tensor
    """Q-values of the network."""

    preference: Tensor
    """Preferences before avoidance: the values, or a random action's."""

    allowed: Tensor
    """Mask (bool) of the actions that the avoidance layer allowed."""


class Policy(Protocol):
    """Anything that acts. It counts how often its avoidance layer overruled its preferred action."""

    interventions: int

    def begin(self, environments: int) -> None:
        """Forget the past: an episode begins in each of ``environments`` environments."""
        ...

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Return actions (E,) int64 for observations (E, R, C) and the mask (E,) bool ``blocked``."""
        ...


class Chooser(Protocol):
    """Chooser of viewpoints for planners."""

    def __call__(self, planner: Planner) -> object:
        """Give viewpoints to planners that are lost after their last step, by ``Planner.lead``."""
        ...


class Tracker:
    """Tracker that steps a planner with a policy.

    The policy sets ``actions``: the actions after each choice, or the poses before each look of a body that
    drives.
    """

    def __init__(
        self,
        world: Config,
        config: PlannerConfig = TUNED,
        prior: bool = False,
        chooser: Chooser | None = None,
    ) -> None:
        """Make planners for environments of the configuration ``world``; for ``prior`` see ``Planner``.

        A ``chooser`` chooses the planners' viewpoints, if given.
        """
        self.world, self.config, self.prior, self.chooser = world, config, prior, chooser
        self.planner = self._planner(1)

    def begin(self, environments: int) -> None:
        """Forget the past: an episode begins in each of ``environments`` environments."""
        if len(self.planner.advice) != environments:
            self.planner = self._planner(environments)
        self.actions = torch.zeros(environments, dtype=torch.int64)
        self.fresh = torch.ones(environments, dtype=torch.bool)

    def look(self, observation: Tensor, blocked: Tensor) -> Planner:
        """Step the planners with what the last actions led to; return them."""
        self.planner.step(observation, blocked, self.actions, self.fresh)
        self.fresh.fill_(False)
        if self.chooser:
            self.chooser(self.planner)
        return self.planner

    def _planner(self, environments: int) -> Planner:
        return Planner(self.world, environments, self.config, self.prior, led=self.chooser is not None)


class QPolicy:
    """Policy of the network's best allowed action, or sometimes a random allowed one."""

    choice: ActionChoice
    """Reasons of the last call."""

    def __init__(
        self,
        network: QNetwork,
        avoidance: Layer,
        generator: torch.Generator,
        epsilon: float = 0.01,
        forward: float = 0.93,
        homing: bool = False,
    ) -> None:
        """Act by ``network`` under ``avoidance``; ``epsilon`` is the fraction of random actions.

        With 1 % of random actions, a body leaves a loop that it cannot notice. With ``homing``, random
        actions go to a target in sight, see ``home``.
        """
        self.network, self.avoidance, self.generator, self.homing = network, avoidance, generator, homing
        self.epsilon, self.forward, self.interventions = epsilon, forward, 0
        self.remembered = network.memory.empty(0)

    def begin(self, environments: int) -> None:
        """Forget the past: an episode begins in each of ``environments`` environments."""
        self.interventions = 0
        self.remembered = self.network.memory.empty(environments)

    @torch.no_grad()
    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Return actions (E,) int64 for observations (E, R, C) and the mask (E,) bool ``blocked``."""
        q = self.network(observation, self.remembered)
        chosen, random = exploration(q.shape[:1], self.generator, self.epsilon, self.forward, 2, q.shape[1])
        preference = epsilon_greedy(q, chosen, home(random, observation) if self.homing else random)
        self.choice = ActionChoice(q, preference, self.avoidance(observation, blocked))
        actions = subsume(preference, self.choice.allowed)
        self.interventions += int((actions != preference.argmax(-1)).sum())
        same = torch.zeros_like(blocked)
        self.remembered = self.network.memory(self.remembered, observation, blocked, actions, same)
        return actions


class Explorer:
    """Policy that follows the planner's advice under avoidance.

    It goes to the target that was seen, or else to the next best view or the view of a chooser. Only the
    predictions of its ``tracker`` and its chooser may be trained.
    """

    choice: ActionChoice
    """Reasons of the last call; the values are 1 for the advised action, as there are no action values."""

    def __init__(
        self,
        avoidance: Layer,
        world: Config = DEFAULT,
        config: PlannerConfig = TUNED,
        tracker: Tracker | None = None,
        chooser: Chooser | None = None,
    ) -> None:
        """Explore environments of the configuration ``world`` under ``avoidance``.

        With a ``chooser``, the goals are the views that it chooses. ``tracker`` replaces the default tracker
        of the planners. Raises ``ValueError`` for bodies that drive: see ``DrivingExplorer``.
        """
        world.require_lattice("an explorer")
        self.avoidance, self.interventions = avoidance, 0
        self.tracker = tracker or Tracker(world, config, chooser=chooser)

    def begin(self, environments: int) -> None:
        """Forget the past: an episode begins in each of ``environments`` environments."""
        self.interventions = 0
        self.tracker.begin(environments)

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Return actions (E,) int64 for observations (E, R, C) and the mask (E,) bool ``blocked``."""
        advice = self.tracker.look(observation, blocked).advice
        advised = one_hot(advice, ACTIONS).float()
        self.choice = ActionChoice(advised, advised, self.avoidance(observation, blocked))
        actions = subsume(advised, self.choice.allowed)
        self.interventions += int((actions != advice).sum())
        self.tracker.actions = actions
        return actions


class RandomPolicy:
    """Random walk of the paper, 93 % forward, under avoidance: the result of exploration without learning."""

    def __init__(self, avoidance: Layer, generator: torch.Generator, forward: float = 0.93) -> None:
        self.avoidance, self.generator, self.forward, self.interventions = avoidance, generator, forward, 0

    def begin(self, environments: int) -> None:
        """Forget the past: an episode begins in each of ``environments`` environments."""
        self.interventions = 0

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Return actions (E,) int64 for observations (E, R, C) and the mask (E,) bool ``blocked``."""
        allowed = self.avoidance(observation, blocked)
        preference = random_preference(allowed, self.generator, self.forward)
        actions = subsume(preference, allowed)
        self.interventions += int((actions != preference.argmax(-1)).sum())
        return actions


def exploration(
    shape: tuple[int, ...],
    generator: torch.Generator,
    epsilon: float,
    forward: float,
    draws: int = 1,
    actions: int = ACTIONS,
) -> tuple[Tensor, Tensor]:
    """Return the mask of random actions and preferences of random actions, for actions of this shape.

    The mask (..., 1) bool has a fraction ``epsilon`` of true values. The preferences (..., A) favour forward
    with probability ``forward``. Of ``draws`` numbers for each action the first decides; 2 draws reproduce
    recorded runs.
    """
    device = generator.device
    uniform = torch.rand(draws, *shape, 1, generator=generator, device=device)[0]
    random = random_preference(torch.empty(*shape, actions, device=device), generator, forward)
    return uniform < epsilon, random


def epsilon_greedy(q: Tensor, chosen: Tensor, random: Tensor) -> Tensor:
    """Return preferences (..., A): the Q-values, or where ``chosen`` those of a ``random`` action."""
    return torch.where(chosen, random, q)


def home(preference: Tensor, observation: Tensor) -> Tensor:
    """Return preferences (E, A) with forward on top if a ``MIDDLE_RAYS`` ray sees the target.

    ``observation`` is (E, R, C). This is the original's rule for random actions.
    """
    seen = observation[:, MIDDLE_RAYS, -1].amax(-1, keepdim=True) > 0
    return preference.masked_fill(seen & (torch.arange(ACTIONS, device=seen.device) == FORWARD), torch.inf)
