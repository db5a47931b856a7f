# /// script
# requires-python = ">=3.11,<3.14"
# dependencies = ["minigrid==3.2.0", "gymnasium==1.4.0", "numpy==2.4.6"]
# ///
"""MiniGrid in Gymnasium's vector environments: ``uv run --no-project minigrid_rooms.py``.

The settings are those of its documentation: ``ImgObsWrapper``, which omits the mission's text, and
Gymnasium's own vectorisation, which resets at the step after an end. With more than one thread it also runs
in processes.
"""

import gymnasium
import minigrid
import numpy as np
from gymnasium.vector import AsyncVectorEnv, SyncVectorEnv
from minigrid.wrappers import ImgObsWrapper
from rounds import Case, Play, measure, threads

gymnasium.register_envs(minigrid)


def single():
    """Return an environment without Gymnasium's checks of every step."""
    return ImgObsWrapper(gymnasium.make("MiniGrid-FourRooms-v0", disable_env_checker=True))


def build(vectorised: type):
    """Return the steps of a vector environment, with random actions drawn beforehand."""

    def make(environments: int) -> Play:
        envs = vectorised([single] * environments)
        envs.reset(seed=0)
        plan = np.random.default_rng(0).integers(7, size=(max(8, 512 // environments), environments))

        def play() -> int:
            for actions in plan:
                envs.step(actions)
            return plan.size

        return play

    return make


WHAT = "four rooms of 19 by 19 cells, moves, a view of 7 by 7 cells, reward, reset"
NOTE = (
    "Moves of a whole cell and turns of 90 degrees; no rays: a view that walls block, cell by cell; a new "
    "house at each reset; episodes end at the goal or after 100 steps"
)
CASES = [Case(f"{WHAT}, one after the other", NOTE, (1, 16, 256), build(SyncVectorEnv))]
if threads() > 1:
    CASES.append(Case(f"{WHAT}, each in a process", NOTE, sorted({threads(), 16}), build(AsyncVectorEnv)))

if __name__ == "__main__":
    measure("MiniGrid", "minigrid", CASES, libraries=["gymnasium"])
