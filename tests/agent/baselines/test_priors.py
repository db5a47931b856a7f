"""Priors of a searcher: the task's places and shares, all floor, or the posterior from finds."""

from itertools import permutations

import numpy as np
import pytest

from tests import sample_houses
from vitruvius.agent.baselines.coverage import WORD, origins_of
from vitruvius.agent.baselines.posterior import KNOWN
from vitruvius.agent.baselines.searcher import Searcher
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.world.arrays import FOUND

HOUSES = [sample_houses.random_house(seed) for seed in range(6)]
HALL = {"points": [[1.0, 1.0]]}


def believed(searcher: Searcher, e: int) -> np.ndarray:
    """Return an environment's weights by region."""
    return searcher.arrays["weights"].view().reshape(searcher.world.num_envs, -1)[e]


def test_the_priors_of_a_weighted_task_have_its_shares():
    envs = HouseVectorEnv(HOUSES, num_envs=6, targets="habit")
    envs.reset(seed=0, options={"house": np.arange(6)})
    for prior in ("task", "finds"):
        searcher = Searcher(envs, prior)
        searcher.act()
        for e, here in enumerate(envs.world.places):
            shares = [region.share for region in here.regions]
            if prior == "finds":  # the shares of the regions are not known yet
                shares = [np.mean(shares)] * len(shares)
            found = believed(searcher, e)
            assert found[: len(shares)] == pytest.approx(shares, abs=0.03 if prior == "finds" else 1e-6)
            assert not found[len(shares) :].any()


def test_samples_of_a_region_fill_one_word_and_lie_in_it():
    envs = HouseVectorEnv(HOUSES, targets="habit")
    searcher = Searcher(envs)
    for here, samples in zip(envs.world.places, searcher.prior.samples, strict=True):
        assert len(samples) == WORD * len(here.regions)
        for k, region in enumerate(here.regions):
            assert np.isin(samples[WORD * k : WORD * (k + 1)], region.targets).all()


def test_finds_tell_which_region_has_which_share_as_bayes_has_it():
    envs = HouseVectorEnv(HOUSES, targets="habit")
    envs.reset(seed=0, options={"house": np.zeros(1, int)})
    searcher, here = Searcher(envs, "finds"), envs.world.places[0]
    searcher.act()
    before, rng = believed(searcher, 0).copy(), np.random.default_rng(0)
    shares = np.array([region.share for region in here.regions])
    assigned = shares[np.array([*permutations(range(len(shares)))])]
    likely, expected = np.ones(len(assigned)), shares
    for found in range(2, 9):
        place = searcher.world.state["reals"][0, 2:]
        spots = here.targets * envs.config.step + origins_of(envs.world).reshape(-1, 2)[0]
        row = np.abs(spots - place).max(axis=1).argmin()
        likely *= assigned @ [(row in region.targets) / len(region.targets) for region in here.regions]
        state = envs.world.state
        state["reals"][0, 2:], state["wholes"][0, FOUND] = spots[rng.integers(len(spots))], found
        envs.world.state = state
        searcher.act()
        expected = likely @ assigned / likely.sum()
        assert believed(searcher, 0)[: len(shares)] == pytest.approx(expected, abs=0.02)
    assert max(expected) > 0.05 + max(before)
    envs.reset(seed=1, options={"house": np.zeros(1, int)})
    searcher.begin()
    searcher.act()
    np.testing.assert_array_equal(believed(searcher, 0), before)


def test_who_does_not_know_the_task_looks_on_all_floor():
    envs = HouseVectorEnv(HOUSES, num_envs=6, targets="secondary")
    everywhere = HouseVectorEnv(HOUSES, num_envs=6, targets="all")
    envs.reset(seed=0, options={"house": np.arange(6)})
    searcher = Searcher(envs, "floor")
    for spots, here, task in zip(
        searcher.prior.spots, everywhere.world.places, envs.world.places, strict=True
    ):
        np.testing.assert_array_equal(spots, here.targets)
        assert len(spots) > len(task.targets)
    found = np.zeros(6)
    for _ in range(600):
        found += envs.step(searcher.act())[1]
    assert (found > 1).all()


@pytest.mark.parametrize("prior", ["task", "floor", "finds"])
def test_no_prior_rules_out_where_the_target_is(prior):
    envs = HouseVectorEnv(HOUSES[3:4], targets="habit")
    envs.reset(seed=2)
    searcher, origin, found = Searcher(envs, prior), envs.world.lattices[0].origin, 0
    spots = searcher.prior.spots[0]
    for _ in range(300):
        action = searcher.act()
        place = np.rint((envs.world.state["reals"][0, 2:] - origin) / envs.config.step).astype(int)
        words = searcher.arrays["left"].numpy().view(np.uint8)
        left = np.unpackbits(words, bitorder="little")[: len(spots)].astype(bool)
        assert searcher.arrays["notes"].numpy()[0, KNOWN] == 1 or left[(spots == place).all(axis=1)].all()
        found += envs.step(action)[1].sum()
    assert found > 1


@pytest.mark.parametrize(
    ("targets", "prior", "message"),
    [("main", "finds", "has no regions; the task"), (HALL, "floor", "places its targets at given points")],
)
def test_a_prior_that_the_task_does_not_allow_is_refused(targets, prior, message):
    house = sample_houses.drawn("aaaa\naaaa\naaaa\na+aa\n....\n....")
    with pytest.raises(ValueError, match=f"prior {prior}: .*{message}"):
        Searcher(HouseVectorEnv([house], targets=targets), prior)
