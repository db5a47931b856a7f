"""Q(lambda), the loss and the mirror, against numbers worked out by hand."""

import pytest
import torch

from agent import train
from agent.actions import FORWARD, LEFT, RIGHT, mirrored
from agent.config import Config
from agent.memory import mirrored_memory
from agent.network import QNetwork, seeded_network
from agent.pqn import lambda_returns, linear, q_loss
from agent.rollout import Rollout

HALF = {"discount": 0.5, "trace": 0.5}


def column(*values: float) -> torch.Tensor:
    """A trace (T, 1) of one environment."""
    return torch.tensor(values, dtype=torch.float32)[:, None]


def returns(*, terminated: int | None = None, truncated: int | None = None, r=(1, 0, 2, 4)) -> list[float]:
    """Returns of four steps with values 8, 4, 2, 6 ahead; the episode may end at one of them."""
    died, timed_out = (column(*(float(t == at) for t in range(4))).bool() for at in (terminated, truncated))
    return lambda_returns(column(*r), died, timed_out, column(8, 4, 2, 6), **HALF).flatten().tolist()


def test_returns_follow_the_trace_worked_out_by_hand():
    # g3 = 4 + .5*6 = 7          g2 = 2 + .5*(.5*2 + .5*7)      = 4.25
    # g1 = .5*(.5*4 + .5*4.25) = 2.0625    g0 = 1 + .5*(.5*8 + .5*2.0625) = 3.515625
    assert returns() == [3.515625, 2.0625, 4.25, 7.0]


def test_a_timeout_is_worth_the_state_it_led_to():
    # g1 = .5*4 = 2    g0 = 1 + .5*(.5*8 + .5*2) = 3.5
    assert returns(truncated=1)[:2] == [3.5, 2.0]


def test_a_terminal_state_is_worth_nothing():
    # g1 = 0    g0 = 1 + .5*(.5*8 + .5*0) = 3
    assert returns(terminated=1)[:2] == [3.0, 0.0]


@pytest.mark.parametrize("end", ["terminated", "truncated"])
def test_no_return_leaks_from_a_later_episode(end):
    assert returns(**{end: 1})[:2] == returns(**{end: 1}, r=(1, 0, 99, -99))[:2]


def test_without_a_trace_returns_are_one_step_and_with_a_full_one_they_never_look_ahead():
    r, v, no = torch.rand(5, 3), torch.rand(5, 3), torch.zeros(5, 3, dtype=torch.bool)
    one_step = lambda_returns(r, no, no, v, discount=0.9, trace=0.0)
    torch.testing.assert_close(one_step, r + 0.9 * v)
    full = lambda_returns(r, no, no, v, discount=0.9, trace=1.0)
    torch.testing.assert_close(full[0], sum(0.9**t * r[t] for t in range(5)) + 0.9**5 * v[-1])


def test_the_loss_sees_the_taken_action_and_no_ignored_step():
    q = torch.tensor([[1.0, 9.0, 9.0], [9.0, 2.0, 9.0], [9.0, 9.0, 3.0]], requires_grad=True)
    valid = torch.tensor([True, True, False])
    loss = q_loss(q, torch.tensor([LEFT, RIGHT, FORWARD]), torch.tensor([3.0, 2.0, 1e9]), valid)
    loss.backward()
    assert loss.item() == 1.0  # half of (2^2 + 0) over two steps
    assert q.grad is not None
    assert q.grad.tolist() == [[-1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]


def test_a_rollout_of_ignored_steps_teaches_nothing():
    q = torch.ones(2, 3)
    assert q_loss(q, torch.zeros(2, dtype=torch.int64), torch.zeros(2), torch.zeros(2).bool()).item() == 0


def test_the_mirror_exchanges_left_and_right_alone_and_undoes_itself():
    actions = torch.tensor([LEFT, RIGHT, FORWARD])
    assert mirrored(actions).tolist() == [RIGHT, LEFT, FORWARD]
    assert torch.equal(mirrored(mirrored(actions)), actions)


def test_every_second_epoch_learns_from_the_mirror(monkeypatch):
    seen = []

    def loss(q_tm1, a_tm1, g_tm1, valid):
        seen.append(a_tm1)
        return q_loss(q_tm1, a_tm1, g_tm1, valid)

    monkeypatch.setattr(train, "q_loss", loss)
    network = seeded_network(0)
    network.register_forward_pre_hook(lambda module, given: seen.extend(given))
    rollout = Rollout.starting(1, torch.rand(1, 40, 2), torch.rand(1, 4, 6))
    for state in (rollout.s, rollout.memory):
        state[0] = state[1]
    rollout.a[:], rollout.r[:], rollout.v[:], rollout.valid[:] = LEFT, 1.0, 0.0, True
    optimizer = torch.optim.SGD(network.parameters(), lr=0.1)
    train.update(network, optimizer, rollout, Config(epochs=2, minibatches=1), torch.Generator())
    s, memory, _, a, s_mirror, memory_mirror, _, a_mirror = seen
    assert torch.equal(s_mirror, s.flip(1))
    assert torch.equal(memory_mirror, mirrored_memory(memory))
    assert (a.item(), a_mirror.item()) == (LEFT, RIGHT)


def test_schedules_run_on_a_line_and_stay_at_its_end():
    assert [linear(0.4, 0.2, progress) for progress in (0, 0.5, 1, 7)] == pytest.approx([0.4, 0.3, 0.2, 0.2])


def test_the_network_has_the_stated_size_and_shape():
    network = QNetwork()
    assert sum(weight.numel() for weight in network.parameters()) == 57_651
    assert network(torch.rand(7, 40, 2), torch.rand(7, 4, 6)).shape == (7, 3)


def test_first_weights_are_a_function_of_the_seed_and_leave_torch_alone():
    before = torch.random.get_rng_state()
    one, same, other = (seeded_network(seed).look.weight for seed in (1, 1, 2))
    assert torch.equal(one, same)
    assert not torch.equal(one, other)
    assert torch.equal(before, torch.random.get_rng_state())
