"""Scores of an episode: what counts, and what they do not depend on."""

from typing import cast

import numpy as np
import pytest
import torch

from tests.sample_houses import drawn, random_house
from vitruvius.agent.algorithms.build import network_of
from vitruvius.agent.algorithms.pqn.config import PQNConfig
from vitruvius.agent.baselines.coverage import Coverage
from vitruvius.agent.baselines.table import BASELINES
from vitruvius.agent.evaluation.episodes import play
from vitruvius.agent.learning.environments import make_envs
from vitruvius.agent.policies.policies import QPolicy, RandomPolicy
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.actions import FORWARD
from vitruvius.sim.oracle.oracle import Oracle

ENVIRONMENTS = 4


@pytest.fixture(scope="module")
def envs() -> HouseVectorEnv:
    """Return some random houses, with targets in the main room."""
    return make_envs([random_house(seed) for seed in range(ENVIRONMENTS)], ENVIRONMENTS)


class Straight:
    """Policy that always goes forward."""

    interventions = 0

    def begin(self, environments):
        pass

    def __call__(self, observation, blocked):
        return torch.full((len(observation),), FORWARD)


class Ending:
    """Environments that reward and block every step; environment i ends for good at step i + 1."""

    num_envs = 3

    def reset(self, seed: int, options: dict) -> tuple[np.ndarray, dict]:
        self.time = 0
        return np.zeros((3, 40, 2), np.float32), {}

    def step_torch(self, actions: torch.Tensor) -> tuple:
        self.time += 1
        yes, terminated = torch.ones(3).bool(), torch.arange(1, 4) == self.time
        return torch.zeros(3, 40, 2), torch.ones(3), terminated, ~yes, {"blocked": yes}


def test_only_the_first_episode_of_each_environment_counts():
    free = RandomPolicy(lambda observation, blocked: torch.ones(3, 3).bool(), torch.Generator())
    scores = play(cast(HouseVectorEnv, Ending()), free, seed=0)
    assert scores.targets.tolist() == [1, 2, 3]
    assert scores.first.tolist() == [1, 1, 1]
    assert (scores.steps, scores.blocked) == (6, 6)


def test_coverage_and_rooms_are_noted_after_500_steps_and_at_the_end():
    envs = make_envs([drawn("aaa\naaa\na+a\n...\n...\nb+b\nbbb")], 4, "mixed")
    coverage = Coverage(envs)
    noted = play(envs, Straight(), seed=0, houses=np.zeros(4, int), coverage=coverage)
    assert noted.coverage.shape == (2, 4)
    assert (noted.coverage[0] > 0.05).all()
    assert (noted.coverage[1] == noted.coverage[0]).all()  # it has stood in front of a wall for long
    assert (noted.coverage[1] == coverage.share()).all()
    assert (noted.rooms == coverage.rooms()).all()


def test_the_oracle_as_a_policy_picks_up_what_it_does_by_itself(envs):
    played = play(envs, BASELINES["oracle"](envs, 0), seed=5)
    envs.reset(seed=5, options={"house": np.arange(ENVIRONMENTS)})
    assert played.targets.tolist() == Oracle(envs).play().tolist()
    assert played.blocked == 0


def test_scores_are_a_function_of_the_seed(envs):
    one, same, other = (play(envs, BASELINES["script"](envs, 0), seed) for seed in (1, 1, 2))
    assert one.targets.tolist() == same.targets.tolist()
    assert one.targets.tolist() != other.targets.tolist()


def random_policy(layer):
    return RandomPolicy(layer, torch.Generator().manual_seed(0))


def untrained_policy(layer):
    return QPolicy(network_of(PQNConfig()), layer, torch.Generator().manual_seed(0))


@pytest.mark.parametrize("make", [random_policy, untrained_policy])
def test_interventions_are_the_actions_that_the_avoidance_layer_changed(make, envs):
    free = torch.ones(ENVIRONMENTS, 3).bool()
    left = free & torch.tensor([True, False, False])
    for allowed, least, most in ((free, 0, 0), (left, 1, ENVIRONMENTS * 1500 - 1)):
        scores = play(envs, make(lambda observation, blocked, allowed=allowed: allowed), seed=0)
        assert scores.steps == ENVIRONMENTS * 1500
        assert least <= scores.interventions <= most
