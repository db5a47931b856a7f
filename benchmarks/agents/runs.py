"""Runs of the study of agents: their commands, folders and outcomes."""

import json
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.agents.entries import EXTERNALS
from benchmarks.agents.records import External, Outcome, TrainingEntry, options
from benchmarks.common.pages import ROOT
from benchmarks.common.processes import CLI, Job, StudyFailed, failure, why
from vitruvius.agent.evaluation import scores
from vitruvius.agent.evaluation.episodes import EpisodeScores
from vitruvius.agent.evaluation.result import Result
from vitruvius.agent.learning.config import TrainConfig, differences
from vitruvius.agent.runs import checkpoint
from vitruvius.agent.runs.runs import Folder
from vitruvius.logic.errors import RequestError


@dataclass(frozen=True)
class EntryRun:
    """Training run of an entry with a seed, in its folder."""

    entry: TrainingEntry
    seed: int
    out: Path

    @property
    def name(self) -> str:
        """Name of the entry."""
        return self.entry.name

    @property
    def folder(self) -> Folder:
        """Files of the run."""
        return Folder(self.out / f"{self.entry.name}-{self.seed}")

    @property
    def begun(self) -> bool:
        """True if any file of the run exists, even if only a note that it failed."""
        return self.folder.config.exists() or failure(self.folder.path).exists()

    @property
    def finished(self) -> bool:
        """True if the agent has seen all of its steps."""
        return finished(self.folder, self.entry.steps)

    def plays(self, mode: str) -> bool:
        """Return True if the run is evaluated in a target mode.

        A change is evaluated only in its own mode, other entries in all modes.
        """
        return not self.entry.beside or self.entry.targets == mode

    def training(self, houses: Path) -> Job:
        """Return the job that trains the agent, or continues its training."""
        entry, folder = self.entry, self.folder.path
        changes = {"steps": entry.steps, "seed": self.seed, **entry.changes}
        command = training_command(houses, folder, entry.preset, entry.name, changes)
        title = f"{entry.name}, seed {self.seed}, {entry.steps / 1e6:.2f} M steps"
        return Job(title, (*CLI, *command), folder)

    def require_same(self) -> None:
        """Raise ``RequestError`` if the folder holds a run with another budget or other options."""
        require_same(self.folder, self.entry.config(self.seed))

    def record(self) -> Outcome:
        """Return the outcome of the run so far."""
        lines = list(self._reports())
        thin = lines[:: -(-len(lines) // 300)] + lines[-1:] if lines else []
        return Outcome(
            entry=self.entry.name,
            seed=self.seed,
            finished=self.finished,
            failed=why(self.folder.path),
            curve=tuple((line["steps"], line["targets"]) for line in thin),
            last=lines[-1] if lines else None,
        )

    def _reports(self) -> Iterator[dict[str, Any]]:
        if self.folder.metrics.exists():
            for line in self.folder.metrics.read_text().splitlines():
                try:
                    yield json.loads(line)
                except ValueError:
                    return  # a kill may truncate the last line


@dataclass(frozen=True)
class ExternalRun:
    """Run of an example that trains an external agent with a seed. The run is complete or does not exist."""

    name: str
    seed: int
    out: Path

    @property
    def agent(self) -> External:
        """Agent of the run."""
        return EXTERNALS[self.name]

    @property
    def scores(self) -> Path:
        """File with the scores of the run."""
        return self.out / f"{self.name}-{self.seed}" / "scores.json"

    @property
    def begun(self) -> bool:
        """True if the run was ever started."""
        return self.scores.parent.exists()

    @property
    def finished(self) -> bool:
        """True if the agent has learnt from all of its steps, and played."""
        steps = self.agent.steps
        return self.scores.exists() and json.loads(self.scores.read_text())["training_steps"] == steps

    def training(self, houses: Path) -> Job:
        """Return the job that trains and evaluates the agent."""
        words = self.agent.command.split()
        options = ("--steps", str(self.agent.steps), "--seed", str(self.seed), "--out", given(self.scores))
        command = (sys.executable, words[0], given(houses), *words[1:], *options)
        title = f"{self.name}, seed {self.seed}, {self.agent.steps / 1e6:.2f} M steps"
        return Job(title, command, self.scores.parent)

    def record(self) -> Outcome:
        """Return the outcome of a run without a score, which shows nothing of its training."""
        return Outcome(self.agent.name, self.seed, False, why(self.scores.parent), (), None)

    def joined(self, result: Result) -> Result:
        """Return a result that also has this run.

        Raises ``StudyFailed`` if the run is of another agent, or of other houses or targets.
        """
        file, mode, name = scores.load(self.scores), self.agent.targets, self.agent.name
        theirs = scores.result_of(file.targets[mode], mode) if mode in file.targets else None
        if not theirs or name not in theirs.policies or not np.array_equal(theirs.oracle, result.oracle):
            raise StudyFailed(f"{self.scores}: not of {name}, or not of these houses and targets. Remove it")
        return with_run(result, name, theirs.policies[name][0])


def training_command(
    houses: Path, folder: Path, preset: str, name: str, changes: Mapping[str, Any]
) -> tuple[str, ...]:
    """Return the arguments of ``vitruvius`` that train a preset with changes, or continue the training."""
    run = options({"preset": preset, "name": name, "out": given(folder)})
    return "train", given(houses), *run, *options(changes), "--resume"


def with_run(result: Result, name: str, run: EpisodeScores) -> Result:
    """Return a result with another run of a policy. A new policy comes before all others."""
    runs = {name: (*result.policies.get(name, ()), run)}
    return replace(result, policies=runs | result.policies | runs)


def finished(folder: Folder, steps: int) -> bool:
    """Return True if the agent of a run has seen this number of steps."""
    return folder.agent.exists() and checkpoint.load(folder.agent).steps >= steps


def require_same(folder: Folder, asked: TrainConfig) -> None:
    """Raise ``RequestError`` if the folder holds a run with another config."""
    if not folder.config.exists():
        return
    kept = json.loads(folder.config.read_text())
    try:
        others = list(differences(checkpoint.config_of(kept["algorithm"], kept["config"]), asked))
    except ValueError as error:
        others = [str(error)]
    if others:
        raise RequestError(
            f"{folder.path} holds a run with other {', '.join(others)}: choose another --out folder"
        )


def given(path: Path) -> str:
    """Return a path for a command. Checkpoints keep commands, so a path in the checkout is relative to it."""
    path = path.resolve()
    return str(path.relative_to(ROOT) if path.is_relative_to(ROOT) else path)
