"""Comparison of an agent's choices of a viewpoint with those of the explorer, from the same state.

While an agent plays, the explorer's planner keeps the same map. When the agent chooses a viewpoint, the
explorer chooses one too, and the states of simulator and planner are kept. Then both choices are played from
there: the same explorer goes to one or the other viewpoint, and continues with its own choices. Targets,
noise and map are the same, so only the choice makes a difference.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import torch

from vitruvius.agent.evaluation.episodes import reset
from vitruvius.agent.learning.environments import shield
from vitruvius.agent.planner import Planner
from vitruvius.agent.planner.core.state import AT, NONE, SEARCH, SIZE
from vitruvius.agent.planner.paths import UNREACHED
from vitruvius.agent.planner.planner import STATE
from vitruvius.agent.policies.episodes import moments
from vitruvius.agent.policies.policies import Explorer, Policy, Tracker
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.world.phases import BLOCKED

MEMORY = tuple(name for name in STATE if name != "advice")
"""Arrays of planners that determine their next steps."""

LONG_AGO = 1 << 20
"""Number of steps since a search for paths that is large enough to cause another search."""


class Tracked(Policy, Protocol):
    """Policy that chooses viewpoints with planners."""

    tracker: Tracker


@dataclass(frozen=True)
class Decisions:
    """Choices of viewpoints, (n,) each."""

    environment: np.ndarray
    """Environment of each choice."""
    step: np.ndarray
    """Steps of the episode before the choice."""
    differs: np.ndarray
    """Bool: True if the explorer would have gone elsewhere, or looked elsewhere from the same place."""
    targets: np.ndarray
    """(n, 2) targets found in the next steps, after the agent's choice and after the explorer's."""


@dataclass(frozen=True)
class Kept:
    """States of one environment before a decision, and both goals."""

    simulator: dict[str, np.ndarray]
    planner: dict[str, np.ndarray]
    action: int
    goals: tuple[tuple[int, int], tuple[int, int]]
    """A node and a heading each: the agent's goal, and the explorer's."""


def decisions(
    envs: HouseVectorEnv,
    again: HouseVectorEnv,
    policy: Tracked,
    houses: int,
    steps: int,
    ahead: int,
    share: float,
) -> Decisions:
    """Sample a ``share`` of an agent's choices in an episode of ``steps``.

    Each choice is continued for ``ahead`` steps. Environment i of ``envs`` is in house i modulo ``houses``.
    ``again`` has environments with the same arguments, as many as continue together. Choices in the last
    ``ahead`` steps are left out.
    """
    batch, where, targets, differs = [], [], [], []

    def play_on() -> None:
        targets.append(played_on(again, batch, ahead))
        batch.clear()

    for environment, step, kept in sampled(envs, policy, houses, steps - ahead, share):
        where.append((environment, step))
        differs.append(kept.goals[0] != kept.goals[1])
        if differs[-1]:
            batch.append(kept)
        if len(batch) == again.num_envs:
            play_on()
    if batch:
        play_on()
    found, different = np.zeros((len(where), 2)), np.array(differs, bool)
    found[different] = np.concatenate([np.zeros((0, 2)), *targets])
    environments, times = np.array(where, int).reshape(-1, 2).T
    return Decisions(environments, times, different, found)


def sampled(
    envs: HouseVectorEnv, policy: Tracked, houses: int, steps: int, share: float
) -> Iterator[tuple[int, int, Kept]]:
    """Play an episode, and yield (environment, step, ``Kept``) for a ``share`` of the choices."""
    count, rng = envs.num_envs, np.random.default_rng(0)
    observation = reset(envs, 0, np.arange(count) % houses)
    explorer = Tracker(envs.config)
    explorer.begin(count)
    for now in moments(envs, policy, observation, steps, through=True):
        if now.actions is None:
            return
        chosen = _new(policy.tracker.planner) & (rng.random(count) < share) & (now.step > 0)
        rows = np.flatnonzero(chosen)
        before = [_memory(explorer.planner, row) for row in rows]
        last = explorer.actions
        states = explorer.planner.arrays["states"].view().reshape(count, SIZE)
        states[rows, AT["kind"]] = NONE  # so that it chooses now
        own = explorer.look(now.observation, now.blocked)
        explorer.actions = now.actions
        simulator = envs.state if len(rows) else {}
        # If the explorer believes that it knows the target's place, there is nothing to compare.
        both = _new(own)
        for row, memory in zip(rows, before, strict=True):
            if both[row]:
                goals = _goal(policy.tracker.planner, row), _goal(own, row)
                _aim(memory, own, row)
                yield int(row), now.step, Kept(_row(simulator, row), memory, int(last[row]), goals)


def played_on(envs: HouseVectorEnv, batch: list[Kept], steps: int) -> np.ndarray:
    """Return the targets (n, 2) that the explorer finds after the agent's choice and after its own.

    It continues from kept states (n).
    """
    count, policy = envs.num_envs, Explorer(shield(envs), envs.config)
    filled = [batch[k % len(batch)] for k in range(count)]
    found = np.zeros((2, count))
    envs.reset(seed=0)
    for which in range(2):
        envs.state = {
            name: np.stack([kept.simulator[name] for kept in filled], axis=int(name == "flags"))
            for name in filled[0].simulator
        }
        policy.begin(count)
        tracker = policy.tracker
        tracker.fresh.fill_(False)
        tracker.actions = torch.tensor([kept.action for kept in filled])
        for name in MEMORY:
            if filled[0].planner[name].size:
                tracker.planner.arrays[name].fill(np.concatenate([kept.planner[name] for kept in filled]))
        states = tracker.planner.arrays["states"].view().reshape(count, SIZE)
        states[:, [AT["goal"], AT["look"]]] = [kept.goals[which] for kept in filled]
        observation = torch.from_numpy(envs.state["observation"])
        blocked = torch.from_numpy(envs.state["flags"][BLOCKED])
        for now in moments(envs, policy, observation, steps, blocked=blocked, through=True):
            found[which] += now.reward.numpy()
    return found[:, : len(batch)].T


def _new(planner: Planner) -> np.ndarray:
    """Return a mask (E,) bool of the environments in which a viewpoint was chosen in the last step."""
    return ((planner.read("kind") == SEARCH) & (planner.read("plan_age") == 0)).numpy()


def _goal(planner: Planner, row: int) -> tuple[int, int]:
    return int(planner.read("goal")[row]), int(planner.read("look")[row])


def _memory(planner: Planner, row: int) -> dict[str, np.ndarray]:
    """Return one environment's part of a planner's memory, without the arrays that are not used."""
    count, memory = len(planner.advice), {}
    for name in MEMORY:
        array = planner.arrays[name].view().reshape(-1)
        parts = len(array) // count if len(array) >= count else 0
        memory[name] = array[row * parts : (row + 1) * parts].copy()
    return memory


def _aim(memory: dict[str, np.ndarray], planner: Planner, row: int) -> None:
    """Let a planner with this memory go to a given goal at once; the goal is set later.

    The eye's place must have some path, or the planner gives up the goal before it searches for paths.
    """
    side = 1 << planner.config.map_bits
    x, y = (int(planner.read(name)[row]) for name in ("x", "y"))
    about = {((y + j >> 1) % side) * side + (x + i >> 1) % side for j in range(2) for i in range(2)}
    memory["distance"][:] = UNREACHED
    memory["distance"][list(about)] = 1
    memory["queue"][: len(about)] = list(about)
    changes = {"kind": SEARCH, "plan_age": 0, "stale": 1, "path_age": LONG_AGO, "queued": len(about)}
    for name, value in changes.items():
        memory["states"][AT[name]] = value


def _row(state: dict[str, np.ndarray], row: int) -> dict[str, np.ndarray]:
    return {name: array[:, row] if name == "flags" else array[row] for name, array in state.items()}
