# pyright: reportIncompatibleMethodOverride=false
"""Terms with a memory, and terms that read rooms and obstacles, compared with NumPy and shapely."""

import pickle
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
import pytest
import shapely

from tests import sample_houses
from vitruvius.logic import House
from vitruvius.sim import DEFAULT, HouseVectorEnv, Oracle
from vitruvius.sim.backends.backend import DOOR, PIECE, WALL
from vitruvius.sim.runtime import ti
from vitruvius.sim.tasks.remembering import Battery, Visit
from vitruvius.sim.tasks.tasks import Collect, task
from vitruvius.sim.tasks.terms import Terms, counted, terms_of

pytestmark = pytest.mark.second_part("kernels of tasks that remember")

DRAWN = sample_houses.drawn("Aa+aa.bBb\n......+bb\n......bbb", cell=1.2)
HOUSES = [DRAWN, *sample_houses.RANDOM[:2]]
COUNT = 32


@ti.data_oriented
@dataclass(frozen=True)
class Noting(Terms):
    """Terms that keep the last room, the last obstacle, and the sums of steps and marks."""

    memory: ClassVar[int] = 4
    sees_room: ClassVar[bool] = True
    sees_bumped: ClassVar[bool] = True

    def marks(self, house: House) -> list[int]:
        """Return twice the room's number plus three, for each room."""
        return [2 * number + 3 for number in range(len(house.rooms))]

    @ti.func
    def remember(self, now):
        """Return the memory after a step: see ``Terms``."""
        return ti.Vector([
            ti.cast(now.room, ti.f32), ti.cast(now.bumped, ti.f32),
            now.was[2] + 1.0, now.was[3] + ti.cast(now.mark, ti.f32),
        ])  # fmt: skip

    @ti.func
    def ends(self, now):
        """Return 1 at a collision after 90 steps: see ``Terms``."""
        return ti.cast((now.memory[2] > 90) & (now.bumped > 0), ti.i32)


def plan(steps: int, count: int = COUNT) -> np.ndarray:
    return np.random.default_rng(2).choice(3, p=[0.15, 0.15, 0.7], size=(steps, count))


def room_of(house: House, x: float, y: float) -> set[int]:
    """Return the number of the first room that contains a place; on a boundary, also the next room's."""
    depths = [
        min(x - west, east - x, y - north, south - y)
        for west, north, east, south in (room.box for room in house.rooms)
    ]
    inside = [number for number, depth in enumerate(depths) if depth > 1e-5]
    near = {number for number, depth in enumerate(depths) if abs(depth) <= 1e-5}
    return {*inside[:1], *near} or {-1}


def things_met(house: House, before: np.ndarray, after: np.ndarray, half: float) -> set[int]:
    """Return a square's obstacles between two centres: furniture, or else a wall; both if it is close."""
    ends = [shapely.box(x - half, y - half, x + half, y + half) for x, y in (before, after)]
    way = shapely.union_all(ends).convex_hull
    pieces = shapely.union_all([shapely.box(*piece.box) for room in house.rooms for piece in room.pieces])
    if way.buffer(-1e-4, join_style="mitre").intersects(pieces):
        return {PIECE}
    return {WALL, PIECE} if way.buffer(1e-4, join_style="mitre").intersects(pieces) else {WALL}


@pytest.fixture(scope="module")
def noting() -> HouseVectorEnv:
    return HouseVectorEnv(
        HOUSES, COUNT, targets=Collect(terms=Noting()), preset=replace(DEFAULT, observe=("rays", "memory"))
    )


def test_terms_see_the_room_and_what_was_bumped_into_and_keep_them(noting):
    _, info = noting.reset(seed=3)
    steps, marks, met, been = np.zeros(COUNT), np.zeros(COUNT), set[int](), set[int]()
    forward, over = DEFAULT.step, np.zeros(COUNT, bool)
    for actions in plan(220):
        before = info["pose"]
        observation, _, terminated, _, info = noting.step(actions)
        np.testing.assert_array_equal(observation["memory"], info["memory"])
        np.testing.assert_array_equal(info["memory"][over], 0)
        steps, marks = np.where(over, 0, steps + 1), np.where(over, 0, marks)
        for e in np.flatnonzero(~over):
            house = HOUSES[info["house"][e]]
            room, bumped, time, sum_ = info["memory"][e]
            assert room in room_of(house, *info["pose"][e, :2])
            marks[e] += 2 * room + 3 if room >= 0 else 0
            assert (time, sum_) == (steps[e], marks[e])
            assert (bumped > 0) == info["blocked"][e]
            if bumped:
                turn = before[e, 2]
                way = np.sign(np.round([np.cos(turn), -np.sin(turn)], 3)) * forward
                at = before[e, :2]
                assert bumped in things_met(house, at, at + way, DEFAULT.body[0] / 2)
            met.add(int(bumped))
            been.add(int(room))
        over = terminated
    assert met == {0, WALL, PIECE}
    assert len(been) > 2


def test_a_memory_is_of_its_environment_alone_and_goes_along_with_states_and_pickles(noting):
    noting.reset(seed=5)
    rows = plan(60)
    for actions in rows[:30]:
        noting.step(actions)
    other, kept = pickle.loads(pickle.dumps(noting)), noting.state
    first = [noting.step(actions)[-1]["memory"] for actions in rows[30:]]
    np.testing.assert_array_equal(first, [other.step(actions)[-1]["memory"] for actions in rows[30:]])
    noting.state = kept
    np.testing.assert_array_equal(first, [noting.step(actions)[-1]["memory"] for actions in rows[30:]])
    few = HouseVectorEnv(HOUSES, 3, targets=noting.world.task, preset=replace(noting.config, memory=0))
    few.reset(seed=5)
    some = [few.step(actions[:3])[-1]["memory"] for actions in rows]
    np.testing.assert_array_equal([each[:3] for each in first], some[30:])


@pytest.mark.parametrize("backend", ["free", "grid"])
def test_every_backend_tells_walls_from_pieces(backend):
    cell = {"grid": 0.4}.get(backend)
    houses = [DRAWN]
    envs = HouseVectorEnv(houses, COUNT, targets=Collect(terms=Noting()), backend=backend)
    assert cell is None or envs.config.in_cells
    envs.reset(seed=1)
    pieces = [piece.box for room in houses[0].rooms for piece in room.pieces]
    seen, random, over = set(), np.random.default_rng(0), np.zeros(COUNT, bool)
    for actions in plan(150):
        speeds = np.stack([random.uniform(0.3, 0.7, COUNT), random.uniform(-3, 3, COUNT)], 1)
        _, _, terminated, _, info = envs.step(speeds if envs.config.drives else actions)
        for e in np.flatnonzero(~over & info["blocked"]):
            x, y = info["pose"][e, :2]
            away = min(max(west - x, x - east, north - y, y - south) for west, north, east, south in pieces)
            bumped = int(info["memory"][e, 1])
            near = max(envs.config.body) / 2 + (envs.config.step if not envs.config.drives else 0)
            assert bumped == WALL or away < near + 1e-3
            assert bumped == PIECE or away > max(envs.config.body) / 2 * 0.7
            seen.add(bumped)
        over = terminated
    assert seen == {WALL, PIECE}


def test_a_closed_door_is_bumped_into():
    houses = [DRAWN]
    config = replace(DEFAULT, closed_doors=4, sees_kind=True)
    envs = HouseVectorEnv(houses, COUNT, targets=Collect(terms=Noting()), preset=config)
    envs.reset(seed=0)
    bumped = {int(each) for actions in plan(150) for each in envs.step(actions)[-1]["memory"][:, 1]}
    assert DOOR in bumped


def played(targets: Any, steps: int) -> list[tuple[Any, ...]]:
    """Return the outputs of each step of the oracle, in ``SAME_STEP``."""
    envs = HouseVectorEnv([DRAWN], COUNT, targets=targets, autoreset_mode="SameStep")
    envs.reset(seed=1)
    oracle = Oracle(envs)
    return [envs.step(oracle.act()) for _ in range(steps)]


def test_the_last_room_that_is_visited_ends_the_episode_and_each_is_worth_1_once():
    visited: list[set[int]] = [set() for _ in range(COUNT)]
    rows, ends = played({"task": "all", "terms": {"class": "visit", "visit": 2.0, "step": -0.125}}, 300), 0
    for _, reward, terminated, _, info in rows:
        last = info.get("final_info", info)
        for e in range(COUNT):
            told = last if terminated[e] else info
            before = len(visited[e])
            visited[e] |= room_of(DRAWN, *told["pose"][e, :2]) - {-1}
            number = int(told["memory"][e, 0])
            assert reward[e] == 2.0 * (number - before) - 0.125
            assert number == len(visited[e]) == sum(int(word).bit_count() for word in told["memory"][e, 1:])
            assert terminated[e] == (number == len(DRAWN.rooms))
            if terminated[e]:
                visited[e], ends = set(), ends + 1
                np.testing.assert_array_equal(info["memory"][e], 0)
    assert ends > 7


def test_a_battery_runs_down_outside_the_room_with_a_charger_and_ends_the_episode():
    task_ = {"task": "secondary", "terms": {"class": "battery", "capacity": 60, "charge": 3, "empty": -4}}
    taken, ends, full = np.zeros(COUNT), 0, 0
    for _, reward, terminated, _, info in played(task_, 250):
        last = info.get("final_info", info)
        for e in range(COUNT):
            told = last if terminated[e] else info
            charged = DRAWN.rooms.index(DRAWN.start) in room_of(DRAWN, *told["pose"][e, :2])
            taken[e] = max(0, taken[e] + 1 - 3 * charged)
            assert told["memory"][e, 0] == taken[e]
            assert terminated[e] == (taken[e] >= 60)
            assert (reward[e] < 0) == terminated[e]
            full += taken[e] == 0
        taken[terminated], ends = 0, ends + terminated.sum()
    assert ends > 9
    assert full > COUNT


def test_evaluation_counts_pick_ups_and_keeps_what_ends_an_episode():
    terms = terms_of(counted(task({"task": "all", "terms": {"class": "battery", "capacity": 9}})))
    assert (terms.memory, terms.sees_room, terms.pick_up) == (1, True, 1.0)
    assert list(terms.marks(HOUSES[0])) == list(Battery().marks(HOUSES[0]))


WRONG = {
    "terms: there is no class vist: did you mean visit?": {"class": "vist"},
    "terms: most is 0: it must be 1 to 1,512 rooms": {"class": "visit", "most": 0},
    "it has 3 rooms, more than the terms' most of 2: raise most": {"class": "visit", "most": 2},
    "no room to visit: there is no room type hut": {"class": "visit", "types": ["hut"]},
    "no room with a charger: there is no room type hut": {"class": "battery", "charger": "hut"},
    "terms: capacity is -1: it must be 1": {"class": "battery", "capacity": -1},
    "terms: charge is -1: it must not be negative": {"class": "battery", "charge": -1},
    "terms: visit must be a finite number, not nan": {"class": "visit", "visit": float("nan")},
}


@pytest.mark.parametrize("message", WRONG)
def test_wrong_memories_are_said_to_be_in_one_line(message):
    with pytest.raises(ValueError, match=r"targets |house 0 of ") as error:
        HouseVectorEnv(HOUSES, targets={"task": "all", "terms": WRONG[message]})
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_a_memory_is_observed_only_where_terms_keep_one():
    with pytest.raises(ValueError, match="observe: the task's terms have no memory: use"):
        HouseVectorEnv(HOUSES, targets="all", preset=replace(DEFAULT, observe=("rays", "memory")))


def test_terms_have_names_and_a_named_task_keeps_its_own():
    assert task("visit") == task({"task": "roam", "terms": "visit"}) == task({"task": "visit", "terms": {}})
    assert terms_of(task({"task": "visit", "terms": {"step": -1}})) == Visit(step=-1)
    assert terms_of(task({"task": "battery", "terms": {"capacity": 50}})) == Battery(capacity=50)
