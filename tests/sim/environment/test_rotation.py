"""Houses in rotation: their order, the end of episodes and periods, and dependence on the seed only."""

import pickle
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests import sample_houses
from vitruvius.logic import House, HouseFileError
from vitruvius.sim import DEFAULT, HouseEnv, HouseRotation, HouseVectorEnv

HOUSES = [sample_houses.drawn("aa+aa.bbb\n......+bb\n......bbb", cell=1.2), *sample_houses.RANDOM[:6:2]]
E, T, LIFE = 6, 50, 20
PLAN = np.random.default_rng(3).choice(3, p=[0.15, 0.15, 0.7], size=(4 * T, E))


def make(count: int = E, houses: Sequence[House] = HOUSES, **more: Any) -> HouseVectorEnv:
    rotation = HouseRotation(houses, 2, T)
    return HouseVectorEnv(rotation, count, **{"targets": "mixed", "max_episode_steps": LIFE} | more)


def steps(envs: HouseVectorEnv, plan: np.ndarray) -> Iterator[list[np.ndarray]]:
    for actions in plan[:, : envs.num_envs]:
        observation, reward, terminated, truncated, info = envs.step(actions)
        yield [observation, reward, terminated, truncated, info["pose"], info["target"], info["house"]]


def same(one: list[np.ndarray], other: list[np.ndarray]) -> bool:
    return all(np.array_equal(a[: len(b)], b) for a, b in zip(one, other, strict=True))


def test_each_period_has_its_houses_for_its_steps_and_they_come_again() -> None:
    envs = make()
    envs.reset(seed=5)
    for k, (*_, truncated, pose, _, _) in enumerate(steps(envs, PLAN), 1):
        number, at = (k - 1) // T, (k - 1) % T + bool(k <= T)  # from steps since an episode's first one
        assert envs.houses == [HOUSES[(2 * number + j) % len(HOUSES)] for j in range(2)]
        inside = [any(shape.holds(row[None, :2])[0] for shape in envs.geometries) for row in pose]
        assert all(inside)
        assert truncated.all() == truncated.any() == (at % (LIFE + 1) == LIFE or k % T == 0)
        times = {envs.world.environment(e)["time"] for e in range(E)}
        assert times == {at % (LIFE + 1)}


def test_trajectories_are_those_of_any_batch_and_of_the_seed() -> None:
    envs, fewer = make(), make(2)
    envs.reset(seed=5)
    fewer.reset(seed=5)
    before = list(steps(envs, PLAN))
    assert all(same(one, other) for one, other in zip(before, steps(fewer, PLAN), strict=True))
    envs.reset(seed=5)
    assert all(same(one, other) for one, other in zip(before, steps(envs, PLAN), strict=True))


@pytest.mark.parametrize(
    ("at", "more"),
    [
        (T - 1, {}),
        (T, {}),
        (T + 20, {}),
        (T + 20, {"preset": "doors"}),
        (T + 20, {"preset": replace(DEFAULT, geodesic=True)}),
        (T + 20, {"targets": {"task": "all", "terms": {"progress": 0.01}}}),
        (T + 20, {"backend": "free", "preset": "drive"}),
    ],
)
def test_kept_environments_go_on_in_the_periods_that_follow(at: int, more: dict[str, Any]) -> None:
    """Environments keep everything about a house, such as doors and distances."""
    envs = make(**more)
    envs.reset(seed=5)
    list(steps(envs, PLAN[:at]))
    other, again = make(**more), pickle.loads(pickle.dumps(envs))
    other.reset(seed=7)
    other.state = envs.state
    after = list(steps(envs, PLAN[at:]))
    for kept in (other, again):
        assert all(same(one, then) for one, then in zip(after, steps(kept, PLAN[at:]), strict=True))


class Counted(Sequence[House]):
    """Sequence of houses that records the requested indices."""

    def __init__(self) -> None:
        self.asked: list[int] = []

    def __len__(self) -> int:
        return 1_000_000

    def __getitem__(self, index: Any) -> Any:
        self.asked.append(index)
        return HOUSES[index % len(HOUSES)]


def test_of_a_million_houses_no_more_are_read_than_two_periods_need() -> None:
    houses = Counted()
    envs = make(houses=houses)
    envs.reset(seed=0)
    list(steps(envs, PLAN[: T + 1]))
    envs.close()
    assert sorted(houses.asked) in ([0, 1, 2, 3], [0, 1, 2, 3, 4, 5])


def test_other_houses_and_another_rotation_can_be_set() -> None:
    envs = make()
    envs.reset(seed=5)
    list(steps(envs, PLAN[: T + 3]))
    envs.set_houses(HOUSES[:1])
    envs.reset(seed=5)
    *_, (*_, truncated, _, _, _) = steps(envs, PLAN[:T])
    assert not truncated.any(), "the rotation is gone"
    envs.set_houses(HouseRotation(HOUSES, 2, T))
    envs.reset(seed=5)
    fresh = make()
    fresh.reset(seed=5)
    assert all(same(one, other) for one, other in zip(steps(envs, PLAN), steps(fresh, PLAN), strict=True))


def test_what_cannot_be_had_is_said() -> None:
    wrongs: list[tuple[tuple[Any, ...], str]] = [
        ((HOUSES, 0), "rotation: size must be a whole number, 1 or more, not 0"),
        ((HOUSES, 2, True), "rotation: steps must be a whole number, 1 or more, not True"),
        (([],), "no house to simulate: the rotation is empty"),
    ]
    for wrong, said in wrongs:
        with pytest.raises(ValueError, match=said):
            HouseRotation(*wrong)
    with pytest.raises(ValueError, match="need autoreset_mode='NextStep'"):
        make(autoreset_mode="SameStep")
    narrow = sample_houses.drawn(sample_houses.ONE_ROOM, cell=0.05)
    envs = make(houses=[*HOUSES[:3], narrow])
    envs.reset(seed=0)
    with pytest.raises(HouseFileError, match="from house 2 of 4 on, house 1 of 2: "):
        list(steps(envs, PLAN[: T + 1]))
    state = make()
    state.reset(seed=0)
    for other in ([-1, 2, T], [0, 3, T], [0, 2, T + 1]):
        with pytest.raises(ValueError, match="the state belongs to another rotation"):
            state.state = state.state | {"passed": np.array(other)}
    for other in ([np.nan, 2, T], [1e300, 2, T], 0, [[0, 2, T]]):
        with pytest.raises(ValueError, match=r"the state's counter passed must be int64 \(3,"):
            state.state = state.state | {"passed": np.array(other)}
    with pytest.raises(ValueError, match="rotating houses need HouseVectorEnv: give HouseEnv a"):
        HouseEnv(HouseRotation(HOUSES, 2, T))
    same = HouseVectorEnv(HOUSES[:1], autoreset_mode="SameStep")
    with pytest.raises(ValueError, match="need autoreset_mode='NextStep'"):
        same.set_houses(HouseRotation(HOUSES, 2, T))
    assert same.houses == HOUSES[:1]
    list(steps(state, PLAN[: T + 1]))
    later = state.state
    with pytest.raises(ValueError, match="pose"):  # of the first period's houses, to which a seed returns
        state.reset(seed=0, options={"house": np.full(E, 0), "pose": np.full((E, 3), 50.0)})
    with pytest.raises(ValueError, match="the state has other dtypes or"):
        state.state = {"passed": np.array([0, 2, T])}
    assert state.houses == HOUSES[2:4]
    assert all(np.array_equal(state.state[name], later[name]) for name in later)
