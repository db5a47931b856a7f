"""The script: its actions for an observation."""

import numpy as np
import pytest
import torch

from vitruvius.agent.baselines.script import FULL_TURN_STEPS, Script
from vitruvius.sim.actions import FORWARD, LEFT, RIGHT


def seen(aside):
    """Return an observation (1, 40, 2) of a target this many rays to the right of the middle."""
    observation = torch.ones(1, 40, 2)
    observation[..., 1] = 0
    observation[0, round(19.5 + aside), 1] = 1
    return observation


def script(forward=True):
    angles = np.deg2rad(58.5 - 3 * np.arange(40))
    allowed = torch.tensor([[True, True, forward]])
    policy = Script(angles, lambda observation, blocked: allowed, torch.Generator().manual_seed(0))
    policy.begin(1)
    return policy


@pytest.mark.parametrize(
    ("aside", "action"), [(0, FORWARD), (7, FORWARD), (-7, FORWARD), (9, RIGHT), (-9, LEFT)]
)
def test_the_script_turns_to_the_target_and_goes(aside, action):
    assert script()(seen(aside), torch.zeros(1).bool()).item() == action


def test_without_a_target_the_script_looks_all_around_and_then_walks():
    policy, nothing = script(), torch.ones(1, 40, 2) * torch.tensor([1.0, 0.0])
    actions = [policy(nothing, torch.zeros(1).bool()).item() for _ in range(30)]
    assert actions[:FULL_TURN_STEPS] == [LEFT] * FULL_TURN_STEPS
    assert actions.count(FORWARD) > 15


def test_a_script_that_something_stops_walks_around_it():
    policy = script(forward=False)
    actions = {policy(seen(0), torch.zeros(1).bool()).item() for _ in range(12)}
    assert actions == {LEFT, RIGHT}
