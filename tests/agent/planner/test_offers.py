"""Offers against the reference: what other viewpoints show for their cost, and that taking one goes there."""

import numpy as np
import pytest
import torch

from agent.learning.environments import shield
from agent.planner import Planner as Offering
from agent.planner.viewpoints.offers import OF
from agent.policies.policies import Explorer
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
    most = planner.tested.config.gain_most
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
                if (there, int(of["look"])) in worth and of["gain"] < 0.9 * most:
                    told = 100 * of["gain"] / of["cost"]
                    assert told == pytest.approx(worth[there, int(of["look"])], rel=1e-3)
                    checked += 1
            apart = [
                max(abs((a - b + 128) % 256 - 128) for a, b in zip(one, other, strict=True))
                for k, one in enumerate(at)
                for other in at[:k]
            ]
            assert min(apart, default=12) >= 12
            several += number > 1
    assert checked > 50
    assert several > 20


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


class Takes:
    """A chooser that takes the same offer always."""

    offers = MOST

    def __init__(self, pick: int) -> None:
        self.pick = pick

    def __call__(self, planner: Offering) -> None:
        planner.take(torch.full((E,), self.pick))


def test_an_explorer_goes_where_its_chooser_says_and_as_it_would_where_that_takes_the_first(continuous):
    def walked(chooser: Takes | None) -> torch.Tensor:
        explorer = Explorer(shield(continuous.envs), continuous.envs.config, chooser=chooser)
        explorer.begin(E)
        looks = (inputs[:2] for inputs in continuous.inputs[:60])
        return torch.stack([explorer(*map(torch.from_numpy, look)) for look in looks])

    assert torch.equal(walked(Takes(0)), walked(None))
    assert not torch.equal(walked(Takes(1)), walked(None))
