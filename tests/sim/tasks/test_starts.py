"""Starts of episodes: in chosen rooms, and by options also for episodes that begin automatically."""

import pickle
from typing import Any

import numpy as np
import pytest

from tests import sample_houses
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.tasks.words import in_words

DRAWN = sample_houses.drawn("Aa+aa.bBb\n......+bb\n......bbb", cell=1.2)
HOUSES = [DRAWN, DRAWN]
TYPES = {room.name: room.type for room in DRAWN.rooms}
COUNT = 24


def rooms_of(poses: np.ndarray) -> set[str]:
    """Return the types of the rooms that contain poses (n, 3)."""
    found = set()
    for x, y, _ in poses:
        for room in DRAWN.rooms:
            west, north, east, south = room.box
            if west <= x <= east and north <= y <= south:
                found.add(room.type)
                break
    return found


@pytest.mark.parametrize("task", ["main", "object", "habit"])
def test_episodes_start_in_rooms_of_the_types_that_a_task_names(task):
    kind = DRAWN.rooms[0].type
    piece = DRAWN.rooms[0].pieces[0].type
    asked = {"task": task, "starts": [kind]} | ({"piece": piece} if task == "object" else {})
    envs = HouseVectorEnv(HOUSES, COUNT, targets=asked)
    assert rooms_of(envs.reset(seed=0)[1]["pose"]) == {kind}
    if task == "main":
        envs.set_houses(HOUSES, {"task": "main", "starts": "all"})
        assert rooms_of(envs.reset(seed=0)[1]["pose"]) == set(TYPES.values())


def test_starts_are_said_in_words_and_wrong_ones_refused():
    kind = DRAWN.rooms[0].type
    assert in_words({"task": "main", "starts": ["wc"]}) == "targets in the main room, from rooms of type wc"
    assert in_words({"task": "reach", "room": "wc", "starts": "all"}) == "reach a wc, from all rooms"
    for wrong, message in (
        (["hut"], f"house 0 of 2: starts: there is no room type hut: there are .*{kind}"),
        (kind, "starts: give a list of room types, or all"),
        ([3], "starts: give a list of room types, or all"),
    ):
        with pytest.raises(ValueError, match=message):
            HouseVectorEnv(HOUSES, targets={"task": "all", "starts": wrong})


POSES = np.tile([1.0 * 1.2 + 1.8, 0.6, np.pi / 2], (COUNT, 1))
"""Poses in the first room."""


def guided(mode: str) -> tuple[HouseVectorEnv, list[Any]]:
    """Return environments whose next episodes have options, and the infos of the steps before and after."""
    envs = HouseVectorEnv(HOUSES, COUNT, targets="main", max_episode_steps=9, autoreset_mode=mode)
    envs.reset(seed=1)
    envs.set_next({"house": np.arange(COUNT) % 2, "pose": POSES})
    return envs, [envs.step(np.zeros(COUNT, int))[-1] for _ in range(10 if mode == "NextStep" else 9)]


@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
def test_an_episode_that_begins_by_itself_begins_by_its_options(mode):
    envs, infos = guided(mode)
    info = infos[-1]
    np.testing.assert_array_equal(info["house"], np.arange(COUNT) % 2)
    np.testing.assert_allclose(info["pose"], POSES, atol=1e-5)
    copy = pickle.loads(pickle.dumps(envs))
    envs.set_next(None)
    told, info = ([each.step(np.zeros(COUNT, int))[-1] for _ in range(10)][-1] for each in (copy, envs))
    assert np.abs(info["pose"][:, :2] - POSES[:, :2]).max() > 0.5
    assert np.abs(told["pose"][:, :2] - POSES[:, :2]).max() < 1e-5


def test_options_for_next_episodes_leave_random_numbers_as_they_are():
    envs, infos = guided("NextStep")
    plain = HouseVectorEnv(HOUSES, COUNT, targets="main", max_episode_steps=9)
    plain.reset(seed=1)
    told = [plain.step(np.zeros(COUNT, int))[-1] for _ in range(10)]
    for one, other in zip(infos[:-1], told[:-1], strict=True):
        np.testing.assert_array_equal(one["pose"], other["pose"])
    same = infos[-1]["house"] == told[-1]["house"]
    np.testing.assert_array_equal(infos[-1]["target"][same], told[-1]["target"][same])
    assert envs.state["next_wholes"].shape == (COUNT, 4)


def test_wrong_options_for_next_episodes_are_refused():
    envs = HouseVectorEnv(HOUSES, 2, targets="main")
    envs.reset(seed=0)
    cases = list[tuple[Any, str]]((
        ({"house": [0, 2]}, "option house: there are houses 0 to 1"),
        ({"pose": [[0, 0, 0]] * 2}, "option pose: name the houses of"),
        ({"reset_mask": [True, False]}, "options for next episodes: only reset"),
        ({"hose": [0, 0]}, "did you mean house"),
        (3, "options must be a dict"),
    ))  # fmt: skip
    for wrong, message in cases:
        with pytest.raises(ValueError, match=message):
            envs.set_next(wrong)
    disabled = HouseVectorEnv(HOUSES, 2, targets="main", autoreset_mode="Disabled")
    with pytest.raises(ValueError, match="resets, and houses that do not rotate"):
        disabled.set_next({"house": [0, 0]})


@pytest.mark.parametrize(
    ("name", "place", "value"),
    [
        *(("next_wholes", 0, 7), ("next_wholes", 0, -1), ("next_wholes", 1, 10**6), ("next_wholes", 3, 99)),
        ("next_reals", 0, 900.0),
        ("next_reals", 2, 1.0),  # a target with one coordinate
    ],
)
def test_a_state_with_options_of_other_houses_is_refused(name, place, value):
    envs = HouseVectorEnv(HOUSES, 1, targets="main")
    envs.reset(seed=0)
    envs.set_next({"house": [0], "pose": POSES[:1]})
    state = envs.state
    state[name][0, place] = value
    with pytest.raises(ValueError, match="the state "):
        envs.state = state
