"""Common parts of all learners, shown by PQN: reports, the end of a run, schedules."""

import math
import subprocess
import sys
from dataclasses import replace

import pytest
import torch

from tests.sample_houses import random_house
from vitruvius.agent.algorithms.build import algorithm_of, network_of
from vitruvius.agent.algorithms.pqn.config import PQNConfig
from vitruvius.agent.algorithms.pqn.learner import PQN
from vitruvius.agent.algorithms.table import ALGORITHMS, PRESETS
from vitruvius.agent.learning.config import linear
from vitruvius.agent.learning.learner import Diverged, Learner, Progress
from vitruvius.agent.policies.network import QNetwork
from vitruvius.sim import HouseVectorEnv

E = 16
SHORT = PQNConfig(num_envs=E, num_steps=8, steps=600)


@pytest.fixture(scope="module")
def envs() -> HouseVectorEnv:
    """Return environments that all tests share, as each new one compiles its kernels."""
    torch.set_num_threads(1)
    return HouseVectorEnv([random_house(seed) for seed in range(4)], E, max_episode_steps=100)


def trained(envs: HouseVectorEnv, config: PQNConfig) -> tuple[QNetwork, list[Progress]]:
    learner = PQN(config, envs)
    return learner.network, list(learner.train())


def test_each_algorithm_has_a_config_a_learner_and_a_preset():
    assert {config.algorithm for config in PRESETS.values()} == set(ALGORITHMS)
    assert all(issubclass(algorithm_of(config), Learner) for config in PRESETS.values())


def test_the_table_of_algorithms_is_imported_without_torch():
    """Without torch, help and completion are fast."""
    program = "import sys, agent.algorithms.table; sys.exit('torch' in sys.modules)"
    subprocess.run([sys.executable, "-c", program], check=True)


def test_a_short_run_changes_all_weights_and_reports_its_progress(envs):
    network, history = trained(envs, SHORT)
    assert [progress.steps for progress in history] == [128, 256, 384, 512, 640]
    assert history[-1].fraction == 1
    assert history[0].epsilon == 0.4
    assert history[-1].epsilon == pytest.approx(SHORT.final_epsilon)
    assert all(math.isfinite(progress.loss) for progress in history)
    pairs = zip(network.parameters(), network_of(PQNConfig()).parameters(), strict=True)
    assert not any(torch.equal(weight, first) for weight, first in pairs)


def test_the_same_config_and_seed_give_the_same_weights(envs):
    one, same, other = (trained(envs, replace(SHORT, seed=seed))[0].state_dict() for seed in (1, 1, 2))
    assert all(torch.equal(one[name], same[name]) for name in one)
    assert not torch.equal(one["look.weight"], other["look.weight"])


def test_steps_whose_action_was_ignored_are_not_counted(envs):
    _, history = trained(envs, replace(SHORT, num_steps=101, num_minibatches=1, update_epochs=1))
    assert history[0].steps == 100 * E  # an episode, without the step that begins the next one


def test_a_run_ends_when_its_seconds_are_over(envs):
    _, history = trained(envs, replace(SHORT, steps=10**9, seconds=0.5))
    assert history[-1].fraction == 1
    assert history[-1].seconds < 5


def test_a_loss_that_is_not_a_number_or_grows_without_bound_ends_the_run(envs):
    learner = PQN(SHORT, envs)
    reports = learner.train()
    next(reports)
    torch.nn.init.constant_(learner.network.judge[-1].bias, float("nan"))
    with pytest.raises(Diverged, match="the loss is nan after 256 steps"):
        next(reports)
    wild = PQN(replace(SHORT, learning_rate=1e9, max_grad_norm=None), envs)
    with pytest.raises(Diverged):
        list(wild.train())


def test_a_linear_schedule_stays_at_its_end_value():
    assert [linear(0.4, 0.2, progress) for progress in (0, 0.5, 1, 7)] == pytest.approx([0.4, 0.3, 0.2, 0.2])
