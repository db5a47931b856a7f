"""Invariants of any house: mirrored and turned houses, walls at any speed, memory bounds."""

import os
import sys
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace as changed

from tests import sample_houses
from tests.logic.house.handmade import turned_house
from tests.programs import finished
from tests.reference import Boxes, sides
from vitruvius.logic import House, Piece, Rect, StarRoom
from vitruvius.sim import DEFAULT, HouseVectorEnv
from vitruvius.sim.actions import FORWARD, LEFT, RIGHT

SEEING = replace(DEFAULT, sees_kind=True)
EACH, STEPS = 200, 60
HOUSES = [sample_houses.random_house(seed, original) for seed in (20, 21) for original in (False, True)]
Placed = TypeVar("Placed", bound=Rect)


def mirrored(rect: Placed) -> Placed:
    """Return the mirror image of a rectangle and its contents: x becomes -x."""
    changes: dict = {"x": -rect.x - rect.width}
    if isinstance(rect, StarRoom | Piece):
        changes["children"] = tuple(mirrored(child) for child in rect.children)
    if isinstance(rect, StarRoom):
        changes["door"] = mirrored(rect.door)
    return changed(rect, **changes)


def mirrored_house(house: House) -> House:
    rooms = tuple(mirrored(room) for room in house.star.rooms)
    return sample_houses.changed_star(house, floor=mirrored(house.star.floor), rooms=rooms)


class Change:
    """Transformation of a house, and of places (..., 2), headings, actions and rays in it."""

    def __init__(self, mirror: bool, quarters: int) -> None:
        self.mirror, self.quarters = mirror, quarters

    def house(self, house: House) -> House:
        return turned_house(mirrored_house(house) if self.mirror else house, self.quarters)

    def place(self, place: np.ndarray) -> np.ndarray:
        x, y = np.moveaxis(place, -1, 0)
        x = -x if self.mirror else x
        for _ in range(self.quarters):
            x, y = -y, x
        return np.stack([x, y], axis=-1)

    def pose(self, pose: np.ndarray) -> np.ndarray:
        heading = np.round(pose[..., 2] / (np.pi / 4))
        heading = (4 - heading if self.mirror else heading) - 2 * self.quarters
        return np.concatenate([self.place(pose[..., :2]), heading[..., None] % 8 * np.pi / 4], axis=-1)

    def actions(self, actions: np.ndarray) -> np.ndarray:
        return np.array([RIGHT, LEFT, FORWARD])[actions] if self.mirror else actions

    def seen(self, seen: np.ndarray) -> np.ndarray:
        return seen[..., ::-1, :] if self.mirror else seen


CHANGES = {
    "mirrored": Change(True, 0),
    "turned": Change(False, 1),
    "turned three times": Change(False, 3),
    "mirrored and turned": Change(True, 2),
}


def walk(envs: HouseVectorEnv, house: np.ndarray, pose: np.ndarray, target: np.ndarray, plan: np.ndarray):
    """Return the outputs of each step of a plan (T, E): observations, poses, blocked, and pick-ups."""
    seen, info = envs.reset(seed=0, options={"house": house, "pose": pose, "target": target})
    rows = [(seen, info["pose"], info["blocked"], np.zeros(len(pose), bool))]
    for actions in plan:
        seen, reward, _, _, info = envs.step(actions)
        rows.append((seen, info["pose"], info["blocked"], reward > 0))
    return tuple(np.stack(column) for column in zip(*rows, strict=True))


@pytest.fixture(scope="module")
def envs():
    return HouseVectorEnv(HOUSES, num_envs=EACH * len(HOUSES), preset=SEEING)


@pytest.fixture(scope="module")
def walked(envs):
    """Return walks in the unchanged houses, along walls and into them."""
    rng = np.random.default_rng(0)
    envs.set_houses(HOUSES)
    pose = np.concatenate([sample_houses.free_poses(house, EACH, seed=5) for house in HOUSES])
    pose[:, :2] = pose[:, :2].astype(np.float32)
    target = (pose[:, :2] + rng.uniform(-2, 2, (len(pose), 2))).astype(np.float32)
    plan = rng.choice(3, p=[0.1, 0.1, 0.8], size=(STEPS, len(pose)))
    house = np.repeat(np.arange(len(HOUSES)), EACH)
    return house, pose, target, plan, walk(envs, house, pose, target, plan)


@pytest.mark.parametrize("name", CHANGES)
def test_rays_and_moves_mirror_and_turn_with_the_house(envs, walked, name):
    change = CHANGES[name]
    house, pose, target, plan, (seen, poses, blocked, picked) = walked
    envs.set_houses([change.house(one) for one in HOUSES])
    theirs = walk(envs, house, change.pose(pose), change.place(target), change.actions(plan))
    np.testing.assert_array_equal(theirs[2], blocked)
    assert 0.05 < blocked.mean() < 0.8
    there = change.pose(poses)
    np.testing.assert_allclose(theirs[1][..., :2], there[..., :2], atol=1e-5)
    turn = np.round((theirs[1][..., 2] - there[..., 2]) / (np.pi / 4)) % 8
    assert not turn.any()
    np.testing.assert_array_equal(theirs[3][0], picked[0])
    # The next target is drawn on the house's own lattice; until then all observations are the same.
    before = picked.cumsum(axis=0) == 0
    assert picked.any()
    np.testing.assert_array_equal(theirs[3] & before, picked & before)
    ours, theirs = change.seen(seen)[before], theirs[0][before]
    # Of the rays that graze an end of a line, some meet the line in one house and miss it in the other.
    same = np.abs(ours - theirs).max(axis=-1) < 1e-6
    assert (~same).mean() < 1e-4


@pytest.fixture(scope="module")
def fast():
    """Return environments of bodies with steps of more than a metre."""
    return HouseVectorEnv(HOUSES, num_envs=EACH, preset=replace(DEFAULT, body=(0.1, 0.1), step=1.1))


def crossed(boxes: Boxes, old: np.ndarray, new: np.ndarray) -> np.ndarray:
    """Return a mask of the straight paths (N,) that cross walls or sides of furniture, by signs of areas."""
    lines = np.concatenate([sides(boxes.walls), sides(boxes.pieces).reshape(-1, 2, 2)])

    def side(a, b, c):
        return np.sign(
            (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1])
            - (b[..., 1] - a[..., 1]) * (c[..., 0] - a[..., 0])
        )

    p, q, a, b = old[:, None], new[:, None], lines[:, 0], lines[:, 1]
    return ((side(p, q, a) * side(p, q, b) < 0) & (side(a, b, p) * side(a, b, q) < 0)).any(axis=1)


@settings(max_examples=20)
@given(seed=st.integers(0, 2**32))
def test_no_body_crosses_a_wall_at_any_speed(fast, seed):
    _, info = fast.reset(seed=seed)
    house, boxes = info["house"], [Boxes.of(shape) for shape in fast.world.bank.geometries]
    rng, went = np.random.default_rng(seed), 0
    for _ in range(20):
        old = info["pose"][:, :2].astype(float)
        info = fast.step(rng.choice(3, p=[0.2, 0.2, 0.6], size=EACH))[4]
        new = info["pose"][:, :2].astype(float)
        for k, here in enumerate(boxes):
            assert not crossed(here, old[house == k], new[house == k]).any()
        went += (np.abs(new - old).max(axis=1) > 1).sum()
    assert went > 100


CHECKED = """
import numpy as np
from vitruvius.sim.runtime import Array, Launch, ti

ti.init(arch=ti.cpu, debug=True, fast_math=False, cfg_optimization=False, log_level=ti.ERROR)

from vitruvius.sim import Config, HouseVectorEnv, Oracle
from tests import sample_houses

houses = [sample_houses.drawn(sample_houses.ONE_ROOM, cell=0.8)] * 2
for backend, by_ray in (("continuous", False), ("grid", True)):
    envs = HouseVectorEnv(
        houses, num_envs=8, backend=backend, targets="mixed", preset=Config(sees_kind=True),
        max_episode_steps=9, autoreset_mode="SameStep", by_ray=by_ray,
    )
    envs.reset(seed=0)
    for actions in np.random.default_rng(0).choice(3, p=[0.1, 0.1, 0.8], size=(20, 8)):
        envs.step(actions)
    envs.targets(3)
    Oracle(envs).act()
    ti.sync()
    print("no fault")


@ti.kernel
def fault(numbers: ti.types.ndarray(ti.f32, 1)):
    for k in range(1):
        numbers[numbers.shape[0] + k] = 1.0


try:
    Launch(fault, {"numbers": Array(ti.f32, 8)})()
    ti.sync()
except (AssertionError, RuntimeError) as error:
    print("a fault", error)
"""


@pytest.mark.second_part("kernels with every bound checked")
def test_nothing_is_read_or_written_out_of_bounds(tmp_path):
    """Taichi's own checks are on, for both backends and both loops; a deliberate fault shows it."""
    program = tmp_path / "checked.py"
    program.write_text(CHECKED)
    root = str(Path(__file__).parents[3])
    done = finished([sys.executable, program], env=os.environ | {"PYTHONPATH": root})
    assert done.returncode == 0, done.stderr
    assert 2 * "no fault\n" + "a fault" in done.stdout, done.stdout + done.stderr
    assert "bound" in done.stdout
