"""The records of the study of agents, and what they say: differences between an agent and its changes."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import Any

from scipy.stats import trim_mean

from agent.algorithms.table import PRESETS
from agent.evaluation.baselines import BASELINES, PAPERS
from agent.evaluation.result import Result
from agent.evaluation.statistics import Estimate, paired_difference
from agent.learning.config import TrainConfig


@dataclass(frozen=True)
class TrainingEntry:
    """What is trained, by several seeds."""

    name: str
    preset: str
    steps: int
    """Environment steps of each run."""
    shows: str
    """What it is there for, in words."""
    beside: str = ""
    """The entry that it is a change of, and is compared with."""
    changes: Mapping[str, Any] = field(default_factory=dict)
    """Values in place of the preset's, by the fields of its config."""

    @property
    def targets(self) -> str:
        """Where targets lie while it learns."""
        return self.config(0).targets

    @property
    def options(self) -> tuple[str, ...]:
        """The changes, as options of ``vitruvius train``."""
        return options(self.changes)

    def config(self, seed: int) -> TrainConfig:
        """That of a run by this seed."""
        return replace(PRESETS[self.preset], steps=self.steps, seed=seed, **self.changes)


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
    """The last report: ``agent.learning.learner.Progress``."""


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
    entries: tuple[TrainingEntry, ...]
    runs: tuple[Outcome, ...]
    """In the order of the entries' seeds."""
    results: dict[str, Result]
    """By target mode. The policies' runs are the finished ones of ``runs``, in their order."""
    externals: tuple[External, ...] = ()
    """Those that are policies in the results of their targets."""
    absent: tuple[Outcome, ...] = ()
    """Runs of external agents that were begun and have no score."""

    def entry(self, name: str) -> TrainingEntry:
        """The entry of this name. Raises ``KeyError``."""
        return {entry.name: entry for entry in self.entries}[name]

    def seeds(self, name: str) -> list[int]:
        """Seeds of an entry's finished runs, in the order of its scores."""
        return [run.seed for run in self.runs if run.entry == name and run.finished]

    def measured(self) -> list[TrainingEntry]:
        """Entries with a finished run."""
        return [entry for entry in self.entries if self.seeds(entry.name)]

    def presets(self) -> list[TrainingEntry]:
        """Those of them that are no change of another."""
        return [entry for entry in self.measured() if not entry.beside]

    def changes(self, name: str) -> list[TrainingEntry]:
        """Those of them that are changes of an entry and have a seed in common with it."""
        return [
            e for e in self.measured() if e.beside == name and set(self.seeds(e.name)) & set(self.seeds(name))
        ]

    def baselines(self) -> list[str]:
        """Policies that the study trains none of: the paper's released weights, and what learns nothing."""
        policies = next(iter(self.results.values())).policies
        return [name for name in (PAPERS[0], *BASELINES) if name in policies]


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


def options(values: Mapping[str, Any]) -> tuple[str, ...]:
    """Fields and their values as options of ``vitruvius train``."""
    words = ((f"--{name.replace('_', '-')}", str(value)) for name, value in values.items())
    return tuple(chain.from_iterable(words))


def difference(study: Study, changed: TrainingEntry) -> Difference:
    """A change beside what it is a change of, over the seeds that both have finished."""
    result = study.results[changed.targets]
    ours, theirs = (study.seeds(name) for name in (changed.name, changed.beside))
    seeds = [seed for seed in ours if seed in theirs]
    one = result.ratios(changed.name)[[ours.index(seed) for seed in seeds]]
    other = result.ratios(changed.beside)[[theirs.index(seed) for seed in seeds]]
    each = (paired_difference(*rows).value for rows in zip(one, other, strict=True))
    return Difference(paired_difference(one, other), tuple(each))


def by_seed(result: Result, policy: str) -> list[float]:
    """The ratio of each of a policy's runs: interquartile mean over the houses."""
    return [float(trim_mean(row, 0.25)) for row in result.ratios(policy)]
