"""Evaluation: every player plays one episode in every house, with the same targets in the same order."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import torch

from agent.avoidance import PaperRule
from agent.network import QNetwork
from agent.policies import Policy, QPolicy, RandomPolicy
from agent.progress import Report
from agent.statistics import Estimate, interquartile_mean
from agent.world import shield
from sim import HouseVectorEnv
from sim.oracle import Oracle


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
    network: QNetwork, envs: HouseVectorEnv, *, seed: int = 0, tell: Report = lambda done, words: None
) -> Scores:
    """What the agent, the random walk and the oracle do, one episode a house; ``tell`` follows it.

    ``envs`` has an environment for each house of its bank.
    """
    agent = QPolicy(network, shield(envs), torch.Generator().manual_seed(seed))
    chance = torch.Generator().manual_seed(seed)
    tell(0.0, "agent")
    agent_score = play("agent", envs, agent, seed)
    tell(0.3, "random + avoidance")
    walk_score = play("random + avoidance", envs, RandomPolicy(PaperRule(chance), chance), seed)
    tell(0.6, "shortest-path oracle")
    oracle_score = play_oracle(envs, seed)
    tell(1.0, f"{envs.num_envs} houses")
    return Scores(agent_score, walk_score, oracle_score)


def play(
    player: str, envs: HouseVectorEnv, policy: Policy, seed: int, houses: np.ndarray | None = None
) -> Score:
    """One episode of the policy in each environment: environment i in house i, or in ``houses[i]``.

    Starts and targets are drawn by (seed + i, episode, counter) and never depend on the player, so that all
    players of one seed face the same.
    """
    observation = _begin(envs, seed, houses)
    policy.begin(envs.num_envs)
    targets, playing = torch.zeros(envs.num_envs), torch.ones(envs.num_envs, dtype=torch.bool)
    blocked, steps, bumps = torch.zeros_like(playing), 0, 0
    while playing.any():
        actions = policy(observation, blocked)
        observation, reward, terminated, truncated, info = envs.step_torch(actions)
        targets += reward * playing
        steps += int(playing.sum())
        blocked = info["blocked"]
        bumps += int((blocked & playing).sum())
        playing &= ~(terminated | truncated)
    return Score(player, targets.numpy(), steps, bumps, policy.interventions)


def play_oracle(envs: HouseVectorEnv, seed: int) -> Score:
    """The same episodes by shortest ways on the true map, one target after the other."""
    _begin(envs, seed)
    oracle = Oracle(envs)
    try:
        return Score("shortest-path oracle", oracle.play())
    finally:
        oracle.close()


def _begin(envs: HouseVectorEnv, seed: int, houses: np.ndarray | None = None) -> torch.Tensor:
    """Begin the episodes of the protocol; observations (E, R, C)."""
    houses = np.arange(envs.num_envs) if houses is None else houses
    return torch.as_tensor(envs.reset(seed=seed, options={"house": houses})[0])
