"""Films of an agent's episode: the body, its rays and its trail in the house, next to the agent's map.

Watchers may observe the episode, such as the writer of a trace (``agent.recording.recorder``).
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Protocol

import numpy as np
from PIL import Image

from vitruvius.agent.algorithms.build import policy_of
from vitruvius.agent.evaluation.episodes import reset
from vitruvius.agent.learning.environments import make_envs
from vitruvius.agent.learning.simulator import sensor
from vitruvius.agent.policies.episodes import Moment, moments
from vitruvius.agent.policies.policies import Explorer, QPolicy
from vitruvius.agent.progress import Report
from vitruvius.agent.recording.map_picture import MapPicture, beside
from vitruvius.agent.runs.checkpoint import Checkpoint
from vitruvius.logic import House
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.film import Camera, film, largest, mosaic

WIDTH = 480
"""Length of the house's longer side in a film of one house, in pixels."""

STRIDE = 4
"""Steps between frames: a full episode takes the paper's 15 s at 25 frames a second."""


class Watcher(Protocol):
    """Observer of an episode that is played in one environment."""

    def begin(self, envs: HouseVectorEnv, policy: QPolicy | Explorer) -> None:
        """Prepare for an episode."""
        ...

    def note(self, moment: Moment) -> None:
        """Observe the environment and the policy in their present state."""
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
    """Play the agent's episode in the house, or its first ``steps``, for ``watchers``: see ``record``."""
    envs, policy = _opened(agent, [house], targets, seed)
    for _ in _played(envs, policy, seed, steps, report, watchers):
        pass


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
    watchers: Sequence[Watcher] = (),
) -> Path:
    """Write a film of the agent's episode in the house, or of its first ``steps``; return its path.

    ``watchers`` observe the episode. With ``seed`` + i it is the episode that an evaluation with ``seed``
    plays in its house i.
    """
    envs, policy = _opened(agent, [house], targets, seed)
    planner = policy.tracker.planner if isinstance(policy, Explorer) else None
    camera, map_picture = Camera(envs, width=width), MapPicture(house, width)

    def shots() -> Iterator[Image.Image]:
        for moment in _played(envs, policy, seed, steps, report, watchers):
            if planner and planner.read("time")[0] == 1:
                # again, if only the first wall shows the body's orientation
                map_picture.begin(envs.scene(0).pose)
            if moment.step % stride == 0 or moment.actions is None:
                shot = camera.shoot()
                yield beside(shot, map_picture.drawn(planner), planner.body.prior) if planner else shot

    return film(shots(), path)


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
    """Write one film of an episode in each of many environments, side by side in rows; return its path.

    Environment i is in house i, from the first again if there are fewer houses, with starts and targets of
    ``seed`` + i. ``width`` is the number of pixels of each. An episode that ends early keeps its last
    picture.
    """
    count = columns * rows
    several = [houses[index % len(houses)] for index in range(count)]
    envs, policy = _opened(agent, several, targets, seed)
    frame = largest(several, width)
    cameras = [Camera(envs, index, width, frame) for index in range(count)]
    shots: list[np.ndarray] = [np.empty(0)] * count

    def frames() -> Iterator[np.ndarray]:
        over = np.zeros(count, bool)
        for moment in _played(envs, policy, seed, steps, report):
            ended, last = moment.ended.numpy(), moment.actions is None
            due = moment.step % stride == 0 or last
            for index in np.flatnonzero(~over & (due | ended)):
                shots[index] = np.asarray(cameras[index].shoot())
            over = ended
            if due:
                yield mosaic(shots, columns)

    return film(frames(), path)


def _opened(
    agent: Checkpoint, houses: Sequence[House], targets: str, seed: int
) -> tuple[HouseVectorEnv, QPolicy | Explorer]:
    """Return an environment in each house, and the agent's policy in them."""
    envs = make_envs(houses, len(houses), targets, preset=sensor(agent.config), backend=agent.config.backend)
    return envs, policy_of(agent.network, agent.config, envs, seed)


def _played(
    envs: HouseVectorEnv,
    policy: QPolicy | Explorer,
    seed: int,
    steps: int | None,
    report: Report,
    watchers: Sequence[Watcher] = (),
) -> Iterator[Moment]:
    """Play an episode in each environment, observed by ``watchers``; yield its moments."""
    for watcher in watchers:
        watcher.begin(envs, policy)
    length = min(steps or envs.config.steps, envs.config.steps)
    for moment in moments(envs, policy, reset(envs, seed), length):
        if moment.step:
            report(moment.step / length, f"step {moment.step}")
        for watcher in watchers:
            watcher.note(moment)
        yield moment
