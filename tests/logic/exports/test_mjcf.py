"""A house in MuJoCo: its range finders see what the simulator's rays see, and walls stop the robot."""

# mujoco has no type stubs.
# pyright: reportAttributeAccessIssue=false

from xml.etree.ElementTree import tostring

import mujoco
import numpy as np
import pytest

from tests.sample_houses import RANDOM, example
from vitruvius.agent.banks import benchmark
from vitruvius.logic import FreeWall, House, Room
from vitruvius.logic.exports.mjcf import EYE_HEIGHT_M, to_mjcf
from vitruvius.logic.grammar import SHIPPED, shipped
from vitruvius.logic.looks.looks import folder_looks
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.config import DEFAULT

CELLS = np.zeros((30, 50), bool)
CELLS[[0, -1]] = CELLS[8:20, 20:26] = True
HOUSES = [*benchmark("home-test-v1")[3:5], RANDOM[0], example(), House.from_grid(CELLS, 0.1)]


def loaded(house: House) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """Return a house in MuJoCo, with its robot at the start."""
    model = mujoco.MjModel.from_xml_string(tostring(to_mjcf(house)).decode())
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def test_range_finders_see_what_the_simulators_rays_see() -> None:
    """They agree to 1e-4 m, except for rays that end on the target, which is absent from MuJoCo's house."""
    env = HouseVectorEnv(HOUSES, num_envs=64, targets="all")
    observation, info = env.reset(seed=3)
    for number, house in enumerate(HOUSES):
        model, data = loaded(house)
        start = model.body("robot").pos.copy()
        for index in np.flatnonzero(info["house"] == number):
            x, y, heading = info["pose"][index]
            data.qpos[:] = x - start[0], -y - start[1], heading
            mujoco.mj_forward(model, data)
            seen = np.where(data.sensordata < 0, DEFAULT.range, np.minimum(data.sensordata, DEFAULT.range))
            others = observation[index, :, 1] == 0
            ours = observation[index, :, 0] * DEFAULT.range
            np.testing.assert_allclose(seen[others], ours[others], atol=1e-4)


def test_range_finders_see_walls_at_any_angle() -> None:
    """The comparison is with robots that drive, whose rays are the same."""
    walls = FreeWall(0.7, 0.5, 2.6, 1.9, 0.12), FreeWall(0.5, 2.5, 1.5, 2.2, 0.0)
    house = House((Room(0, 0, 4, 3, "R0", "hall"),), hub="R0", topology="own", free_walls=walls)
    env = HouseVectorEnv([house], num_envs=16, backend="free", targets="all")
    observation, info = env.reset(seed=0)
    model, data = loaded(house)
    start = model.body("robot").pos.copy()
    for (x, y, heading), rays in zip(info["pose"], observation, strict=True):
        data.qpos[:] = x - start[0], -y - start[1], heading
        mujoco.mj_forward(model, data)
        others = rays[:, 1] == 0
        seen = np.minimum(data.sensordata, DEFAULT.range)
        np.testing.assert_allclose(seen[others], rays[others, 0] * DEFAULT.range, atol=1e-4)


@pytest.mark.parametrize("house", HOUSES, ids=["home", "home", "star", "original", "map"])
def test_the_robot_starts_free_drives_and_is_stopped_by_walls(house: House) -> None:
    model, data = loaded(house)
    assert data.ncon == 0
    start = model.body("robot").pos[0]
    for _ in range(2000):  # 10 s at 1 m/s
        data.ctrl[:] = 1.0, 0.0, 0.0
        mujoco.mj_step(model, data)
    assert data.qpos[0] > 0.05
    assert start + data.qpos[0] < max(other.box[2] for other in house.rooms)
    assert np.isfinite(data.sensordata).all()
    assert data.ncon > 0


def test_range_finders_are_lower_than_all_furniture() -> None:
    for grammar in shipped():
        assert min(folder_looks(SHIPPED / grammar).heights.values()) > EYE_HEIGHT_M
