"""The searcher that drives: its posterior by shapely's lines of sight, and what it does with it. 20 s."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from logic import House
from sim import DEFAULT, HouseVectorEnv
from sim.baselines import roadmap
from sim.baselines.bound import TimeBound
from sim.baselines.coverage import WORD
from sim.baselines.driving_searcher import DrivingSearcher
from sim.baselines.posterior import DONE, KNOWN
from sim.baselines.true_path import TruePath
from sim.config import DRIVE, Config
from sim.drive import Drive
from sim.world.episodes import FOUND
from tests import sample_houses
from tests.sim.backends.free_study import Solids, houses, with_slanted_walls

BOX, COMMANDS = replace(DEFAULT, steps=600), replace(DRIVE, steps=600)
AROUND = replace(BOX, rays=60, first_ray=180.0, ray_spacing=6.0, range=4.0)
STOPS = replace(BOX, drive=Drive(at_contact="stop", reverse=0.5))
POOR = replace(COMMANDS, noise=0.1, dropout=0.3, angle_noise=5.0, latency=3)


def begun(bank: list[House], count: int, targets: str = "secondary", config: Config = BOX):
    """Environments in the houses of a bank, one after the other, and their searcher."""
    envs = HouseVectorEnv(bank, count, backend="free", targets=targets, preset=config)
    envs.reset(seed=3, options={"house": np.arange(count) % len(bank)})
    return envs, DrivingSearcher(envs)


def left_of(searcher: DrivingSearcher, e: int, count: int) -> np.ndarray:
    """Which of its house's spots (count,) an environment's target may still be at, bool."""
    words = searcher.arrays["left"].view().reshape(searcher.world.num_envs, -1)[e].astype("<u8")
    return np.unpackbits(words.view(np.uint8), bitorder="little")[:count].astype(bool)


def knows(searcher: DrivingSearcher) -> np.ndarray:
    """Which environments (E,) have seen their target."""
    return searcher.arrays["notes"].view()[:, KNOWN] == 1


class Looks:
    """Which spots of a house a look shows, by shapely."""

    def __init__(self, house: House, spots: np.ndarray, config: Config) -> None:
        self.solids, self.spots, self.config = Solids(house), spots, config

    def show(self, pose: np.ndarray, margin: float) -> np.ndarray:
        """Of targets whose sides are shorter by twice a margin, those (m,) that a ray or the body meets."""
        angles = pose[2] + self.config.ray_angles
        eyes = np.tile(pose[:2], (len(angles), 1))
        length = self.solids.seen(eyes, angles, self.config.range)
        ends = eyes + length[:, None] * np.column_stack([np.cos(angles), -np.sin(angles)])
        rays = shapely.MultiLineString(np.stack([eyes, ends], axis=1).tolist())
        body = shapely.Point(*pose[:2]).buffer(self.config.body[0] / 2 - margin, quad_segs=64)
        half = self.config.target / 2 - margin
        squares = shapely.box(*(self.spots - half).T, *(self.spots + half).T)
        shapely.prepare([rays, body])
        return shapely.intersects(rays, squares) | shapely.intersects(body, squares)


@pytest.mark.parametrize(
    ("house", "targets", "config"),
    [
        (sample_houses.random_house(3), "secondary", BOX),
        (sample_houses.random_house(6), "mixed", AROUND),
        (with_slanted_walls(5), "all", BOX),
        (with_slanted_walls(9), "all", AROUND),
    ],
    ids=["rooms", "all around", "slanted", "slanted all around"],
)
def test_the_posterior_is_what_lines_of_sight_leave(house, targets, config):
    """Every step until some targets are found; but for spots whose edge a ray comes within 0.2 mm of."""
    envs, searcher = begun([house], 1, targets, config)
    spots, step = envs.world.places[0].targets, config.step
    where = envs.world.lattices[0].origin + step * spots
    looks, apart = Looks(house, where, config), config.target + max(config.body)
    surely = perhaps = np.ones(len(spots), bool)  # left, by a target a little larger, and smaller
    found, last, compared = 0, None, 0
    for _ in range(400):
        action, info = searcher.act(), envs.info()
        pose, target = info["pose"][0].astype(float), info["target"][0]
        now = envs.world.state["wholes"][0, FOUND]
        if now != found:
            near = np.zeros(len(spots), bool)
            if last is not None:
                near = (np.abs(where - last) < apart - 1e-4).all(axis=1)
            surely, perhaps, found, last = ~near, ~near, now, target
        if not knows(searcher)[0]:
            surely, perhaps = surely & ~looks.show(pose, -1e-4), perhaps & ~looks.show(pose, 1e-4)
            left = left_of(searcher, 0, len(spots))
            assert (surely <= left).all()
            assert (left <= perhaps).all()
            assert (surely != perhaps).mean() < 0.05
            compared += 1
        if (found > 1 and compared > 12) or compared > 70:
            break
        envs.step(action)
    assert compared > 5
    assert found > 1


@pytest.mark.parametrize(
    ("targets", "config"),
    [("main", BOX), ("secondary", COMMANDS), ("mixed", AROUND), ("all", STOPS)],
    ids=["main", "commands", "all around", "stops"],
)
def test_a_target_is_never_struck_out_before_it_is_seen(targets, config):
    bank = houses(6, seed=40) if targets == "all" else [sample_houses.random_house(k) for k in range(6)]
    envs, searcher = begun(bank, 12, targets, config)
    found = 0
    for _ in range(400):
        action, places = searcher.act(), envs.world.state["reals"][:, 2:]
        for e, known in enumerate(knows(searcher)):
            if not known:
                spots, lattice = searcher.prior.spots[e % 6], envs.world.lattices[e % 6]
                place = np.rint((places[e] - lattice.origin) / config.step)
                assert left_of(searcher, e, len(spots))[(spots == place).all(axis=1)].all()
        found += envs.step(action)[1].sum()
    assert found > 24


@pytest.mark.parametrize(
    ("targets", "config", "least"),
    [("secondary", BOX, 0.5), ("mixed", COMMANDS, 0.5), ("all", STOPS, 0.35)],
    ids=["slide", "commands", "stop"],
)
def test_it_stays_below_the_bound_and_is_not_far_from_it(targets, config, least):
    bank = houses(12, seed=80) if targets == "all" else [sample_houses.random_house(k) for k in range(12)]
    envs, searcher = begun(bank, 12, targets, config)
    bound, found = TimeBound(envs).most(), np.zeros(12)
    for _ in range(config.steps):
        found += envs.step(searcher.act())[1]
    assert (found <= bound).all()
    assert found.sum() >= least * bound.sum()


def test_once_it_has_seen_the_target_it_drives_as_who_knows_it():
    envs, searcher = begun([sample_houses.random_house(k) for k in range(4)], 16, "mixed")
    path, alike = TruePath(envs), 0
    for _ in range(200):
        action, known = searcher.act(), knows(searcher)
        np.testing.assert_array_equal(action[known], path.act()[known])
        alike += known.sum()
        envs.step(action)
    assert alike > 400


def actions(bank: list[House], count: int, config: Config) -> np.ndarray:
    """What the first of so many bodies is told in 250 steps."""
    envs, searcher = begun(bank[: 1 if count == 1 else None], count, "mixed", config)
    made = []
    for _ in range(250):
        made.append(searcher.act())
        envs.step(made[-1])
    return np.array(made)[:, 0]


@pytest.mark.parametrize("config", [BOX, COMMANDS], ids=["box", "commands"])
def test_it_does_the_same_alone_as_among_others(config):
    bank = [sample_houses.random_house(k) for k in range(4)]
    np.testing.assert_array_equal(actions(bank, 1, config), actions(bank, 40, config))


def test_it_looks_by_its_own_rays_and_not_by_those_that_are_shown():
    bank = [sample_houses.random_house(0)]
    np.testing.assert_array_equal(actions(bank, 1, COMMANDS), actions(bank, 1, POOR))


def test_it_begins_again_in_an_episode_that_it_knows():
    envs, searcher = begun([sample_houses.random_house(1)], 2)
    made = []
    for _ in range(2):
        envs.reset(seed=3, options={"house": np.zeros(2, int)})
        searcher.begin()
        for _ in range(120):
            made.append(searcher.act())
            envs.step(made[-1])
    np.testing.assert_array_equal(made[:120], made[120:])


def test_a_place_that_no_view_is_judged_by_is_driven_to():
    """As straight as by who knows that the target is there."""
    envs, searcher = begun([sample_houses.random_house(3)], 1)
    spots, lattice = searcher.prior.spots[0], envs.world.lattices[0]
    hidden = np.setdiff1d(np.arange(len(spots)), searcher.prior.samples[0])[-1]
    there = {"house": [0], "target": [lattice.origin + envs.config.step * spots[hidden]]}
    took = []
    for player in (searcher, TruePath(envs)):
        envs.reset(seed=3, options=there)
        if player is searcher:
            searcher.act()
            assert not knows(searcher)
            searcher.arrays["left"].view()[:] = 0
            searcher.arrays["left"].view()[hidden // WORD] = 1 << int(hidden % WORD)
            searcher.arrays["notes"].view()[0, DONE:] = 0  # it chooses again
        took.append(1)
        while not envs.step(player.act())[1]:
            took[-1] += 1
    assert 50 < took[1] <= took[0] <= took[1] + 5


@pytest.mark.parametrize(
    ("backend", "config", "message"),
    [
        ("continuous", BOX, "take the backend free, or a Searcher"),
        (
            "free",
            replace(BOX, drive=Drive(sideways=0.5)),
            "a searcher drives where its body heads: take a drive without sideways",
        ),
    ],
)
def test_bodies_that_do_not_drive_as_they_head_are_refused(backend, config, message):
    envs = HouseVectorEnv([sample_houses.random_house(0)], 1, backend=backend, preset=config)
    with pytest.raises(ValueError, match=message):
        DrivingSearcher(envs)


def test_a_house_of_too_many_corners_is_refused(monkeypatch):
    monkeypatch.setattr(roadmap, "MOST_CORNERS", 3)
    with pytest.raises(ValueError, match=r"house 0 of 1 has \d+ corners that paths may turn at: 3 at most"):
        begun([sample_houses.random_house(0)], 1)
