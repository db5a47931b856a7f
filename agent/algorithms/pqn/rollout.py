"""Rollout: some steps of many environments, stored in place for the learner."""

from dataclasses import dataclass

import torch
from torch import Tensor

from vitruvius.agent.avoidance import Layer, best_value, subsume
from vitruvius.agent.learning.stopwatch import Stopwatch
from vitruvius.agent.policies.network import QNetwork
from vitruvius.agent.policies.policies import epsilon_greedy, exploration
from vitruvius.sim import HouseVectorEnv


@dataclass
class Rollout:
    """Storage of T steps of E environments, overwritten by the next rollout.

    States at index t are those before step t.
    """

    s: Tensor
    """Observations (T + 1, E, R, C) float32."""

    blocked: Tensor
    """True if the step to a state was blocked, (T + 1, E) bool."""

    memory: Tensor
    """Memories at each state (T + 1, E, M, S) float32."""

    v: Tensor
    """Q-value (T + 1, E) float32 of the action that the network, under avoidance, prefers in each state."""

    a: Tensor
    """Executed actions (T, E) int64, after the avoidance layer."""

    r: Tensor
    """Rewards (T, E) float32."""

    terminated: Tensor
    """True if a step ended the episode in a terminal state, (T, E) bool."""

    truncated: Tensor
    """True if the time ran out at a step, (T, E) bool."""

    valid: Tensor
    """True for steps that count, (T, E) bool: all but those after an end, whose action the environment
    ignored."""

    overruled: int = 0
    """Number of actions that the avoidance layer changed."""

    @classmethod
    def starting(cls, steps: int, observation: Tensor, memory: Tensor) -> "Rollout":
        """Allocate ``steps`` steps from the first observations (E, R, C) and memories (E, M, S)."""
        size = (steps, len(observation))
        ended = observation.new_zeros(size, dtype=torch.bool)
        rollout = cls(
            s=observation.new_empty(steps + 1, *observation.shape),
            blocked=observation.new_zeros(steps + 1, len(observation), dtype=torch.bool),
            memory=memory.new_empty(steps + 1, *memory.shape),
            v=observation.new_empty(steps + 1, len(observation)),
            a=observation.new_empty(size, dtype=torch.int64),
            r=observation.new_empty(size),
            terminated=ended.clone(),
            truncated=ended.clone(),
            valid=ended.clone(),
        )
        rollout.s[-1], rollout.memory[-1] = observation, memory
        return rollout

    @torch.inference_mode()
    def fill(
        self,
        envs: HouseVectorEnv,
        network: QNetwork,
        avoidance: Layer,
        *,
        epsilon: float,
        forward: float,
        generator: torch.Generator,
        simulating: Stopwatch,
    ) -> None:
        """Act from the end of the last rollout: the network's actions under avoidance, some at random.

        A fraction ``epsilon`` of the actions is random. ``simulating`` counts the simulator's seconds.
        """
        first = ended = self.terminated[-1] | self.truncated[-1]
        for states in (self.s, self.blocked, self.memory):
            states[0] = states[-1]
        values, explored = [], []
        noise = exploration(self.a.shape, generator, epsilon, forward, 2, network.actions)
        for t, (chosen, random) in enumerate(zip(*noise, strict=True)):
            q, allowed = self._values(t, network, avoidance)
            values.append((q, allowed))
            explored.append(epsilon_greedy(q, chosen, random))
            self.a[t] = subsume(explored[t], allowed)
            with simulating.running():
                observation, reward, terminated, truncated, info = envs.step_torch(self.a[t])
            # Copied, because the simulator overwrites its tensors at the next step.
            self.s[t + 1], self.blocked[t + 1], self.r[t] = observation, info["blocked"], reward
            self.terminated[t], self.truncated[t] = terminated, truncated
            # The step after an end begins the next episode: its memory is empty.
            begun, ended = ended, terminated | truncated
            self.memory[t + 1] = network.memory(self.memory[t], self.s[t], self.blocked[t], self.a[t], begun)
        values.append(self._values(-1, network, avoidance))
        # The rest for all steps at once.
        q, allowed = (torch.stack(column) for column in zip(*values, strict=True))
        self.v.copy_(best_value(q, allowed))
        wanted = torch.stack(explored)
        self.overruled = int((_of(wanted, self.a) < wanted.amax(-1)).sum())
        self.valid[0] = ~first
        self.valid[1:] = ~(self.terminated | self.truncated)[:-1]

    def _values(self, t: int, network: QNetwork, avoidance: Layer) -> tuple[Tensor, Tensor]:
        """Return Q-values of the actions in state t (E, A), and the mask of those that avoidance allows."""
        return network(self.s[t], self.memory[t]), avoidance(self.s[t], self.blocked[t])


def _of(values: Tensor, actions: Tensor) -> Tensor:
    """Return the values (...) of the given actions (...), out of those of all actions (..., A)."""
    return values.gather(-1, actions[..., None]).squeeze(-1)
