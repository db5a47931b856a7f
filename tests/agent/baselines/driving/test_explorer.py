"""Planners and explorers of bodies that drive. 80 s."""

import re
from dataclasses import replace

import numpy as np
import pytest
import shapely
import torch

from tests.sample_houses import ONE_ROOM, drawn, random_house
from tests.sim.backends.free_study import Solids, with_slanted_walls
from vitruvius.agent.baselines.driving.explorer import DrivingExplorer
from vitruvius.agent.baselines.driving.steering import steered
from vitruvius.agent.baselines.table import DRIVING_BASELINES
from vitruvius.agent.evaluation.episodes import play
from vitruvius.agent.learning.environments import make_envs
from vitruvius.agent.planner import FREE, TAKEN, Planner
from vitruvius.agent.policies.policies import Explorer
from vitruvius.logic import FreeWall, House, Room
from vitruvius.sim import DEFAULT, HouseVectorEnv
from vitruvius.sim.drive import COMMANDS, Drive

SLANTED = House(
    (Room(0, 0, 6, 5, "R0", "hall"),),
    hub="R0",
    topology="own",
    free_walls=(FreeWall(1.0, 1.0, 3.0, 2.5, 0.1), FreeWall(4.0, 4.5, 5.0, 2.0, 0.0)),
)
HOUSES = [drawn(ONE_ROOM, 1.0), SLANTED, *(random_house(seed) for seed in range(4))]


def explorer(envs: HouseVectorEnv) -> DrivingExplorer:
    policy = DRIVING_BASELINES["explorer"](envs, 0)
    assert isinstance(policy, DrivingExplorer)
    return policy


def driven(envs: HouseVectorEnv, steps: int, seed: int = 0, house: int | None = None) -> list[np.ndarray]:
    """Return the actions and the last poses of an explorer."""
    policy, count = explorer(envs), envs.num_envs
    options = {"house": np.arange(count) % len(HOUSES) if house is None else np.full(count, house)}
    seen, blocked, rows = (
        torch.from_numpy(envs.reset(seed=seed, options=options)[0]),
        torch.zeros(count).bool(),
        [],
    )
    policy.begin(count)
    for _ in range(steps):
        rows.append(policy(seen, blocked).numpy().copy())
        seen, _, _, _, info = envs.step_torch(torch.from_numpy(rows[-1]))
        blocked = info["blocked"]
    return [np.stack(rows), envs.world.describe()[0]]


@pytest.mark.parametrize("targets", ["main", "all"])
def test_in_small_houses_it_finds_the_first_target_of_every_episode_and_more_than_others_that_know_no_more(
    targets,
):
    houses = [house for house in HOUSES for _ in range(4)]
    envs = make_envs(houses, len(houses), targets, backend="free")
    found = {
        name: play(envs, DRIVING_BASELINES[name](envs, 0), 0)
        for name in ("random drive", "explorer", "true path")
    }
    assert np.isfinite(found["explorer"].first).all()
    assert (found["explorer"].targets >= found["random drive"].targets).all()
    assert found["explorer"].targets.sum() > 0.55 * found["true path"].targets.sum()


def test_its_map_is_the_houses_where_it_looked_also_where_walls_stand_at_an_angle():
    """Occupied cells are near an obstacle, floor is not inside one, and no wall that rays meet is missing."""
    bank = [*HOUSES, with_slanted_walls(3)]
    envs = make_envs(bank, len(bank), "all", backend="free")
    policy, count = explorer(envs), len(bank)
    seen, info = envs.reset(seed=1, options={"house": np.arange(count)})
    start, blocked = info["pose"][:, :2].astype(float), torch.zeros(count).bool()
    ends = [[] for _ in bank]
    policy.begin(count)
    for _ in range(250):
        actions = policy(torch.as_tensor(seen), blocked)
        pose = envs.world.describe()[0].astype(float)
        look = np.asarray(seen).astype(float)
        met = (look[:, :, 0] < 0.99) & (look[:, :, 1] == 0)
        angle = pose[:, 2, None] + envs.config.ray_angles
        way = look[:, :, :1] * envs.config.range * np.stack([np.cos(angle), -np.sin(angle)], axis=-1)
        for e in range(count):
            ends[e].append((pose[e, :2] + way[e])[met[e]] - start[e])
        seen, _, _, _, info = envs.step_torch(actions)
        seen, blocked = seen.numpy().copy(), info["blocked"]
    cell = policy.tracker.planner.cell
    for e, house in enumerate(bank):
        cells, solids = policy.tracker.planner.occupancy(e), Solids(house).all
        middle = start[e] + cell * (np.argwhere(cells == FREE)[:, ::-1] - len(cells) // 2 + 0.5)
        inside = shapely.distance(shapely.points(middle), solids) == 0
        assert len(middle) > 100
        assert inside.mean() < 0.01
        taken = start[e] + cell * (np.argwhere(cells == TAKEN)[:, ::-1] - len(cells) // 2 + 0.5)
        assert shapely.distance(shapely.points(taken), solids).max() < 0.81 * cell
        at = np.floor(np.concatenate(ends[e]) / cell).astype(int) + len(cells) // 2
        # Rays are swept every other step if they show nothing new.
        assert (cells[at[:, 1], at[:, 0]] == TAKEN).mean() > 0.99


def test_it_drives_the_same_in_any_batch_and_again():
    envs = make_envs(HOUSES, 6, "all", backend="free")
    whole, again = driven(envs, 150, seed=5), driven(envs, 150, seed=5)
    single = driven(make_envs(HOUSES, 1, "all", backend="free"), 150, seed=8, house=3)
    for one, other in zip(whole, again, strict=True):
        np.testing.assert_array_equal(one, other)
    np.testing.assert_array_equal(whole[0][:, 3], single[0][:, 0])
    np.testing.assert_array_equal(whole[1][3], single[1][0])


@pytest.mark.parametrize(
    "config",
    [
        replace(
            DEFAULT,
            rays=180,
            first_ray=179.0,
            ray_spacing=2.0,
            sees_kind=True,
            drive=Drive(commands=COMMANDS, at_contact="stop"),
        ),
        replace(
            DEFAULT,
            rays=10,
            first_ray=67.5,
            ray_spacing=15.0,
            noise=0.02,
            dropout=0.02,
            drive=Drive(time_step=0.2, speed=1.5, reverse=0.5, acceleration=float("inf")),
        ),
    ],
    ids=["around, by commands, stops", "few and noisy, fast"],
)
def test_other_rays_and_other_motions_do_as_well(config):
    envs = make_envs(HOUSES, 6, "main", preset=config, backend="free")
    found = play(envs, DRIVING_BASELINES["explorer"](envs, 0), 0)
    assert np.isfinite(found.first).all()
    assert found.targets.mean() > 8


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"ray_spacing": 20.0, "rays": 9, "first_ray": 80.0}, "rays at most 15 degrees apart, not 20"),
        ({"rays": 20}, "rays from 45 degrees left to 45 right at least"),
        ({"rays": 400, "ray_spacing": 1.0, "first_ray": 180.0}, "at most one full turn of rays"),
        ({"latency": 2}, "current rays, not those of 2 steps ago"),
        ({"angle_noise": 1.0}, "rays without angle_noise"),
    ],
)
def test_rays_that_no_map_can_be_kept_by_are_refused_in_a_line(changes, words):
    with pytest.raises(ValueError, match=re.escape(f"a planner that drives needs {words}")) as error:
        Planner(replace(DEFAULT, **{"drives": True} | changes), 2)
    assert "\n" not in str(error.value)


def test_each_explorer_refuses_the_bodies_of_the_other_in_a_line():
    envs = make_envs(HOUSES[:1], 1, "main", backend="free")
    with pytest.raises(ValueError, match="an explorer counts grid steps"):
        Explorer(lambda observation, blocked: blocked, envs.config)
    with pytest.raises(ValueError, match="an explorer that drives needs the backend free"):
        DrivingExplorer(DEFAULT, lambda: np.zeros((1, 3)))
    with pytest.raises(ValueError, match="planners of bodies that drive choose their viewpoints"):
        Planner(envs.config, 1, led=True)


def test_what_is_told_turns_there_stops_there_and_keeps_the_limits():
    drive = Drive(speed=1.0, acceleration=2.0)
    off, room = np.array([0.0, 0.0, 0.05, -3.0, 2 * np.pi]), np.array([np.inf, 0.01, np.inf, np.inf, 0.0])
    v, w = steered(drive, off, room).T
    np.testing.assert_allclose(v, [1.0, 0.2, 1.0, 0.0, 0.0], atol=1e-6)
    np.testing.assert_allclose(w, [0.0, 0.0, 0.5, -3.0, 0.0], atol=1e-6)
    chosen = steered(replace(drive, commands=COMMANDS), np.array([0.0, 3.0, -3.0, 0.5]))
    assert chosen.tolist() == [2, 0, 1, 9]
