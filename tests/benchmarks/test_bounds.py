"""Limits of the network that chooses views: choices with parts of the truth, and views that follow."""

from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
import torch

from benchmarks.planner.backed_up import FIRST, backed_up
from benchmarks.planner.bounds import Bounds
from tests.sample_houses import FOUR_ROOMS
from vitruvius.agent.evaluation.episodes import reset
from vitruvius.agent.learning.environments import make_envs
from vitruvius.agent.policies.episodes import moments
from vitruvius.logic.errors import RequestError

pytestmark = pytest.mark.second_part("each study is run in small")

HOUSES = FOUR_ROOMS
EVERYONE = np.arange(len(HOUSES))


def played(maker: Any, steps: int) -> Any:
    """Return a policy that has played, and the number of targets that it found."""
    envs = make_envs(HOUSES, len(HOUSES), "secondary")
    policy = maker(envs)
    found = sum(float(now.reward.sum()) for now in moments(envs, policy, reset(envs, 0, EVERYONE), steps))
    return envs, policy, found


def test_views_that_are_valued_with_those_that_follow_are_places_in_the_house() -> None:
    envs = make_envs(HOUSES, len(HOUSES), "secondary")
    policy = backed_up(envs)
    chooser, told = cast(Any, policy.tracker.chooser), []
    further = chooser.poses

    def noted(
        environments: np.ndarray, corners: np.ndarray, place: np.ndarray, look: np.ndarray
    ) -> np.ndarray:
        poses = further(environments, corners, place, look)
        worth = chooser.truth.read(environments, corners)
        views = torch.from_numpy(look * worth[0, 0].numel() + place)
        ahead = chooser.further.ahead(environments, poses)
        told.append((worth.flatten(1).gather(1, views).numpy(), ahead))
        return poses

    chooser.poses = noted
    found = sum(float(now.reward.sum()) for now in moments(envs, policy, reset(envs, 0, EVERYONE), 200))
    worth, ahead = (np.concatenate(each) for each in zip(*told, strict=True))
    assert worth.shape == ahead.shape == (len(worth), FIRST)
    # Only reachable views have a value, and a view that shows something has a higher value than one that does
    # not.
    assert (ahead[worth > 0] > 0).all()
    assert (ahead <= 1).all()
    assert np.corrcoef(worth[worth > 0], ahead[worth > 0])[0, 1] > 0.3
    assert found > 0


def test_choices_with_all_of_the_truth_are_best(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    Bounds(houses=1, choices=40, out=tmp_path / "out").run()
    rows = [line.split(" | ") for line in capsys.readouterr().out.splitlines() if line.startswith("| ")][1:]
    share = {row[0].removeprefix("| "): float(row[1]) for row in rows if row[1][0].isdigit()}
    assert max(share, key=lambda name: share[name]) == "what views show in truth, known paths"
    assert share["untrained, who foresees nothing"] < share["untrained"]
    with pytest.raises(RequestError, match="1 or more"):
        Bounds(choices=0, out=tmp_path / "other").run()
