"""Baselines: policies without training, which every evaluation compares with the agents.

| baseline | description |
|---|---|
| random + avoidance | the paper's random walk under the paper's avoidance rule (``RandomPolicy``) |
| script | goes to a target in sight, else looks around and walks (``Script``) |
| explorer | the planner without a network (``Explorer``) |
| searcher | knows the house, but not where the target is |
| oracle | knows the house and the target |

``KNOWS`` lists what the others know. The last two read the simulator's state, which no agent may: they bound
what an agent can reach.
"""

from collections.abc import Callable

import numpy as np
import torch
from torch import Tensor, nn

from vitruvius.agent.avoidance import Layer, PaperRule, random_preference, subsume
from vitruvius.agent.baselines.searcher import Searcher
from vitruvius.agent.learning.environments import shield
from vitruvius.agent.policies.policies import Explorer, Policy, RandomPolicy
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.actions import ACTIONS, FORWARD, LEFT, RIGHT
from vitruvius.sim.oracle.oracle import Oracle

FULL_TURN, WALK, DETOUR = 8, 64, 16
"""Turns of a look all around; steps from one such look to the next; random steps around an obstacle."""

WANTED = 1e6
"""Preference above all random ones."""

AHEAD = np.deg2rad(22.5)
"""Angle to a target, in radians, above which the next heading is nearer to it."""


class Script:
    """Policy that turns to the target in sight and goes there.

    Without a target it looks all around, walks at random, and looks again. If an obstacle stands between it
    and the target, it walks at random for a while; otherwise it would stay there.
    """

    def __init__(self, angles: np.ndarray, avoidance: Layer, generator: torch.Generator) -> None:
        """Make the policy for rays at ``angles`` (R,), radians from the heading."""
        self.angles = torch.tensor(angles, dtype=torch.float32)
        self.avoidance, self.generator, self.interventions = avoidance, generator, 0
        self.time = self.detour = torch.zeros(0)

    def begin(self, environments: int) -> None:
        """Forget the past: an episode begins in each of ``environments`` environments."""
        self.interventions, self.time, self.detour = 0, torch.zeros(environments), torch.zeros(environments)

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Return actions (E,) int64 for observations (E, R, C) and the mask (E,) bool ``blocked``."""
        allowed, seen = self.avoidance(observation, blocked), observation[..., -1]
        aside = (seen * self.angles).sum(-1) / seen.sum(-1).clamp(min=1)
        towards = torch.where(aside > AHEAD, LEFT, torch.where(aside < -AHEAD, RIGHT, FORWARD))
        sight = seen.any(-1)
        stuck = sight & (towards == FORWARD) & ~allowed[..., FORWARD]
        self.detour = torch.where(stuck, DETOUR, (self.detour - 1).clamp(min=0))
        going, around = sight & (self.detour == 0), ~sight & (self.time % WALK < FULL_TURN)
        self.time = torch.where(going, 0, self.time + 1)

        wanted = nn.functional.one_hot(torch.where(going, towards, LEFT), ACTIONS)
        preference = random_preference(allowed, self.generator)
        preference += WANTED * wanted * (going | around)[:, None]
        actions = subsume(preference, allowed)
        self.interventions += int((actions != preference.argmax(-1)).sum())
        return actions


class Privileged:
    """Policy that reads the simulator's state and not the observation: the oracle or the searcher."""

    interventions = 0

    def __init__(self, act: Callable[[], np.ndarray], begin: Callable[[], None] = lambda: None) -> None:
        """Make the policy; ``act`` returns the actions (E,) int64 from where the bodies are."""
        self.act, self._begin = act, begin

    def begin(self, environments: int) -> None:
        """Forget the past: an episode begins in each environment."""
        self._begin()

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Return actions (E,) int64 without a look at the observation."""
        return torch.from_numpy(self.act())


def random_walk(envs: HouseVectorEnv, seed: int) -> Policy:
    """Return the policy random + avoidance, see above."""
    generator = torch.Generator().manual_seed(seed)
    return RandomPolicy(PaperRule(generator, distance=envs.config.column("distance")), generator)


def script(envs: HouseVectorEnv, seed: int) -> Policy:
    """Return a ``Script`` for the rays and the body of these environments."""
    return Script(envs.config.ray_angles, shield(envs), torch.Generator().manual_seed(seed))


def explorer(envs: HouseVectorEnv, seed: int) -> Policy:
    """Return the planner alone, under the shield."""
    return Explorer(shield(envs), envs.config)


def searcher(envs: HouseVectorEnv, seed: int) -> Policy:
    """Return the searcher, which knows the house, not the target: see ``agent.baselines.searcher``."""
    searcher = Searcher(envs)
    return Privileged(searcher.act, searcher.begin)


def oracle(envs: HouseVectorEnv, seed: int) -> Policy:
    """Return the oracle, which takes a shortest path to each target: see ``sim.oracle.oracle``."""
    return Privileged(Oracle(envs).act)


BASELINES: dict[str, Callable[[HouseVectorEnv, int], Policy]] = {
    "random + avoidance": random_walk,
    "script": script,
    "explorer": explorer,
    "searcher": searcher,
    "oracle": oracle,
}
"""Functions that make a baseline's policy from environments and a seed, by name. Every other score is divided
by the oracle's."""

KNOWS = {
    "random + avoidance": ("rays",),
    "script": ("rays", "bump", "last_action"),
    "explorer": ("rays", "bump", "last_action"),
    "random drive": (),
    "pursuit": ("rays",),
}
"""Signals that baselines without privileged knowledge act by, those of ``drivers`` included, in the terms of
``vitruvius.sim.Config.observe``."""

PRIVILEGED = ("searcher", "oracle")
"""Baselines that know where they are: noise and slips would only make their plans wrong."""

PAPERS = ("paper-original", "paper")
"""Agent of the paper: the weights that its authors released, and the same agent trained again here."""

REFERENCES = (*PAPERS, *BASELINES)
"""Policies that ``vitruvius evaluate`` shows with all agents."""
