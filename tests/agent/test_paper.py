"""The paper's agent: its network, targets, schedules, and what it replays after each episode."""

from dataclasses import replace
from typing import cast

import pytest
import torch

from agent.actions import FORWARD, LEFT, RIGHT
from agent.build import network_of
from agent.config import PRESETS, PaperConfig
from agent.paper import Paper, PaperNetwork, explore, q_targets, squared_loss
from sim import HouseVectorEnv
from tests.sample_houses import random_house

E = 8
PRESET = cast(PaperConfig, PRESETS["paper"])
SMALL = replace(PRESET, num_envs=E, steps=3000, buffer_size=2048, batch_size=64, num_minibatches=4)


@pytest.fixture(scope="module")
def envs() -> HouseVectorEnv:
    """The paper's environments for all tests, as each compiles its kernels; episodes of at most 100 steps."""
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


def test_the_loss_is_the_squared_error_of_the_taken_actions_without_ignored_steps():
    q = torch.tensor([[1.0, 9.0, 9.0], [9.0, 2.0, 9.0], [9.0, 9.0, 3.0]])
    actions, target = torch.tensor([LEFT, RIGHT, FORWARD]), torch.tensor([3.0, 2.0, 1e9])
    assert squared_loss(q, actions, target, torch.tensor([True, True, False])).item() == 2.0


def test_rate_and_epsilon_fall_to_the_papers_last_values(envs):
    learner = Paper(PRESET, envs)
    assert learner.epsilon == 1.0
    learner.episodes, learner.updates = 1000, 499_999
    assert learner.epsilon == 0.025
    for _ in range(8):
        learner.act()
    learner.train_step(learner.batch(*learner.sample(env=0, began=0)))
    assert learner.optimizer.param_groups[0]["lr"] == pytest.approx(2e-6, rel=1e-3)


def test_it_replays_once_after_each_episode_and_all_of_its_rewarded_steps(envs, monkeypatch):
    learner, replayed = Paper(replace(PRESET, num_minibatches=1), envs), []
    sample = learner.sample

    def noted(env: int, began: int) -> tuple[torch.Tensor, torch.Tensor]:
        rows, envs_of = sample(env, began)
        assert len(rows) == len(envs_of) == 500
        # The episode ended two rows ago: the last row is the ignored one.
        replayed.append((learner.replay.written - 2, env, rows[envs_of == env].tolist()))
        return rows, envs_of

    monkeypatch.setattr(learner, "sample", noted)
    for _ in range(400):
        learner.step()
    ends, rewarded = learner.replay.data["ended"][:399], 0
    assert learner.episodes == ends.sum()
    first = 500 // E - 2  # before, the buffer held too little
    assert [(row, env) for row, env, _ in replayed] == [
        (row, env) for row, env in ends.nonzero().tolist() if row >= first
    ]
    for row, env, rows in replayed:
        before = ends[:row, env].nonzero()
        begin = int(before[-1]) + 2 if len(before) else 0
        wanted = {begin + int(at) for at in learner.replay.data["r"][begin : row + 1, env].nonzero()}
        assert wanted <= set(rows)
        rewarded += len(wanted)
    assert rewarded > 0


def test_exploring_goes_forward_where_the_middle_rays_see_the_target():
    seen = torch.zeros(E, 40, 3)
    seen[: E // 2, 19, -1] = 1
    generator = torch.Generator().manual_seed(0)
    wanted = explore(torch.zeros(E, 3), seen, epsilon=1.0, forward=1e-6, generator=generator).argmax(-1)
    assert wanted[: E // 2].tolist() == [FORWARD] * (E // 2)
    assert (wanted[E // 2 :] != FORWARD).all()


def run(envs, config=SMALL, steps=None) -> Paper:
    """A run to its end, or to the first report after that many steps."""
    learner = Paper(config, envs)
    for now in learner.train():
        if steps and now.steps >= steps:
            break
    return learner


def weights(learner: Paper) -> torch.Tensor:
    return torch.cat([weight.detach().flatten() for weight in learner.network.parameters()])


def test_a_run_that_was_stopped_goes_on_bit_for_bit(envs, tmp_path):
    torch.save(run(envs, steps=2000).state(), tmp_path / "run.pt")
    whole, resumed = run(envs), Paper(SMALL, envs)
    resumed.restore(torch.load(tmp_path / "run.pt", weights_only=True))
    assert 2000 <= resumed.steps < 3000
    assert list(resumed.train())
    assert (resumed.steps, resumed.updates, resumed.episodes) == (whole.steps, whole.updates, whole.episodes)
    assert whole.updates >= 100
    assert torch.isfinite(weights(whole)).all()
    assert torch.equal(weights(resumed), weights(whole))
    assert torch.equal(resumed.replay.data["s"], whole.replay.data["s"])
