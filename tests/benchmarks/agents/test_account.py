"""The account of where steps go: whole, as the world has it, and right in a house drawn by hand."""

import numpy as np
import pytest
import torch

from agent.evaluation.baselines import BASELINES
from agent.evaluation.episodes import play, reset
from agent.learning.environments import make_envs, shield
from agent.policies.policies import RandomPolicy
from benchmarks.agents.account import AGAIN, CORNERS, CROSSING, DOOR, OUT, SURVEY, RoomSearch, follow, room_of
from tests.sample_houses import drawn, random_house

HOUSES = [random_house(seed) for seed in range(3)]


def walk(envs):
    generator = torch.Generator().manual_seed(0)
    return RandomPolicy(shield(envs), generator)


@pytest.mark.parametrize("targets", ["main", "secondary", "mixed"])
def test_each_step_and_each_target_is_of_one_phase(targets):
    envs = make_envs(HOUSES, len(HOUSES), targets)
    account = follow(envs, walk(envs), seed=3)
    assert (account.steps.sum(axis=1) == envs.config.steps).all()
    score = play(envs, walk(envs), 3)
    assert np.array_equal(account.sighted.sum(axis=1), score.targets)
    assert account.blocked.sum() == score.blocked
    assert (account.turning + account.blocked <= account.steps).all()


def test_where_targets_lie_anywhere_nothing_is_crossed():
    envs = make_envs(HOUSES, len(HOUSES), "mixed")
    assert follow(envs, walk(envs), seed=3).steps[:, CROSSING].sum() == 0


def test_the_searcher_spends_less_on_rooms_that_hold_nothing_than_a_walk_does():
    envs = make_envs(HOUSES, len(HOUSES), "secondary")
    searcher = follow(envs, BASELINES["searcher"](envs, 3), seed=3)
    left = [
        account.steps[:, [CORNERS, OUT]].sum() / account.steps.sum()
        for account in (searcher, follow(envs, walk(envs), seed=3))
    ]
    assert left[0] < left[1]


def test_a_room_is_new_then_left_and_after_a_pick_up_searched_again():
    """A room without furniture is seen whole by a turn in its middle."""
    envs = make_envs([drawn("aaaa....\naaa+....\naaaa....")], 1, "secondary")
    reset(envs, 0)
    pose = {"house": np.zeros(1, int), "target": np.array([[0.4, 0.4]])}

    def be(x: float, y: float) -> None:
        envs.reset(seed=0, options=pose | {"pose": np.array([[x, y, 0.0]])})

    be(1.2, 1.35)
    search, phases = RoomSearch(envs), []
    for _ in range(8):
        phases.append(search.phase()[0])
        envs.step(np.zeros(1, int))
        search.look(np.zeros(1, bool))
    assert phases[0] == SURVEY
    assert search.phase()[0] == OUT
    search.look(np.ones(1, bool))
    assert search.phase()[0] == AGAIN
    be(3.6, 1.35)
    assert search.phase()[0] == DOOR
    be(5.4, 1.35)
    assert search.phase()[0] == CROSSING


def test_a_place_is_in_the_room_that_holds_it_or_in_the_main_room():
    rooms = np.array([[1.0, 1.0, 1.0, 1.0], [4.0, 1.0, 1.0, 1.0], [np.nan] * 4])
    places = np.array([[1.5, 0.5], [4.0, 1.0], [2.5, 1.0]])
    assert room_of(places, rooms).tolist() == [1, 2, 0]
