"""One episode in each environment: what a policy picks up there, and how it goes about it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch

from agent.policies.episodes import moments
from agent.policies.policies import Policy
from sim import HouseVectorEnv
from sim.baselines.coverage import Coverage

COVERAGE_STEPS = (500, 1500)
"""Steps after which coverage is noted, or at the episode's end if that comes before."""


@dataclass(frozen=True)
class EpisodeScores:
    """What a policy did in H houses, one episode each."""

    targets: np.ndarray
    """(H,) targets picked up in each house."""

    steps: int
    """Steps of all episodes together."""

    blocked: int
    """Moves that walls or furniture blocked, in all episodes."""

    interventions: int
    """Actions that the avoidance layer changed, in all episodes."""

    first: np.ndarray
    """(H,) steps until the first target was picked up; infinite where none was."""

    coverage: np.ndarray
    """(2, H) share of the house that it had seen after each of ``COVERAGE_STEPS``; see ``Coverage``."""

    rooms: np.ndarray
    """(H,) number of secondary rooms that it was in."""


def play(
    envs: HouseVectorEnv,
    policy: Policy,
    seed: int | Sequence[int],
    houses: np.ndarray | None = None,
    coverage: Coverage | None = None,
) -> EpisodeScores:
    """Play one episode of the policy in each environment: environment i in house i, or in ``houses[i]``.

    Starts and targets are sampled by (seed + i, episode, counter), or by the i-th of several seeds. They
    never depend on the policy, so all policies meet the same for one seed. With ``coverage`` of the
    environments, it and the rooms that the body was in are noted too.
    """
    observation = reset(envs, seed, houses)
    targets, playing = torch.zeros(envs.num_envs), torch.ones(envs.num_envs, dtype=torch.bool)
    first, steps, bumps = torch.full((envs.num_envs,), torch.inf), 0, 0
    noted = _CoverageNotes(coverage, envs.num_envs)
    for now in moments(envs, policy, observation):
        if not now.step:
            continue
        first[(targets == 0) & (now.reward > 0) & playing] = now.step
        targets += now.reward * playing
        steps += int(playing.sum())
        bumps += int((now.blocked & playing).sum())
        noted.note(now.step, playing.numpy(), ~now.ended.numpy())
        playing = ~now.ended
    return EpisodeScores(
        targets.numpy(),
        steps,
        bumps,
        policy.interventions,
        first.numpy(),
        noted.shares,
        noted.rooms,
    )


def reset(envs: HouseVectorEnv, seed: int | Sequence[int], houses: np.ndarray | None = None) -> torch.Tensor:
    """Begin the episodes that ``play`` plays; their first observations (E, R, C)."""
    houses = np.arange(envs.num_envs) if houses is None else houses
    return torch.as_tensor(envs.reset(seed=seed, options={"house": houses})[0])


class _CoverageNotes:
    """How much of its house each body has looked at, and its rooms; zeros where that is not asked for."""

    def __init__(self, coverage: Coverage | None, count: int) -> None:
        self.coverage = coverage
        self.shares, self.rooms = np.zeros((len(COVERAGE_STEPS), count)), np.zeros(count, int)
        if coverage is not None:
            coverage.begin()

    def note(self, time: int, playing: np.ndarray, still: np.ndarray) -> None:
        """Look after a step of the environments (E,) bool ``playing``, of which some are ``still``."""
        if self.coverage is None:
            return
        self.coverage.look()
        ended = playing & ~still
        if ended.any():
            self.rooms[ended] = self.coverage.rooms()[ended]
        if ended.any() or time in COVERAGE_STEPS:
            share = self.coverage.share()
            for shares, step in zip(self.shares, COVERAGE_STEPS, strict=True):
                now = playing if time == step else ended & (time < step)
                shares[now] = share[now]
