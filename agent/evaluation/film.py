"""Film an agent's episode: the body, its rays and its trail in the house; beside it the agent's map."""

from pathlib import Path

import torch

from agent.build import policy_of
from agent.checkpoint import Checkpoint
from agent.evaluation.episodes import reset
from agent.evaluation.map_picture import MapPicture, beside
from agent.progress import Report
from agent.simulator import sensor
from agent.world import make_envs
from logic import House
from sim.film import Camera, film

STRIDE = 4
"""Steps between frames: a full episode takes the paper's 15 s at 25 frames a second."""

WIDTH = 480
"""Pixels of the house's longer side, and of the map's."""


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
) -> Path:
    """Write a GIF of the agent's episode in the house, whole or its first ``steps``; its path.

    With ``seed`` + i it is the episode that an evaluation with ``seed`` plays in its house i.
    """
    envs = make_envs([house], 1, targets, preset=sensor(agent.config))
    length = min(steps or envs.config.steps, envs.config.steps)
    observation = reset(envs, seed)
    policy = policy_of(agent.network, agent.config, envs, seed)
    policy.begin(1)
    blocked = torch.zeros(1, dtype=torch.bool)
    camera, map_picture, frames = Camera(envs, width=width), MapPicture(house, width), []

    def shoot() -> None:
        shot = camera.shoot()
        frames.append(beside(shot, map_picture.drawn(policy.tracker.planner)) if policy.tracker else shot)

    for step in range(length):
        actions = policy(observation, blocked)
        if policy.tracker and policy.tracker.planner.read("time")[0] == 1:
            map_picture.begin(envs.scene(0).pose)  # again where only the first wall shows how the body stands
        if step % stride == 0:
            shoot()
        observation, _, terminated, truncated, info = envs.step_torch(actions)
        blocked = info["blocked"]
        report((step + 1) / length, f"step {step + 1}")
        if terminated | truncated:
            break
    shoot()
    return film(frames, path)
