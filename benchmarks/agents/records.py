"""Records of the study of agents, and the differences between an agent and its changes."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import Any

from scipy.stats import trim_mean

from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.baselines.table import BASELINES, PAPERS
from vitruvius.agent.evaluation.result import Result
from vitruvius.agent.evaluation.statistics import Estimate, paired_difference
from vitruvius.agent.learning.config import TrainConfig


@dataclass(frozen=True)
class TrainingEntry:
    """Training of an agent, with several seeds."""

    name: str
    preset: str
    steps: int
    """Environment steps of each run."""
    shows: str
    """Purpose of the entry, in words."""
    beside: str = ""
    """Name of the entry that this one changes and is compared with."""
    changes: Mapping[str, Any] = field(default_factory=dict)
    """Values that replace the preset's, by the fields of its config."""

    @property
    def targets(self) -> str:
        """Place of the targets during training."""
        return self.config(0).targets

    @property
    def options(self) -> tuple[str, ...]:
        """Changes, as options of ``vitruvius train``."""
        return options(self.changes)

    def config(self, seed: int) -> TrainConfig:
        """Return the config of a run with this seed."""
        return replace(PRESETS[self.preset], steps=self.steps, seed=seed, **self.changes)


@dataclass(frozen=True)
class External:
    """Agent of another library, from one of the examples.

    It is evaluated on the same targets that it learnt with.
    """

    name: str
    """Name in its scores."""
    command: str
    steps: int
    """Environment steps of each run."""
    targets: str
    shows: str
    """Description in words."""


@dataclass(frozen=True)
class Outcome:
    """Outcome of an entry's training with one seed."""

    entry: str
    seed: int
    finished: bool
    failed: str
    """Reason why the last try failed, if it did."""
    curve: tuple[tuple[int, float], ...]
    """Environment steps, and targets per 1500 steps during training."""
    last: dict[str, Any] | None
    """Last report: ``agent.learning.learner.Progress``."""


@dataclass(frozen=True)
class Study:
    """Contents of the page."""

    share: float
    """Fraction of the whole budget, 0 to 1."""
    command: str
    days: str
    machine: str
    versions: str
    learnt_in: str
    measured_in: str
    entries: tuple[TrainingEntry, ...]
    runs: tuple[Outcome, ...]
    """Runs in the order of the entries' seeds."""
    results: dict[str, Result]
    """Results by target mode. The policies' runs are the finished ones of ``runs``, in their order."""
    externals: tuple[External, ...] = ()
    """External agents that are policies in the results of their targets."""
    absent: tuple[Outcome, ...] = ()
    """Runs of external agents that began and have no score."""

    def entry(self, name: str) -> TrainingEntry:
        """Return the entry with this name. Raises ``KeyError``."""
        return {entry.name: entry for entry in self.entries}[name]

    def seeds(self, name: str) -> list[int]:
        """Return the seeds of an entry's finished runs, in the order of its scores."""
        return [run.seed for run in self.runs if run.entry == name and run.finished]

    def measured(self) -> list[TrainingEntry]:
        """Return the entries with a finished run."""
        return [entry for entry in self.entries if self.seeds(entry.name)]

    def presets(self) -> list[TrainingEntry]:
        """Return the entries with a finished run that are not a change of another."""
        return [entry for entry in self.measured() if not entry.beside]

    def changes(self, name: str) -> list[TrainingEntry]:
        """Return the entries with a finished run that change an entry and have a seed in common with it."""
        return [
            e for e in self.measured() if e.beside == name and set(self.seeds(e.name)) & set(self.seeds(name))
        ]

    def baselines(self) -> list[str]:
        """Return the policies that the study does not train: the paper's released weights and baselines."""
        policies = next(iter(self.results.values())).policies
        return [name for name in (PAPERS[0], *BASELINES) if name in policies]


@dataclass(frozen=True)
class Difference:
    """Effect of a change on the ratio, in the houses that the agent learns for."""

    all: Estimate
    """Difference of the interquartile means. Its interval is from a bootstrap of pairs: same seed, same
    house."""
    each: tuple[float, ...]
    """Difference for each seed."""

    @property
    def clear(self) -> bool:
        """True if the effect is clear: the interval does not contain 0, and no seed has the other sign."""
        low, high = min(self.all.low, *self.each), max(self.all.high, *self.each)
        return low > 0 or high < 0


def options(values: Mapping[str, Any]) -> tuple[str, ...]:
    """Return fields and their values as options of ``vitruvius train``."""
    words = ((f"--{name.replace('_', '-')}", str(value)) for name, value in values.items())
    return tuple(chain.from_iterable(words))


def difference(study: Study, changed: TrainingEntry) -> Difference:
    """Return the difference between a change and its base, over the seeds that both have finished."""
    result = study.results[changed.targets]
    ours, theirs = (study.seeds(name) for name in (changed.name, changed.beside))
    seeds = [seed for seed in ours if seed in theirs]
    one = result.ratios(changed.name)[[ours.index(seed) for seed in seeds]]
    other = result.ratios(changed.beside)[[theirs.index(seed) for seed in seeds]]
    each = (paired_difference(*rows).value for rows in zip(one, other, strict=True))
    return Difference(paired_difference(one, other), tuple(each))


def by_seed(result: Result, policy: str) -> list[float]:
    """Return the ratio of each of a policy's runs: the interquartile mean over the houses."""
    return [float(trim_mean(row, 0.25)) for row in result.ratios(policy)]
