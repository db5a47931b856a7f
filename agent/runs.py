"""A training run around the learner: worlds, a new network, progress to be seen, checkpoints on the way."""

from collections.abc import Sequence
from pathlib import Path
from time import perf_counter

import torch

from agent import checkpoint
from agent.checkpoint import Checkpoint
from agent.config import Config
from agent.map import FEATURES
from agent.network import seeded_network
from agent.progress import progress
from agent.train import Progress, learn
from agent.world import make_worlds, shield
from logic import House

SAVE_EVERY = 30.0
"""Seconds between checkpoints."""


def run(
    houses: Sequence[House], config: Config, path: Path, every: float | None = None
) -> tuple[Checkpoint, list[Progress]]:
    """Train a new agent in the houses; the checkpoint at ``path`` is never older than half a minute.

    ``every`` is the pause between the lines of progress in a pipe, in seconds; None: no lines.
    """
    torch.set_num_threads(config.threads)
    envs = make_worlds(houses, config.environments, config.targets)
    features = FEATURES if config.map else 0
    network = seeded_network(config.seed, envs.config.rays, envs.config.channels, config.half_lives, features)
    history: list[Progress] = []
    saved = perf_counter()
    with progress("training", every) as tell:
        for now in learn(envs, network, shield(envs), config):
            history.append(now)
            tell(now.fraction, f"{now.steps / 1e6:.2f} M steps, {now.targets:.1f} targets per 1500 steps")
            if perf_counter() - saved > SAVE_EVERY:
                checkpoint.save(Checkpoint(network, config, now.steps), path)
                saved = perf_counter()
    result = Checkpoint(network.eval(), config, history[-1].steps)
    checkpoint.save(result, path)
    return result, history
