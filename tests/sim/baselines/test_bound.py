"""The bound on what bodies that drive can do: by hand, and beside all that play. 22 s."""

from dataclasses import replace

import numpy as np
import pytest

from logic import FreeWall, House, Room
from sim import DEFAULT, HouseVectorEnv
from sim.baselines.bound import TimeBound, acceleration_loss
from sim.baselines.steering import steered
from sim.baselines.true_path import TruePath
from sim.config import DRIVE, Config
from sim.drive import Drive
from tests.sim.backends.free_study import houses

HALL = Room(0, 0, 9, 9, "R0", "hall")
EMPTY = House((HALL,), hub="R0", topology="own")


def walled(*ends: tuple[float, float]) -> House:
    """The same with walls that end there, from the north and from the south in turn."""
    walls = tuple(FreeWall(x, 9.0 * (k % 2), x, y, 0.0) for k, (x, y) in enumerate(ends))
    return House((HALL,), hub="R0", topology="own", free_walls=walls)


AGILE = replace(DEFAULT, drive=Drive(acceleration=float("inf"), turn_acceleration=float("inf")))
RADIUS, HALF = DEFAULT.body[0] / 2, DEFAULT.target / 2
SPEED, TURN_SPEED, STEP = DEFAULT.drive.speed, DEFAULT.drive.turn_speed, DEFAULT.drive.time_step


def begun(house: House, poses, targets, config: Config = DEFAULT) -> HouseVectorEnv:
    """Environments whose bodies stand at poses (E, 3), with targets at (E, 2)."""
    envs = HouseVectorEnv([house], len(poses), backend="free", preset=config, targets="all")
    options = {"house": [0] * len(poses), "pose": poses, "target": targets}
    envs.reset(seed=0, options=options)
    return envs


def steps_of(way: float) -> int:
    """Steps that a body takes from rest for a way straight on."""
    speed, gone, steps = 0.0, 0.0, 0
    while gone < way - 1e-6:
        speed = min(SPEED, speed + DEFAULT.drive.acceleration * STEP)
        gone, steps = gone + STEP * speed, steps + 1
    return steps


def test_straight_on_in_an_empty_room_it_is_exact():
    away = HALF + RADIUS + 0.155 + STEP * SPEED * np.arange(40)  # midway between two steps
    envs = begun(EMPTY, [[1, 4.5, 0.0]] * 40, [[1 + each, 4.5] for each in away])
    bound = TimeBound(envs).first()
    assert bound.tolist() == [steps_of(each - HALF - RADIUS) for each in away]
    first = np.full(40, np.inf)
    for step in range(1, 60):
        _, reward, *_ = envs.step(np.tile(np.array([SPEED, 0], np.float32), (40, 1)))
        first[(reward > 0) & (first == np.inf)] = step
    assert bound.tolist() == first.tolist()


@pytest.mark.parametrize("angle", [0.5, 1.2, np.pi / 2, 2.5, np.pi])
def test_a_turn_costs_what_it_costs_by_hand(angle):
    """Of a turn by some angle, its sine brings the body on, of the last quarter at most: as sectors of
    headings and samples of places have it, less by a tenth of a second at most.
    """
    envs = begun(EMPTY, [[2.5, 4.5, angle]], [[6.5, 4.5]], AGILE)
    by_hand = (4 - HALF - RADIUS) / SPEED + (angle - np.sin(min(angle, np.pi / 2))) / TURN_SPEED
    [first] = STEP * TimeBound(envs).first()
    assert by_hand - 0.1 <= first <= by_hand + STEP


def around(*ends: tuple[float, float]) -> float:
    """Metres by hand from (1.5, 4.5) about ends of walls, to the left and to the right in turn, to where a
    target at (7.5, 4.5) is picked up from a diagonal: tangents of circles about the ends, and arcs.
    """
    places = np.array([(1.5, 4.5), *ends, (7.5, 4.5)])
    apart = np.hypot(*np.diff(places, axis=0).T)
    inner = np.array([RADIUS, *[2 * RADIUS] * (len(ends) - 1), RADIUS])
    way = np.sqrt(apart**2 - inner**2).sum()
    for k in range(len(ends)):
        one, other = places[k] - places[k + 1], places[k + 2] - places[k + 1]
        angle = np.arccos(one @ other / np.hypot(*one) / np.hypot(*other))
        way += RADIUS * (2 * np.pi - angle - np.arccos(inner[k : k + 2] / apart[k : k + 2]).sum())
    return way - np.sqrt(2) * HALF - RADIUS


@pytest.mark.parametrize("ends", [[(4.5, 7.5)], [(3.0, 6.0), (6.0, 3.0)]], ids=["one", "two"])
def test_around_walls_it_is_the_shortest_path_by_hand(ends):
    """Less by what corners are cut and places are apart, by a tenth of a metre at each wall at most."""
    envs = begun(walled(*ends), [[1.5, 4.5, -np.pi / 4]], [[7.5, 4.5]], AGILE)
    [first] = TimeBound(envs).first()
    assert around(*ends) - 0.1 * len(ends) <= first * STEP * SPEED <= around(*ends) + STEP * SPEED


def test_no_way_is_infinite():
    envs = HouseVectorEnv([walled((4.5, 9.0))], 1, backend="free", targets="all")
    envs.reset(seed=0, options={"house": [0], "pose": [[2, 2, 0.0]], "target": [[7, 7]]})
    assert TimeBound(envs).first().tolist() == [np.inf]
    assert TimeBound(envs).most().tolist() == [0]


def test_a_pick_up_takes_a_step_where_the_next_target_is_at_the_same_place():
    task = {"points": [[4.5, 4.5]], "start": [4.2, 4.5, 0.0]}
    envs = HouseVectorEnv([EMPTY], 1, backend="free", preset=replace(DEFAULT, steps=40), targets=task)
    envs.reset(seed=0)
    for left in (40, 39, 38):
        assert TimeBound(envs).most().tolist() == [left]
        assert envs.step(np.zeros((1, 2), np.float32))[1].tolist() == [1]


def test_a_body_narrower_than_its_places_are_apart_has_no_bound():
    envs = HouseVectorEnv([EMPTY], 1, backend="free", preset=replace(DEFAULT, body=(0.02, 0.02)))
    with pytest.raises(ValueError, match=r"bodies are 0\.02 m wide, with targets of 0\.537882 m"):
        TimeBound(envs)


PLAYERS = "true path", "straight", "random"


def told(player: str, envs: HouseVectorEnv, path: TruePath, rng: np.random.Generator) -> np.ndarray:
    """What a player tells all bodies."""
    if player == "true path":
        return path.act()
    drive = envs.config.drive
    if player == "random":
        if drive.commands:
            return rng.integers(len(drive.commands), size=envs.num_envs)
        return rng.uniform(drive.low, drive.high, (envs.num_envs, 2)).astype(np.float32)
    info = envs.info()
    away = info["target"] - info["pose"][:, :2]
    return steered(envs.config.drive, np.arctan2(-away[:, 1], away[:, 0]) - info["pose"][:, 2])


@pytest.mark.parametrize(
    ("config", "least"),
    [
        (DEFAULT, 0.75),
        (AGILE, 0.8),
        (replace(DEFAULT, drive=Drive(at_contact="stop", reverse=0.5)), 0.5),
        (DRIVE, 0.65),
    ],
    ids=["slide", "agile", "stop", "commands"],
)
def test_nobody_is_better_and_who_knows_the_way_is_not_much_worse(config, least):
    """In houses of all kinds, half of them with walls at an angle."""
    bank = houses(24, seed=80)
    config = replace(config, steps=400)
    envs = HouseVectorEnv(bank, 2 * len(bank), backend="free", preset=config, targets="all")
    bound, path, rng = TimeBound(envs), TruePath(envs), np.random.default_rng(0)
    begin = {"seed": 5, "options": {"house": np.arange(2 * len(bank)) % len(bank)}}
    envs.reset(**begin)
    most, soonest = bound.most(), bound.first()
    for player in PLAYERS:
        envs.reset(**begin)
        found, first = np.zeros(len(most)), np.full(len(most), np.inf)
        for step in range(1, config.steps + 1):
            _, reward, *_ = envs.step(told(player, envs, path, rng))
            found += reward
            first[(reward > 0) & (first == np.inf)] = step
        assert (found <= most).all()
        assert (first >= soonest).all()
        if player == "true path":
            assert found.sum() >= least * most.sum()


def test_in_the_middle_of_an_episode_it_counts_from_there():
    envs = HouseVectorEnv(houses(8, seed=3), 8, backend="free", preset=AGILE)
    envs.reset(seed=0)
    bound, path, found = TimeBound(envs), TruePath(envs), np.zeros(8)
    for _ in range(700):
        envs.step(path.act())
    most = bound.most()
    for _ in range(800):
        found += envs.step(path.act())[1]
    assert (found <= most).all()
    assert found.sum() >= 0.75 * most.sum()


def test_what_is_lost_until_the_greatest_speed_is_by_steps():
    lost = acceleration_loss(np.array([0, 0, 0, 0.5]), np.array([0.01, 0.03, 9.0, 9.0]), DEFAULT)
    np.testing.assert_allclose(lost, [0, 5 / 70, 9 / 70, 0])


@pytest.mark.parametrize("knows", [TimeBound, TruePath])
def test_bodies_on_a_lattice_have_an_oracle(knows):
    with pytest.raises(ValueError, match="take the backend free, or an oracle"):
        knows(HouseVectorEnv([EMPTY], 1))
