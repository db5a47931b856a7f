"""Policies: the share of random actions."""

import pytest
import torch

from agent.policies.policies import epsilon_greedy, exploration
from sim.actions import FORWARD, LEFT


def seeded() -> torch.Generator:
    return torch.Generator().manual_seed(0)


@pytest.mark.parametrize("draws", [1, 2])
@pytest.mark.parametrize("epsilon", [0.0, 0.25, 1.0])
def test_a_share_of_the_actions_is_random_and_the_rest_are_the_best(epsilon, draws):
    q = torch.tensor([[1.0, 0.0, 0.0]]).expand(20_000, 3)
    actions = epsilon_greedy(q, *exploration((len(q),), seeded(), epsilon, 1.0, draws)).argmax(-1)
    assert (actions == FORWARD).float().mean().item() == pytest.approx(epsilon, abs=0.01)
    assert ((actions == FORWARD) | (actions == LEFT)).all()
