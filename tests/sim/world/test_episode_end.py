"""The end of an episode shows the state in which the episode ended, and nothing of the next."""

from dataclasses import replace

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from tests.sim.tasks.test_furniture import HOUSE
from vitruvius.sim import DEFAULT, HouseEnv, HouseVectorEnv, Oracle

pytestmark = pytest.mark.second_part("every task in every autoreset mode")

TASKS = {
    "reach": ({"task": "reach", "room": "bedroom"}, DEFAULT),
    "object": ({"task": "object", "piece": "bed"}, DEFAULT),
    "main, at its last step": ("main", replace(DEFAULT, steps=10)),
}
"""Tasks whose episodes end with a pick-up, and one whose time sometimes runs out at a pick-up."""


@pytest.mark.parametrize("name", TASKS)
@pytest.mark.parametrize("mode", AutoresetMode)
def test_the_target_at_an_end_is_the_one_that_was_reached(name: str, mode: AutoresetMode) -> None:
    """The target is that of the info before the step; the body overlaps it, and rays end on it."""
    task, config = TASKS[name]
    envs = HouseVectorEnv([HOUSE], 32, targets=task, preset=config, autoreset_mode=mode, seed=7)
    oracle, reached, in_sight, started = Oracle(envs), 0, 0, None
    _, info = envs.reset()
    for _ in range(160):
        before = info["target"].copy()
        observation, reward, terminated, truncated, info = envs.step(oracle.act())
        ended = terminated | truncated
        picked = ended & (reward > 0)
        if mode is AutoresetMode.SAME_STEP and ended.any():
            final, last = info["final_obs"], info["final_info"]
            assert not np.allclose(info["target"][ended], before[ended])  # the next episode's
        else:
            final, last = observation, info
        np.testing.assert_array_equal(last["target"][ended], before[ended])
        away = np.abs(last["pose"][:, :2] - last["target"]).max(axis=1)
        assert (away[picked] < config.target / 2 + max(config.body)).all()
        reached += picked.sum()
        in_sight += (final[picked, :, -1] > 0).any(axis=1).sum()
        if mode is AutoresetMode.DISABLED and ended.any():
            started = envs.info()["target"]
            np.testing.assert_array_equal(started[ended], before[ended])
            _, info = envs.reset(options={"reset_mask": ended})
            assert not np.allclose(info["target"][ended], before[ended])
    assert reached >= (20 if name != "main, at its last step" else 5)
    assert in_sight > reached / 2


def test_pick_ups_are_counted_to_the_last_step() -> None:
    task, config = TASKS["reach"]
    env = HouseEnv([HOUSE], targets=task, preset=config)
    env.reset(seed=3)
    oracle, over, reward = Oracle(env.envs), False, 0.0
    while not over:
        _, reward, over, _, _ = env.step(oracle.act()[0])
    assert reward == 1
    assert env.envs.scene(0).found == 1
