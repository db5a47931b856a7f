# pyright: reportInvalidTypeForm=false
"""Episodes, targets and random numbers: their dependences and independences."""

import numpy as np
import pytest

from tests import sample_houses
from tests.reference import Reference
from vitruvius.logic import House, Rect, Star
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.runtime import start, ti
from vitruvius.sim.world.philox import Words, philox

HOUSES = [sample_houses.drawn("aa+aa.bbb\n......+bb\n......bbb", cell=1.2), *sample_houses.RANDOM]
STEPS = 120


def actions(count: int, steps: int = STEPS) -> np.ndarray:
    return np.random.default_rng(3).choice(3, p=[0.15, 0.15, 0.7], size=(steps, count))


def rollout(envs: HouseVectorEnv, plan: np.ndarray, seed: int) -> list[np.ndarray]:
    """Return all outputs of an environment in a plan's steps (T, E): observations, rewards, ends, infos."""
    observation, info = envs.reset(seed=seed)
    parts = [[observation[None]], [], [], [], [info["pose"][None]], [info["target"][None]]]
    for action in plan:
        *step, info = envs.step(action)
        for part, value in zip(parts, [*step, info["pose"], info["target"]], strict=True):
            part.append(value[None])
    return [np.concatenate(part) for part in parts]


@pytest.fixture(scope="module")
def batch():
    return HouseVectorEnv(HOUSES, num_envs=6, targets="mixed", max_episode_steps=50)


@pytest.fixture(scope="module")
def alone():
    return HouseVectorEnv(HOUSES, num_envs=1, targets="mixed", max_episode_steps=50)


def test_n_environments_together_equal_n_single_ones(batch, alone):
    """Through several episodes, environment i of seed s equals a single one of seed s + i, bit for bit."""
    plan = actions(6)
    together = rollout(batch, plan, seed=11)
    for i in range(6):
        for ours, theirs in zip(together, rollout(alone, plan[:, i : i + 1], seed=11 + i), strict=True):
            np.testing.assert_array_equal(ours[:, i], theirs[:, 0])


def test_the_same_seed_is_the_same_trajectory_and_another_is_not(batch):
    plan = actions(6)
    first, again, other = (rollout(batch, plan, seed) for seed in (0, 0, 1))
    for a, b in zip(first, again, strict=True):
        np.testing.assert_array_equal(a, b)
    assert (first[0] != other[0]).any(axis=(0, 2, 3)).all()


def test_the_first_random_houses_and_starts_of_seed_0_are_known(batch):
    """A golden: it changes only if the random numbers or the places change, and then results change."""
    _, info = batch.reset(seed=0)
    assert info["house"].tolist() == [2, 6, 2, 5, 0, 5]
    np.testing.assert_allclose(info["pose"][0], (2.8595154, 3.1548777, 5.4977875), atol=1e-5)
    np.testing.assert_allclose(info["target"][0], (3.002951, 4.589231), atol=1e-5)


def test_random_words_equal_those_published_for_philox():
    """Known answers of Philox4x32-10, from the Random123 library's tests."""
    start()
    known = {
        (0, (0, 0, 0, 0)): "6627e8d5 e169c58d bc57ac4c 9b00dbd8",
        (0xFFFFFFFFFFFFFFFF, (0xFFFFFFFF,) * 4): "408f276d 41c83b0e a20bc7c6 6d5451fd",
        (
            0x299F31D0A4093822,
            (0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344),
        ): "d16cfe09 94fdcceb 5001e420 24126ea1",
    }
    out = ti.ndarray(ti.u64, shape=4)

    @ti.kernel
    def draw(out: ti.types.ndarray(), key: ti.u64, a: ti.u64, b: ti.u64, c: ti.u64, d: ti.u64):
        words = philox(key, Words(a, b, c, d))
        for i in ti.static(range(4)):
            out[i] = words[i]

    for (key, counter), words in known.items():
        draw(out, key, *counter)
        assert [f"{word:08x}" for word in out.to_numpy()] == words.split()


def picked_targets(envs: HouseVectorEnv, chosen: np.ndarray) -> list[list[tuple[float, ...]]]:
    """Return the targets of each environment's first episode, in the order in which an agent met them."""
    count = envs.num_envs
    _, info = envs.reset(seed=5, options={"house": np.zeros(count, int)})
    met = [[tuple(target)] for target in info["target"].tolist()]
    for action in chosen:
        _, reward, _, _, info = envs.step(action)
        for e in np.flatnonzero(reward):
            met[e].append(tuple(info["target"][e].tolist()))
    return met


def test_the_kth_target_does_not_depend_on_the_agent():
    envs = HouseVectorEnv(HOUSES[:1], num_envs=64, targets="main")
    one = picked_targets(envs, actions(64, 1400))
    other = picked_targets(envs, actions(64, 1400)[::-1])
    shared = [min(len(a), len(b)) for a, b in zip(one, other, strict=True)]
    assert sum(shared) > 64 + 20
    for a, b, count in zip(one, other, shared, strict=True):
        assert a[:count] == b[:count]
        apart = np.abs(np.diff(a, axis=0)).max(axis=1, initial=0) if len(a) > 1 else np.array([9])
        assert (apart >= envs.config.target + envs.config.body[0]).all()


@pytest.mark.parametrize("targets", ["main", "secondary", "mixed"])
def test_targets_lie_wholly_where_they_should(targets):
    """Check every possible place, not a sample: free floor of the right rooms."""
    envs = HouseVectorEnv(HOUSES, targets=targets)
    world, side, checked = envs.world, envs.config.target, 0
    for house, lattice, here in zip(HOUSES, world.lattices, world.places, strict=True):
        reference = Reference(house)
        rooms = np.array([room.box for room in house.star.rooms])
        for place in lattice.origin + lattice.pitch * here.targets[::37]:
            low, high = place - side / 2, place + side / 2
            touched = ((rooms[:, :2] + 1e-5 < high) & (low < rooms[:, 2:] - 1e-5)).all(axis=1)
            inside = ((rooms[:, :2] - 1e-5 < low) & (high < rooms[:, 2:] + 1e-5)).all(axis=1)
            in_main = not touched.any()
            assert in_main or inside.any()
            assert targets == "mixed" or in_main == (targets == "main")
            assert reference.in_the_way(place, place, side) is not True
            checked += 1
    assert checked > 100


def test_set_houses_with_other_targets_equals_a_new_environment():
    moved = HouseVectorEnv(HOUSES, num_envs=8, targets="main")
    moved.reset(seed=1)
    moved.set_houses(HOUSES[1:], "secondary")
    made = HouseVectorEnv(HOUSES[1:], num_envs=8, targets="secondary")
    for envs in (moved, made):
        _, info = envs.reset(seed=4)
        assert np.array_equal(envs.targets(1)[:, 0], info["target"])
    assert np.array_equal(moved.targets(20), made.targets(20))
    moved.set_houses(HOUSES)  # and the targets stay there
    made.set_houses(HOUSES)
    for envs in (moved, made):
        envs.reset(seed=5)
    assert np.array_equal(moved.targets(20), made.targets(20))


def test_set_houses_refuses_a_task_whose_episodes_end_or_earn_otherwise():
    envs = HouseVectorEnv(HOUSES, targets="main")
    envs.reset(seed=1)
    before = envs.targets(5)
    with pytest.raises(ValueError, match="episodes of that task end differently: make"):
        envs.set_houses(HOUSES, {"task": "reach", "room": "kitchen"})
    with pytest.raises(ValueError, match="other terms: make a new environment"):
        envs.set_houses(HOUSES, {"task": "main", "terms": {"step": -1.0}})
    with pytest.raises(ValueError, match="house 0 of 1"):
        envs.set_houses([House.of_star(Star(Rect(0, 0, 4, 4)))], "secondary")
    envs.reset(seed=1)
    assert np.array_equal(envs.targets(5), before)


def test_episodes_start_free_and_not_on_the_target(batch):
    references = [Reference(house) for house in HOUSES]
    for seed in range(0, 120, 6):
        _, info = batch.reset(seed=seed)
        apart = np.abs(info["pose"][:, :2] - info["target"]).max(axis=1)
        assert (apart >= (batch.config.target + batch.config.body[0]) / 2 - 1e-5).all()
        for house, place in zip(info["house"], info["pose"][:, :2], strict=True):
            assert references[house].in_the_way(place, place, batch.config.body[0]) is not True


def test_the_step_after_an_end_only_begins_the_next_episode(alone):
    alone.reset(seed=0)
    for _ in range(49):
        assert not alone.step([2])[3]
    last, _, terminated, truncated, _ = alone.step([2])
    assert truncated
    assert not terminated
    first, reward, terminated, truncated, info = alone.step([2])
    assert (reward, terminated, truncated) == (0, False, False)
    again, later = alone.reset(seed=0)[0], alone.reset()
    np.testing.assert_array_equal(first, later[0])  # the same episode, however it is reached
    np.testing.assert_array_equal(info["pose"], later[1]["pose"])
    assert (first != last).any()
    assert (first != again).any()


def test_a_pick_up_earns_one_and_a_new_target():
    house = sample_houses.drawn("a+a\n...\n...", cell=1.2)
    envs = HouseVectorEnv([house])
    options = {"house": [0], "pose": [[1.8, 3.2, np.pi / 2]], "target": [[1.8, 2.7]]}
    envs.reset(seed=0, options=options)
    rewards, target = [], np.zeros(2)
    for _ in range(4):
        _, reward, _, _, info = envs.step([2])
        rewards.append(float(reward[0]))
        if reward[0]:
            target = info["target"][0]
    assert rewards == [0, 1, 0, 0]
    assert np.abs(target - (1.8, 2.7)).max() > 0.5


def test_a_collision_ends_a_paper_episode_and_only_blocks_a_default_one():
    house = sample_houses.drawn("a+a\n...\n...", cell=1.2)
    for preset, ends in (("default", False), ("paper", True)):
        envs = HouseVectorEnv([house], preset=preset)
        envs.reset(seed=0, options={"house": [0], "pose": [[0.4, 1.5, np.pi / 2]]})
        done = [envs.step([2])[2][0] for _ in range(4)]
        assert any(done) == ends
