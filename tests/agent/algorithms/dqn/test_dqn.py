"""Deep Q-learning: targets compared with numbers computed by hand, replay, and runs that stop and resume."""

from dataclasses import replace
from typing import cast

import numpy as np
import pytest
import torch

from tests.sample_houses import random_house
from vitruvius.agent.algorithms.dqn.config import DQNConfig
from vitruvius.agent.algorithms.dqn.learner import DQN, double_q_targets, huber_loss, n_step_returns
from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.avoidance import PaperRule
from vitruvius.agent.evaluation.episodes import play
from vitruvius.agent.learning.environments import shield
from vitruvius.agent.policies.policies import QPolicy, RandomPolicy
from vitruvius.logic import House, Rect, Star
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.actions import FORWARD, LEFT, RIGHT

E = 8
PRESET = cast(DQNConfig, PRESETS["dqn"])
SMALL = replace(
    PRESET, num_envs=E, steps=3000, buffer_size=2048, learning_starts=256, batch_size=64, n_step=3
)


@pytest.fixture(scope="module")
def envs() -> HouseVectorEnv:
    """Return environments that all tests share, as each new one compiles its kernels.

    Episodes have 100 steps, so that many end.
    """
    torch.set_num_threads(1)
    return HouseVectorEnv([random_house(seed) for seed in range(4)], E, max_episode_steps=100)


def returned(terminated=(), truncated=(), r=(1.0, 2.0, 4.0)) -> list[float]:
    """Return g, ahead and discount of three steps with these rewards and ends, at a discount of a half."""
    rewards = torch.tensor(r)[:, None]
    ends = (torch.tensor([[step in at] for step in range(3)]) for at in (terminated, truncated))
    return [float(part) for part in n_step_returns(rewards, *ends, gamma=0.5)]


def test_n_rewards_are_discounted_and_summed_and_then_the_state_they_lead_to_counts():
    assert returned() == [1 + 2 / 2 + 4 / 4, 3, 1 / 8]


def test_the_value_after_a_terminal_state_is_left_out_and_after_a_timeout_it_counts():
    assert returned(terminated=[1]) == [1 + 2 / 2, 2, 0]
    assert returned(truncated=[1]) == [1 + 2 / 2, 2, 1 / 4]
    assert returned(terminated=[2]) == [1 + 2 / 2 + 4 / 4, 3, 0]
    assert returned(truncated=[0]) == [1, 1, 1 / 2]
    assert returned(terminated=[0], truncated=[0]) == [1, 1, 0]


@pytest.mark.parametrize("end", ["terminated", "truncated"])
def test_nothing_after_an_episodes_end_counts(end):
    assert returned(**{end: [0]}) == returned(**{end: [0]}, r=(1, 99, -99)) == returned(**{end: [0, 1]})[:3]
    assert returned(terminated=[2], truncated=[0]) == returned(truncated=[0])


def test_the_network_chooses_among_the_allowed_actions_and_the_target_network_says_their_value():
    q_target, q_online = torch.tensor([[1.0, 8.0, 4.0]] * 2), torch.tensor([[3.0, 2.0, 9.0]] * 2)
    allowed = torch.tensor([[True, True, True], [True, True, False]])
    g, discount = torch.tensor([10.0, 10.0]), torch.tensor([0.5, 0.5])
    found = double_q_targets(g, discount, q_target, q_online, allowed)
    assert found.tolist() == [10 + 4 / 2, 10 + 1 / 2]
    assert double_q_targets(g, 0 * discount, q_target, q_online, allowed).tolist() == [10.0, 10.0]


def test_the_loss_is_squared_for_small_errors_linear_for_large_ones_and_leaves_out_ignored_steps():
    q = torch.tensor([[1.0, 9.0, 9.0], [9.0, 2.0, 9.0], [9.0, 9.0, 3.0]])
    actions, target = torch.tensor([LEFT, RIGHT, FORWARD]), torch.tensor([1.5, 5.0, 1e9])
    loss = huber_loss(q, actions, target, torch.tensor([True, True, False]))
    assert loss.item() == ((0.5 * 0.5**2) + (3 - 0.5)) / 2


def test_steps_whose_action_was_ignored_change_no_weight(envs):
    learner = DQN(replace(SMALL, max_grad_norm=1e9), envs)
    for _ in range(72):
        learner.act()
    learner.replay.data["valid"][:] = False
    assert float(learner.train_step(learner.sample())) == 0
    assert all(float(weight.grad.abs().max()) == 0 for weight in learner.network.parameters())


def test_the_buffer_holds_what_was_seen_and_the_actions_that_were_executed(envs):
    learner = DQN(SMALL, envs)
    rule, given = PaperRule(learner.generator, threshold=2.0), []
    learner.avoidance = lambda observation, blocked: given.append(rule(observation, blocked)) or given[-1]
    seen = [learner.s]
    for _ in range(250):
        learner.act()
        seen.append(learner.s)
    data = learner.replay.data
    assert torch.equal(data["a"][:250], torch.stack(given).long().argmax(-1))  # a single rotation is allowed
    assert learner.tally.overruled > 100 * E
    assert torch.equal(data["allowed"][:250], torch.stack(given))
    assert torch.equal(data["s"][:250], torch.stack(seen[:250]).half())
    # Episodes have 100 steps: rows 99 and 200 are the last ones, 100 and 201 the ignored ones.
    steps = torch.arange(250)
    assert torch.equal(data["valid"][:250], ((steps != 100) & (steps != 201))[:, None].expand(-1, E))
    assert torch.equal(data["truncated"][:250], ((steps == 99) | (steps == 200))[:, None].expand(-1, E))
    assert learner.tally.steps == 248 * E


def run(envs, config) -> DQN:
    """Return a run at its end."""
    learner = DQN(config, envs)
    assert list(learner.train())
    return learner


def weights(learner: DQN) -> torch.Tensor:
    return torch.cat(
        [w.detach().flatten() for w in [*learner.network.parameters(), *learner.target.parameters()]]
    )


def test_a_run_is_a_function_of_config_houses_and_seed(envs):
    one, same, other = (run(envs, replace(SMALL, seed=seed)) for seed in (1, 1, 2))
    assert one.updates == same.updates > 50
    assert torch.equal(weights(one), weights(same))
    assert not torch.equal(weights(one), weights(other))


def test_a_run_of_another_config_or_in_other_houses_cannot_go_on(envs):
    learner = DQN(SMALL, envs)
    state = learner.state()
    with pytest.raises(ValueError, match="n_step"):
        DQN(replace(SMALL, n_step=2), envs).restore(state)
    with pytest.raises(ValueError, match="other houses"):
        learner.restore(state | {"houses": "others"})
    longer = DQN(replace(SMALL, steps=8192), envs)
    longer.restore(state)


@pytest.mark.second_part("it learns")
def test_in_an_empty_room_it_learns_to_find_more_than_a_random_walk(envs):
    """It finds 40 times as much in a run of seconds."""
    envs = HouseVectorEnv([House.of_star(Star(Rect(0, 0, 4, 4)))], 32, max_episode_steps=300)
    config = replace(
        PRESET,
        num_envs=32,
        steps=32_000,
        buffer_size=32_000,
        learning_starts=2000,
        train_frequency=2,
        batch_size=256,
    )
    learner = run(envs, config)
    generator, first = torch.Generator().manual_seed(0), np.zeros(32, int)
    agent = play(envs, QPolicy(learner.network, shield(envs), generator), 7, houses=first)
    walk = play(envs, RandomPolicy(PaperRule(generator), generator), 7, houses=first)
    assert agent.targets.mean() > 3 * walk.targets.mean() + 1
