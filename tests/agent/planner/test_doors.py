"""Closed doors: the avoidance layer lets a body walk at them, and the explorer finds what is behind."""

import numpy as np
import pytest
import torch

from tests import sample_houses
from vitruvius.agent.learning.environments import make_envs, shield
from vitruvius.agent.policies.policies import Explorer
from vitruvius.sim.config import DOORS

pytestmark = pytest.mark.second_part("the planner behind closed doors")

HOUSE = sample_houses.drawn("aaa\naaa\na+a\n...\n...\n...", cell=0.9)
"""House whose door is in the middle of the south wall of ``a``, 0.9 m wide."""


def test_the_shield_lets_a_body_walk_at_a_door_and_not_at_a_wall():
    """After a collision, too, the layer forbids the step until the door opens."""
    envs = make_envs([HOUSE], 2, "all", preset=DOORS)
    pose = np.array([[1.35, 2.7 + 0.16, np.pi / 2], [0.45, 2.7 + 0.16, np.pi / 2]])
    seen, _ = envs.reset(seed=0, options={"house": [0, 0], "pose": pose, "target": [[0.4, 0.4]] * 2})
    layer = shield(envs)
    for blocked in (False, True):
        allowed = layer(torch.as_tensor(seen), torch.full((2,), blocked))
        assert allowed[:, 2].tolist() == [True, False]


def test_the_explorer_opens_a_door_and_finds_the_targets_behind_it():
    envs = make_envs([HOUSE], 4, "secondary", preset=DOORS)
    policy, found = Explorer(shield(envs), envs.config), np.zeros(4)
    seen, blocked = torch.as_tensor(envs.reset(seed=0)[0]), torch.zeros(4, dtype=torch.bool)
    policy.begin(4)
    assert not envs.world.open_doors.any()
    for _ in range(400):
        seen, reward, _, _, info = envs.step_torch(policy(seen, blocked))
        blocked, found = info["blocked"], found + reward.numpy()
    assert envs.world.open_doors.all()
    assert (found >= 3).all()
