"""Wrapper of ``HouseVectorEnv`` that adds a window of a planner's map to the observations."""

from typing import Any

import numpy as np
import torch
from gymnasium import spaces
from gymnasium.vector import AutoresetMode, VectorEnv, VectorWrapper
from gymnasium.vector.utils import batch_space
from torch import Tensor

from vitruvius.agent.planner.core.config import TUNED, PlannerConfig
from vitruvius.agent.planner.local_map import LAYERS, LocalMap
from vitruvius.agent.planner.planner import Planner
from vitruvius.agent.planner.step import SKIPPED
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.config import RAYS

MAP = "map"


class MapWindow(VectorWrapper):
    """Wrapper that adds a part ``map`` to observations: ``Box(0, 255, (4, side, side), uint8)``.

    | layer | value |
    |---|---|
    | 0 | 255 where a cell is occupied |
    | 1 | 255 where a cell was ever seen |
    | 2 | 255 on the frontier: seen, not occupied, next to a cell that was not seen |
    | 3 | time since a cell was seen: 0 now, 254 as many steps as an episode has, 255 never |

    A cell is half a body wide, 0.14 m by default. The body is in the middle. By its nearest eighth of a turn
    it looks up, or halfway between up and left. The map is that of ``agent.planner``, made from the agent's
    rays and moves alone; in the backend ``free`` from its rays and its pose.
    """

    def __init__(self, env: VectorEnv, side: int = 48, config: PlannerConfig = TUNED) -> None:
        """Show ``side`` by ``side`` cells.

        Raises ``ValueError`` for environments without rays, or with flat observations, and for a side that is
        odd or larger than a map.
        """
        super().__init__(env)
        inner = env.unwrapped
        if not isinstance(inner, HouseVectorEnv):
            raise ValueError(f"a map needs a HouseVectorEnv, not a {type(inner).__name__}")
        self.inner, told = inner, inner.config
        if told.flat or RAYS not in told.observe:
            raise ValueError("a map is built from rays: add rays to observe, and leave out flat")
        self.planner = Planner(told, self.num_envs, config)
        self.window = LocalMap(self.planner, side)
        seen = env.single_observation_space
        parts = dict(seen.spaces) if isinstance(seen, spaces.Dict) else {RAYS: seen}
        box = spaces.Box(0, 255, (len(LAYERS), side, side), np.uint8)
        self.single_observation_space = spaces.Dict({**parts, MAP: box}, sort_keys=False)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.ended = torch.zeros(self.num_envs, dtype=torch.bool)

    def reset(self, *, seed: Any = None, options: Any = None) -> tuple[Any, dict[str, Any]]:
        """Reset the environments. Maps of episodes that begin are empty except for what is in sight."""
        seen, info = self.env.reset(seed=seed, options=options)
        begun = np.ones(self.num_envs, bool)
        if options and "reset_mask" in options:
            begun = np.asarray(options["reset_mask"], bool)
        self.ended = self.ended & ~torch.from_numpy(begun)
        none = torch.zeros(self.num_envs, dtype=torch.int64)
        self._keep(seen, none.bool(), none, torch.from_numpy(np.where(begun, 1, SKIPPED)))
        return self._with_map(seen), info

    def step(self, actions: Any) -> tuple[Any, ...]:
        """Step the environments and the maps."""
        seen, reward, terminated, truncated, info = self.env.step(actions)
        ended, final = terminated | truncated, info.get("final_obs")
        blocked = info["blocked"]
        if final is not None:
            blocked = np.where(ended, info["final_info"]["blocked"], blocked)
        last = self._follow(seen, final, *map(torch.from_numpy, (blocked, np.asarray(actions), ended)))
        if final is not None:
            hidden = last.numpy() * ended[:, None, None, None]
            info["final_obs"] = self._parts(final) | {MAP: hidden}
        return self._with_map(seen), reward, terminated, truncated, info

    def step_torch(self, actions: Tensor) -> tuple[Any, ...]:
        """Return ``HouseVectorEnv.step_torch``, with the map added to its observations.

        The map is in the same memory at each call. In ``SAME_STEP``, ``final_obs`` in the info has a copy,
        valid where an episode ended.
        """
        seen, reward, terminated, truncated, info = self.inner.step_torch(actions)
        ended, final, blocked = terminated | truncated, info.get("final_obs"), info["blocked"]
        if final is not None:
            blocked = torch.where(ended, info["final_info"]["blocked"], blocked)
        last = self._follow(seen, final, blocked, actions, ended)
        if final is not None:
            info = info | {"final_obs": self._parts(final) | {MAP: last}}
        return self._parts(seen) | {MAP: self.window.cells}, reward, terminated, truncated, info

    def _follow(self, seen: Any, final: Any, blocked: Tensor, actions: Tensor, ended: Tensor) -> Tensor:
        """Update the maps. Return the windows; in ``SAME_STEP``, a copy of the windows as episodes ended."""
        begun, last = torch.zeros_like(ended, dtype=torch.uint8), self.window.cells
        if self.inner.autoreset_mode is AutoresetMode.NEXT_STEP:
            begun[self.ended], self.ended = 1, ended.clone()
        if self.inner.autoreset_mode is AutoresetMode.SAME_STEP and bool(ended.any()):
            before = torch.where(ended[:, None, None], self._rays(final), self._rays(seen))
            last = self._keep(before, blocked, actions, begun, ended).clone()
            begun = torch.where(ended, 1, SKIPPED)
            seen, blocked = self._rays(seen), torch.zeros_like(blocked)
        self._keep(seen, blocked, actions, begun)
        return last

    def _keep(
        self, seen: Any, blocked: Tensor, actions: Tensor, begun: Tensor, ended: Tensor | None = None
    ) -> Tensor:
        """Step the planners and return their windows; for episodes that ``ended``, from their last pose."""
        moved = actions
        if self.inner.config.drives:
            pose = self.inner.world.describe()[0]
            if ended is not None:
                pose = np.where(ended.cpu().numpy()[:, None], self.inner.world.describe(last=True)[0], pose)
            moved = torch.from_numpy(pose.astype(np.float32))
        self.planner.step(self._rays(seen), blocked, moved, begun)
        return self.window.read()

    def _rays(self, seen: Any) -> Tensor:
        return torch.as_tensor(seen[RAYS] if isinstance(seen, dict) else seen)

    def _parts(self, seen: Any) -> dict[str, Any]:
        return dict(seen) if isinstance(seen, dict) else {RAYS: seen}

    def _with_map(self, seen: Any) -> dict[str, Any]:
        return self._parts(seen) | {MAP: self.window.cells.cpu().numpy().copy()}
