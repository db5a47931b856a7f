"""Script: a policy that looks around, walks at random, and goes to a target in sight."""

import numpy as np
import torch
from torch import Tensor, nn

from vitruvius.agent.avoidance import Layer, random_preference, subsume
from vitruvius.sim.actions import ACTIONS, FORWARD, LEFT, RIGHT

FULL_TURN_STEPS, WALK_STEPS, DETOUR_STEPS = 8, 64, 16
"""Turns of a look all around; steps from one such look to the next; random steps around an obstacle."""

WANTED = 1e6
"""Preference above all random ones."""

MAX_AHEAD_RAD = np.deg2rad(22.5)
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
        towards = torch.where(
            aside > MAX_AHEAD_RAD, LEFT, torch.where(aside < -MAX_AHEAD_RAD, RIGHT, FORWARD)
        )
        sight = seen.any(-1)
        stuck = sight & (towards == FORWARD) & ~allowed[..., FORWARD]
        self.detour = torch.where(stuck, DETOUR_STEPS, (self.detour - 1).clamp(min=0))
        going, around = sight & (self.detour == 0), ~sight & (self.time % WALK_STEPS < FULL_TURN_STEPS)
        self.time = torch.where(going, 0, self.time + 1)

        wanted = nn.functional.one_hot(torch.where(going, towards, LEFT), ACTIONS)
        preference = random_preference(allowed, self.generator)
        preference += WANTED * wanted * (going | around)[:, None]
        actions = subsume(preference, allowed)
        self.interventions += int((actions != preference.argmax(-1)).sum())
        return actions
