"""Terms of a task: rewards and ends of episodes, compared with arithmetic on infos."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import pytest

from tests import sample_houses
from vitruvius.sim import HouseVectorEnv, Oracle
from vitruvius.sim.runtime import ti
from vitruvius.sim.tasks.tasks import task
from vitruvius.sim.tasks.terms import PLAIN, Terms, counted, terms_of

HOUSES = sample_houses.RANDOM[:2]
COUNT = 64


@ti.data_oriented
@dataclass(frozen=True)
class Everything(Terms):
    """Terms with a reward that depends on all that terms read, and an end at a collision after some steps."""

    after: int = 40

    @ti.func
    def reward(self, now):
        """Return the reward of a step: see ``Terms``."""
        away = (now.target - now.eye).norm()
        return (
            now.picked
            + 0.5 * now.blocked
            + 0.25 * now.action
            + 0.125 * now.found
            + 0.01 * now.time
            + 0.001 * now.house
            + 0.0001 * now.heading
            + away
        )

    @ti.func
    def ends(self, now):
        """Return 1 if the episode ends: see ``Terms``."""
        return now.blocked & ti.cast(now.time > ti.static(self.after), ti.i32)


@ti.data_oriented
@dataclass(frozen=True)
class Nearer(Terms):
    """Terms whose reward is the decrease of the distance to the step's target."""

    sees_distance: ClassVar[bool] = True

    @ti.func
    def reward(self, now):
        """Return the reward of a step: see ``Terms``."""
        return now.before - now.distance


def played(targets: Any, steps: int = 400, **arguments: Any) -> list[tuple[Any, ...]]:
    """Return actions and the outputs of each step, with each environment's target and house before it."""
    envs = HouseVectorEnv(HOUSES, COUNT, targets=targets, **arguments)
    _, info = envs.reset(seed=1)
    rows, random = [], np.random.default_rng(0)
    for _ in range(steps):
        actions = random.choice(3, COUNT, p=[0.2, 0.1, 0.7])
        rows.append((actions, info, *envs.step(actions)))
        info = rows[-1][-1]
    return rows


def without(rows: list[tuple[Any, ...]], *places: int) -> list[tuple[Any, ...]]:
    return [tuple(each for k, each in enumerate(row) if k not in places) for row in rows]


def test_terms_of_a_pick_up_a_step_and_a_bump_are_added_and_change_nothing_else():
    plain = played("main")
    shaped = played({"task": "main", "terms": {"pick_up": 2.0, "step": -0.01, "bump": -0.25}})
    np.testing.assert_equal(without(shaped, 3), without(plain, 3))
    picked, bumps = 0, 0
    for (*_, one, _, _, info), (*_, other, _, _, _) in zip(plain, shaped, strict=True):
        expected = 2 * one - np.float32(0.01) - 0.25 * info["blocked"]
        np.testing.assert_allclose(other, expected, atol=1e-6)
        picked, bumps = picked + one.sum(), bumps + info["blocked"].sum()
    assert picked > 9
    assert bumps > 999


def test_plain_terms_are_no_terms():
    assert task({"task": "main", "terms": {}}) == task("main")
    assert terms_of(task("main")) == PLAIN
    np.testing.assert_equal(played({"task": "main", "terms": {"pick_up": 1}}, 40), played("main", 40))


def test_a_class_of_terms_sees_all_of_a_step():
    terms = {"class": "tests.sim.tasks.test_terms:Everything", "after": 20}
    rows = played({"task": "main", "terms": terms}, autoreset_mode="SameStep")
    found, time, ends = np.zeros(COUNT), np.zeros(COUNT), 0
    for actions, before, _, reward, terminated, truncated, info in rows:
        assert not truncated.any()
        over, time = terminated, time + 1
        blocked, pose = info["blocked"].copy(), info["pose"].copy()
        if over.any():
            last = info["final_info"]
            blocked[over], pose[over] = last["blocked"][over], last["pose"][over]
        target, pickup = before["target"], np.abs(pose[:, :2] - before["target"]).max(1) < 0.41
        picked = pickup & (np.abs(pose[:, :2] - target).max(1) < (0.5378 + 0.2868) / 2 - 1e-5)
        found += picked
        np.testing.assert_array_equal(over, blocked & (time > 20))
        heading = np.round(pose[:, 2] / (np.pi / 4))
        expected = picked + 0.5 * blocked + 0.25 * actions + 0.125 * found + 0.01 * time
        expected += 0.001 * before["house"] + 0.0001 * heading + np.linalg.norm(target - pose[:, :2], axis=1)
        np.testing.assert_allclose(reward, expected, atol=1e-5)
        found[over], time[over], ends = 0, 0, ends + over.sum()
    assert ends > COUNT


def test_a_class_of_terms_sees_the_distance_if_it_says_so():
    near = {"task": "main", "terms": "tests.sim.tasks.test_terms:Nearer"}
    progress = {"task": "main", "terms": {"progress": 1.0, "pick_up": 0.0}}
    picked = 0
    rows = zip(played(near), played(progress), played("main"), strict=True)
    for (*_, one, _, _, _), (*_, other, _, _, _), (*_, found, _, _, _) in rows:
        np.testing.assert_array_equal(one[found == 0], other[found == 0])
        np.testing.assert_array_equal(one[found == 1], 1)
        picked += found.sum()
    assert picked > 9
    with pytest.raises(ValueError, match="the oracle cannot run a task whose terms use the distance"):
        Oracle(HouseVectorEnv(HOUSES, targets=near)).play()


def test_an_episode_ends_after_so_many_pick_ups_or_steps():
    rows = played({"task": "main", "terms": {"targets": 2, "steps": 300}}, 650, autoreset_mode="SameStep")
    found, time, terminations, truncations = np.zeros(COUNT), np.zeros(COUNT), 0, 0
    for _, _, _, reward, terminated, truncated, _ in rows:
        found, time = found + reward, time + 1
        np.testing.assert_array_equal(terminated, found == 2)
        np.testing.assert_array_equal(truncated, time == 300)
        over = terminated | truncated
        found[over], time[over] = 0, 0
        terminations, truncations = terminations + terminated.sum(), truncations + truncated.sum()
    assert terminations > 0 < truncations
    assert HouseVectorEnv(HOUSES, targets={"task": "main", "terms": {"steps": 9}}).config.steps == 9


def test_counted_a_task_rewards_pick_ups_and_ends_as_before():
    shaped = task({"task": "main", "terms": {"class": "tests.sim.tasks.test_terms:Everything"}})
    for one, other in zip(played(shaped, 99), played(counted(shaped), 99), strict=True):
        np.testing.assert_equal(one[4:], other[4:])
        assert set(np.unique(other[3])) <= {0, 1}
    assert counted(task({"task": "main", "terms": {"bump": -1.0, "targets": 2}})) == task(
        {"task": "main", "terms": {"targets": 2}}
    )


WRONG = {
    "terms: there is no term stepp: did you mean step?": {"stepp": 1},
    "terms: step must be a finite number, not nan": {"step": float("nan")},
    "terms: step must be a number, not '1'": {"step": "1"},
    "terms: targets must be a whole number, 0 or more, not -1": {"targets": -1},
    "terms: discount is 2: it must be 0 to 1": {"discount": 2},
    ":Reach is not a subclass of vitruvius.sim.tasks.terms.Terms": "vitruvius.sim.tasks.tasks:Reach",
    "No module named 'gone'": "gone:Away",
    'terms: give {"step": -0.01} or "module:Class", not 3': 3,
}


@pytest.mark.parametrize("message", WRONG)
def test_wrong_terms_are_said_to_be_in_one_line(message):
    with pytest.raises(ValueError, match="targets ") as error:
        HouseVectorEnv(HOUSES, targets={"task": "main", "terms": WRONG[message]})
    assert message in str(error.value)
    assert "\n" not in str(error.value)
