"""Policies: the share of random actions."""

import pytest
import torch

from agent.actions import FORWARD, LEFT
from agent.policies.policies import epsilon_greedy, exploration_noise, explore


def seeded() -> torch.Generator:
    return torch.Generator().manual_seed(0)


def by_noise(q: torch.Tensor, epsilon: float) -> torch.Tensor:
    return explore(q, exploration_noise((len(q),), seeded(), epsilon, forward=1.0))


def by_generator(q: torch.Tensor, epsilon: float) -> torch.Tensor:
    return epsilon_greedy(q, epsilon, forward=1.0, generator=seeded())


@pytest.mark.parametrize("exploring", [by_noise, by_generator])
@pytest.mark.parametrize("epsilon", [0.0, 0.25, 1.0])
def test_a_share_of_the_actions_is_random_and_the_rest_are_the_best(epsilon, exploring):
    q = torch.tensor([[1.0, 0.0, 0.0]]).expand(20_000, 3)
    actions = exploring(q, epsilon).argmax(-1)
    assert (actions == FORWARD).float().mean().item() == pytest.approx(epsilon, abs=0.01)
    assert ((actions == FORWARD) | (actions == LEFT)).all()
