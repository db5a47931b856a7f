"""A recurrent network that has no map learns from the explorer, then by reward."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from benchmarks.imitation.lesson import Lesson
from benchmarks.imitation.network import RaysNetwork
from benchmarks.imitation.run import GAMMA, LAMBDA, Imitation, Pupil, advantages
from logic import generate
from logic.errors import RequestError
from sim.actions import ACTIONS, FORWARD

HOUSES = list(generate(3, seed=31, count=2))
SMALL = Imitation(houses=1, imitate=1, reinforce=1, window=16, width=8, envs=4, play=1, episodes=1)


def test_a_window_is_what_the_network_reads_and_what_was_done() -> None:
    torch.manual_seed(0)
    lesson = Lesson(HOUSES, 4, RaysNetwork(8), seed=0)
    window = lesson.window(12, led=True)
    acts = window.signals[1:, :, -ACTIONS - 1 : -1].argmax(2)
    assert torch.equal(acts, window.actions)  # the last action is read at the next step
    assert (window.actions == FORWARD).any()
    assert window.allowed.gather(2, window.actions[..., None]).all()
    assert (window.memory == 0).all()
    window = lesson.window(12, led=False)
    with torch.no_grad():
        _, _, after = lesson.pupil.network(window.signals[:-1], window.memory)
    assert torch.allclose(after, lesson.pupil.memory, atol=1e-5)
    before = lesson.pupil.memory.clone()
    lesson.restart(np.array([True, False, False, False]))
    assert (lesson.pupil.memory[0, 0] == 0).all()
    assert torch.equal(lesson.pupil.memory[0, 1:], before[0, 1:])


def test_advantages_are_discounted_sums_of_the_critics_errors() -> None:
    rewards, values = torch.rand(3, 2), torch.rand(4, 2)
    errors = rewards + GAMMA * values[1:] - values[:-1]
    flow = GAMMA * LAMBDA
    expected = errors[0] + flow * errors[1] + flow**2 * errors[2]
    assert torch.allclose(advantages(rewards, values)[0], expected)


def test_it_learns_to_do_as_the_explorer_does_and_at_first_by_reward_its_critic_alone() -> None:
    pupil = Pupil(HOUSES, SMALL, {})
    losses = [pupil.imitated()["loss"] for _ in range(30)]
    assert losses[-1] < losses[0] / 2
    actor = {name: each.clone() for name, each in pupil.network.named_parameters()}
    pupil.seconds = SMALL.imitate
    pupil.learn(SMALL.imitate + 0.01)
    changed = {name for name, each in pupil.network.named_parameters() if not torch.equal(each, actor[name])}
    assert changed
    assert all(name.startswith("critic") for name in changed)
    pupil.seconds = SMALL.imitate + SMALL.reinforce / 2
    pupil.learn(pupil.seconds + 0.01)
    assert not torch.equal(pupil.network.state_dict()["actor.0.weight"], actor["actor.0.weight"])


def test_a_network_is_kept_learns_on_with_more_time_and_plays_beside_the_explorer(
    tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    study = replace(SMALL, out=tmp_path / "out")
    study.run()
    kept = next((tmp_path / "out").glob("network-*"))
    before = kept.read_bytes()
    study.run()
    assert kept.read_bytes() == before
    rows = [
        line for line in capsys.readouterr().out.splitlines() if line.startswith(("| its", "| an action"))
    ]
    assert len(rows) == 4
    assert rows[:2] == rows[2:]
    assert replace(study, reinforce=1.5).learnt()["seconds"] >= 2.5
    assert kept.read_bytes() != before


def test_options_that_cannot_be_are_refused(tmp_path: Path) -> None:
    with pytest.raises(RequestError, match="greater than 0"):
        Imitation(window=0, out=tmp_path).run()
