"""Play an agent's episode before watchers: one films it, the body, its rays and its trail in the house and
beside it the agent's map; another writes its trace (``agent.report.recorder``).
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Protocol

import numpy as np
import torch
from PIL import Image
from torch import Tensor

from agent.build import policy_of
from agent.checkpoint import Checkpoint
from agent.evaluation.commands import WIDTH
from agent.evaluation.episodes import reset
from agent.evaluation.map_picture import MapPicture, beside
from agent.policies import Policy, QPolicy
from agent.progress import Report
from agent.simulator import sensor
from agent.world import make_envs
from logic import House
from sim import HouseVectorEnv
from sim.film import Camera, film, largest, mosaic

STRIDE = 4
"""Steps between frames: a full episode takes the paper's 15 s at 25 frames a second."""


class Watcher(Protocol):
    """What looks on while an episode is played in one environment."""

    def begin(self, envs: HouseVectorEnv, policy: QPolicy) -> None:
        """An episode begins."""
        ...

    def chose(self, step: int, action: int) -> None:
        """The policy has chosen; its action is not made yet."""
        ...

    def moved(self, blocked: bool) -> None:
        """The action is made."""
        ...

    def end(self) -> None:
        """The episode is over, or watched for as long as it should be."""
        ...


def watch(
    agent: Checkpoint,
    house: House,
    watchers: Sequence[Watcher],
    *,
    targets: str = "main",
    seed: int = 0,
    steps: int | None = None,
    report: Report = lambda done, words: None,
) -> None:
    """Play the agent's episode in the house, whole or its first ``steps``.

    With ``seed`` + i it is the episode that an evaluation with ``seed`` plays in its house i.
    """
    envs = make_envs([house], 1, targets, preset=sensor(agent.config))
    length = min(steps or envs.config.steps, envs.config.steps)
    observation = reset(envs, seed)
    policy = policy_of(agent.network, agent.config, envs, seed)
    policy.begin(1)
    blocked = torch.zeros(1, dtype=torch.bool)
    for watcher in watchers:
        watcher.begin(envs, policy)
    for step in range(length):
        actions: Tensor = policy(observation, blocked)
        for watcher in watchers:
            watcher.chose(step, int(actions[0]))
        observation, _, terminated, truncated, info = envs.step_torch(actions)
        blocked = info["blocked"]
        for watcher in watchers:
            watcher.moved(bool(blocked[0]))
        report((step + 1) / length, f"step {step + 1}")
        if terminated | truncated:
            break
    for watcher in watchers:
        watcher.end()


class Filming:
    """Draws every ``stride``-th step, and the last state."""

    def __init__(self, stride: int = STRIDE, width: int = WIDTH) -> None:
        """Draw pictures of this width, in pixels."""
        self.stride, self.width, self.frames = stride, width, list[Image.Image]()

    def begin(self, envs: HouseVectorEnv, policy: QPolicy) -> None:
        """See ``Watcher``."""
        self.envs, self.policy = envs, policy
        self.camera, self.map = Camera(envs, width=self.width), MapPicture(envs.houses[0], self.width)

    def chose(self, step: int, action: int) -> None:
        """See ``Watcher``."""
        tracker = self.policy.tracker
        if tracker and tracker.planner.read("time")[0] == 1:
            self.map.begin(
                self.envs.scene(0).pose
            )  # again where only the first wall shows how the body stands
        if step % self.stride == 0:
            self.shoot()

    def moved(self, blocked: bool) -> None:
        """See ``Watcher``."""

    def end(self) -> None:
        """See ``Watcher``."""
        self.shoot()

    def shoot(self) -> None:
        """Draw the environment, and the map if there is one."""
        shot, tracker = self.camera.shoot(), self.policy.tracker
        self.frames.append(beside(shot, self.map.drawn(tracker.planner)) if tracker else shot)


def record(
    agent: Checkpoint,
    house: House,
    path: Path,
    *,
    targets: str = "main",
    seed: int = 0,
    steps: int | None = None,
    stride: int = STRIDE,
    width: int = WIDTH,
    report: Report = lambda done, words: None,
    others: Sequence[Watcher] = (),
) -> Path:
    """Write a GIF of the agent's episode in the house, as ``watch`` plays it, before ``others`` beside the
    camera; its path.
    """
    filming = Filming(stride, width)
    watch(agent, house, [filming, *others], targets=targets, seed=seed, steps=steps, report=report)
    return film(filming.frames, path)


def record_mosaic(
    agent: Checkpoint,
    houses: Sequence[House],
    path: Path,
    columns: int,
    rows: int,
    *,
    targets: str = "main",
    seed: int = 0,
    steps: int | None = None,
    stride: int = STRIDE,
    width: int = WIDTH,
    report: Report = lambda done, words: None,
) -> Path:
    """Write one film of an episode in each of many environments, side by side in rows; its path.

    Environment i is in house i, from the first again where there are fewer, with starts and targets of
    ``seed`` + i. ``width``: pixels of each. Where an episode ends before the others, its last picture stays.
    """
    count = columns * rows
    several = [houses[index % len(houses)] for index in range(count)]
    envs = make_envs(several, count, targets, preset=sensor(agent.config))
    policy = policy_of(agent.network, agent.config, envs, seed)
    frame = largest(several, width)
    cameras = [Camera(envs, index, width, frame) for index in range(count)]
    shots: list[np.ndarray] = [np.empty(0)] * count

    def frames() -> Iterator[np.ndarray]:
        over = np.zeros(count, bool)
        for step, ended in _played(envs, policy, seed, steps, report):
            due = step % stride == 0 or bool(ended.all())
            for index in np.flatnonzero(~over & (due | ended)):
                shots[index] = np.asarray(cameras[index].shoot())
            over = ended
            if due:
                yield mosaic(shots, columns)

    return film(frames(), path)


def _played(
    envs: HouseVectorEnv, policy: Policy, seed: int, steps: int | None, report: Report
) -> Iterator[tuple[int, np.ndarray]]:
    """Play an episode in each environment: before each step and after the last one, yields its number, and
    which episodes have ended, (E,) bool.
    """
    observation, length = reset(envs, seed), min(steps or envs.config.steps, envs.config.steps)
    policy.begin(envs.num_envs)
    blocked = torch.zeros(envs.num_envs, dtype=torch.bool)
    ended = np.zeros(envs.num_envs, bool)
    for step in range(length):
        actions = policy(observation, blocked)
        yield step, ended
        observation, _, terminated, truncated, info = envs.step_torch(actions)
        blocked = info["blocked"]
        ended = ended | (terminated | truncated).numpy()
        report((step + 1) / length, f"step {step + 1}")
        if ended.all():
            break
    yield length, np.ones(envs.num_envs, bool)
