"""Evaluation: every player plays one episode in every house, with the same targets in the same order."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import torch

from agent.avoidance import PaperRule
from agent.network import QNetwork
from agent.policies import Policy, QPolicy, RandomPolicy
from agent.progress import Report
from agent.statistics import Estimate, interquartile_mean
from agent.world import make_worlds, shield
from logic import House
from sim import HouseVectorEnv


@dataclass(frozen=True)
class Score:
    """What a player did in H houses, one episode each."""

    player: str
    """Who played."""

    targets: np.ndarray
    """(H,) targets picked up in each house."""

    steps: int = 0
    """Steps of all episodes together."""

    blocked: int = 0
    """Moves that walls or furniture blocked."""

    interventions: int = 0
    """Actions that the avoidance layer changed."""

    def count(self) -> Estimate:
        """Targets in an episode: interquartile mean over the houses."""
        return interquartile_mean(self.targets)

    def ratio(self, oracle: "Score") -> Estimate:
        """Targets as a share of what the oracle picks up in the same house: interquartile mean over them."""
        return interquartile_mean(self.targets / oracle.targets)


class Scores(NamedTuple):
    """The players of an evaluation, in the order of its table."""

    agent: Score
    walk: Score
    oracle: Score


def evaluate(
    network: QNetwork,
    houses: Sequence[House],
    *,
    targets: str = "main",
    seed: int = 0,
    tell: Report = lambda done, words: None,
) -> Scores:
    """What the agent, the random walk and the oracle do, one episode a house; ``tell`` follows it."""
    envs = make_worlds(houses, len(houses), targets)
    agent = QPolicy(network, shield(envs), torch.Generator().manual_seed(seed))
    chance = torch.Generator().manual_seed(seed)
    tell(0.0, "agent")
    agent_score = play("agent", envs, agent, seed)
    tell(0.3, "random + avoidance")
    walk_score = play("random + avoidance", envs, RandomPolicy(PaperRule(chance), chance), seed)
    tell(0.6, "shortest-path oracle")
    oracle_score = play_oracle(envs, seed)
    tell(1.0, f"{len(houses)} houses")
    return Scores(agent_score, walk_score, oracle_score)


def play(player: str, envs: HouseVectorEnv, policy: Policy, seed: int) -> Score:
    """One episode of the policy in each environment: environment i plays in house i of the bank.

    Starts and targets are drawn by (seed + i, episode, counter) and never depend on the player, so that all
    players of one seed face the same.
    """
    observation = _begin(envs, seed)
    policy.begin(envs.num_envs)
    targets, playing = torch.zeros(envs.num_envs), torch.ones(envs.num_envs, dtype=torch.bool)
    steps = blocked = 0
    while playing.any():
        actions = policy(observation)
        observation, reward, terminated, truncated, info = envs.step_torch(actions)
        targets += reward * playing
        steps += int(playing.sum())
        blocked += int((info["blocked"] & playing).sum())
        playing &= ~(terminated | truncated)
    return Score(player, targets.numpy(), steps, blocked, policy.interventions)


def play_oracle(envs: HouseVectorEnv, seed: int) -> Score:
    """The same episodes by shortest ways on the true map, one target after the other."""
    from sim.oracle import Oracle  # its kernels need a running Taichi, which the worlds have started

    _begin(envs, seed)
    oracle = Oracle(envs)
    try:
        return Score("shortest-path oracle", oracle.play())
    finally:
        oracle.close()


def _begin(envs: HouseVectorEnv, seed: int) -> torch.Tensor:
    """Begin the episodes of the protocol; observations (E, R, C)."""
    observation, _ = envs.reset(seed=seed, options={"house": np.arange(envs.num_envs)})
    return torch.as_tensor(observation)
