"""One episode in each environment: the targets that a policy picks up, and its behaviour."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch

from vitruvius.agent.baselines.coverage import Coverage
from vitruvius.agent.policies.episodes import moments
from vitruvius.agent.policies.policies import Policy
from vitruvius.sim import HouseVectorEnv

COVERAGE_STEPS = (500, 1500)
"""Steps after which coverage is noted; a shorter episode notes it at its end."""


@dataclass(frozen=True)
class EpisodeScores:
    """Scores of a policy in H houses, one episode each."""

    targets: np.ndarray
    """(H,) targets picked up in each house."""

    steps: int
    """Steps of all episodes together."""

    blocked: int
    """Moves that walls or furniture blocked, in all episodes."""

    interventions: int
    """Actions that the avoidance layer changed, in all episodes."""

    first: np.ndarray
    """(H,) steps until the first target was picked up; infinite without one."""

    coverage: np.ndarray
    """(2, H) fraction of the house seen after each of ``COVERAGE_STEPS``; see ``Coverage``."""

    rooms: np.ndarray
    """(H,) number of secondary rooms visited."""


def play(
    envs: HouseVectorEnv,
    policy: Policy,
    seed: int | Sequence[int],
    houses: np.ndarray | None = None,
    coverage: Coverage | None = None,
) -> EpisodeScores:
    """Play one episode of the policy in each environment: environment i in house i, or in ``houses[i]``.

    Starts and targets are sampled by (seed + i, episode, counter), or by the i-th of several seeds. They
    never depend on the policy, so all policies meet the same ones for one seed. With ``coverage`` of the
    environments, the scores include coverage and the rooms visited.
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
    """Begin the episodes that ``play`` plays; return their first observations (E, R, C)."""
    houses = np.arange(envs.num_envs) if houses is None else houses
    return torch.as_tensor(envs.reset(seed=seed, options={"house": houses})[0])


class _CoverageNotes:
    """Fraction of its house that each body has looked at, and its rooms; zeros without ``coverage``."""

    def __init__(self, coverage: Coverage | None, count: int) -> None:
        self.coverage = coverage
        self.shares, self.rooms = np.zeros((len(COVERAGE_STEPS), count)), np.zeros(count, int)
        if coverage is not None:
            coverage.begin()

    def note(self, time: int, playing: np.ndarray, still: np.ndarray) -> None:
        """Update coverage after a step of the environments (E,) bool ``playing``, some of them ``still``."""
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
