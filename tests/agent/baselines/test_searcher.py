"""The searcher: seen spots are those that environments show, and it never excludes the target's place."""

from dataclasses import replace

import numpy as np
import pytest

from tests import sample_houses
from vitruvius.agent.baselines.coverage import WORD, Coverage
from vitruvius.agent.baselines.posterior import DONE, KNOWN
from vitruvius.agent.baselines.searcher import Searcher
from vitruvius.sim import DEFAULT, HouseVectorEnv, Oracle

HOUSE = sample_houses.random_house(3)
GRID = sample_houses.drawn("aaa\naAa\na+a\n...\n...\nb+b\nbbb", cell=0.9)


def bits(words, count):
    """Return the first ``count`` bits of words."""
    words = words[: -(-count // WORD)].astype("<u8")
    return np.unpackbits(words.view(np.uint8), bitorder="little")[:count].astype(bool)


AROUND = replace(DEFAULT, rays=90, first_ray=180.0, ray_spacing=4.0)


@pytest.mark.parametrize(
    ("backend", "preset"),
    [("continuous", DEFAULT), ("grid", DEFAULT), ("free", DEFAULT), ("free", AROUND)],
    ids=["continuous", "grid", "free", "all around"],
)
def test_a_spot_is_seen_just_where_the_environment_shows_a_target_there(backend, preset):
    house, how = GRID if backend == "grid" else HOUSE, {"backend": backend, "preset": preset}
    one = HouseVectorEnv([house], targets="mixed", **how)
    one.reset(seed=0)
    coverage = Coverage(one)
    targets = coverage.spots[0]
    number = len(targets)
    many = HouseVectorEnv([house], num_envs=number, targets="mixed", **how)
    for seed in range(12):
        _, info = one.reset(seed=seed)
        coverage.begin()
        pose = np.repeat(info["pose"].astype(float), number, axis=0)
        options = {"house": np.zeros(number, int), "pose": pose, "target": targets}
        shown = many.reset(seed=0, options=options)[0][..., 1].any(axis=1)
        away, half, body = np.abs(targets - pose[:, :2]), one.config.target / 2, one.config.body[0] / 2
        under = (away < half + body - 1e-5).all(axis=1)
        if backend == "free":
            under = np.hypot(*np.maximum(0, away - half).T) < body - 1e-5
        seen = bits(coverage.seen[0], number)
        assert (seen == (shown | under)).mean() > 0.998  # except for a ray along a target's edge
        assert 0.02 < seen.mean() < 1
        assert coverage.share()[0] == seen.sum() / number


def test_what_was_seen_stays_seen_until_the_next_reset():
    envs = HouseVectorEnv([HOUSE], num_envs=3, targets="mixed")
    envs.reset(seed=0)
    coverage = Coverage(envs)
    coverage.begin()
    first = before = coverage.share()
    for _ in range(8):
        envs.step(np.zeros(3, int))
        coverage.look()
        assert (coverage.share() >= before).all()
        before = coverage.share()
    assert (before > first).all()
    envs.reset(seed=0)
    coverage.begin()
    assert (coverage.share() == first).all()


def test_what_one_environment_forgets_the_others_keep():
    envs = HouseVectorEnv([HOUSE], num_envs=3, targets="mixed")
    envs.reset(seed=0)
    coverage = Coverage(envs)
    coverage.begin()
    before = coverage.seen.copy()
    assert before.any(axis=1).all()
    coverage.forget(np.array([False, True, False]))
    np.testing.assert_array_equal(coverage.seen, before * np.array([[1], [0], [1]], np.uint64))


def test_a_room_counts_once_the_eye_is_in_it():
    envs = HouseVectorEnv(
        [sample_houses.drawn("aaa\naaa\na+a\n...\n...\nb+b\nbbb")], num_envs=2, targets="mixed"
    )
    poses = np.array([[1.35, 3.1, np.pi / 2], [1.35, 3.1, -np.pi / 2]])
    envs.reset(seed=0, options={"house": np.zeros(2, int), "pose": poses})
    coverage = Coverage(envs)
    coverage.begin()
    entered = []
    for _ in range(40):
        envs.step(np.full(2, 2))
        coverage.look()
        entered.append(coverage.rooms().tolist())
    assert entered[0] == [0, 0]
    assert entered[-1] == [1, 1]
    assert entered == sorted(entered)


def played(envs, seed, steps):
    """Return the searcher's actions (steps, E), its targets (E,), and the number of blocked moves."""
    envs.reset(seed=seed, options={"house": np.arange(envs.num_envs) % len(envs.houses)})
    searcher, actions, targets, blocked = Searcher(envs), [], np.zeros(envs.num_envs), 0
    for _ in range(steps):
        actions.append(searcher.act())
        _, reward, _, _, info = envs.step(actions[-1])
        targets, blocked = targets + reward, blocked + info["blocked"].sum()
    return np.array(actions), targets, blocked


@pytest.mark.parametrize("targets", ["main", "secondary"])
def test_the_target_is_always_where_the_searcher_still_looks(targets):
    envs = HouseVectorEnv([HOUSE], targets=targets)
    envs.reset(seed=1)
    searcher, spots = Searcher(envs), envs.world.places[0].targets
    origin, found = envs.world.lattices[0].origin, 0
    for _ in range(400):
        action = searcher.act()
        place = np.rint((envs.world.state["reals"][0, 2:] - origin) / envs.config.step).astype(int)
        left = bits(searcher.arrays["left"].numpy(), len(spots))
        assert searcher.arrays["notes"].numpy()[0, KNOWN] == 1 or left[(spots == place).all(axis=1)].all()
        found += envs.step(action)[1].sum()
    assert found > 2


def test_the_searcher_is_never_blocked_and_stands_below_the_oracle():
    houses = [sample_houses.random_house(seed) for seed in range(6)]
    envs = HouseVectorEnv(houses, num_envs=6, targets="secondary")
    _, targets, blocked = played(envs, 0, 1500)
    envs.reset(seed=0, options={"house": np.arange(6)})
    best = Oracle(envs).play()
    assert blocked == 0
    assert (targets <= best).all()
    assert targets.sum() > 0.6 * best.sum()


def test_a_target_in_sight_is_picked_up_by_a_shortest_way():
    envs = HouseVectorEnv([HOUSE], num_envs=16)
    sees = envs.reset(seed=0)[0][..., 1].any(axis=1)
    ways = [0 if way is None else len(way) for way in Oracle(envs).paths()]
    searcher, taken = Searcher(envs), np.zeros(16, int)
    for step in range(1, 1 + max(ways)):
        reward = envs.step(searcher.act())[1]
        taken[(taken == 0) & (reward > 0)] = step
    assert sees.any()
    assert taken[sees].tolist() == np.array(ways)[sees].tolist()


def test_a_searcher_does_the_same_alone_as_among_others():
    houses = [sample_houses.random_house(seed) for seed in range(4)]
    many = HouseVectorEnv(houses, num_envs=40, targets="mixed")
    alone = HouseVectorEnv(houses[:1], targets="mixed")
    assert (played(many, 7, 300)[0][:, 0] == played(alone, 7, 300)[0][:, 0]).all()


def test_the_searcher_works_on_a_grid():
    envs = HouseVectorEnv([GRID], num_envs=2, targets="secondary", backend="grid")
    _, targets, blocked = played(envs, 0, 300)
    assert targets.min() > 2
    assert blocked == 0


def test_places_of_the_target_between_those_that_viewpoints_are_judged_by_are_looked_at_too():
    envs = HouseVectorEnv([HOUSE], targets="secondary")
    envs.reset(seed=5)
    searcher, spots = Searcher(envs), len(envs.world.places[0].targets)
    envs.step(searcher.act())
    left = searcher.arrays["left"].numpy()
    unseen = np.flatnonzero(bits(left, spots))
    last = np.setdiff1d(unseen, searcher.arrays["samples"].numpy())[-1]
    alone = np.zeros_like(left)
    alone[last // WORD] = 1 << int(last % WORD)
    searcher.arrays["left"].fill(alone)
    searcher.arrays["notes"].view()[0, DONE:] = 0  # so that it plans again
    made = []
    for _ in range(9):
        made.append(searcher.act()[0])
        envs.step(np.array(made[-1:]))
    assert 2 in made  # it goes there
