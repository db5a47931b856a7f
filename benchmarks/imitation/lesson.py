"""Windows of steps to learn from, which the network or the explorer takes. Axes as in ``network.py``."""

from typing import NamedTuple, cast

import numpy as np
import torch
from torch import Tensor

from agent.learning.environments import make_envs, shield
from agent.policies.policies import Explorer
from benchmarks.imitation.network import RaysNetwork, RaysPolicy, sensed
from logic import House
from sim import HouseVectorEnv
from sim.config import DEFAULT

RESTARTS = 0.04
"""Share of the environments that begin another episode before each window, beside those near their end."""


class StepsTaken(NamedTuple):
    """Steps to learn from."""

    signals: Tensor
    """(T + 1, E, S): what the network reads at each step, and after the last."""

    allowed: Tensor
    """(T, E, A) bool: what avoidance leaves."""

    actions: Tensor
    """(T, E) int64: what was done."""

    rewards: Tensor
    """(T, E) float32."""

    memory: Tensor
    """(1, E, W): before the first step."""

    def of(self, environments: Tensor) -> "StepsTaken":
        """That of some environments (n,) int64."""
        return StepsTaken(*(field[:, environments] for field in self))

    def log_odds(self, logits: Tensor) -> tuple[Tensor, Tensor]:
        """By logits (T, E, A): logarithms of the probabilities (T, E) of what was done, and the entropy."""
        every = logits.masked_fill(~self.allowed, -1e9).log_softmax(2)
        return every.gather(2, self.actions[..., None])[..., 0], -(every.exp() * every).sum(2).mean()


class Lesson:
    """Bodies that a network or the explorer leads."""

    def __init__(self, houses: list[House], number: int, network: RaysNetwork, seed: int) -> None:
        self.envs = cast(HouseVectorEnv, make_envs(houses, number, "secondary"))
        self.pupil = RaysPolicy(network, shield(self.envs), drawn=True, seed=seed)
        self.explorer = Explorer(shield(self.envs), self.envs.config)
        self.random, self.age = np.random.default_rng(seed), np.zeros(number, int)
        self.observation = torch.as_tensor(self.envs.reset(seed=seed)[0])
        self.blocked = torch.zeros(number, dtype=torch.bool)
        for policy in (self.pupil, self.explorer):
            policy.begin(number)

    def window(self, steps: int, led: bool) -> StepsTaken:
        """Some steps of the network, or of the explorer where it is ``led``: then the memory is not kept."""
        self.restart((self.random.random(len(self.age)) < RESTARTS) | (self.age + steps >= DEFAULT.steps))
        memory, rows = self.pupil.memory.clone(), []
        for _ in range(steps):
            signals = sensed(self.observation, self.blocked, self.pupil.actions)
            if led:
                self.pupil.actions = self.explorer(self.observation, self.blocked).clone()
                allowed = self.explorer.choice.allowed.clone()
            else:
                self.pupil(self.observation, self.blocked)
                allowed = self.pupil.allowed.clone()
            observation, reward, _, _, info = self.envs.step_torch(self.pupil.actions)
            self.observation, self.blocked = observation, info["blocked"].clone()
            rows.append((signals, allowed, self.pupil.actions, reward.clone()))
        self.age += steps
        signals, allowed, actions, rewards = (torch.stack(column) for column in zip(*rows, strict=True))
        last = sensed(self.observation, self.blocked, self.pupil.actions)[None]
        return StepsTaken(torch.cat([signals, last]), allowed, actions, rewards, memory)

    def restart(self, begun: np.ndarray) -> None:
        """Begin other episodes where (E,) bool."""
        if begun.any():
            observation, _ = self.envs.reset(options={"reset_mask": begun})
            fresh = torch.from_numpy(begun)
            self.observation, self.blocked = torch.as_tensor(observation), self.blocked & ~fresh
            self.age[begun], self.pupil.memory[:, fresh], self.pupil.actions[fresh] = 0, 0.0, 0
            self.explorer.tracker.fresh |= fresh
