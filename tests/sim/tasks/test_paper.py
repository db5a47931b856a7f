"""The paper preset against a recording of the original program: 3000 random steps in its own house."""

import numpy as np
import pytest

from tests import sample_houses
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.config import PIXEL

START = (185, 190, 90)
"""Start of the recording's episodes: the body's north-west corner in pixels, and degrees."""


@pytest.fixture(scope="module")
def replay():
    """Return the recording, and each of its steps repeated in our simulator from the pose before it."""
    house = sample_houses.example(whole_pixels=True)
    trace = dict(np.load(sample_houses.FIXTURES / "example1-trace.npz"))
    after, episode = trace["pose"].astype(float), trace["episode"]
    before = np.vstack([[START], after[:-1]])
    before[np.flatnonzero(np.diff(episode)) + 1] = START
    count = len(after)
    envs = HouseVectorEnv([house], num_envs=count, preset="paper")
    target = (trace["target_before"] + 7.5) * PIXEL
    envs.reset(seed=0, options={"house": np.zeros(count, int), "pose": eye(before), "target": target})
    return trace, eye(after), envs.step(trace["action"].astype(int))


def eye(corner: np.ndarray) -> np.ndarray:
    """Return the eyes of recorded poses: 4 px from the corner, 5 at diagonal headings. Metres and radians."""
    offset = np.where(corner[:, 2] % 90 == 0, 4, 5)[:, None]
    return np.column_stack([(corner[:, :2] + offset) * PIXEL, np.deg2rad(corner[:, 2])])


def test_every_collision_is_found_and_none_is_false(replay):
    trace, _, (_, _, terminated, _, _) = replay
    assert trace["collided"].sum() == 81
    assert terminated[trace["collided"]].all()
    assert terminated[~trace["collided"]].sum() <= 5


def test_poses_and_rewards_equal_those_of_the_original_program(replay):
    trace, pose, (_, reward, _, _, info) = replay
    np.testing.assert_allclose(info["pose"], pose, atol=1e-4)
    np.testing.assert_array_equal(reward, trace["reward"])


def test_rays_are_within_a_hundredth_of_the_range(replay):
    trace, _, (observation, reward, _, _, _) = replay
    same_target = reward == 0  # after a pick-up each program draws its own next target
    ours, theirs = observation[same_target], trace["observation"][same_target]
    assert (np.abs(ours[..., 1] - theirs[..., 1]) <= 0.01).mean() >= 0.995
    assert (ours[..., 2] == theirs[..., 2]).mean() >= 0.999
    # The original writes each angle one ray too early; ours is the ray's own angle.
    np.testing.assert_allclose(ours[:, 1:, 0], theirs[:, :-1, 0], atol=1e-6)
