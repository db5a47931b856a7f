"""The free backend: it equals shapely, it is the same in any batch, and it refuses invalid use. 100 s."""

import re
from dataclasses import replace

import gymnasium
import numpy as np
import pytest
import shapely
import torch
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode

from tests.sim.backends.free_study import Solids, compare, houses, with_slanted_walls
from tests.sim.conformance.autoreset import check_autoreset_modes
from tests.sim.conformance.claims import check_vector_env
from vitruvius.agent.baselines.searcher import Searcher
from vitruvius.logic import House, Room
from vitruvius.sim import DEFAULT, HouseVectorEnv, Oracle
from vitruvius.sim.config import DRIVE
from vitruvius.sim.drive import Drive
from vitruvius.sim.tasks.tasks import Collect
from vitruvius.sim.tasks.terms import Terms

HOUSES = houses(6, seed=50)
EMPTY = House((Room(0, 0, 9, 9, "R0", "hall"),), hub="R0", topology="own")


def make(**arguments) -> HouseVectorEnv:
    return HouseVectorEnv(
        **({"houses": HOUSES, "num_envs": 32, "backend": "free", "targets": "all"} | arguments)
    )


def plan(envs: HouseVectorEnv, steps: int, seed: int = 0) -> np.ndarray:
    """Return actions (T, E, 2), mostly forward."""
    rng, space = np.random.default_rng(seed), envs.single_action_space
    assert isinstance(space, gymnasium.spaces.Box)
    v = rng.uniform(0.4, 1, (steps, envs.num_envs)) * space.high[0]
    w = rng.uniform(-1, 1, (steps, envs.num_envs)) * space.high[1]
    return np.stack([v, w], axis=-1).astype(np.float32)


def walked(envs: HouseVectorEnv, actions: np.ndarray, seed: int = 0) -> list[np.ndarray]:
    """Return all outputs of a walk: observations, poses, rewards, and blocked."""
    seen, info = envs.reset(seed=seed)
    rows = [(seen, info["pose"], np.zeros(envs.num_envs, np.float32), info["blocked"])]
    for action in actions:
        seen, reward, _, _, info = envs.step(action)
        rows.append((seen, info["pose"], reward, info["blocked"]))
    return [np.stack(column) for column in zip(*rows, strict=True)]


@pytest.mark.parametrize("sideways", [0.0, 3.0])
@pytest.mark.parametrize("at_contact", ["slide", "stop"])
def test_rays_and_contacts_are_those_of_shapely(at_contact, sideways):
    """Run a sample of ``free_study``, which can run a million cases as a command."""
    found = compare(houses(12, seed=7), 25, at_contact, 7, sideways)
    assert (found.wrong_rays, found.wrong_moves) == (0, 0)
    assert found.met > 20
    assert found.grazing <= 1e-4 * found.rays
    assert found.close <= 0.01 * found.moves


@pytest.mark.parametrize("preset", [DEFAULT, DRIVE])
@pytest.mark.parametrize("mode", AutoresetMode)
def test_it_conforms_in_every_autoreset_mode(mode, preset):
    check_vector_env(make(num_envs=3, autoreset_mode=mode, preset=preset, max_episode_steps=20), steps=60)


def test_its_autoreset_modes_give_the_same_episodes():
    check_autoreset_modes(lambda mode: make(num_envs=3, autoreset_mode=mode, max_episode_steps=20), steps=60)


@pytest.mark.filterwarnings("ignore:.*already been instantiated.*", "ignore:.*Box.*")
def test_gymnasium_finds_nothing_wrong_with_the_single_environment():
    env = gymnasium.make("Vitruvius/House-v0", backend="free", render_mode="rgb_array")
    check_env(env.unwrapped)
    with pytest.raises(ValueError, match=r"an action must be two numbers, \(v, w\), not an"):
        env.unwrapped.step(2)


def test_a_trajectory_depends_neither_on_the_batch_nor_on_the_loop():
    rough = replace(DEFAULT, noise=0.02, angle_noise=1.0, latency=2, slip=0.02, dropout=0.02)
    actions = plan(make(), 60)
    whole = walked(make(preset=rough, max_episode_steps=40), actions)
    by_ray = walked(make(preset=rough, max_episode_steps=40, by_ray=True), actions)
    single = walked(make(preset=rough, max_episode_steps=40, num_envs=1), actions[:, 5:6], seed=5)
    for ours, theirs, one in zip(whole, by_ray, single, strict=True):
        np.testing.assert_array_equal(ours, theirs)
        np.testing.assert_array_equal(ours[:, 5:6], one)
    assert whole[3].mean() > 0.05
    assert whole[2].sum() > 0


def test_a_saved_state_goes_on_bit_for_bit_also_in_another_environment():
    rough = replace(
        DEFAULT, latency=3, observe=("rays", "bump", "odometry", "goal", "speed"), flat=True, drift=0.1
    )
    envs, other = make(preset=rough), make(preset=rough)
    actions = plan(envs, 40)
    envs.reset(seed=0)
    for action in actions[:20]:
        envs.step(action)
    other.state = envs.state
    for action in actions[20:]:
        np.testing.assert_array_equal(envs.step(action)[0], other.step(action)[0])
    for name in ("speeds", "odometer", "past_reals"):
        state = envs.state
        state[name][:, 1] = np.nan
        with pytest.raises(ValueError, match=r"the state is invalid: .* not a finite number"):
            envs.state = state


def test_tensors_and_arrays_are_the_same_actions():
    ours, theirs = make(), make()
    ours.reset(seed=0), theirs.reset(seed=0)
    for action in plan(ours, 10):
        seen = ours.step(action)[0]
        np.testing.assert_array_equal(seen, theirs.step_torch(torch.from_numpy(action))[0].numpy())


def test_speeds_come_as_near_to_what_is_told_as_the_limits_let_them():
    """Compare with the same motion in float64, in an empty room."""
    drive = Drive(
        time_step=0.05, speed=0.8, reverse=0.3, turn_speed=2.0, acceleration=1.5, turn_acceleration=8.0
    )
    config = replace(DEFAULT, drive=drive, observe=("speed", "rays"))
    envs = make(houses=[EMPTY], preset=config)
    rng = np.random.default_rng(0)
    pose = np.column_stack([rng.uniform(3, 6, (32, 2)), rng.uniform(0, 2 * np.pi, 32)])
    _, info = envs.reset(seed=0, options={"house": np.zeros(32, int), "pose": pose})
    x, y, heading = info["pose"].astype(float).T
    v, w = np.zeros(32), np.zeros(32)
    for _ in range(60):
        told = np.column_stack([rng.uniform(-0.3, 0.8, 32), rng.uniform(-2, 2, 32)]).astype(np.float32)
        seen, _, _, _, info = envs.step(told)
        v += np.clip(told[:, 0] - v, -1.5 * 0.05, 1.5 * 0.05)
        w += np.clip(told[:, 1] - w, -8 * 0.05, 8 * 0.05)
        # An arc, or without a turn a line.
        end, turns = heading + w * 0.05, np.abs(w) > 1e-6
        radius = v / np.where(turns, w, 1)
        x += np.where(turns, radius * (np.sin(end) - np.sin(heading)), v * 0.05 * np.cos(heading))
        y += np.where(turns, radius * (np.cos(end) - np.cos(heading)), -v * 0.05 * np.sin(heading))
        heading = end
        np.testing.assert_allclose(seen["speed"], np.column_stack([v, w]), atol=1e-5)
        np.testing.assert_allclose(info["pose"][:, :2], np.column_stack([x, y]), atol=2e-5)
        np.testing.assert_allclose(np.angle(np.exp(1j * (info["pose"][:, 2] - heading))), 0, atol=2e-5)
        assert (info["pose"][:, 2] >= 0).all()
        assert (info["pose"][:, 2] < 2 * np.pi).all()


def test_what_a_body_touches_takes_its_speed():
    config = replace(DEFAULT, observe=("speed",), drive=Drive(acceleration=float("inf"), at_contact="stop"))
    envs = make(houses=[EMPTY], num_envs=2, preset=config)
    envs.reset(seed=0, options={"house": [0, 0], "pose": [[4.5, 0.16, np.pi / 2], [4.5, 4.5, 0.0]]})
    seen, _, _, _, info = envs.step(np.array([[0.7, 0.0], [0.7, 0.0]], np.float32))
    assert info["blocked"].tolist() == [True, False]
    reached = 0.16 - DEFAULT.body[0] / 2
    np.testing.assert_allclose(seen["speed"][:, 0], [reached / 0.1, 0.7], atol=1e-3)
    seen, _, _, _, info = envs.step(np.array([[0.7, 0.0], [0.7, 0.0]], np.float32))
    assert abs(seen["speed"][0, 0]) < 1e-3
    np.testing.assert_allclose(info["pose"][0, :2], [4.5, DEFAULT.body[0] / 2], atol=2e-5)


def test_lists_lose_no_line_at_any_heading():
    """Rays over 120 degrees, whose lists are by sectors, equal those among rays all around, bit for bit."""
    wide = replace(DEFAULT, rays=120, first_ray=178.5, ray_spacing=3)
    narrow, around = make(num_envs=400), make(num_envs=400, preset=wide)
    actions = plan(narrow, 30)
    ours, theirs = walked(narrow, actions), walked(around, actions)
    np.testing.assert_array_equal(ours[1], theirs[1])
    np.testing.assert_array_equal(ours[0], theirs[0][:, :, 40:80])


def test_late_rays_are_those_of_some_steps_before():
    actions = plan(make(), 30)
    now, late = walked(make(), actions), walked(make(preset=replace(DEFAULT, latency=4)), actions)
    np.testing.assert_array_equal(now[1], late[1])
    np.testing.assert_array_equal(now[0][:-4], late[0][4:])
    for k in range(4):
        np.testing.assert_array_equal(now[0][0], late[0][k])


def test_late_rays_are_those_of_some_steps_before_on_a_lattice_too():
    ours, late = (
        make(houses=HOUSES[:3], backend="continuous", preset=replace(DEFAULT, latency=latency))
        for latency in (0, 3)
    )
    rows = np.random.default_rng(0).choice(3, p=[0.2, 0.2, 0.6], size=(20, 32))
    now, then = walked(ours, rows), walked(late, rows)
    np.testing.assert_array_equal(now[0][:-3], then[0][3:])


def test_noise_of_directions_is_normal_and_cut():
    """Compare the places where rays meet a long wall, within four standard errors."""
    config = replace(DEFAULT, rays=1, first_ray=0.0, angle_noise=2.0)
    envs = make(houses=[EMPTY], num_envs=20_000, preset=config)
    pose = np.tile([4.5, 4.5, 0.0], (20_000, 1))
    seen, _ = envs.reset(
        seed=0, options={"house": np.zeros(20_000, int), "pose": pose, "target": 0 * pose[:, :2]}
    )
    angle = np.rad2deg(np.arccos(np.minimum(1, 4.5 / (seen[:, 0, 0] * config.range))))
    assert angle.max() < 8.05
    assert (angle**2).mean() == pytest.approx(4, rel=4 * np.sqrt(2 / 20_000))


def test_targets_lie_clear_of_walls_at_an_angle_and_bodies_start_clear_of_them():
    bank = [with_slanted_walls(seed) for seed in range(8)]
    envs = make(houses=bank, num_envs=8)
    _, info = envs.reset(seed=0, options={"house": np.arange(8)})
    for k, house in enumerate(bank):
        solids, here = Solids(house), envs.world.places[k]
        places = envs.world.lattices[k].origin + envs.config.step * here.targets
        half = envs.config.target / 2 - 1e-5
        squares = shapely.box(*(places - half).T, *(places + half).T)
        assert len(places) > 50
        assert not shapely.intersects(squares, solids.all).any()
        assert solids.away(info["pose"][k, None, :2])[0] > envs.config.body[0] / 2 - 2e-5


def test_a_target_is_picked_up_where_the_disc_overlaps_its_square():
    envs, near = make(houses=[EMPTY], num_envs=4), DEFAULT.target / 2
    away = (DEFAULT.body[0] / 2) / np.sqrt(2)
    spots = np.array([[near + away - 1e-3] * 2, [near + away + 1e-3] * 2, [near, 0.0], [0.0, 1.0]])
    pose = np.column_stack([4.5 + spots, np.zeros(4)])
    envs.reset(seed=0, options={"house": [0] * 4, "pose": pose, "target": [[4.5, 4.5]] * 4})
    _, reward, *_ = envs.step(np.zeros((4, 2), np.float32))
    assert reward.tolist() == [1, 0, 1, 0]


def test_wrong_actions_are_refused_before_anything_moves():
    envs = make()
    envs.reset(seed=0)
    before, given = envs.state, np.zeros((32, 2), np.float32)
    given[31, 0] = -0.1
    with pytest.raises(ValueError, match=re.escape("action 31 is (-0.1, 0): v from 0 to 0.7 m/s")):
        envs.step(given)
    for name, values in envs.state.items():
        np.testing.assert_array_equal(values, before[name])


def test_actions_beyond_the_box_are_clipped_where_that_is_asked_for():
    clips = replace(DEFAULT, drive=Drive(clips=True))
    ours, theirs = make(preset=clips), make()
    ours.reset(seed=0), theirs.reset(seed=0)
    for action in plan(ours, 10):
        far = np.where(np.abs(action) > 0.5, 10 * action, action)
        low, high = np.array([0, -3], np.float32), np.array([0.7, 3], np.float32)
        np.testing.assert_array_equal(ours.step(far)[0], theirs.step(np.clip(far, low, high))[0])
    with pytest.raises(ValueError, match="action 0 is"):
        ours.step(np.full((32, 2), np.nan, np.float32))


def test_commands_are_a_discrete_choice_of_the_same_motions():
    ours, theirs = make(preset=DRIVE), make()
    assert ours.single_action_space == gymnasium.spaces.Discrete(15)
    ours.reset(seed=0), theirs.reset(seed=0)
    table = np.array(DRIVE.drive.commands, np.float32)
    for chosen in np.random.default_rng(0).integers(15, size=(20, 32)):
        np.testing.assert_array_equal(ours.step(chosen)[0], theirs.step(table[chosen])[0])
    with pytest.raises(ValueError, match="actions must be 0 to 14, not 0 to 15"):
        ours.step(np.arange(32) % 16)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            {"preset": replace(DEFAULT, observe=("last_action",))},
            "backend FreeMotion: there is no observation last",
        ),
        (
            {"targets": Collect(terms=Terms(progress=0.1))},
            "backend 'free' does not provide the distance to the",
        ),
        (
            {"backend": "continuous", "preset": replace(DEFAULT, observe=("speed",))},
            "backend Continuous: there",
        ),
        (
            {"backend": "continuous", "preset": replace(DEFAULT, ray_spacing=2.0)},
            "ray_spacing is 2 degrees",
        ),
        (
            {"backend": "grid", "preset": replace(DEFAULT, angle_noise=1.0)},
            "angle_noise is 1 degrees: only the backend free supports",
        ),
    ],
)
def test_what_it_lacks_is_refused_in_a_line_and_so_is_what_others_lack(arguments, message):
    with pytest.raises(ValueError, match=re.escape(message)) as error:
        make(**{"houses": [EMPTY]} | arguments)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("baseline", [Oracle, Searcher])
def test_baselines_of_a_lattice_are_refused_in_a_line(baseline):
    with pytest.raises(ValueError, match="counts grid steps: use the backend continuous or grid, not free"):
        baseline(make(houses=[EMPTY]))


def test_a_map_is_seen_as_the_continuous_backend_sees_it():
    taken = np.ones((40, 50), bool)
    taken[1:-1, 1:-1] = False
    for i, j in np.random.default_rng(0).integers(2, 34, (10, 2)):
        taken[i : i + 4, j : j + 4] = True
    ours, theirs = (
        make(houses=[House.from_grid(taken, 0.1)], backend=name) for name in ("free", "continuous")
    )
    _, info = theirs.reset(seed=0)
    options = {name: info[name] for name in ("house", "pose", "target")}
    seen, their_seen = (envs.reset(seed=0, options=options)[0] for envs in (ours, theirs))
    np.testing.assert_allclose(seen[..., 0], their_seen[..., 0], atol=2e-5 / DEFAULT.range)
    assert len(ours.geometries[0].filled)
