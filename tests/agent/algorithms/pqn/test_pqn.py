"""Q(lambda) and the loss compared with numbers computed by hand; runs that stop and resume."""

from dataclasses import replace

import pytest
import torch

from tests.sample_houses import random_house
from vitruvius.agent.algorithms.build import network_of
from vitruvius.agent.algorithms.pqn.config import PQNConfig
from vitruvius.agent.algorithms.pqn.learner import PQN, RolloutBatch, lambda_returns, q_loss
from vitruvius.agent.algorithms.pqn.recurrent import RecurrentQNetwork
from vitruvius.agent.policies.network import QNetwork
from vitruvius.logic.errors import RequestError
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.actions import FORWARD, LEFT, RIGHT

E = 16

HALF = {"gamma": 0.5, "q_lambda": 0.5}


def column(*values: float) -> torch.Tensor:
    """Return values (T, 1) of one environment."""
    return torch.tensor(values, dtype=torch.float32)[:, None]


def returns(*, terminated: int | None = None, truncated: int | None = None, r=(1, 0, 2, 4)) -> list[float]:
    """Return the returns of four steps with values 8, 4, 2, 6 ahead; the episode may end at one of them."""
    died, timed_out = (column(*(float(t == at) for t in range(4))).bool() for at in (terminated, truncated))
    return lambda_returns(column(*r), died, timed_out, column(8, 4, 2, 6), **HALF).flatten().tolist()


def test_returns_are_those_worked_out_by_hand():
    # g3 = 4 + .5*6 = 7          g2 = 2 + .5*(.5*2 + .5*7)      = 4.25
    # g1 = .5*(.5*4 + .5*4.25) = 2.0625    g0 = 1 + .5*(.5*8 + .5*2.0625) = 3.515625
    assert returns() == [3.515625, 2.0625, 4.25, 7.0]


def test_after_a_timeout_the_value_of_the_next_state_counts():
    # g1 = .5*4 = 2    g0 = 1 + .5*(.5*8 + .5*2) = 3.5
    assert returns(truncated=1)[:2] == [3.5, 2.0]


def test_the_value_of_a_terminal_state_is_0():
    # g1 = 0    g0 = 1 + .5*(.5*8 + .5*0) = 3
    assert returns(terminated=1)[:2] == [3.0, 0.0]


@pytest.mark.parametrize("end", ["terminated", "truncated"])
def test_no_return_flows_from_an_episode_to_the_one_before(end):
    assert returns(**{end: 1})[:2] == returns(**{end: 1}, r=(1, 0, 99, -99))[:2]


def test_lambda_0_gives_one_step_returns_and_lambda_1_sums_of_all_rewards():
    r, v, no = torch.rand(5, 3), torch.rand(5, 3), torch.zeros(5, 3, dtype=torch.bool)
    one_step = lambda_returns(r, no, no, v, gamma=0.9, q_lambda=0.0)
    torch.testing.assert_close(one_step, r + 0.9 * v)
    full = lambda_returns(r, no, no, v, gamma=0.9, q_lambda=1.0)
    torch.testing.assert_close(full[0], sum(0.9**t * r[t] for t in range(5)) + 0.9**5 * v[-1])


def test_the_loss_is_of_the_taken_actions_without_ignored_steps():
    q = torch.tensor([[1.0, 9.0, 9.0], [9.0, 2.0, 9.0], [9.0, 9.0, 3.0]], requires_grad=True)
    valid = torch.tensor([True, True, False])
    loss = q_loss(q, torch.tensor([LEFT, RIGHT, FORWARD]), torch.tensor([3.0, 2.0, 1e9]), valid)
    loss.backward()
    assert loss.item() == 1.0  # half of (2^2 + 0) over two steps
    assert q.grad is not None
    assert q.grad.tolist() == [[-1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]


def test_the_loss_of_ignored_steps_alone_is_0():
    q = torch.ones(2, 3)
    assert q_loss(q, torch.zeros(2, dtype=torch.int64), torch.zeros(2), torch.zeros(2).bool()).item() == 0


@pytest.fixture(scope="module")
def envs() -> HouseVectorEnv:
    """Return environments that all tests share, as each new one compiles its kernels.

    Episodes have 40 steps, so that many end.
    """
    torch.set_num_threads(1)
    return HouseVectorEnv([random_house(seed) for seed in range(4)], E, max_episode_steps=40)


def learnt_from(envs, monkeypatch, **changes) -> tuple[PQN, list[RolloutBatch]]:
    """Return a learner after one rollout, and the batches that it learned from."""
    config = replace(PQNConfig(num_envs=E, num_minibatches=1, steps=100_000), **changes)
    learner = PQN(config, envs)
    batches, train_step = [], learner.train_step
    monkeypatch.setattr(learner, "train_step", lambda batch: batches.append(batch) or train_step(batch))
    learner.iterate()
    return learner, batches


def test_an_epoch_learns_from_each_step_of_the_rollout_once(envs, monkeypatch):
    learner, batches = learnt_from(envs, monkeypatch, update_epochs=1)
    acted = torch.stack([batches[0].s_tm1.sum((1, 2)), batches[0].a_tm1.float()], dim=1)
    lived = torch.stack([learner.rollout.s[:-1].sum((2, 3)), learner.rollout.a.float()], dim=2).flatten(0, 1)
    torch.testing.assert_close(acted.sort(0).values, lived.sort(0).values)


RECURRENT = {"network": "recurrent", "half_lives": ()}


def test_a_recurrent_network_learns_from_the_memories_that_it_acted_with(envs, monkeypatch):
    learner, [batch] = learnt_from(envs, monkeypatch, update_epochs=1, num_steps=90, **RECURRENT)
    acted = learner.rollout.memory[:-1]
    assert (~learner.rollout.valid).any()  # an episode ended, and its memory with it
    order = batch.s_tm1.unflatten(0, (90, E))[0].sum((1, 2)).argsort()
    same = learner.rollout.s[0].sum((1, 2)).argsort()
    computed = batch.m_tm1.detach().unflatten(0, (90, E))
    torch.testing.assert_close(computed[:, order], acted[:, same], atol=1e-5, rtol=0)


def test_gradients_of_a_recurrent_network_reach_back_to_the_first_observation(envs):
    network = RecurrentQNetwork()
    observations = torch.rand(9, 2, 40, 2, requires_grad=True)
    no, acts = torch.zeros(9, 2).bool(), torch.zeros(9, 2, dtype=torch.int64)
    memories = network.memory.unrolled(network.memory.empty(2), observations, no, acts, no)
    [reach] = torch.autograd.grad(memories[-1].sum(), observations, retain_graph=True)
    assert reach[:-1].abs().amax((1, 2, 3)).gt(0).all()
    cut = no.clone()
    cut[4] = True  # the step from state 4 began another episode
    memories = network.memory.unrolled(network.memory.empty(2), observations, no, acts, cut)
    assert not memories[5].any()
    [reach] = torch.autograd.grad(memories[-1].sum(), observations)
    assert not reach[:5].any()
    assert reach[5:-1].abs().amax((1, 2, 3)).gt(0).all()


def learner_of(envs, **changes) -> PQN:
    return PQN(PQNConfig(num_envs=E, num_steps=8, steps=2000, **changes), envs)


def test_a_run_of_another_config_algorithm_or_bank_cannot_go_on(envs):
    state = learner_of(envs).state()
    with pytest.raises(RequestError, match="q_lambda, seed"):
        learner_of(envs, q_lambda=0.5, seed=3).restore(state)
    with pytest.raises(RequestError, match="dqn cannot be resumed as pqn"):
        learner_of(envs).restore(state | {"algorithm": "dqn"})
    with pytest.raises(RequestError, match="other houses"):
        learner_of(envs).restore(state | {"houses": "others"})


def test_the_network_has_the_stated_size_and_shape():
    network = QNetwork()
    assert sum(weight.numel() for weight in network.parameters()) == 57_651
    assert network(torch.rand(7, 40, 2), torch.rand(7, 4, 6)).shape == (7, 3)


def test_first_weights_are_a_function_of_the_seed_and_torchs_generator_is_left_alone():
    before = torch.random.get_rng_state()
    one, same, other = (network_of(PQNConfig(seed=seed)).look.weight for seed in (1, 1, 2))
    assert torch.equal(one, same)
    assert not torch.equal(one, other)
    assert torch.equal(before, torch.random.get_rng_state())
