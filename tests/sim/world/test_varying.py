"""Values that differ between episodes: noise, lost rays, slips, drift, and limits of driving."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests import sample_houses
from vitruvius.sim import DEFAULT, Config, HouseVectorEnv
from vitruvius.sim.drive import COMMANDS, Drive

pytestmark = pytest.mark.second_part("kernels of what varies by episode")

HOUSES = sample_houses.RANDOM[:2]
DRAWN = sample_houses.drawn("aa+aa.bbb\n......+bb\n......bbb", cell=1.2)
COUNT, STEPS = 24, 40
FIELDS = {"noise": 0.05, "dropout": 0.1, "slip": 0.2, "drift": 0.1}


def played(config: Config, count: int = COUNT, **more: Any) -> list[np.ndarray]:
    """Return the observations and poses of all steps."""
    envs = HouseVectorEnv(HOUSES, count, preset=config, targets="all", **more)
    seen, info = envs.reset(seed=2)
    shown = []
    for actions in np.random.default_rng(0).choice(3, p=[0.1, 0.1, 0.8], size=(STEPS, COUNT)):
        shown.append(np.hstack([seen, info["pose"]]))
        seen, *_, info = envs.step(actions[:count])
    return shown


FLAT = replace(DEFAULT, observe=("rays", "odometry"), flat=True, steps=15)


def test_a_range_of_one_value_is_the_field():
    varied = tuple((name, value, value) for name, value in FIELDS.items())
    np.testing.assert_array_equal(played(replace(FLAT, **FIELDS)), played(replace(FLAT, varied=varied)))


def test_each_episode_has_its_own_value_a_function_of_its_seed_and_number():
    config = replace(FLAT, varied=(("noise", 0.0, 0.2), ("slip", 0.0, 0.5)))
    many, few = played(config), played(config, 3)
    np.testing.assert_array_equal(np.array(many)[:, :3], few)
    exact = HouseVectorEnv(HOUSES, 1024, targets="all")
    noisy = HouseVectorEnv(
        HOUSES, 1024, targets="all", preset=replace(DEFAULT, varied=(("noise", 0.0, 0.2),))
    )
    spread = []
    for _ in range(2):
        seen = [envs.reset(seed=None if spread else 5)[0][..., 0] for envs in (noisy, exact)]
        errors = (seen[0] - seen[1]) * DEFAULT.range
        inside = (seen[1] < 0.9) & (seen[1] > 0.1)
        squares = (errors**2 * inside).sum(1) / np.maximum(1, inside.sum(1))
        spread.append(np.where(inside.sum(1) > 15, np.sqrt(squares), 0.1))
    assert 0.09 < spread[0].mean() < 0.11
    assert spread[0].std() > 0.04  # uniform from 0 to 0.2 has 0.058
    assert abs(np.corrcoef(*spread)[0, 1]) < 0.1


def test_a_body_makes_shares_of_what_it_is_told_and_of_its_acceleration():
    quick = Drive(commands=COMMANDS, acceleration=2.0, turn_acceleration=12.0)
    slow = Drive(
        commands=tuple((0.5 * v, 0.5 * w) for v, w in COMMANDS), acceleration=0.5, turn_acceleration=3.0
    )
    base = replace(DEFAULT, observe=("rays", "speed"), flat=True)
    varied = ("speed", 0.5, 0.5), ("acceleration", 0.25, 0.25)
    shares = played(replace(base, drive=quick, varied=varied), backend="free")
    np.testing.assert_array_equal(shares, played(replace(base, drive=slow), backend="free"))


@pytest.mark.parametrize("backend", ["continuous", "free"])
def test_a_body_of_a_share_of_its_width_moves_as_one_that_is_so_wide(backend):
    """Starts and places of targets may differ; a disc's skin is scaled with its width, too."""
    narrow = tuple(0.5 * side for side in DEFAULT.body)
    eye = tuple(0.5 * side for side in narrow)
    drive = Drive(commands=COMMANDS) if backend == "free" else DEFAULT.drive
    plan = np.random.default_rng(4).choice(3, p=[0.1, 0.1, 0.8], size=(120, COUNT))
    made = [
        HouseVectorEnv(HOUSES, COUNT, preset=preset, targets="all", backend=backend)
        for preset in (
            replace(DEFAULT, drive=drive, varied=(("width", 0.5, 0.5),)),
            replace(DEFAULT, drive=drive, body=narrow, eye=eye),
        )
    ]
    _, info = made[0].reset(seed=1)
    made[1].reset(seed=1, options={name: info[name] for name in ("house", "pose", "target")})
    on, bumps, differing = np.ones(COUNT, bool), 0, np.zeros(COUNT)
    for actions in plan:
        (_, reward, *_, info), (_, other, *_, same) = (envs.step(actions) for envs in made)
        np.testing.assert_allclose(info["pose"][on], same["pose"][on], atol=2e-3 * (backend == "free") + 1e-5)
        np.testing.assert_array_equal(reward[on], other[on])
        bumps, differing = bumps + info["blocked"][on].sum(), differing + (info["blocked"] ^ same["blocked"])
        on &= reward == 0  # the next target lies elsewhere
    assert bumps > COUNT
    assert differing[on].sum() <= 0.02 * bumps * (backend == "free")
    assert 0 < on.sum() < COUNT


@pytest.mark.parametrize(
    ("varied", "message"),
    [
        ([("nose", 0, 1)], "did you mean noise"),
        ([("noise", 0.2, 0.1)], "noise from 0.2 to 0.1"),
        ([("slip", 0.0, 1.5)], "between 0 and 1"),
        ([("noise", 0.0)], "must have 3 values"),
        ([("noise", 0, 1), ("noise", 0, 2)], "each field once"),
        ([("noise", 0, float("nan"))], "noise from 0 to nan"),
        ([("width", 0.5, 1.5)], "between 0 and 1"),
    ],
)
def test_wrong_ranges_are_refused(varied, message):
    with pytest.raises(ValueError, match=message):
        Config(varied=varied)


def test_a_width_that_differs_is_refused_where_another_is_counted_on():
    varied = (("width", 0.5, 1.0),)
    with pytest.raises(ValueError, match="varied: width cannot vary together with closed doors"):
        Config(varied=varied, closed_doors=4)
    with pytest.raises(ValueError, match="varied: robots of this backend have a fixed width: use"):
        HouseVectorEnv([DRAWN], preset=Config(varied=varied), backend="grid")
    with pytest.raises(ValueError, match="to the target needs a body of fixed width"):
        HouseVectorEnv(
            HOUSES, preset=Config(varied=varied), targets={"task": "all", "terms": {"progress": 1}}
        )


def test_only_a_body_that_drives_has_a_speed():
    with pytest.raises(ValueError, match="varied: robots of this backend do not drive: speed"):
        HouseVectorEnv(HOUSES, preset=Config(varied=(("speed", 0.5, 1.0),)))
