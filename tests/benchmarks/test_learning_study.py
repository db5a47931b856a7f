"""Measurement of learning: pairs of episodes, shuffled predictions, and choices that are played again."""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
import torch
from torch import Tensor

from benchmarks.planner import learning
from benchmarks.planner.contenders import Shuffled, contender, informed, with_shuffled_predictions
from benchmarks.planner.decisions import Kept, decisions, played_on, sampled
from benchmarks.planner.learning import EXPLORER, Learning, clustered, runs_of, scores_table, share
from tests.sample_houses import random_house
from vitruvius.agent.evaluation.episodes import reset
from vitruvius.agent.learning.environments import make_envs, shield
from vitruvius.agent.planner import Planner
from vitruvius.agent.policies.policies import Explorer, Policy, Tracker
from vitruvius.logic import save
from vitruvius.logic.errors import RequestError
from vitruvius.sim import HouseVectorEnv

pytestmark = pytest.mark.second_part("each study is run in small")

HOUSES = [random_house(seed) for seed in range(4)]


def environments(number: int) -> HouseVectorEnv:
    return make_envs(HOUSES, number, "secondary")


def explorer(envs: HouseVectorEnv) -> Policy:
    """Return the explorer, for use as ``module:function``."""
    return Explorer(shield(envs), envs.config)


@pytest.fixture
def study(tmp_path: Path) -> Learning:
    """Return a short study."""
    save(HOUSES, tmp_path / "houses.jsonl")
    return Learning(
        (f"mine={__name__}:explorer,explorer",),
        bank=str(tmp_path / "houses.jsonl"),
        episodes=2,
        steps=160,
        decisions=1.0,
        ahead=40,
        out=tmp_path / "out",
    )


# The tables.


def test_the_explorer_by_another_name_differs_by_nothing_and_scores_are_kept(
    study: Learning, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    study.run()
    page = capsys.readouterr().out
    own, choices = (line.split(" | ") for line in page.splitlines() if line.startswith("| mine | "))
    assert own[1] == "2"
    assert own[3:6] == ["+0.000 ± 0.000", "+0.000 to +0.000", "0.000"]
    assert int(choices[1]) > 10
    assert choices[2] == "0.000"
    monkeypatch.setattr(learning, "episode", None)  # Kept results are not played again.
    monkeypatch.setattr(learning, "decisions", None)
    study.run()
    assert capsys.readouterr().out == page == (study.out / "learning.md").read_text()


def test_differences_are_paired_by_episode_and_their_error_is_over_houses() -> None:
    rng = np.random.default_rng(0)
    base = rng.uniform(0, 9, (1, 2, 4, 50))
    gain = np.stack([np.full((2, 4, 50), 0.1), np.full((2, 4, 50), 0.3)])
    table = scores_table("", {EXPLORER: base, "two runs": base + gain})
    assert table.rows[1][1] == "2"
    assert table.rows[1][3:6] == ("+0.200 ± 0.000", "+0.180 to +0.220", "0.141")  # over runs, too
    # All episodes of a house fail together: they count as one.
    together = np.tile(rng.normal(size=(1, 1, 1, 50)), (1, 2, 4, 1))
    (row,) = scores_table("", {EXPLORER: base, "a": base + together}).rows[1:]
    assert row[3].endswith(f"± {together[0, 0, 0].std() / 7:.3f}")


def test_shares_are_of_the_oracles_targets_in_the_same_house() -> None:
    most = np.zeros((2, 4, 3))
    most[:, :, 0], most[:, :, 1] = 5, 2  # and none in the third house
    shares = share(np.ones((1, 2, 4, 3)), most)
    assert shares[0, 0].T.tolist() == [[0.2] * 4, [0.5] * 4, [4.0] * 4]


def test_errors_of_choices_are_over_houses() -> None:
    values, house = np.array([1.0, 1.0, 0.0, 0.0]), np.array([0, 0, 1, 1])
    assert clustered(values, house) == "+0.500 ± 0.500"
    assert clustered(values, np.arange(4)) == "+0.500 ± 0.289"


@pytest.mark.parametrize("text", ["=", "a=", "=a", "a=,"])
def test_an_agent_without_a_file_is_refused(text: str) -> None:
    with pytest.raises(RequestError, match="NAME=FILE"):
        runs_of(text)


def test_several_files_are_runs_of_one_agent() -> None:
    assert runs_of("map=a,b") == ("map", ("a", "b"))
    assert runs_of("map-completion") == ("map-completion", ("map-completion",))


def test_what_cannot_be_imported_is_one_line() -> None:
    with pytest.raises(RequestError, match="No module named 'nowhere'"):
        contender("nowhere:make")
    with pytest.raises(RequestError, match="did you mean explorer"):
        contender(f"{__name__}:explorers")


# Shuffled predictions.


class Pair(NamedTuple):
    one: Tensor
    other: Tensor


def test_every_row_gets_the_prediction_of_another_one() -> None:
    shuffled = Shuffled(lambda rows: Pair(rows, 10 * rows))
    first = shuffled(torch.tensor([1.0, 2, 3]))
    assert isinstance(first, Pair)
    assert first.one.tolist() == [3, 1, 2]
    assert shuffled(torch.tensor([4.0])).other.tolist() == [30]
    assert shuffled(torch.tensor([5.0, 6])).one.tolist() == [4, 5]
    assert Shuffled(np.sqrt)(np.array([1.0, 4.0])).tolist() == [2, 1]


def test_a_prior_that_is_shuffled_is_that_of_other_environments() -> None:
    envs = environments(8)
    priors = []
    for change in (lambda policy: policy, lambda policy: with_shuffled_predictions(policy, "")):
        policy = change(informed(envs, "rooms"))
        reset(envs, 0, np.arange(8) % 4)
        policy.begin(8)
        priors.append(policy.tracker.planner.arrays["prior"].numpy().reshape(8, -1))
    own, shuffled = priors
    assert (shuffled == np.roll(own, 1, axis=0)).all()
    assert (shuffled != own).any(axis=1).all()


def test_an_agent_that_predicts_nothing_cannot_be_shuffled() -> None:
    with pytest.raises(RequestError, match="no method predict"):
        with_shuffled_predictions(explorer(environments(1)), "explorer")


# Choices that are played again.


def test_from_a_kept_state_the_explorer_goes_to_the_goal_that_it_is_given(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    envs, again = environments(8), environments(4)
    batch: list[Kept] = []
    for _, _, kept in sampled(envs, informed(envs, "rooms"), 4, 300, 1.0):
        if kept.goals[0] != kept.goals[1]:
            batch.append(kept)
        if len(batch) == 4:
            break
    goals: list[tuple[np.ndarray, np.ndarray]] = []
    look = Tracker.look

    def noted(self: Tracker, observation: Tensor, blocked: Tensor) -> Planner:
        found = look(self, observation, blocked)
        goals.append((found.read("goal").numpy().copy(), found.read("look").numpy().copy()))
        return found

    monkeypatch.setattr(Tracker, "look", noted)
    played_on(again, batch, 1)
    assert len(goals) == 2
    for which, (goal, heading) in enumerate(goals):
        assert [*zip(goal.tolist(), heading.tolist(), strict=True)] == [kept.goals[which] for kept in batch]


def test_what_is_played_again_is_the_same_each_time_and_depends_on_the_choice() -> None:
    def made(policy: Any) -> np.ndarray:
        found = decisions(environments(8), environments(4), policy, 4, 300, 120, 0.4)
        assert found.targets.shape == (len(found.step), 2)
        assert (found.step < 180).all()
        assert (found.targets[~found.differs] == 0).all()
        return found.targets[found.differs]

    envs = environments(8)
    first, second = made(informed(envs, "rooms")), made(informed(envs, "rooms"))
    assert (first == second).all()
    assert (first[:, 0] != first[:, 1]).any()
    assert first.any()
