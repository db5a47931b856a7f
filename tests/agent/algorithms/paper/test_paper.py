"""Paper's agent: its network, targets and schedules, and the steps that it replays after each episode."""

from dataclasses import replace
from typing import cast

import pytest
import torch
from torch import nn

from tests.sample_houses import random_house
from vitruvius.agent.algorithms.build import network_of
from vitruvius.agent.algorithms.paper.config import PaperConfig
from vitruvius.agent.algorithms.paper.learner import Paper, q_targets, squared_loss
from vitruvius.agent.algorithms.paper.network import PaperNetwork
from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.actions import FORWARD, LEFT, RIGHT

E = 8
PRESET = cast(PaperConfig, PRESETS["paper"])
EIGHT = replace(PRESET, num_envs=E)


@pytest.fixture(scope="module")
def envs() -> HouseVectorEnv:
    """Return the paper's environments for all tests, as each new one compiles its kernels.

    Episodes have at most 100 steps.
    """
    torch.set_num_threads(1)
    houses = [random_house(seed) for seed in range(4)]
    return HouseVectorEnv(houses, E, preset=PRESET.world, max_episode_steps=100)


def test_the_network_has_61_653_parameters_and_a_softmax():
    network = PaperNetwork()
    assert sum(weight.numel() for weight in network.parameters()) == 61_653
    torch.testing.assert_close(network(torch.rand(7, 40, 3)).sum(-1), torch.ones(7))
    one, same = (network_of(PRESET).layers[0].weight for _ in range(2))
    assert torch.equal(one, same)


def test_a_target_is_the_reward_and_the_greatest_value_ahead_but_for_an_episodes_end():
    q_t = torch.tensor([[1.0, 8.0, 4.0]] * 2)
    assert q_targets(torch.tensor([2.0, 2.0]), torch.tensor([False, True]), q_t).tolist() == [10.0, 2.0]


def test_the_loss_is_the_mean_squared_error_with_none_for_actions_that_were_not_taken():
    q = torch.tensor([[1.0, 9.0, 9.0], [9.0, 2.0, 9.0]])
    actions, target = torch.tensor([LEFT, RIGHT]), torch.tensor([4.0, 5.0])
    assert squared_loss(q, actions, target).item() == nn.functional.mse_loss(
        q, torch.tensor([[4.0, 9.0, 9.0], [9.0, 5.0, 9.0]])
    )


def test_the_first_weights_are_keras_s_or_torch_s_own():
    """Glorot weights are uniform up to the root of 6 / (inputs + outputs)."""
    network = network_of(PRESET)
    for layer in network.layers:
        if isinstance(layer, nn.Linear):
            limit = (6 / (layer.in_features + layer.out_features)) ** 0.5
            assert 0.9 * limit < layer.weight.abs().max() <= limit
            assert not layer.bias.any()
    assert network_of(replace(PRESET, initialisation="torch")).layers[0].bias.any()


def test_rate_and_epsilon_fall_as_the_originals_and_the_run_ends_after_817_episodes(envs):
    learner = Paper(EIGHT, envs)
    assert learner.epsilon == 1.0
    learner.episodes, learner.updates = 817, 408_499
    assert learner.epsilon == pytest.approx(0.0378, rel=1e-2)
    assert learner.fraction == 1
    learner.episodes = 1000
    assert learner.epsilon == 0.025
    for _ in range(8):
        learner.act()
    learner.train_step(learner.batch(*learner.sample(env=0, began=0)))
    assert learner.optimizer.param_groups[0]["lr"] == pytest.approx(1e-2 / 4086, rel=1e-3)
    assert learner.optimizer.param_groups[0]["eps"] == 1e-7


def test_it_replays_500_steps_after_each_episode_its_rewarded_ones_first(envs, monkeypatch):
    learner, replayed = Paper(replace(EIGHT, num_minibatches=1), envs), []
    sample = learner.sample

    def noted(env: int, began: int) -> tuple[torch.Tensor, torch.Tensor]:
        rows, envs_of = sample(env, began)
        assert len(rows) == len(envs_of) == 500
        assert learner.replay.read("valid", rows, envs_of).all()
        # The episode ended two rows ago: the last row is the ignored one.
        replayed.append((learner.replay.written - 2, env, rows.tolist(), envs_of.tolist()))
        return rows, envs_of

    monkeypatch.setattr(learner, "sample", noted)
    for _ in range(400):
        learner.step()
    ends, rewarded = learner.replay.data["ended"][:399], 0
    assert learner.episodes == ends.sum()
    assert [(row, env) for row, env, *_ in replayed] == [(row, env) for row, env in ends.nonzero().tolist()]
    for row, env, rows, envs_of in replayed:
        before = ends[:row, env].nonzero()
        begin = int(before[-1]) + 2 if len(before) else 0
        wanted = [begin + int(at) for at in learner.replay.data["r"][begin : row + 1, env].nonzero()]
        assert list(zip(rows, envs_of, strict=True))[: len(wanted)] == [(each, env) for each in wanted]
        rewarded += len(wanted)
    assert rewarded > 0
    one, same = replayed[-1][2:]
    assert len({*zip(one[rewarded:], same[rewarded:], strict=True)}) == 500 - rewarded  # different ones


@pytest.mark.parametrize("homing", [True, False])
def test_exploring_goes_forward_where_the_middle_rays_see_the_target_if_it_homes(envs, homing):
    seen = torch.zeros(E, 40, 3)
    seen[: E // 2, 19, -1] = 1
    learner = Paper(replace(EIGHT, forward=1e-6, homing=homing), envs)
    wanted = learner.preference(torch.zeros(E, 3), seen).argmax(-1)
    assert (wanted[: E // 2] == FORWARD).tolist() == [homing] * (E // 2)
    assert (wanted[E // 2 :] != FORWARD).all()
