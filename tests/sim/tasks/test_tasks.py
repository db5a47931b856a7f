"""Tasks: places of their targets, ends of their episodes, and their next targets, computed by hand."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from tests import sample_houses
from vitruvius.agent.baselines.searcher import Searcher
from vitruvius.logic import House, save
from vitruvius.sim import DEFAULT, HouseVectorEnv, Oracle, Points, Reach
from vitruvius.sim.tasks.tasks import Box

ONE = sample_houses.drawn(sample_houses.ONE_ROOM)
HOUSES = [ONE, *sample_houses.RANDOM]
COUNT = 40


@dataclass(frozen=True)
class Largest:
    """Task with targets in the largest room, or in the first rooms."""

    first: int = 0
    ends_on_pick_up: ClassVar[bool] = False

    def spaces(self, house: House) -> list[Box]:
        if self.first:
            return [room.box for room in house.star.rooms[: self.first]]
        return [max(house.star.rooms, key=lambda room: room.width * room.height).box]


def lie_in(targets: np.ndarray, boxes: list[Box]) -> np.ndarray:
    """Return a mask (n,) bool of the targets (n, 2) that lie completely in one of the boxes."""
    half, found = DEFAULT.target / 2 - 1e-5, np.zeros(len(targets), bool)
    for west, north, east, south in boxes:
        low, high = np.array([west, north]) + half, np.array([east, south]) - half
        found |= ((low <= targets) & (targets <= high)).all(axis=1)
    return found


@pytest.mark.parametrize(
    "targets",
    [
        "main",
        "secondary",
        "mixed",
        {"task": "reach", "room": "hall"},
        Largest(),
        "tests.sim.tasks.test_tasks:Largest",
    ],
    ids=str,
)
def test_targets_lie_in_the_tasks_spaces(targets):
    houses = sample_houses.RANDOM
    envs = HouseVectorEnv(houses, num_envs=len(houses), targets=targets)
    envs.reset(seed=0, options={"house": np.arange(len(houses))})
    for house, coming in zip(houses, envs.targets(30), strict=True):
        rooms = [room.box for room in house.star.rooms]
        spaces = {"main": [house.star.floor.box], "secondary": rooms, "mixed": [house.star.floor.box, *rooms]}
        if isinstance(targets, dict):
            spaces = [room.box for room in house.star.rooms if room.type == "hall"]
        else:
            spaces = spaces[targets] if targets in spaces else Largest().spaces(house)
        assert lie_in(coming, spaces).all()
        if targets == "main" and house.format == "vitruvius-1":
            assert not lie_in(coming, rooms).any()


def test_the_targets_that_peek_shows_come_whatever_the_agent_does():
    envs = HouseVectorEnv(HOUSES, num_envs=COUNT, targets="mixed", max_episode_steps=400)
    envs.reset(seed=5)
    coming, found = envs.targets(20), []
    oracle = Oracle(envs)
    for player in ("oracle", "random"):
        _, info = envs.reset(seed=5)
        at = np.zeros(COUNT, int)
        for step in range(300):
            chance = np.random.default_rng(step).choice(3, p=[0.1, 0.1, 0.8], size=COUNT)
            _, reward, _, _, info = envs.step(oracle.act() if player == "oracle" else chance)
            at += reward.astype(int)
            np.testing.assert_array_equal(info["target"], coming[np.arange(COUNT), at])
        found.append(at.sum())
    assert found[0] > 2 * COUNT > found[1]


@pytest.mark.parametrize("mode", AutoresetMode)
def test_a_room_is_reached_once_and_that_ends_the_episode(mode):
    task, houses = {"task": "reach", "room": "hall"}, sample_houses.RANDOM
    envs = HouseVectorEnv(houses, num_envs=len(houses), targets=task, autoreset_mode=mode)
    envs.reset(seed=1)
    oracle = Oracle(envs)
    at, terminated, info = envs.targets(1)[:, 0], np.zeros(len(houses), bool), {}
    while not terminated.any():
        at = envs.targets(1)[:, 0]
        _, reward, terminated, truncated, info = envs.step(oracle.act())
        np.testing.assert_array_equal(terminated, reward == 1)
        assert not truncated.any()
    last = info["final_info"] if mode is AutoresetMode.SAME_STEP else info
    reached = np.abs(last["pose"][terminated, :2] - at[terminated]).max(axis=1)
    assert (reached < DEFAULT.target / 2 + max(DEFAULT.body)).all()


POINTS = {"points": [[6.75, 0.45], [4.05, 0.9], [5.0, 2.55], [0.5, 0.5]], "start": [5.85, 1.35, np.pi / 4]}
"""Points in the house ``ONE``: three in the main room and one in room a; the start is in the middle of a
cell."""


@pytest.mark.parametrize("backend", ["continuous", "grid"])
def test_targets_at_given_points_are_met_from_the_given_start(backend):
    envs = HouseVectorEnv([ONE], num_envs=64, backend=backend, targets=POINTS, max_episode_steps=300)
    _, info = envs.reset(seed=0)
    np.testing.assert_allclose(info["pose"], np.tile(POINTS["start"], (64, 1)), atol=1e-5)
    coming = envs.targets(200)
    away = np.abs(coming[:, :, None] - np.array(POINTS["points"])).max(axis=3)
    assert away.min(axis=2).max() < 1e-5
    which = away.argmin(axis=2)
    assert (which[:, 1:] != which[:, :-1]).all()
    shares = np.bincount(which.ravel(), minlength=4) / which.size
    np.testing.assert_allclose(shares, 0.25, atol=0.02)
    for policy in (Oracle(envs), Searcher(envs)):
        envs.reset(seed=0)
        picked = np.sum([envs.step(policy.act())[1] for _ in range(299)], axis=0)
        assert (picked >= 3).all()


def test_a_task_as_text_goes_through_the_spec_and_is_filmed(tmp_path):
    save([ONE], tmp_path / "house.jsonl")
    made: Any = gymnasium.make_vec(
        "Vitruvius/House-v0",
        houses=str(tmp_path / "house.jsonl"),
        targets=json.dumps(POINTS),
        render_mode="rgb_array",
    )
    assert made.unwrapped.world.task == Points(POINTS["points"], POINTS["start"])
    made.reset(seed=0)
    frame = made.render()[0]
    made.step(np.array([0]))
    assert (frame != made.render()[0]).any()


def test_a_house_without_such_a_room_is_refused():
    with pytest.raises(
        ValueError,
        match=r"house 0 of 7: it has no room that can hold the targets of Reach\(room='sauna'\)",
    ):
        HouseVectorEnv(HOUSES, targets=Reach("sauna"))


def test_a_task_by_its_name_goes_through_the_spec(tmp_path: Path) -> None:
    given = {"task": "tests.sim.tasks.test_tasks:Largest", "first": 1}
    save([ONE], tmp_path / "house.jsonl")
    houses = str(tmp_path / "house.jsonl")
    made: Any = gymnasium.make_vec("Vitruvius/House-v0", num_envs=3, houses=houses, targets=given)
    assert made.unwrapped.world.task == Largest(1)
    assert json.loads(made.spec.to_json())["kwargs"]["targets"] == given


@pytest.mark.parametrize(
    ("targets", "message"),
    [
        ("attic.json", "there is no task attic.json"),
        ("[1]", "there is no task"),
        ({"points": []}, r"points: give a list of \[x, y\], not \[\]"),
        ({"points": [[1.0, float("nan")]]}, "points: give a list"),
        ({"points": [[1.0, 2.0]], "start": [1.0, 2.0]}, r"start: give \[x, y, heading\]"),
        ({"points": [[1.0, 2.0]], "unit": "ft"}, "unit ft: there are m, px"),
        (
            {"points": [[99.0, 2.0]]},
            r"house 0 of 1: the robot cannot pick up a target at \(99.000, 2.000\) m",
        ),
        ({"points": [[6.0, 1.0]], "start": [-1.0, 1.0, 0.0]}, "the robot cannot stand at"),
        ({"points": [[6.0, 1.0]], "start": [6.0, 1.0, 0.3]}, "heading must be a multiple of pi/4"),
        ("attic", "there is no task attic: there are main, secondary, mixed"),
        ({"task": "fly"}, "there is no task fly: there are collect, habit, object, points, reach"),
        ({"task": "reach"}, "cannot be used: .*room"),
        ({"task": "reach", "room": "hall", "door": 1}, "cannot be used: .*door"),
        ("tests.sim.tasks.test_tasks:Smallest", "cannot be used: .*Smallest"),
        ("tests.nowhere:Task", "cannot be used: No module"),
        (5, "5 is not a task"),
    ],
)
def test_an_object_that_is_no_task_is_refused(targets, message):
    with pytest.raises(ValueError, match=message):
        HouseVectorEnv([ONE], targets=targets)
