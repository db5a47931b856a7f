"""Rollouts: the steps that count, the memory, and the start of one rollout after another."""

import pytest
import torch

from tests.sample_houses import random_house
from vitruvius.agent.algorithms.build import network_of
from vitruvius.agent.algorithms.pqn.config import PQNConfig
from vitruvius.agent.algorithms.pqn.rollout import Rollout
from vitruvius.agent.learning.environments import shield
from vitruvius.agent.learning.stopwatch import Stopwatch
from vitruvius.agent.policies.network import QNetwork
from vitruvius.sim import HouseVectorEnv

E, STEPS = 16, 40


@pytest.fixture(scope="module")
def envs() -> HouseVectorEnv:
    """Return environments that all tests share, as each new one compiles its kernels.

    Episodes have 40 steps.
    """
    torch.set_num_threads(1)
    return HouseVectorEnv([random_house(seed) for seed in range(4)], E, max_episode_steps=STEPS)


def filled(envs: HouseVectorEnv, network: QNetwork, *, length: int, times: int) -> tuple[torch.Tensor, ...]:
    """Return observations, memories, actions and validity of ``times`` rollouts, end to end."""
    observation = torch.as_tensor(envs.reset(seed=0)[0])
    rollout, kept = Rollout.starting(length, observation, network.memory.empty(E)), []
    for _ in range(times):
        generator = torch.Generator().manual_seed(0)
        rollout.fill(
            envs,
            network,
            shield(envs),
            epsilon=0.0,
            forward=0.9,
            generator=generator,
            simulating=Stopwatch(),
        )
        kept.append(
            [part.clone() for part in (rollout.s[:-1], rollout.memory[:-1], rollout.a, rollout.valid)]
        )
    return tuple(torch.cat(parts) for parts in zip(*kept, strict=True))


def test_the_step_after_an_end_is_not_valid_and_the_next_episodes_memory_begins_empty(envs):
    _, memory, _, valid = filled(envs, network_of(PQNConfig()), length=15, times=4)
    assert valid.logical_not().nonzero()[:, 0].tolist() == [STEPS] * E
    held = memory.sum((2, 3)).gt(0)
    assert not held[[0, STEPS + 1]].any()
    assert held[1 : STEPS + 1].all()
    assert held[STEPS + 2 :].all()


def test_a_rollout_goes_on_where_the_one_before_it_ended(envs):
    network = network_of(PQNConfig())
    halves, whole = filled(envs, network, length=20, times=2), filled(envs, network, length=40, times=1)
    assert all(torch.equal(a, b) for a, b in zip(halves, whole, strict=True))
