"""Offers against the reference: what other viewpoints show for their cost, and that taking one goes there."""

import numpy as np
import pytest
import torch

from agent.planner import Planner as Offering
from agent.planner.offers import OF
from tests.agent.planner import planning
from tests.agent.planner.adapter import Planner
from tests.agent.planner.conftest import E, Walk

MOST = 8


def with_offers(walk: Walk) -> Planner:
    planner = Planner(walk.envs.config, E)
    planner.tested = Offering(walk.envs.config, E, offers=MOST)
    return planner


def test_offers_show_what_they_say_for_their_cost_and_lie_apart(continuous):
    """The first is the planner's own choice, and offers change nothing of what it does."""
    planner, checked, several = with_offers(continuous), 0, 0
    for inputs in continuous.inputs[:120]:
        before = [planner.memory(e) for e in range(E)]
        planner.step(*inputs)
        continuous.planner.step(*inputs)
        assert np.array_equal(planner.array("states"), continuous.planner.array("states"))
        assert np.array_equal(planner.array("gains"), continuous.planner.array("gains"))
        for e in range(E):
            after, number = planner.memory(e), int(planner.tested.offered[e, 0])
            assert (number > 0) <= (after.kind == "search" and after.plan_age == 0)
            if number == 0:
                continue
            begins = after.time == 1 or before[e].since != after.since
            worth = planning.choice(continuous.body, after, before[e].tried & (not begins)).worth
            offers = planner.tested.offers[e, :number].numpy()
            at = [(int(node) % 256, int(node) // 256) for node in offers[:, OF["node"]]]
            assert (at[0], int(offers[0, OF["look"]])) == (after.goal, after.look)
            for offer, there in zip(offers, at, strict=True):
                of = {name: float(offer[k]) for name, k in OF.items()}
                if (there, int(of["look"])) in worth and of["gain"] < 0.9 * planner.tested.offered[e, 2]:
                    told = 100 * of["gain"] / of["cost"]
                    assert told == pytest.approx(worth[there, int(of["look"])], rel=1e-3)
                    checked += 1
                assert -1e-3 <= of["unseen"] <= of["around"] + 1e-3
            apart = [
                max(abs((a - b + 128) % 256 - 128) for a, b in zip(one, other, strict=True))
                for k, one in enumerate(at)
                for other in at[:k]
            ]
            assert min(apart, default=12) >= 12
            several += number > 1
    assert checked > 50
    assert several > 20


def test_what_was_never_seen_is_told_apart(continuous):
    """When an episode begins most of what a view shows was seen or not: both are there on a walk."""
    planner, shares = with_offers(continuous), []
    for inputs in continuous.inputs[:120]:
        planner.step(*inputs)
        first = planner.tested.offers[planner.tested.offered[:, 0] > 0, 0].numpy()
        shares += (first[:, OF["unseen"]] / first[:, OF["gain"]]).tolist()
    assert min(shares) < 0.05
    assert max(shares) > 0.5


def test_an_offer_that_is_taken_becomes_the_goal_and_its_path_is_searched(continuous):
    planner, taken = with_offers(continuous), 0
    for inputs in continuous.inputs[:120]:
        planner.step(*inputs)
        tested, states = planner.tested, planner.array("states").copy()
        picks = torch.where(tested.offered[:, 0] > 1, 1, 0)
        tested.take(picks)
        for e in range(E):
            if picks[e] == 0:
                assert np.array_equal(planner.array("states")[e], states[e])
                continue
            after, offer = planner.memory(e), tested.offers[e, 1]
            assert after.goal == (int(offer[0]) % 256, int(offer[0]) // 256)
            assert after.look == offer[OF["look"]]
            assert after.distance[after.goal[::-1]] == 0
            assert 0 <= after.path < 65535
            taken += 1
    assert taken > 10


def test_planners_that_note_no_offers_take_none(continuous):
    with pytest.raises(ValueError, match="make them with offers"):
        continuous.planner.tested.take(torch.zeros(E, dtype=torch.int64))
