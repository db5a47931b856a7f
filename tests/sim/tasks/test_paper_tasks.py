"""The paper's house and its tasks, by name: starts, places of targets, and the number of targets."""

import gymnasium
import numpy as np
import pytest

from vitruvius.sim import Oracle
from vitruvius.sim.config import PIXEL

EPISODES = 32

MAIN = [(160, 240), (220, 240), (230, 280), (170, 320)]
SECONDARY = [(270, 190), (250, 325), (110, 290), (160, 170)]
"""North-west corners of targets in the original, in pixels; a target is 15 px wide."""

TASKS = {
    "paper-main": (MAIN, 56.8),
    "paper-secondary": (SECONDARY, 21.0),
    "paper-mixed": (MAIN + SECONDARY, 32.3),
}
"""For each task: its places, and the targets of an oracle in an exact twin of the original. They depend a
little on the choice among shortest paths: 55.8 to 57.3, 20.9 to 21.0, 32.2 to 32.9."""


@pytest.fixture(scope="module")
def envs():
    return gymnasium.make_vec("Vitruvius/Paper-v0", num_envs=EPISODES).unwrapped


@pytest.mark.parametrize("task", TASKS)
def test_the_papers_tasks_have_its_start_its_places_and_its_number_of_targets(envs, task):
    corners, shortest = TASKS[task]
    envs.set_houses("paper-house", task)
    _, info = envs.reset(seed=0)
    # The body's corner is at (198, 268), its eye 4 px further; it looks north.
    np.testing.assert_allclose(
        info["pose"] / (PIXEL, PIXEL, 1), [[202, 272, np.pi / 2]] * EPISODES, atol=1e-3
    )
    coming = np.round(envs.targets(200) / PIXEL - 7.5, 3)
    assert {tuple(corner) for corner in coming.reshape(-1, 2).tolist()} == set(corners)
    assert (coming[:, 1:] != coming[:, :-1]).any(axis=2).all()
    in_main = (coming[:, :, None] == np.array(MAIN)).all(axis=3).any(axis=2).mean()
    assert in_main == pytest.approx(
        {"paper-main": 1, "paper-secondary": 0, "paper-mixed": 0.5}[task], abs=0.02
    )
    assert Oracle(envs).play().mean() == pytest.approx(shortest, rel=0.03)
