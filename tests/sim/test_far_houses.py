"""Houses up to 512 m from the origin: exact up to float32, and near the origin equal to small houses."""

from pathlib import Path

import numpy as np
import pytest
from msgspec import structs

from tests.plans import PLANS
from tests.reference import Reference, cast, sides
from vitruvius.logic import FreeWall, House, Room, load
from vitruvius.logic.drawing.draw import plan_svg
from vitruvius.logic.exports import export
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.backends.continuous.pack import _lines
from vitruvius.sim.backends.rays import EXACT, OVERLAP, overlap
from vitruvius.sim.geometry import geometry

pytestmark = pytest.mark.second_part("kernels for houses far from the origin")

AWAY = 489.9
"""Distance in metres, a multiple of the plans' cells of 0.3 m."""

ERROR = 8e-5
"""Largest error of a ray in metres across a line: rounding of the line and of the eye, and the overlap."""

EACH = 1000
BACKENDS = "continuous", "grid", "free"


def moved(house: House, east: float, south: float) -> House:
    """Return a house at another place."""

    def there(part):
        return structs.replace(part, x=round(part.x + east, 9), y=round(part.y + south, 9))

    rooms = [structs.replace(there(room), children=tuple(map(there, room.children))) for room in house.rooms]
    parts = {name: tuple(map(there, getattr(house, name))) for name in ("doors", "windows")}
    return structs.replace(house, rooms=tuple(rooms), **parts)


FAR = moved(PLANS["flat"], AWAY, -AWAY)
WING = Room(400.2, 0.0, 3.0, 3.0, "WING", "hall")


def angles(envs: HouseVectorEnv, pose: np.ndarray) -> np.ndarray:
    """Return the directions of all rays (E, R) in radians, from exact headings."""
    return np.round(4 / np.pi * pose[:, 2:].astype(float)) * (np.pi / 4) + envs.config.ray_angles


@pytest.mark.parametrize("backend", BACKENDS)
def test_rays_and_moves_far_from_the_origin_are_those_of_the_reference_in_float64(backend: str) -> None:
    envs = HouseVectorEnv([FAR], EACH, backend=backend, targets="all")
    reference, rng = Reference(FAR), np.random.default_rng(0)
    side = envs.config.body[0] - (2e-3 if backend == "grid" else 0)  # bodies on the grid touch walls
    lattice = envs.world.lattices[0]
    spots = lattice.origin.astype(float) + lattice.pitch * np.argwhere(np.ones(lattice.shape, bool))
    if backend != "grid":
        spots = spots + rng.uniform(0, 0.05, spots.shape)
    spots = np.array([each for each in rng.permutation(spots)[: 3 * EACH] if reference.is_free(each, side)])
    pose = np.column_stack([spots[np.arange(EACH) % len(spots)], rng.integers(8, size=EACH) * np.pi / 4])
    away = {"house": np.zeros(EACH, int), "pose": pose, "target": np.tile([AWAY, 90 - AWAY], (EACH, 1))}
    seen, info = envs.reset(seed=0, options=away)
    shape = geometry(FAR)
    lines = sides(
        np.hstack([shape.solids[:, :2] - shape.solids[:, 2:], shape.solids[:, :2] + shape.solids[:, 2:]])
    )
    eye, angle, equal = info["pose"][:, :2].astype(float), angles(envs, info["pose"]), 0
    steep = np.minimum(np.abs(np.cos(angle)), np.abs(np.sin(angle)))
    error = ERROR / np.where(steep < 1e-6, 1, steep)
    for e in range(EACH):
        near, far = (cast(lines, eye[e], angle[e], slack) for slack in (2 * ERROR, -2 * ERROR))
        ours = seen[e, :, 0].astype(float) * envs.config.range
        assert (ours > np.minimum(near, envs.config.range) - error[e]).all()
        assert (ours < np.minimum(far, envs.config.range) + error[e]).all()
        equal += (near == far).sum()
    assert equal > 0.99 * angle.size
    if backend == "free":
        return
    *_, after = envs.step(np.full(EACH, 2))
    way = np.round(np.column_stack([np.cos(pose[:, 2]), -np.sin(pose[:, 2])])) * envs.config.step
    expected = [reference.in_the_way(*ends, side) for ends in zip(eye, eye + way, strict=True)]
    known = np.array([each is not None for each in expected])
    np.testing.assert_array_equal(after["blocked"][known], np.array(expected, object)[known].astype(bool))
    assert known.mean() > 0.9
    assert 0.02 < after["blocked"].mean() < 0.9


@pytest.mark.parametrize("backend", ["continuous", "grid"])
def test_a_floor_of_500_by_500_m_is_read_drawn_and_simulated_up_to_its_corners(
    backend: str, tmp_path: Path
) -> None:
    made = House.from_grid(np.random.default_rng(0).random((41, 41)) < 0.2, 12.23)
    [floor] = load(export([made], tmp_path, "ros")[0])
    assert floor.occupancy
    assert made.occupancy
    assert floor.occupancy.rows == made.occupancy.rows
    assert floor.rooms[0].box == pytest.approx(made.rooms[0].box, abs=1e-9)
    assert plan_svg(floor).startswith("<svg")
    envs = HouseVectorEnv([floor], 200, backend=backend, targets="all", preset={"step": 2.4})
    seen, info = envs.reset(seed=0)
    eye, angle = info["pose"][:, :2].astype(float), angles(envs, info["pose"])
    upright, level = floor.walls
    walls = sides(np.array([*((x, a, x, b) for x, a, b in upright), *((a, y, b, y) for y, a, b in level)]))
    steep = np.minimum(np.abs(np.cos(angle)), np.abs(np.sin(angle)))
    error = ERROR / np.where(steep < 1e-6, 1, steep)
    apart = np.maximum(walls.min(axis=1) - eye[:, None], eye[:, None] - walls.max(axis=1)).max(axis=2)
    for e, near in enumerate(apart < 40):
        most, least = (cast(walls[near], eye[e], angle[e], slack) for slack in (-2 * ERROR, 2 * ERROR))
        ours, is_wall = seen[e, :, 0].astype(float) * envs.config.range, seen[e, :, 1] == 0
        assert (ours > np.minimum(least, envs.config.range) - error[e])[is_wall].all()
        assert (ours < np.minimum(most, envs.config.range) + error[e])[is_wall].all()
    for corner in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
        assert ((eye * corner).min(axis=1) > 150).any()


@pytest.mark.parametrize("axis", [0, 1])
def test_lines_cover_their_ends_however_far_they_are(axis: int) -> None:
    """Lines are extended in float32 by the rounding error of rays, and near the origin by a constant."""
    rng = np.random.default_rng(1)
    ends = np.sort(rng.uniform(-512, 512, (100_000, 2)))
    at = rng.uniform(-512, 512, len(ends))
    walls = np.column_stack([at, ends[:, 0], at, ends[:, 1]])[:, [axis, 1 - axis, 2 + axis, 3 - axis]]
    at, middle, half, _ = _lines(walls, np.zeros((0, 4)), [], axis).astype(float).T
    low, high = ends.astype(np.float32).astype(float).T
    spare = np.minimum(low - (middle - half), middle + half - high)
    reach = np.abs(np.column_stack([at, low, high])).max(axis=1)
    assert (spare > np.where(reach > EXACT, np.spacing(reach.astype(np.float32)), OVERLAP / 4)).all()
    assert set(overlap(walls[reach < EXACT])) == {OVERLAP}


@pytest.mark.parametrize("backend", ["continuous", "free"])
def test_rays_at_far_corners_do_not_leak(backend: str) -> None:
    """Eyes are placed where a ray meets a corner of their room."""
    envs = HouseVectorEnv([FAR], EACH, backend=backend, targets="all")
    rng, corners = np.random.default_rng(1), np.array([np.reshape(room.box, (2, 2)) for room in FAR.rooms])
    reference, poses, rays, ways = Reference(FAR), [], [], []
    side = envs.config.body[0] + 2e-3
    while len(poses) < EACH:
        room = corners[rng.integers(len(corners))]
        corner = np.array([room[rng.integers(2), 0], room[rng.integers(2), 1]])
        heading, ray, way = rng.integers(8), rng.integers(40), rng.uniform(0.3, 4.0)
        angle = heading * np.pi / 4 + envs.config.ray_angles[ray]
        eye = corner - way * np.array([np.cos(angle), -np.sin(angle)])
        if np.all((room[0] + side / 2 < eye) & (eye < room[1] - side / 2)) and reference.is_free(eye, side):
            poses.append([*eye, heading * np.pi / 4])
            rays.append(ray)
            ways.append(way)
    hidden = np.tile([AWAY, 90 - AWAY], (EACH, 1))
    options = {"house": np.zeros(EACH, int), "pose": np.array(poses), "target": hidden}
    seen = envs.reset(seed=0, options=options)[0][np.arange(EACH), rays, 0]
    assert (seen * envs.config.range < np.array(ways) + 1e-3).all()


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_house_with_a_far_wing_is_near_the_origin_bit_for_bit_the_house_without(backend: str) -> None:
    house, rng = PLANS["flat"], np.random.default_rng(2)
    whole = structs.replace(house, rooms=(*house.rooms, WING))
    some = {"num_envs": 64, "backend": backend, "targets": {"rooms": ["corridor"]}}
    small, large = HouseVectorEnv([house], **some), HouseVectorEnv([whole], **some)
    _, info = small.reset(seed=0)
    options = {"house": np.zeros(64, int), "pose": info["pose"], "target": np.full((64, 2), -20.0)}
    rows = [[envs.reset(seed=0, options=options)] for envs in (small, large)]
    for _ in range(150):
        actions = small.action_space.sample()
        if backend != "free":
            actions = rng.choice(3, 64, p=[0.15, 0.15, 0.7])
        for envs, told in zip((small, large), rows, strict=True):
            seen, _, _, _, now = envs.step(actions)
            told.append((seen, now))
    blocked = 0
    for (seen, now), (other, then) in zip(*rows, strict=True):
        np.testing.assert_array_equal(seen, other)
        for name in ("pose", "blocked"):
            np.testing.assert_array_equal(now[name], then[name])
        blocked += now["blocked"].sum()
    assert blocked > 0


def test_walls_at_an_angle_do_not_leak_far_from_the_origin() -> None:
    """Four walls form a ring, turned by some degrees, and each ends on the next one's line."""
    middle, turn = np.array([503.0, 503.0]), np.radians(20)
    ring = middle + 2 * np.array(
        [[np.cos(turn + k * np.pi / 2), np.sin(turn + k * np.pi / 2)] for k in range(4)]
    )
    pairs = zip(ring.tolist(), np.roll(ring, -1, axis=0).tolist(), strict=True)
    walls = tuple(FreeWall(x, y, end_x, end_y, 0.0) for (x, y), (end_x, end_y) in pairs)
    house = House((Room(500, 500, 6, 6, "R0", "hall"),), hub="R0", topology="own", free_walls=walls)
    envs = HouseVectorEnv([house], EACH, backend="free", targets={"points": [[500.4, 500.4]]})
    rng = np.random.default_rng(3)
    pose = np.column_stack([middle + rng.uniform(-0.8, 0.8, (EACH, 2)), rng.uniform(0, 2 * np.pi, EACH)])
    seen, _ = envs.reset(seed=0, options={"house": np.zeros(EACH, int), "pose": pose})
    assert (seen[..., 0] * envs.config.range).max() < 4.0


def test_houses_beyond_the_limit_and_lattices_of_too_many_places_are_refused() -> None:
    with pytest.raises(ValueError, match="R0 extends more than 512 m from the origin"):
        HouseVectorEnv([moved(PLANS["flat"], 512.0, 0.0)], 1)
    with pytest.raises(
        ValueError, match=r"positions, 0.0001 m apart: at most 67,108,864, and 65,536 along an axis"
    ):
        HouseVectorEnv([PLANS["flat"]], 1, preset={"step": 1e-4})
