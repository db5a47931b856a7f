"""Evaluation: every player plays one episode in every house, with the same targets in the same order."""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import torch

from agent.avoidance import PaperRule
from agent.build import policy_of
from agent.checkpoint import Checkpoint
from agent.policies import Policy, RandomPolicy
from agent.progress import Report
from agent.statistics import Estimate, interquartile_mean
from sim import HouseVectorEnv
from sim.lookout import Lookout
from sim.oracle import Oracle

MARKS = (500, 1500)
"""Steps after which coverage is noted, or at the episode's end if that comes before."""


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

    first: np.ndarray = field(default_factory=lambda: np.empty(0))
    """(H,) steps until the first target was picked up; infinite where none was."""

    coverage: np.ndarray = field(default_factory=lambda: np.empty((2, 0)))
    """(2, H) share of the house that it had looked at after each of ``MARKS``; see ``sim.lookout``."""

    rooms: np.ndarray = field(default_factory=lambda: np.empty(0))
    """(H,) secondary rooms that it was in."""

    def count(self) -> Estimate:
        """Targets in an episode: interquartile mean over the houses."""
        return interquartile_mean(self.targets)

    def ratio(self, oracle: "Score") -> Estimate:
        """Targets as a share of what the oracle picks up in the same house: interquartile mean over them."""
        return interquartile_mean(self.targets / oracle.targets)


class Scores(NamedTuple):
    """The players of a short evaluation, in the order of its table. For the whole one see ``protocol``."""

    agent: Score
    walk: Score
    oracle: Score


def evaluate(
    agent: Checkpoint, envs: HouseVectorEnv, *, seed: int = 0, tell: Report = lambda done, words: None
) -> Scores:
    """What the agent, the random walk and the oracle do, one episode a house; ``tell`` follows it.

    ``envs`` has an environment for each house of its bank.
    """
    policy = policy_of(agent.network, agent.config, envs, seed)
    chance = torch.Generator().manual_seed(seed)
    tell(0.0, "agent")
    agent_score = play("agent", envs, policy, seed)
    tell(0.3, "random + avoidance")
    walk_score = play("random + avoidance", envs, RandomPolicy(PaperRule(chance), chance), seed)
    tell(0.6, "shortest-path oracle")
    oracle_score = play_oracle(envs, seed)
    tell(1.0, f"{envs.num_envs} houses")
    return Scores(agent_score, walk_score, oracle_score)


def play(
    player: str,
    envs: HouseVectorEnv,
    policy: Policy,
    seed: int,
    houses: np.ndarray | None = None,
    watch: Lookout | None = None,
) -> Score:
    """One episode of the policy in each environment: environment i in house i, or in ``houses[i]``.

    Starts and targets are drawn by (seed + i, episode, counter) and never depend on the player, so that all
    players of one seed face the same. With a ``watch`` over the environments it is noted, too, how much of
    its house the player looked at, and the rooms that it was in.
    """
    observation = begin(envs, seed, houses)
    policy.begin(envs.num_envs)
    targets, playing = torch.zeros(envs.num_envs), torch.ones(envs.num_envs, dtype=torch.bool)
    first = torch.full((envs.num_envs,), torch.inf)
    blocked, steps, bumps, time = torch.zeros_like(playing), 0, 0, 0
    seen = _Seen(watch, envs.num_envs)
    while playing.any():
        actions = policy(observation, blocked)
        observation, reward, terminated, truncated, info = envs.step_torch(actions)
        time += 1
        first[(targets == 0) & (reward > 0) & playing] = time
        targets += reward * playing
        steps += int(playing.sum())
        blocked = info["blocked"]
        bumps += int((blocked & playing).sum())
        still = playing & ~(terminated | truncated)
        seen.note(time, playing.numpy(), still.numpy())
        playing = still
    return Score(
        player,
        targets.numpy(),
        steps,
        bumps,
        policy.interventions,
        first=first.numpy(),
        coverage=seen.coverage,
        rooms=seen.rooms,
    )


def play_oracle(envs: HouseVectorEnv, seed: int) -> Score:
    """The same episodes by shortest ways on the true map, one target after the other."""
    begin(envs, seed)
    oracle = Oracle(envs)
    try:
        return Score("shortest-path oracle", oracle.play())
    finally:
        oracle.close()


def begin(envs: HouseVectorEnv, seed: int, houses: np.ndarray | None = None) -> torch.Tensor:
    """Begin the episodes of the protocol; observations (E, R, C)."""
    houses = np.arange(envs.num_envs) if houses is None else houses
    return torch.as_tensor(envs.reset(seed=seed, options={"house": houses})[0])


class _Seen:
    """What a watch saw of each environment's one episode; nothing without a watch."""

    def __init__(self, watch: Lookout | None, count: int) -> None:
        self.watch = watch
        self.coverage, self.rooms = np.zeros((len(MARKS), count)), np.zeros(count, int)
        if watch is not None:
            watch.begin()

    def note(self, time: int, playing: np.ndarray, still: np.ndarray) -> None:
        """After a step that those environments made that were ``playing``; some are ``still``."""
        if self.watch is None:
            return
        self.watch.look()
        ended = playing & ~still
        if ended.any():
            self.rooms[ended] = self.watch.rooms()[ended]
        if ended.any() or time in MARKS:
            share = self.watch.share()
            for coverage, mark in zip(self.coverage, MARKS, strict=True):
                now = playing if time == mark else ended & (time < mark)
                coverage[now] = share[now]
