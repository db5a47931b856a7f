"""A rollout: what some steps of many worlds gave, kept in place for the learner."""

from dataclasses import dataclass
from time import perf_counter

import torch
from torch import Tensor

from agent.avoidance import Layer, best_value, subsume
from agent.network import QNetwork
from agent.policies import explore
from sim import HouseVectorEnv


@dataclass
class Rollout:
    """T steps of E worlds, overwritten by the next. Index t of a state array is the state before step t."""

    s: Tensor
    """Observations (T + 1, E, R, C) float32."""

    blocked: Tensor
    """Whether the step to each state was blocked (T + 1, E) bool."""

    memory: Tensor
    """What is remembered at each state (T + 1, E, M, 6) float32."""

    v: Tensor
    """Greatest allowed Q-value (T + 1, E) float32 of each state."""

    a: Tensor
    """Executed actions (T, E) int64: what the avoidance layer let through."""

    r: Tensor
    """Rewards (T, E) float32."""

    terminated: Tensor
    """Whether a step ended the episode for good (T, E) bool."""

    truncated: Tensor
    """Whether the time ran out at a step (T, E) bool."""

    valid: Tensor
    """Which steps count (T, E) bool: all but those after an end, whose action the world ignored."""

    overruled: int = 0
    """How many actions the avoidance layer changed."""

    simulating: float = 0.0
    """Seconds spent in the simulator."""

    @classmethod
    def starting(cls, steps: int, observation: Tensor, memory: Tensor) -> "Rollout":
        """Make room for so many steps from the first observations (E, R, C) and memories (E, M, 6)."""
        size = (steps, len(observation))
        ended = torch.zeros(size, dtype=torch.bool)
        rollout = cls(
            s=observation.new_empty(steps + 1, *observation.shape),
            blocked=torch.zeros(steps + 1, len(observation), dtype=torch.bool),
            memory=memory.new_empty(steps + 1, *memory.shape),
            v=observation.new_empty(steps + 1, len(observation)),
            a=torch.empty(size, dtype=torch.int64),
            r=observation.new_empty(size),
            terminated=ended.clone(),
            truncated=ended.clone(),
            valid=ended.clone(),
        )
        rollout.s[-1], rollout.memory[-1] = observation, memory
        return rollout

    @torch.no_grad()
    def fill(
        self,
        envs: HouseVectorEnv,
        network: QNetwork,
        avoidance: Layer,
        *,
        epsilon: float,
        forward: float,
        generator: torch.Generator,
    ) -> None:
        """Act from where the rollout before ended: the network under avoidance, ``epsilon`` at random."""
        ended = self.terminated[-1] | self.truncated[-1]
        for states in (self.s, self.blocked, self.memory):
            states[0] = states[-1]
        self.overruled, self.simulating = 0, 0.0
        for t in range(len(self.a)):
            q, allowed = network(self.s[t], self.memory[t]), avoidance(self.s[t], self.blocked[t])
            preference = explore(q, generator, epsilon, forward)
            self.v[t], self.a[t], self.valid[t] = best_value(q, allowed), subsume(preference, allowed), ~ended
            self.overruled += int((self.a[t] != preference.argmax(-1)).sum())
            before = perf_counter()
            observation, reward, terminated, truncated, info = envs.step_torch(self.a[t])
            self.simulating += perf_counter() - before
            # Copied: the world writes over its tensors at the next step.
            self.s[t + 1], self.blocked[t + 1], self.r[t] = observation, info["blocked"], reward
            self.terminated[t], self.truncated[t] = terminated, truncated
            # The step after an end begins the next episode: it is no memory of that one.
            begun, ended = ended, self.terminated[t] | self.truncated[t]
            self.memory[t + 1] = network.memory(self.memory[t], self.s[t], self.blocked[t], self.a[t], begun)
        self.v[-1] = best_value(network(self.s[-1], self.memory[-1]), avoidance(self.s[-1], self.blocked[-1]))
