"""Vector environments for Stable-Baselines3, which has an interface of its own.

This module needs Stable-Baselines3, which is not among our dependencies.
"""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv, VectorWrapper
from stable_baselines3.common.vec_env import VecEnv


class StableBaselinesVecEnv(VecEnv):
    """Stable-Baselines3 wrapper of a ``VectorEnv``, as in ``DQN("MlpPolicy", StableBaselinesVecEnv(envs))``.

    The ``VectorEnv`` must reset in the same step. Options apply to all environments together, as in
    Gymnasium: ``set_options({"house": [0, 1]})``. Attributes and methods also apply to all environments
    together. They belong to the outermost wrapper that has them, or else to the vector environment.
    """

    def __init__(self, envs: VectorEnv, infos: bool = False) -> None:
        """Wrap a vector environment whose ``autoreset_mode`` is SAME_STEP.

        Stable-Baselines3 knows no other mode. ``infos``: True if each step returns the infos of all
        environments, which takes as long as stepping 256 environments. Otherwise a step returns the infos of
        environments whose episode ended; the library's algorithms read no others. Raises ``ValueError`` for
        another ``autoreset_mode``.
        """
        mode = envs.metadata.get("autoreset_mode")
        if mode is not AutoresetMode.SAME_STEP:
            raise ValueError(f"autoreset_mode is {mode}: Stable-Baselines3 needs AutoresetMode.SAME_STEP")
        self.envs, self.infos = envs, infos
        super().__init__(envs.num_envs, envs.single_observation_space, envs.single_action_space)

    def reset(self) -> Any:
        """Return observations (N, ...). Seeds and options that were set are used once."""
        seed: Any = None if self._seeds[0] is None else self._seeds
        observation, info = self.envs.reset(seed=seed, options=self._options[0] or None)
        self.reset_infos = [_info_of(info, index) for index in range(self.num_envs)]
        self._reset_seeds()
        self._reset_options()
        return observation

    def set_options(self, options: list[dict[str, Any]] | dict[str, Any] | None = None) -> None:
        """Set the options of the next reset, for all environments or as a dictionary for each of them."""
        if isinstance(options, list):
            names = dict.fromkeys(name for each in options for name in each)
            if len(options) != self.num_envs or any(each.keys() != names.keys() for each in options):
                raise ValueError(
                    f"options: give each of the {self.num_envs} environments a dictionary, all "
                    "with the same keys"
                )
            options = {name: np.array([each[name] for each in options]) for name in names}
        super().set_options(options)

    def step_async(self, actions: np.ndarray) -> None:
        """Store the actions (N, ...) for ``step_wait``."""
        self._actions = actions

    def step_wait(self) -> tuple[Any, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        """Return observations (N, ...), rewards (N,) float32, ends (N,) bool, and the N infos.

        If an episode has ended, its last observation is in the info, as ``terminal_observation``.
        """
        observation, reward, terminated, truncated, info = self.envs.step(self._actions)
        done = terminated | truncated
        infos: list[dict[str, Any]] = [{"TimeLimit.truncated": False} for _ in range(self.num_envs)]
        for index in range(self.num_envs) if self.infos else np.flatnonzero(done):
            infos[index] |= _info_of(info, index)
        for index in np.flatnonzero(done):
            first = infos[index]
            infos[index] = first.pop("final_info") | {"terminal_observation": first.pop("final_obs")}
            infos[index]["TimeLimit.truncated"] = bool(truncated[index] and not terminated[index])
            self.reset_infos[index] = {name: first[name] for name in first if name != "TimeLimit.truncated"}
        return observation, np.asarray(reward, np.float32), done, infos

    def close(self) -> None:
        """Close the environments."""
        self.envs.close()

    def get_images(self) -> Sequence[np.ndarray | None]:
        """Return a picture of each environment, (height, width, 3) uint8."""
        return self.envs.render() or [None] * self.num_envs  # pyright: ignore[reportReturnType]

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return a list that repeats the attribute for each of the environments ``indices``."""
        return [getattr(self._owner(attr_name), attr_name) for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Set the attribute of the layer that has it, for all environments."""
        setattr(self._owner(attr_name), attr_name, value)

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> list[Any]:
        """Call the method once. Return its result, repeated for each of the environments ``indices``."""
        returned = getattr(self._owner(method_name), method_name)(*args, **kwargs)
        return [returned for _ in self._get_indices(indices)]

    def env_is_wrapped(self, wrapper_class: type, indices: Any = None) -> list[bool]:
        """Return for each of the environments ``indices`` True if a wrapper of this class is present."""
        wrapped = any(isinstance(layer, wrapper_class) for layer in self._layers())
        return [wrapped for _ in self._get_indices(indices)]

    def _layers(self) -> Iterator[VectorEnv]:
        """Yield the wrappers from the outermost to the innermost, then the vector environment."""
        layer = self.envs
        while isinstance(layer, VectorWrapper):
            yield layer
            layer = layer.env
        yield layer

    def _owner(self, name: str) -> VectorEnv:
        """Return the outermost layer with an attribute, or else the environment."""
        return next((layer for layer in self._layers() if hasattr(layer, name)), self.envs.unwrapped)


def _info_of(infos: dict[str, Any], index: Any) -> dict[str, Any]:
    """Return one environment's info from the infos of all environments."""
    found = {}
    for name, values in infos.items():
        said = infos.get(f"_{name}")
        if not name.startswith("_") and (said is None or said[index]):
            found[name] = _info_of(values, index) if isinstance(values, dict) else values[index]
    return found
