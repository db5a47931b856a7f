"""Walks that the planner's tests share: recorded once, and replayed through planners step by step."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
import pytest
import torch

from tests.agent.learning.test_environments import mirror
from tests.agent.planner.adapter import UNKNOWN, Planner
from tests.sample_houses import random_house
from vitruvius.agent.learning.environments import make_envs
from vitruvius.logic import House, generate
from vitruvius.sim import DEFAULT, HouseVectorEnv
from vitruvius.sim.actions import HEADINGS

E, STEPS = 8, 240


class Step(NamedTuple):
    """Step of one environment's planner: its inputs, and its memory before and after."""

    e: int
    observation: np.ndarray
    blocked: bool
    action: int
    before: Any
    after: Any


@dataclass
class Walk:
    """Steps of environments in houses, and the truth: poses, targets and rewards (E,)."""

    envs: HouseVectorEnv
    planner: Planner
    inputs: list[tuple[np.ndarray, ...]] = field(default_factory=list)
    poses: list[np.ndarray] = field(default_factory=list)
    targets: list[np.ndarray] = field(default_factory=list)
    rewards: list[np.ndarray] = field(default_factory=list)

    @property
    def cell(self) -> float:
        """Metres."""
        return self.planner.tested.cell

    @property
    def houses(self) -> list[House]:
        return [self.envs.houses[e % len(self.envs.houses)] for e in range(self.envs.num_envs)]

    def record(self, steps: int, random: float = 0.0) -> "Walk":
        """Record a walk that follows the planner; a ``random`` fraction of steps is random."""
        number, noise = self.envs.num_envs, np.random.default_rng(0)
        options = {"house": np.arange(number) % len(self.envs.houses)}
        observation, info = self.envs.reset(seed=2, options=options)
        blocked, action, reward = np.zeros(number, bool), np.zeros(number, np.int64), np.zeros(number)
        for step in range(steps):
            self.inputs.append((observation.copy(), blocked.copy(), action, np.full(number, step == 0)))
            self.poses.append(info["pose"].copy())
            self.targets.append(info["target"].copy())
            self.rewards.append(reward)
            self.planner.step(*self.inputs[-1])
            advised = noise.random(number) >= random
            action = np.where(
                advised, self.planner.array("advice")[:, 0], noise.choice(3, number, p=[0.2, 0.1, 0.7])
            )
            observation, reward, _, _, info = self.envs.step(action)
            blocked = info["blocked"]
        return self

    def __iter__(self) -> Iterator[Step]:
        """Yield the walk's steps, replayed by the planner; environments of a step follow each other."""
        before = [self.planner.memory(e) for e in range(self.envs.num_envs)]
        for inputs in self.inputs:
            self.planner.step(*inputs)
            for e, (observation, blocked, action, _) in enumerate(zip(*inputs, strict=True)):
                after = self.planner.memory(e)
                yield Step(e, observation, bool(blocked), int(action), before[e], after)
                before[e] = after


def ask(
    planner: Planner,
    memories: list[Any],
    poses: list[tuple[int, int, int]],
    keep: bool = False,
    **numbers: Any,
) -> list[Any]:
    """Return planners with these memories, one for each environment, at a pose each, in half cells.

    The planners have taken a step forward to the pose without a look. They have no goal unless ``numbers``
    give one, and no gains and no tried viewpoints unless they ``keep`` theirs.
    """
    quiet = {"time": 301, "since": 280, "new": 0, "straight": 0, "known": 0, "kind": "none", "aligned": 1}
    for e, (memory, (x, y, heading)) in enumerate(zip(memories, poses, strict=True)):
        dx, dy = (planner.tested.body.step * way for way in HEADINGS[heading])
        target = {"target": memory.target} if numbers.get("known") else {}
        planner.write(e, memory, x=x - dx, y=y - dy, heading=heading, **(quiet | numbers | target))
    if not keep:
        planner.array("gains")[:], planner.array("candidates")[:] = UNKNOWN, 0
    number, world = len(memories), planner.tested.world
    blank, no = np.zeros((number, world.rays, world.channels), np.float32), np.zeros(number, bool)
    planner.step(blank, no, np.full(number, 2), no)
    return [planner.memory(e) for e in range(number)]


@pytest.fixture(scope="session")
def continuous() -> Walk:
    """Return a walk in seven furnished houses and the mirror image of the first."""
    torch.set_num_threads(1)
    houses = [random_house(seed) for seed in range(E - 1)]
    envs = make_envs([*houses, mirror(houses[0])], E, "mixed")
    return Walk(envs, Planner(envs.config, E)).record(STEPS, random=0.2)


@pytest.fixture(scope="session")
def planner() -> Planner:
    """Planners whose memories tests write."""
    return Planner(DEFAULT, E)


@pytest.fixture(scope="session")
def grid() -> Walk:
    """Return a walk in a house whose edges lie on a grid, in whose cells bodies stand."""
    torch.set_num_threads(1)
    envs = make_envs(list(generate(3, seed=5, count=1, cell=0.3)), E, "mixed", backend="grid")
    return Walk(envs, Planner(envs.config, E)).record(STEPS, random=0.2)


@pytest.fixture(params=["continuous", "grid"])
def walk(request: pytest.FixtureRequest) -> Walk:
    return request.getfixturevalue(request.param)
