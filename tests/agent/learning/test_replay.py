"""Replay buffer compared with episodes written by hand: no sample mixes episodes or environments."""

import pytest
import torch

from vitruvius.agent.algorithms.dqn.learner import n_step_batch
from vitruvius.agent.learning.replay import ReplayBuffer

LENGTHS = (7, 5)
"""Steps in the episodes of the two environments; the action of the next row is ignored."""


def filled(rows: int, room: int) -> ReplayBuffer:
    """Return a buffer of two environments after ``rows`` rows, with capacity ``room``.

    An observation has its row's number and environment, a reward the number of its episode. Each episode ends
    by a time-out.
    """
    no = torch.zeros(2, dtype=torch.bool)
    replay = ReplayBuffer(
        room,
        s=torch.zeros(2, 4, 2),
        m=torch.zeros(2, 1, 6),
        allowed=torch.zeros(2, 3, dtype=torch.bool),
        a=torch.zeros(2, dtype=torch.int64),
        r=torch.zeros(2),
        terminated=no,
        truncated=no,
        valid=no,
    )
    for row in range(rows):
        place = [(row // (length + 1), row % (length + 1)) for length in LENGTHS]
        replay.append(
            s=torch.tensor([[[float(row), env]] * 4 for env in range(2)]),
            m=torch.full((2, 1, 6), float(row)),
            allowed=torch.ones(2, 3, dtype=torch.bool),
            a=torch.tensor([row % 3] * 2),
            r=torch.tensor([float(episode + 1) * (time > 0) for episode, time in place]),
            terminated=no,
            truncated=torch.tensor(
                [time == length for (_, time), length in zip(place, LENGTHS, strict=True)]
            ),
            valid=torch.tensor([time > 0 for _, time in place]),
        )
    return replay


@pytest.mark.parametrize("rows", [20, 50, 99])
def test_a_sample_has_rows_that_are_still_there_and_enough_rows_after_them(rows):
    replay = filled(rows, room=30)
    sampled, envs = replay.sample(2000, 3, torch.Generator().manual_seed(0))
    assert sampled.min() == max(0, rows - 30)
    assert sampled.max() == rows - 3 - 1
    assert set(envs.tolist()) == {0, 1}
    assert torch.equal(replay.read("s", sampled, envs)[:, 0].long(), torch.stack([sampled, envs], dim=1))


@pytest.mark.parametrize("rows", [20, 50, 99])
def test_n_step_returns_from_the_buffer_never_mix_episodes_or_environments(rows):
    replay, n = filled(rows, room=30), 3
    sampled, envs = replay.sample(2000, n, torch.Generator().manual_seed(0))
    batch = n_step_batch(replay, sampled, envs, n=n, gamma=1.0)
    assert torch.equal(batch.s_tm1[:, 0].long(), torch.stack([sampled, envs], dim=1))
    assert torch.equal(batch.m_tm1[:, 0, 0].long(), sampled)
    assert torch.equal(batch.a_tm1, sampled % 3)
    length = torch.tensor(LENGTHS)[envs]
    time, episode = sampled % (length + 1), sampled // (length + 1)
    assert torch.equal(batch.valid, time > 0)  # the ignored rows are marked as such
    valid = batch.valid
    steps = (length + 1 - time).clamp(max=n)[valid]
    assert torch.equal(batch.g[valid], (steps * (episode + 1)[valid]).float())
    assert torch.equal(batch.s_t[valid][:, 0, 0].long(), sampled[valid] + steps)
    assert torch.equal(batch.s_t[:, 0, 1].long(), envs)
    assert torch.equal(batch.discount_t[valid], torch.ones(int(valid.sum())))


def test_a_buffer_restored_from_its_state_goes_on_like_the_one_before(tmp_path):
    replay, other = filled(20, room=30), filled(7, room=30)
    torch.save(replay.state(), tmp_path / "replay.pt")
    other.restore(torch.load(tmp_path / "replay.pt", weights_only=True))
    for each in (replay, other):
        each.append(**{name: torch.ones_like(data[0]) for name, data in each.data.items()})
    assert other.written == 21
    assert all(torch.equal(data, other.data[name]) for name, data in replay.data.items())
