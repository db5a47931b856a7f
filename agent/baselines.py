"""Players that learn nothing, beside which an agent stands: what a rule, a search and the truth achieve.

| player | knows |
|---|---|
| random + avoidance | its rays: the paper's random walk under the paper's rule (``RandomPolicy``) |
| script | its rays: to a target in sight, else around and at random (``Script``) |
| explorer | its rays, and its own map of what they showed: to where a look shows most (``Explorer``) |
| searcher | the house, and where a target may still be |
| oracle | the house and the target |

The last two are told what no agent is, by design: they say how much there is to gain by searching well, and
what is left is luck.
"""

from collections.abc import Callable

import numpy as np
import torch
from torch import Tensor, nn

from agent.avoidance import ACTIONS, FORWARD, LEFT, RIGHT, Layer, PaperRule, random_preference, subsume
from agent.policies import Explorer, Policy, RandomPolicy
from agent.world import shield
from sim import HouseVectorEnv
from sim.oracle import Oracle
from sim.searcher import Searcher

AROUND, WALK, DETOUR = 8, 64, 16
"""Turns that a full one takes; steps from one look around to the next; steps by chance around an obstacle."""

SURELY = 1e6
"""More than any preference by chance."""

AHEAD = np.deg2rad(22.5)
"""Radians: a target further aside is nearer to the next heading."""


class Script:
    """Turn to the target in sight and go there; without one look all around, walk by chance, look again.

    Where something is in the way to the target it walks by chance for a while, or it would never leave there.
    """

    def __init__(self, angles: np.ndarray, avoidance: Layer, generator: torch.Generator) -> None:
        """For rays at ``angles`` (R,), radians from the heading."""
        self.angles = torch.tensor(angles, dtype=torch.float32)
        self.avoidance, self.generator, self.interventions = avoidance, generator, 0
        self.time = self.detour = torch.zeros(0)

    def begin(self, environments: int) -> None:
        """Forget: an episode begins in so many environments."""
        self.interventions, self.time, self.detour = 0, torch.zeros(environments), torch.zeros(environments)

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Actions (E,) int64 for observations (E, R, C); ``blocked`` (E,) bool: the last move was."""
        allowed, seen = self.avoidance(observation, blocked), observation[..., -1]
        aside = (seen * self.angles).sum(-1) / seen.sum(-1).clamp(min=1)
        towards = torch.where(aside > AHEAD, LEFT, torch.where(aside < -AHEAD, RIGHT, FORWARD))
        sight = seen.any(-1)
        stuck = sight & (towards == FORWARD) & ~allowed[..., FORWARD]
        self.detour = torch.where(stuck, DETOUR, (self.detour - 1).clamp(min=0))
        going, around = sight & (self.detour == 0), ~sight & (self.time % WALK < AROUND)
        self.time = torch.where(going, 0, self.time + 1)

        wish = nn.functional.one_hot(torch.where(going, towards, LEFT), ACTIONS)
        preference = random_preference(allowed, self.generator)
        preference += SURELY * wish * (going | around)[:, None]
        actions = subsume(preference, allowed)
        self.interventions += int((actions != preference.argmax(-1)).sum())
        return actions


class Told:
    """Does what a source of actions says that knows the world: an oracle or a searcher."""

    interventions = 0

    def __init__(self, act: Callable[[], np.ndarray], begin: Callable[[], None] = lambda: None) -> None:
        """``act`` gives the actions (E,) int64 from where the bodies are."""
        self.act, self._begin = act, begin

    def begin(self, environments: int) -> None:
        """Forget: an episode begins in so many environments."""
        self._begin()

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Actions (E,) int64; what is seen does not matter."""
        return torch.from_numpy(self.act())


def baselines(envs: HouseVectorEnv, seed: int) -> dict[str, Callable[[], Policy]]:
    """By name, what makes each for these environments, the oracle last."""

    def chance() -> torch.Generator:
        return torch.Generator().manual_seed(seed)

    def searcher() -> Policy:
        searcher = Searcher(envs)
        return Told(searcher.act, searcher.begin)

    return {
        "random + avoidance": lambda: RandomPolicy(PaperRule(rng := chance()), rng),
        "script": lambda: Script(envs.config.ray_angles, shield(envs), chance()),
        "explorer": lambda: Explorer(shield(envs), envs.config),
        "searcher": searcher,
        "oracle": lambda: Told(Oracle(envs).act),
    }
