"""A vector environment that conforms, for tests to break."""

from typing import Any

import numpy as np
from gymnasium import spaces
from gymnasium.error import ResetNeeded
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

NEXT, SAME, DISABLED = AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP, AutoresetMode.DISABLED


class Walk(VectorEnv):
    """Walkers on a line, whose episodes end at random."""

    def __init__(self, mode: AutoresetMode = NEXT, num_envs: int = 3, render_mode: Any = "rgb_array"):
        self.metadata = {"render_modes": ["rgb_array"], "render_fps": 9, "autoreset_mode": mode}
        self.num_envs, self.mode, self.render_mode = num_envs, mode, render_mode
        self.single_observation_space = spaces.Box(-9, 9, (2,), np.float32)
        self.single_action_space = spaces.Discrete(3)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.rng = [np.random.default_rng() for _ in range(num_envs)]
        self.state = np.zeros((num_envs, 2), np.float32)
        self.over = np.zeros(num_envs, bool)

    def reset(self, *, seed: Any = None, options=None):
        mask = np.ones(self.num_envs, bool) if options is None else self.mask(options)
        if seed is not None:
            seeds = self.seeds(seed)
            self.over &= ~mask
            for index in np.flatnonzero(mask):
                self.rng[index] = np.random.default_rng(seeds[index])
        for index in np.flatnonzero(mask):
            self.begin(index)
        self.over &= ~mask
        return self.see(), self.tell()

    def mask(self, options):
        mask = options.get("reset_mask", np.ones(self.num_envs, bool))
        if mask.shape != (self.num_envs,) or mask.dtype != np.bool_:
            raise ValueError(f"reset_mask {mask.shape} {mask.dtype}")
        return mask

    def seeds(self, seed):
        seeds = range(seed, seed + self.num_envs) if isinstance(seed, int) else seed
        if len(seeds) != self.num_envs:
            raise ValueError(f"{len(seeds)} seeds")
        return seeds

    def begin(self, index):
        rng = self.rng[index]
        self.state[index] = rng.uniform(-1, 1), rng.integers(3, 9)

    def move(self, index, action) -> float:
        self.state[index] += 0.1 * (action - 1) + 0.01 * self.rng[index].normal(), -1
        return float(self.state[index, 0])

    def step(self, actions):
        if self.mode is DISABLED:
            self.refuse()
        reward = np.zeros(self.num_envs)
        for index, action in enumerate(actions):
            if self.mode is NEXT and self.over[index]:
                reward[index] = self.again(index, action)
            else:
                reward[index] = self.move(index, action)
        over, truncated = self.over, self.state[:, 1] <= 0
        self.over = truncated.copy()
        terminated = self.stopped(over)
        info = self.tell()
        if self.mode is SAME and truncated.any():
            info |= self.final(truncated)
            for index in np.flatnonzero(truncated):
                self.begin(index)
        return self.see(), reward, terminated, truncated, info

    def refuse(self):
        if self.over.any():
            raise ResetNeeded(f"ended: {self.over}")

    def again(self, index, action) -> float:
        self.begin(index)
        return 0.0

    def stopped(self, over):
        return np.zeros(self.num_envs, bool)

    def final(self, over):
        final = {"final_obs": self.see(), "_final_obs": over.copy()}
        return final | {"final_info": self.tell(), "_final_info": over.copy()}

    def see(self) -> Any:
        return self.state * np.array([1, 0], np.float32)

    def tell(self) -> Any:
        return {"left": self.state[:, 1].copy(), "_left": np.ones(self.num_envs, bool)}

    def render(self) -> Any:
        return tuple(np.full((4, 5, 3), int(9 * abs(x)), np.uint8) for x, _ in self.state)
