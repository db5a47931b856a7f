"""Results of a world's step: copies for ``step``, tensors in the same memory for ``step_torch``."""

from typing import Any

import numpy as np

from vitruvius.sim.environment.observed import observed
from vitruvius.sim.world.arrays import HOUSE, SAME_STEP
from vitruvius.sim.world.phases import BLOCKED, FINAL_BLOCKED, TERMINATED, TRUNCATED
from vitruvius.sim.world.world import World


class Outputs:
    """Arrays that a world's kernels write, in the shapes that an environment returns."""

    def __init__(self, world: World) -> None:
        self.world = world
        self.shape = world.num_envs, world.config.rays, world.config.channels

        self._joins: list[tuple[Any, list[Any]]] = []
        self.extra_shape = world.num_envs, world.config.extra_numbers

    def rays(self, name: str = "observation") -> np.ndarray:
        """Return a copy of the rays, (E, R, C) float32.

        With the name ``final``, those of episodes that ended.
        """
        return self.world.arrays[name].numpy().view(np.float32).reshape(self.shape)

    def observation(self, final: bool = False, chosen: np.ndarray | None = None) -> Any:
        """Return copies of the observations, with 0 for all but the ``chosen`` (E,) bool environments.

        ``final``: return the last observations of episodes that ended.
        """
        config = self.world.config
        rays, extras = self.rays("final" if final else "observation"), None
        if config.extras:
            extras = (
                self.world.arrays["final_extras" if final else "extras"].numpy().reshape(self.extra_shape)
            )
        if chosen is not None:
            rays[~chosen] = 0
            if extras is not None:
                extras[~chosen] = 0
        seen = observed(config, rays, extras)
        return np.concatenate(self._rows(seen), axis=1) if config.flat else seen

    def _rows(self, seen: Any) -> list[Any]:
        """Return the parts of an observation, (E, n) each."""
        parts = seen.values() if isinstance(seen, dict) else [seen]
        return [part.reshape(self.world.num_envs, -1) for part in parts]

    def flags(self) -> np.ndarray:
        """Return a copy of the flags terminated, truncated and blocked, (3, E) bool.

        In ``SAME_STEP`` there is a fourth row: True if the last move of an ended episode was blocked.
        """
        return self.world.arrays["flags"].numpy().view(bool).reshape(-1, self.world.num_envs)

    def info(
        self, flags: np.ndarray | None = None, last: bool = False, stepped: bool = False
    ) -> dict[str, np.ndarray]:
        """Return a copy of the environments' info. ``last``, ``stepped``: see ``World.describe``."""
        pose, target, house = self.world.describe(last, stepped)
        flags = self.flags() if flags is None else flags
        blocked = flags[FINAL_BLOCKED if last else BLOCKED].copy()
        info = {"pose": pose, "blocked": blocked, "house": house, "target": target}
        if self.world.config.geodesic:
            info["distance"] = self.world.arrays["last_distance" if last else "distance"].numpy()
        if self.world.kind.at_once > 1:
            others = self.world.arrays["last_others" if last else "others"].numpy()
            others = others.reshape(self.world.num_envs, -1, 2)
            info["targets"] = np.concatenate([target[:, None], others], axis=1)
        if self.world.config.memory:
            kept = self.world.arrays["last_memory" if last else "memory"].numpy()
            info["memory"] = kept.reshape(-1, self.world.config.memory)
        return info

    def finals(self, ended: np.ndarray) -> dict[str, Any]:
        """Return the last observations and infos of ended episodes, for the info in ``SAME_STEP``.

        ``ended`` (E,) bool is True for the environments whose episode ended in this step.
        """
        if not ended.any():
            return {}
        observation = self.observation(final=True, chosen=ended)
        last = self.info(last=True)
        masks = {f"_{name}": ended.copy() for name in last}
        final = {"final_obs": observation, "_final_obs": ended}
        return final | {"final_info": last | masks, "_final_info": ended.copy()}

    def tensors(self, device: str) -> tuple[Any, tuple[Any, ...]]:
        """Return the tensor for actions, and the results of ``step_torch``, in the world's own memory."""
        arrays, count = self.world.arrays, self.world.num_envs
        flags = arrays["flags"].tensor(np.bool_, (arrays["flags"].shape[0] // count, count))
        wholes = arrays["wholes"].tensor(np.int32, arrays["wholes"].shape)
        info: dict[str, Any] = {"blocked": flags[BLOCKED], "house": wholes[:, HOUSE]}
        if self.world.config.geodesic:
            info["distance"] = arrays["distance"].tensor(np.int32, (count,))
        if self.world.config.memory:
            info["memory"] = arrays["memory"].tensor(np.float32, (count, self.world.config.memory))
        if self.world.kind.mode == SAME_STEP:
            info["final_obs"] = self._tensor("final", "final_extras")
            info["final_info"] = {"blocked": flags[FINAL_BLOCKED]}
        observation = self._tensor("observation", "extras")
        reward, action = arrays["reward"].tensor(np.float32, (count,)), arrays["action"]
        outputs = observation, reward, flags[TERMINATED], flags[TRUNCATED], info
        return action.view() if device == "cpu" else action.tensor(action.dtype, action.shape), outputs

    def _tensor(self, rays: str, extras: str) -> Any:
        """Return an observation as tensors in the world's memory.

        A flat observation has its own memory: see ``join``.
        """
        arrays, config = self.world.arrays, self.world.config
        numbers = arrays[extras].tensor(np.float32, self.extra_shape) if config.extras else None
        seen = observed(config, arrays[rays].tensor(np.float32, self.shape), numbers)
        if not config.flat:
            return seen
        import torch

        self._joins.append((torch.cat(self._rows(seen), dim=1), self._rows(seen)))
        return self._joins[-1][0]

    def join(self) -> None:
        """Update the flat tensors."""
        import torch

        for whole, parts in self._joins:
            torch.cat(parts, dim=1, out=whole)
