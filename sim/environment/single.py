"""A single environment: a Gymnasium ``Env``."""

from functools import cached_property
from typing import Any

import gymnasium
import numpy as np
from gymnasium.error import ClosedEnvironmentError, ResetNeeded

from vitruvius.logic.spelling import keywords
from vitruvius.sim.environment.arguments import BANK, METADATA, Houses, Preset, read_arguments
from vitruvius.sim.environment.observed import only, single_spaces
from vitruvius.sim.environment.options import for_one, read_seeds
from vitruvius.sim.environment.specs import KeepsSpec
from vitruvius.sim.environment.steps import orders
from vitruvius.sim.environment.vector import HouseVectorEnv
from vitruvius.sim.tasks.tasks import Targets


class HouseEnv(KeepsSpec, gymnasium.Env):  # pyright: ignore[reportIncompatibleVariableOverride]
    """A single environment: ``HouseVectorEnv`` with ``num_envs=1``, and its arguments.

    Taichi starts at the first reset. So a process may create an environment, to read its spaces, and then
    fork, as Gymnasium's ``AsyncVectorEnv`` does.
    """

    metadata = METADATA

    @keywords(config="preset", bank="houses", task="targets")
    def __init__(
        self,
        houses: Houses = BANK,
        render_mode: str | None = None,
        *,
        backend: str = "continuous",
        targets: Targets = "main",
        preset: Preset = "default",
        seed: int | None = None,
        max_episode_steps: int | None = None,
        device: str = "cpu",
        by_ray: bool | None = None,
    ) -> None:
        """Check the arguments: see ``HouseVectorEnv``. Raises ``ValueError`` that names the wrong argument.

        Houses without a place for a target are an error of the first reset.
        """
        if render_mode == "human":
            raise ValueError(
                "render_mode 'human': use gymnasium.make, which opens a window for it, or "
                "HouseVectorEnv(num_envs=1); HouseEnv itself renders only 'rgb_array'"
            )
        asked = read_arguments(houses, backend, targets, preset, max_episode_steps, render_mode, device)
        if asked.rotation:
            raise ValueError("rotating houses need HouseVectorEnv: give HouseEnv a list of houses")
        if seed is not None:
            read_seeds(seed, 1)
        self._arguments: dict[str, Any] = {
            "houses": asked.houses,
            "backend": backend,
            "targets": asked.task,
            "preset": preset,
            "seed": seed,
            "max_episode_steps": max_episode_steps,
            "device": device,
            "by_ray": by_ray,
        }
        self.render_mode, self.episode_steps = render_mode, asked.config.steps
        self.observation_space, self.action_space = single_spaces(asked.config)
        self._over = self._closed = False

    @cached_property
    def envs(self) -> HouseVectorEnv:
        """The vector environment of one, created when it is first needed."""
        return HouseVectorEnv(num_envs=1, render_mode=self.render_mode, **self._arguments)

    def lengthen(self, steps: int) -> None:
        """Truncate episodes after ``steps``: see ``KeepsSpec``."""
        self._arguments["max_episode_steps"] = self.episode_steps = steps

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin a new episode.

        ``options`` are those of ``HouseVectorEnv``, for one environment: a house, a (3,) pose, a (2,) target.
        """
        self._require_open()
        batched = for_one(options)
        if seed is not None:
            (seed,) = read_seeds(seed, 1)
        observation, info = self.envs.reset(seed=seed, options=batched)
        super().reset(seed=seed)
        self._over = False
        return only(observation), _only(info)

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Take one action. Raises ``ResetNeeded`` after an episode's end."""
        self._require_open()
        if self._over:
            raise ResetNeeded("the episode has ended: call reset()")
        action = np.asarray(action)
        if action.shape != self.action_space.shape:
            words = orders(self.action_space, self.envs.config.drive).words
            raise ValueError(f"an action must be {words}, not an array of shape {action.shape}")
        observation, reward, terminated, truncated, info = self.envs.step(action[None])
        self._over = bool(terminated[0] or truncated[0])
        return only(observation), float(reward[0]), bool(terminated[0]), bool(truncated[0]), _only(info)

    def render(self) -> np.ndarray | None:
        """Return a picture, (height, width, 3) uint8, if ``render_mode`` is ``rgb_array``."""
        self._require_open()
        frames = self.envs.render()
        return None if frames is None else frames[0]

    def close(self) -> None:
        """Close the environment; it cannot be stepped or reset afterwards."""
        self._closed = True
        if "envs" in self.__dict__:
            self.envs.close()

    def _require_open(self) -> None:
        if self._closed:
            raise ClosedEnvironmentError("this environment was closed: make a new one")


def _only(info: dict[str, Any]) -> dict[str, Any]:
    """Return the info of the only environment, as Python's own numbers and arrays."""
    return {key: value[0].item() if value.ndim == 1 else value[0] for key, value in info.items()}
