"""Film an agent's episode: the body, its rays and its trail, every few steps."""

from pathlib import Path

import torch

from agent.build import policy_of
from agent.checkpoint import Checkpoint
from agent.evaluation.episodes import reset
from agent.progress import Report
from agent.world import make_envs, sensor
from logic import House
from sim.film import Camera, film

STRIDE = 4
"""Steps between frames: a full episode takes the paper's 15 s at 25 frames a second."""


def record(
    agent: Checkpoint,
    house: House,
    path: Path,
    *,
    targets: str = "main",
    seed: int = 0,
    steps: int | None = None,
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
    camera = Camera(envs, width=640)
    frames = [camera.shoot()]
    for step in range(1, length + 1):
        observation, _, terminated, truncated, info = envs.step_torch(policy(observation, blocked))
        blocked = info["blocked"]
        ended = bool(terminated | truncated)
        if step % STRIDE == 0 or ended:
            frames.append(camera.shoot())
        report(step / length, f"step {step}")
        if ended:
            break
    return film(frames, path)
