"""One house at a time: a Gymnasium ``Env``."""

from typing import Any

import gymnasium
import numpy as np
from gymnasium.error import ResetNeeded

from sim.arguments import BANK, Houses
from sim.vector import METADATA, HouseVectorEnv


class HouseEnv(gymnasium.Env):
    """One environment: ``HouseVectorEnv`` with ``num_envs=1``, and its arguments."""

    metadata = METADATA

    def __init__(self, houses: Houses = BANK, render_mode: str | None = None, **arguments: Any) -> None:
        """See ``HouseVectorEnv``."""
        self.envs = HouseVectorEnv(houses, num_envs=1, render_mode=render_mode, **arguments)
        self.render_mode = render_mode
        self.action_space = self.envs.single_action_space
        self.observation_space = self.envs.single_observation_space
        self._over = False

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin a new episode; ``options`` as for ``HouseVectorEnv``: a house, a (3,) pose, a (2,) target."""
        super().reset(seed=seed)
        batched = {key: np.asarray(value)[None] for key, value in (options or {}).items()}
        observation, info = self.envs.reset(seed=seed, options=batched)
        self._over = False
        return observation[0], _only(info)

    def step(self, action: Any) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """One action; after an episode's end, ``ResetNeeded``."""
        if self._over:
            raise ResetNeeded("the episode has ended: call reset()")
        observation, reward, terminated, truncated, info = self.envs.step(np.asarray(action)[None])
        self._over = bool(terminated[0] or truncated[0])
        return observation[0], float(reward[0]), bool(terminated[0]), bool(truncated[0]), _only(info)

    def render(self) -> np.ndarray | None:
        """A picture, (height, width, 3) uint8, where ``render_mode`` is ``rgb_array``."""
        frames = self.envs.render()
        return None if frames is None else frames[0]

    def close(self) -> None:
        """End: to step or reset after it is an error."""
        self.envs.close()


def _only(info: dict[str, Any]) -> dict[str, Any]:
    """The info of the only environment."""
    return {key: value[0] for key, value in info.items()}
