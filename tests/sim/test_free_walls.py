"""Free-standing walls: those along an axis stop bodies and rays in every backend. 12 s."""

from dataclasses import replace

import numpy as np
import pytest
from msgspec import structs

from tests.plans import CELL
from vitruvius.logic import FreeWall, House, Piece, Room
from vitruvius.sim import DEFAULT, HouseVectorEnv

BOX = 1.5, 1.2, 1.8, 2.4  # west, north, east, south, on the grid of 0.3 m
ROOM = Room(0, 0, 3.6, 3.6, "R0", "hall")
PLAIN = House((ROOM,), hub="R0")
WITH_PIECE = House(
    (structs.replace(ROOM, children=(Piece(BOX[0], BOX[1], 0.3, 1.2, "shelf"),)),), hub="R0", topology="own"
)
WITH_WALL = structs.replace(PLAIN, topology="own", free_walls=(FreeWall(1.65, 2.4, 1.65, 1.2, 0.3),))
THIN = structs.replace(PLAIN, topology="own", free_walls=(FreeWall(0.6, 1.8, 2.4, 1.8, 0.0),))
SLANTED = structs.replace(PLAIN, topology="own", free_walls=(FreeWall(1, 1, 2, 1.5, 0.1),))


def walk(house: House, backend: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the observations of all steps, the poses, and a mask of blocked steps."""
    plan = np.random.default_rng(0).choice(3, p=[0.15, 0.15, 0.7], size=(60, 100))
    envs = HouseVectorEnv(
        [house], num_envs=100, backend=backend, targets="all", preset=replace(DEFAULT, sees_kind=True)
    )
    seen, info = envs.reset(seed=0)
    rows = [(seen, info["pose"], info["blocked"])]
    for actions in plan:
        seen, _, _, _, info = envs.step(actions)
        rows.append((seen, info["pose"], info["blocked"]))
    seen, poses, blocked = zip(*rows, strict=True)
    return np.stack(seen), np.stack(poses), np.stack(blocked)


@pytest.mark.parametrize("backend", ["continuous", "grid"])
def test_a_wall_along_an_axis_is_met_as_a_piece_of_its_size_and_seen_as_a_wall(backend: str) -> None:
    (ours, poses, blocked), (theirs, their_poses, their_blocked) = (
        walk(house, backend) for house in (WITH_WALL, WITH_PIECE)
    )
    np.testing.assert_array_equal(poses, their_poses)
    np.testing.assert_array_equal(blocked, their_blocked)
    np.testing.assert_allclose(ours[..., 0], theirs[..., 0], atol=1e-6)
    same = np.abs(ours[..., 0] - theirs[..., 0]) < 1e-7
    np.testing.assert_array_equal(ours[..., 1][same], (theirs[..., 1] + theirs[..., 2])[same])
    assert theirs[..., 2].any()
    assert not ours[..., 2].any()


@pytest.mark.parametrize("backend", ["continuous", "grid"])
def test_a_wall_without_a_thickness_cannot_be_crossed(backend: str) -> None:
    side = DEFAULT.body[0] / 2 if backend == "continuous" else CELL / 2
    _, poses, _ = walk(THIN, backend)
    beside = (poses[..., 0] > 0.6) & (poses[..., 0] < 2.4)
    assert np.abs(poses[..., 1][beside] - 1.8).min() > side - 1e-4


def test_a_wall_that_is_too_far_off_is_refused() -> None:
    far = structs.replace(THIN, free_walls=(FreeWall(0.0, 0.0, 0.0, 600.0, 0.1),))
    with pytest.raises(ValueError, match="house 0 of 1: wall 0 extends more than 512"):
        HouseVectorEnv([far])
