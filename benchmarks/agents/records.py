"""The records of the study of agents, and what they say: differences between an agent and its changes."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import trim_mean

from agent.beside import OURS
from agent.evaluate import Score
from agent.protocol import Result
from agent.statistics import Estimate, bootstrap


@dataclass(frozen=True)
class Entry:
    """What is trained, by several seeds."""

    name: str
    preset: str
    options: tuple[str, ...]
    """What differs from the preset, as options of ``vitruvius train``."""
    steps: int
    """Environment steps of each run."""
    targets: str
    """Where targets lie while it learns."""
    shows: str
    """What it is there for, in words."""
    beside: str = ""
    """The entry that it is a change of, and is compared with."""


@dataclass(frozen=True)
class External:
    """Another library's agent, by one of the examples; it is measured with targets such as it learnt for."""

    name: str
    """As its scores name it."""
    command: str
    steps: int
    """Environment steps of each run."""
    targets: str
    shows: str
    """What it is, in words."""


@dataclass(frozen=True)
class Outcome:
    """How an entry's training by one seed went."""

    entry: str
    seed: int
    finished: bool
    failed: str
    """Why the last try failed, if it did."""
    curve: tuple[tuple[int, float], ...]
    """Environment steps, and targets per 1500 steps while learning."""
    last: dict[str, Any] | None
    """The last report: ``agent.learner.Progress``."""


@dataclass(frozen=True)
class Study:
    """All that the page is made of."""

    share: float
    """Of the whole budget, 0 to 1."""
    command: str
    days: str
    machine: str
    versions: str
    learnt_in: str
    measured_in: str
    entries: tuple[Entry, ...]
    runs: tuple[Outcome, ...]
    """In the order of the entries' seeds."""
    results: dict[str, Result]
    """By target mode. The players' runs are the finished ones of ``runs``, in their order."""
    externals: tuple[External, ...] = ()
    """Those that are players in the results of their targets."""
    absent: tuple[Outcome, ...] = ()
    """Runs of external agents that were begun and have no score."""

    def entry(self, name: str) -> Entry:
        """The entry of this name. Raises ``KeyError``."""
        return {entry.name: entry for entry in self.entries}[name]

    def seeds(self, name: str) -> list[int]:
        """Seeds of an entry's finished runs, in the order of its scores."""
        return [run.seed for run in self.runs if run.entry == name and run.finished]

    def measured(self) -> list[Entry]:
        """Entries with a finished run."""
        return [entry for entry in self.entries if self.seeds(entry.name)]

    def presets(self) -> list[Entry]:
        """Those of them that are no change of another."""
        return [entry for entry in self.measured() if not entry.beside]

    def changes(self, name: str) -> list[Entry]:
        """Those of them that are changes of an entry and have a seed in common with it."""
        return [
            e for e in self.measured() if e.beside == name and set(self.seeds(e.name)) & set(self.seeds(name))
        ]

    def baselines(self) -> list[str]:
        """Players that learn nothing."""
        players = next(iter(self.results.values())).players
        return [name for name in OURS if name != "paper" and name in players]


@dataclass(frozen=True)
class Difference:
    """What a change does to the ratio in the houses that the agent learns for."""

    all: Estimate
    """Difference of the interquartile means, its interval by a bootstrap of pairs: same seed, same house."""
    each: tuple[float, ...]
    """The same by seed."""

    @property
    def clear(self) -> bool:
        """Whether there is one: the interval does not hold 0, and no seed is of the other sign."""
        low, high = min(self.all.low, *self.each), max(self.all.high, *self.each)
        return low > 0 or high < 0


def difference(study: Study, changed: Entry) -> Difference:
    """A change beside what it is a change of, over the seeds that both have finished."""
    result = study.results[changed.targets]
    ours, theirs = (study.seeds(name) for name in (changed.name, changed.beside))
    seeds = [seed for seed in ours if seed in theirs]
    one = ratios(result, changed.name)[[ours.index(seed) for seed in seeds]]
    other = ratios(result, changed.beside)[[theirs.index(seed) for seed in seeds]]

    def between(pairs: np.ndarray) -> np.ndarray:
        """The figure of these pairs, given by their numbers."""
        chosen = pairs.astype(int)
        means = (trim_mean(side.ravel()[chosen], 0.25, axis=-1) for side in (one, other))
        return np.subtract(*means)

    numbers = np.arange(one.size).reshape(one.shape)
    return Difference(bootstrap(numbers, between), tuple(float(between(row)) for row in numbers))


def ratios(result: Result, player: str) -> np.ndarray:
    """(S, H) share of the oracle's targets by run and house, of the houses where the oracle finds any."""
    some = result.oracle > 0
    return result.stacked(player, lambda score: score.targets)[:, some] / result.oracle[some]


def by_seed(result: Result, player: str) -> list[float]:
    """The ratio of each of a player's runs: interquartile mean over the houses."""
    return [float(trim_mean(row, 0.25)) for row in ratios(result, player)]


def result_of(record: dict[str, Any], targets: str) -> Result:
    """What ``agent.scoreboard.record`` wrote of a target mode, as it was."""
    players = {
        name: tuple(
            Score(
                name,
                np.array(run["targets"], float),
                run["steps"],
                run["blocked"],
                run["interventions"],
                _steps(run["first"]),
                np.array(run["coverage"]),
                np.array(run["rooms"]),
            )
            for run in player["runs"]
        )
        for name, player in record["players"].items()
    }
    return Result(targets, np.array(record["rooms"]), _steps(record["shortest"]), players)


def _steps(values: list[int | None]) -> np.ndarray:
    return np.array([np.inf if value is None else value for value in values])
