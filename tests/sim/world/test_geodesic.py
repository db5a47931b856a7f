"""The distance to the target equals the oracle's number of steps, at every pose."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests import sample_houses
from vitruvius.sim import DEFAULT, PAPER, HouseVectorEnv, Oracle
from vitruvius.sim.config import DOORS
from vitruvius.sim.world import geodesic

HOUSES = sample_houses.RANDOM[:3]
ONE = sample_houses.drawn(sample_houses.ONE_ROOM)
TWO = sample_houses.drawn("aaaaa..\naaAaa..\naaaa+..\nbbbb+..\nbbbbb..\nbBbbb..")
COUNT = 24


def asking(preset: Any = DEFAULT, **arguments: Any) -> HouseVectorEnv:
    arguments = {"targets": "all"} | arguments
    return HouseVectorEnv(HOUSES, COUNT, preset=replace(preset, geodesic=True), **arguments)


def true_distances(envs: HouseVectorEnv) -> np.ndarray:
    return np.array([-1 if path is None else len(path) for path in Oracle(envs).paths()])


def strides(envs: HouseVectorEnv, steps: int, seed: int = 0) -> Any:
    """Yield the outputs of random steps."""
    random = np.random.default_rng(seed)
    for _ in range(steps):
        yield envs.step(random.choice(3, COUNT, p=[0.15, 0.15, 0.7]))


@pytest.mark.parametrize(
    "arguments",
    [
        {},
        {"houses": [TWO], "backend": "grid", "targets": "secondary"},
        {"preset": PAPER, "targets": "main", "autoreset_mode": "SameStep"},
        {"by_ray": True, "autoreset_mode": "SameStep", "max_episode_steps": 40},
        {"houses": [ONE], "targets": {"points": [[1.0, 1.0], [2.03, 1.51], [3.3, 1.2]]}},
    ],
    ids=["continuous", "grid", "paper", "by ray", "points"],
)
def test_the_distance_is_the_oracles_number_of_steps(arguments):
    arguments = {"houses": HOUSES, "preset": DEFAULT, "targets": "all"} | arguments
    arguments["preset"] = replace(arguments["preset"], geodesic=True)
    envs = HouseVectorEnv(num_envs=COUNT, **arguments)
    _, info = envs.reset(seed=1)
    np.testing.assert_array_equal(info["distance"], true_distances(envs))
    for k, (*_, info) in enumerate(strides(envs, 120)):
        if k % 20 == 0:
            np.testing.assert_array_equal(info["distance"], true_distances(envs))
    assert info["distance"].max() > 9


def test_a_given_target_has_its_distance_whether_it_was_met_before_or_lies_outside():
    envs = asking()
    _, info = envs.reset(seed=1)
    house, pose, target = info["house"], info["pose"], info["target"]
    _, again = envs.reset(options={"house": house, "pose": pose, "target": target})
    np.testing.assert_array_equal(again["distance"], info["distance"])
    _, again = envs.reset(options={"house": house, "target": target})
    np.testing.assert_array_equal(again["distance"], true_distances(envs))
    for k in range(1, 60):  # on the lattice, at growing distances
        corners = [
            envs.world.lattices[number].origin - np.float32(DEFAULT.step) * (1 + 9 * k) for number in house
        ]
        _, outside = envs.reset(options={"house": house, "target": np.array(corners, np.float32)})
        assert (outside["distance"] == -1).all()


def test_following_the_oracle_brings_the_target_one_step_nearer_each_time():
    envs = asking()
    _, info = envs.reset(seed=2)
    oracle, found = Oracle(envs), 0
    for _ in range(150):
        before = info["distance"]
        _, reward, _, _, info = envs.step(oracle.act())
        np.testing.assert_array_equal(before[reward == 1], 1)
        still = reward == 0
        np.testing.assert_array_equal(info["distance"][still], before[still] - 1)
        found += reward.sum()
    assert found > COUNT


def test_poses_and_targets_that_are_given_have_their_distances():
    envs = asking()
    _, info = envs.reset(seed=3)
    options = {"house": info["house"], "pose": info["pose"], "target": info["target"] + 0.013}
    _, info = envs.reset(options=options)
    np.testing.assert_array_equal(info["distance"], true_distances(envs))
    _, info = envs.reset(options={"house": info["house"], "target": np.full((COUNT, 2), -9.0)})
    np.testing.assert_array_equal(info["distance"], -1)


def test_distances_depend_on_nothing_but_the_state(monkeypatch):
    envs, other = asking(), asking()
    envs.reset(seed=4)
    infos = [info["distance"] for *_, info in strides(envs, 60)]
    middle = envs.state
    after = [info["distance"] for *_, info in strides(envs, 40, seed=1)]
    monkeypatch.setattr(geodesic, "MOST_BYTES", 1)  # fields are discarded again and again
    other.reset(seed=4)
    np.testing.assert_array_equal([info["distance"] for *_, info in strides(other, 60)], infos)
    assert envs.world.distances is not None
    assert other.world.distances is not None
    assert other.world.distances.fields < envs.world.distances.fields
    other.reset(seed=9)
    other.state = middle
    np.testing.assert_array_equal(other.info()["distance"], infos[-1])
    np.testing.assert_array_equal([info["distance"] for *_, info in strides(other, 40, seed=1)], after)


def test_another_bank_has_other_fields():
    envs = asking()
    envs.reset(seed=1)
    envs.set_houses(sample_houses.RANDOM[3:5], "main")
    _, info = envs.reset(seed=1)
    np.testing.assert_array_equal(info["distance"], true_distances(envs))


def test_to_know_distances_changes_nothing_else():
    asked, plain = asking(), HouseVectorEnv(HOUSES, COUNT, targets="all")
    asked.reset(seed=5)
    plain.reset(seed=5)
    for (*one, info), (*other, known) in zip(strides(asked, 80), strides(plain, 80), strict=True):
        np.testing.assert_equal(one, other)
        info.pop("distance")
        np.testing.assert_equal(info, known)


@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
def test_progress_is_a_difference_of_potentials(mode):
    terms = {"progress": 0.5, "discount": 0.9, "targets": 2, "steps": 100}
    envs = asking(targets={"task": "all", "terms": terms}, autoreset_mode=mode)
    _, info = envs.reset(seed=6)
    oracle, over, ends = Oracle(envs), np.zeros(COUNT, bool), 0
    random = np.random.default_rng(0)
    for _ in range(260):
        before, begins = info["distance"], over & (mode == "NextStep")
        picked = before == 1  # by the oracle's action
        actions = oracle.act()
        wander = random.random(COUNT) < 0.3
        actions[wander] = random.choice(3, wander.sum())
        _, reward, terminated, truncated, info = envs.step(actions)
        over = terminated | truncated
        after = info["distance"].copy()
        if mode == "SameStep" and over.any():
            after[over] = info["final_info"]["distance"][over]
        expected = 0.5 * (before - 0.9 * np.where(terminated, 0, after))
        expected[begins] = 0
        sure = ~wander
        np.testing.assert_allclose((reward - expected)[sure], (picked & ~begins)[sure], atol=1e-5)
        assert np.isin(np.round((reward - expected)[wander], 4), [0, 1]).all()
        ends += terminated.sum()
    assert ends > 9


def test_the_torch_path_has_distances_in_its_own_memory():
    torch = pytest.importorskip("torch")
    envs = asking()
    envs.reset(seed=7)
    info = {}
    for _ in range(30):
        *_, info = envs.step_torch(torch.full((COUNT,), 2))
    np.testing.assert_array_equal(info["distance"].numpy(), true_distances(envs))


def test_where_doors_are_closed_there_are_no_distances():
    with pytest.raises(ValueError, match="the distance to the target needs open doors"):
        asking(DOORS)
