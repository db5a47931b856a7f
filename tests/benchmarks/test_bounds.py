"""What limits the network that searches: choices with parts of the truth, and rules that were mended."""

from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
import torch

from agent.algorithms.search.windows import LEVELS, ViewMaps, empty
from agent.evaluation.episodes import reset
from agent.learning.environments import make_envs, shield
from agent.planner.frame import AXES
from agent.policies.episodes import moments
from agent.policies.policies import Explorer
from benchmarks.planner.backed_up import FIRST, backed_up
from benchmarks.planner.bounds import Bounds
from benchmarks.planner.mended import NODE, cost, hides, mended, stands, without_beside
from benchmarks.planner.true_views import true_views
from logic import generate
from logic.errors import RequestError

HOUSES = list(generate(4, seed=31, count=4))
EVERYONE = np.arange(len(HOUSES))


def played(maker: Any, steps: int) -> Any:
    """A policy that has played, and the targets that it found."""
    envs = make_envs(HOUSES, len(HOUSES), "secondary")
    policy = maker(envs)
    found = sum(float(now.reward.sum()) for now in moments(envs, policy, reset(envs, 0, EVERYONE), steps))
    return envs, policy, found


def test_a_path_costs_its_steps() -> None:
    envs = make_envs(HOUSES[:1], 1, "secondary")
    planner = Explorer(shield(envs), envs.config).tracker.planner
    assert round(planner.cell / envs.config.step) == NODE
    straight = cost(torch.tensor([[[10]]]), torch.full((1, 8, 1, 1), 3.0))
    assert float(straight[0, 0, 0, 0]) == 3 + 4 + 10 * NODE


def test_targets_that_were_not_seen_lie_where_the_map_says_that_they_may() -> None:
    """By another way: the exact posterior, which strikes out each place that a ray would have met."""
    envs, policy, _ = played(true_views, 200)
    chooser, houses = cast(Any, policy.tracker.chooser), envs.unwrapped.world.describe()[2]
    reader, truth = chooser.reader, chooser.truth
    maps, corners = reader.read(EVERYONE), reader.corners(EVERYONE)
    rows, left = truth.views.arrays["rows"].numpy(), truth.views.arrays["left"].numpy()
    spots = truth.views.arrays["spots"].numpy().reshape(-1, 2)
    may, unseen = hides(maps).numpy(), (maps.blocks // LEVELS**2 < 3).numpy()
    kept, struck, loosely = [], [], []
    for e in EVERYONE:
        row, words = rows[houses[e]], left.reshape(len(HOUSES), -1)[e]
        places = spots[row[0] : row[0] + row[1]]
        still = np.unpackbits(words.view(np.uint8), bitorder="little")[: len(places)].astype(bool)
        away = (places - truth.start[e]) @ AXES[truth.quarter[e]].T / truth.steps  # nodes east and south
        blocks = (np.floor(away[:, ::-1] - corners[e] + 2) // 2).astype(int)
        at = e, *blocks.T
        kept += list(may[at][still])
        struck += list(may[at][~still])
        loosely += list(unseen[at][~still])
    assert min(len(kept), len(struck)) > 500
    assert np.mean(kept) > 0.8
    assert np.mean(struck) < 0.5 * np.mean(loosely)


def test_a_body_stands_on_seen_ground_and_on_floor_that_is_foreseen() -> None:
    maps = empty(1)
    maps.blocks[0, :2, :2] = 4 * LEVELS
    maps.foreseen[0, 0, 2:4, :2] = 51
    found = stands(maps)[0]
    assert [round(float(found[at]), 6) for at in ((0, 0), (1, 0), (1, 1))] == [1, 0.2, 0]


def test_no_target_is_looked_for_beside_what_was_seen_since() -> None:
    maps: ViewMaps = empty(1)
    maps.foreseen.fill_(9)
    maps.blocks[0, 10, 10] = 4 * LEVELS**2
    planes = without_beside(maps).foreseen[0]
    assert (planes[2, 9:12, 9:12] == 0).all()
    assert int((planes[2] == 0).sum()) == 9
    assert (planes[[0, 1, 3]] == 9).all()


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
    # What one can come to, and that alone, is valued; what shows something is worth more than what does not.
    assert (ahead[worth > 0] > 0).all()
    assert (ahead <= 1).all()
    assert np.corrcoef(worth[worth > 0], ahead[worth > 0])[0, 1] > 0.3
    assert found > 0


def test_who_goes_by_the_mended_rules_finds_targets() -> None:
    assert played(mended, 300)[2] > 0


def test_choices_with_all_of_the_truth_are_best(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    Bounds(houses=1, choices=40, out=tmp_path / "out").run()
    rows = [line.split(" | ") for line in capsys.readouterr().out.splitlines() if line.startswith("| ")][1:]
    share = {row[0].removeprefix("| "): float(row[1]) for row in rows if row[1][0].isdigit()}
    assert max(share, key=lambda name: share[name]) == "what views show in truth, known paths"
    assert share["untrained, who foresees nothing"] < share["untrained"]
    with pytest.raises(RequestError, match="1 or more"):
        Bounds(choices=0, out=tmp_path / "other").run()
