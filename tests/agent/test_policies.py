"""Policies: the share of random actions, and how a network and a map's advice are combined."""

import numpy as np
import pytest
import torch

from agent.actions import FORWARD, LEFT, RIGHT
from agent.build import network_of
from agent.config import PQNConfig
from agent.policies import QPolicy, defer, epsilon_greedy, exploration_noise, explore
from agent.world import make_envs, shield
from tests.sample_houses import random_house


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


def test_a_network_prefers_the_maps_advice_where_actions_have_about_the_same_value():
    q = torch.tensor([[0.5, 0.55, 0.5], [0.5, 0.7, 0.5]])
    advice = torch.tensor([FORWARD, FORWARD])
    assert defer(q, advice).argmax(-1).tolist() == [FORWARD, RIGHT]


def test_a_new_network_with_a_map_does_what_the_map_advises():
    envs = make_envs([random_house(seed) for seed in range(5)], 6, "mixed")
    policy = QPolicy(network_of(PQNConfig(map=True)), shield(envs), torch.Generator(), epsilon=0.0)
    seen, blocked = torch.as_tensor(envs.reset(seed=0)[0]), torch.zeros(6, dtype=torch.bool)
    policy.begin(6)
    for _ in range(50):
        actions = policy(seen, blocked)
        assert policy.tracker
        assert torch.equal(actions, policy.tracker.planner.advice)
        observation, _, _, _, info = envs.step(np.asarray(actions))
        seen, blocked = torch.as_tensor(observation), torch.as_tensor(info["blocked"])
