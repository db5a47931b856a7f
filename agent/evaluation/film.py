"""Play an agent's episode before watchers: one films it, the body, its rays and its trail in the house and
beside it the agent's map; another writes its trace (``agent.report.recorder``).
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

import torch
from PIL import Image
from torch import Tensor

from agent.build import policy_of
from agent.checkpoint import Checkpoint
from agent.evaluation.episodes import reset
from agent.evaluation.map_picture import MapPicture, beside
from agent.policies import QPolicy
from agent.progress import Report
from agent.simulator import sensor
from agent.world import make_envs
from logic import House
from sim import HouseVectorEnv
from sim.film import Camera, film

STRIDE = 4
"""Steps between frames: a full episode takes the paper's 15 s at 25 frames a second."""

WIDTH = 480
"""Pixels of the house's longer side, and of the map's."""


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
