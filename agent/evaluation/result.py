"""Result of all policies in one target mode, and its figures."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from vitruvius.agent.baselines.table import TRUE_PATH
from vitruvius.agent.evaluation.episodes import COVERAGE_STEPS, EpisodeScores
from vitruvius.agent.evaluation.statistics import Estimate, interquartile_mean, mean, paired_difference
from vitruvius.sim.tasks.words import in_words

SUCCESS_STEPS = 300
"""Number of steps within which the first target must be picked up for a success."""


class Human(NamedTuple):
    """Targets that the paper's human picked up, and those of the oracle in the same house."""

    targets: int
    oracle: int


HUMAN = {
    mode: human
    for prefix in ("", "paper-")
    for mode, human in ((f"{prefix}main", Human(27, 56)), (f"{prefix}secondary", Human(10, 21)))
}
"""Scores of the human by target mode, in the paper's house, which is in no bank here. Only the tasks
``paper-main`` and ``paper-secondary`` are the human's. The human had the whole map in sight."""

HUMAN_RATIO = 0.48
"""Ratio of the human's targets to the oracle's, in both modes."""

DEFINITIONS = {
    "targets": "targets collected in an episode of 1500 steps (3000 in the world long): interquartile mean "
    "over houses and training runs",
    "ratio": "targets relative to the oracle in the same house, for driving robots to the true path: "
    "interquartile mean",
    "success": f"share of episodes that reach their first target within {SUCCESS_STEPS} steps, or at all if "
    "it ends the episode",
    "spl": "success weighted by the length of the shortest path over the path taken, in steps",
    "first_find": "steps to the first target if it ends the episode, or those of a whole episode",
    "coverage_500": "share of the target places, in any room, that the policy has looked at after 500 steps",
    "coverage_1500": "the same after 1500 steps",
    "rooms": "share of the secondary rooms that the policy has entered",
    "blocked": "moves that walls or furniture blocked, per 1000 steps",
    "interventions": "actions that the action mask changed, per 1000 steps",
    "human": "share of houses with more targets than the paper's human had in the paper's own house: "
    f"{HUMAN['main'].targets} in the main room, {HUMAN['secondary'].targets} in secondary rooms",
}
"""Definition of each figure. Figures are means unless they state otherwise. All have 95 % intervals by a
stratified bootstrap over training runs and houses; those of blocked and interventions are over runs."""


def yardstick(policies: Iterable[str]) -> str:
    """Return the name of the policy that ratios divide by, among the names of the policies."""
    return TRUE_PATH if TRUE_PATH in set(policies) else "oracle"


@dataclass(frozen=True)
class Result:
    """Scores of all policies in one target mode, one episode in each of H houses, or of H episodes."""

    mode: str
    """Mode of the targets: a name of ``agent.learning.config.TARGET_MODES``."""

    rooms: np.ndarray
    """(H,) number of secondary rooms of each house."""

    shortest: np.ndarray
    """(H,) fewest steps from the start to the first target, or the true path's steps if bodies drive;
    infinite if no path leads to the target."""

    policies: dict[str, tuple[EpisodeScores, ...]]
    """Scores of each training run, by the policy's name; a baseline has one run. The oracle is a policy, or
    if bodies drive, the true path."""

    episodes: int = 1
    """Number of the H episodes in each house."""

    steps: int = 1500
    """Steps after which an episode is truncated."""

    ends_on_pick_up: bool = False
    """True if the first pick-up ends the episode; then that is the episode's success, at whatever step."""

    named: str = ""
    """Mode in words, if these houses have names of their own for their furniture."""

    @property
    def task(self) -> str:
        """Mode in words."""
        return self.named or in_words(self.mode)

    @property
    def yardstick(self) -> str:
        """Name of the policy that ratios divide by: ``oracle`` or ``true path``."""
        return yardstick(self.policies)

    @property
    def oracle(self) -> np.ndarray:
        """Targets that the yardstick picked up, (H,)."""
        return self.policies[self.yardstick][0].targets

    @property
    def human(self) -> Human | None:
        """Scores of the paper's human, who is compared with bodies of the same motion."""
        return HUMAN.get(self.mode) if self.yardstick == "oracle" else None

    def stacked(self, policy: str, value: Callable[[EpisodeScores], np.ndarray]) -> np.ndarray:
        """Return a value of each house for each of a policy's runs, (S, H)."""
        return np.stack([value(scores) for scores in self.policies[policy]])

    def ratios(self, policy: str, rooms: int | None = None) -> np.ndarray:
        """Return ratios (S, H') to the oracle's targets by run and house.

        They are of all houses, or of those with ``rooms`` rooms. Houses where the oracle picks up nothing are
        left out.
        """
        chosen = (self.oracle > 0) & ((self.rooms == rooms) | (rooms is None))
        return self.stacked(policy, lambda scores: scores.targets)[:, chosen] / self.oracle[chosen]

    def ratio(self, policy: str, rooms: int | None = None) -> Estimate:
        """Return the interquartile mean of ``ratios``."""
        return interquartile_mean(self.ratios(policy, rooms))

    def by_rooms(self, policy: str) -> dict[int, Estimate]:
        """Return the ratio in houses of each number of rooms."""
        return {int(rooms): self.ratio(policy, int(rooms)) for rooms in np.unique(self.rooms)}

    def difference(self, policy: str, other: str) -> Estimate:
        """Return the policy's ratio minus the other's, paired by house; both must have equally many runs."""
        return paired_difference(self.ratios(policy), self.ratios(other))

    def spl(self, policy: str) -> np.ndarray:
        """Return SPL (S, H) by run and house: success times shortest path's length over the path taken."""
        first = self.stacked(policy, lambda scores: scores.first)
        success = np.isfinite(first) if self.ends_on_pick_up else first <= SUCCESS_STEPS
        share = np.zeros(first.shape)
        np.divide(np.minimum(self.shortest, first), first, out=share, where=success)
        return share

    def targets(self, policy: str) -> Estimate:
        """Return the targets picked up in an episode."""
        return interquartile_mean(self.stacked(policy, lambda scores: scores.targets))

    @cached_property
    def _known(self) -> dict[str, dict[str, Estimate]]:
        """Cache of figures: a bootstrap takes about 10 ms, and tables read figures several times."""
        return {}

    def figures(self, policy: str) -> dict[str, Estimate]:
        """Return the figures of a policy, by name; see ``DEFINITIONS``."""
        if policy not in self._known:
            self._known[policy] = self._figures(policy)
        return self._known[policy]

    def _figures(self, policy: str) -> dict[str, Estimate]:
        counts = self.stacked(policy, lambda scores: scores.targets)
        first = self.stacked(policy, lambda scores: scores.first)
        success = np.isfinite(first) if self.ends_on_pick_up else first <= SUCCESS_STEPS
        found = {"first_find": mean(np.minimum(first, self.steps))} if self.ends_on_pick_up else {}
        done = {
            "targets": self.targets(policy),
            "ratio": self.ratio(policy),
            "success": mean(success),
            "spl": mean(self.spl(policy)),
            **found,
        }
        rooms = self.stacked(policy, lambda scores: scores.rooms) / np.maximum(self.rooms, 1)
        coverage = {
            f"coverage_{step}": mean(self.stacked(policy, lambda scores, k=k: scores.coverage[k]))
            for k, step in enumerate(COVERAGE_STEPS)
        }
        runs = self.policies[policy]
        blocked, interventions = (
            np.array([[1000 * getattr(scores, name) / scores.steps] for scores in runs])
            for name in ("blocked", "interventions")
        )
        human = self.human
        return {
            **done,
            **coverage,
            "rooms": mean(rooms),
            "blocked": mean(blocked),
            "interventions": mean(interventions),
            **({"human": mean(counts > human.targets)} if human else {}),
        }


def joined(parts: Sequence[Result]) -> Result:
    """Return a bank's result from those of its parts: an episode of each house, then the next of each."""
    episodes = parts[0].episodes

    def whole(arrays: Iterable[np.ndarray]) -> np.ndarray:
        divided = [array.reshape(*array.shape[:-1], episodes, -1) for array in arrays]
        found = np.concatenate(divided, axis=-1)
        return found.reshape(*found.shape[:-2], -1)

    def scores(runs: Sequence[EpisodeScores]) -> EpisodeScores:
        steps, blocked, interventions = (
            sum(getattr(each, name) for each in runs) for name in ("steps", "blocked", "interventions")
        )
        targets, first, coverage, rooms = (
            whole(getattr(each, name) for each in runs) for name in ("targets", "first", "coverage", "rooms")
        )
        return EpisodeScores(targets, steps, blocked, interventions, first, coverage, rooms)

    policies = {
        name: tuple(map(scores, zip(*(part.policies[name] for part in parts), strict=True)))
        for name in parts[0].policies
    }
    rooms, shortest = (whole(getattr(part, name) for part in parts) for name in ("rooms", "shortest"))
    return replace(parts[0], rooms=rooms, shortest=shortest, policies=policies)
