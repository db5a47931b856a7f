"""The runs of the study of agents: what is trained, by which commands, in which folders; how each went."""

import json
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from agent import checkpoint
from agent.cli import parse
from agent.config import PRESETS, differences
from agent.evaluation import scores
from agent.evaluation.episodes import EpisodeScores
from agent.evaluation.result import Result
from agent.results.study import Entry, Guest, Run
from agent.runs import Folder
from benchmarks.jobs import ROOT, Job, failure, why
from logic.errors import RequestError, VitruviusError

CLI = (sys.executable, "-m", "agent.cli")

BUDGET = 15 * 60
RATES = {"pqn": 46_000, "pqn-map": 21_500, "dqn": 12_000, "paper": 1_800, "pqn-recurrent": 20_000}
"""The whole budget of a run: as many steps as 15 minutes gave on one quiet core of the machine that the study
began on, at so many a second. Counted in steps, it does not depend on the machine."""


def _entry(name: str, preset: str, shows: str, said: str = "", beside: str = "") -> Entry:
    """An entry with its preset's budget; its targets are the preset's, where no option says otherwise."""
    options = tuple(said.split())
    targets = options[options.index("--targets") + 1] if "--targets" in options else PRESETS[preset].targets
    return Entry(name, preset, options, BUDGET * RATES[preset], targets, shows, beside)


def _changed(name: str, shows: str, said: str) -> Entry:
    """A change of the agent with a map."""
    return _entry(f"map-{name}", "pqn-map", shows, said, beside="pqn-map")


ENTRIES = (
    _entry("pqn-map", "pqn-map", "the agent with a map"),
    _entry("pqn", "pqn", "rays and exponential moving averages of the past, no map"),
    _entry("dqn", "dqn", "deep Q-learning from a replay memory"),
    _entry("paper", "paper", "the paper's network, learnt by the paper's method in the paper's world"),
    _entry("pqn-recurrent", "pqn-recurrent", "a recurrent layer in place of the averages"),
    _entry("pqn-secondary", "pqn", "no map at all", "--targets secondary", beside="pqn-map"),
    _changed("no-shield", "no avoidance layer", "--avoidance none"),
    _changed("paper-rule", "the paper's avoidance in place of the shield", "--avoidance paper"),
    _entry("pqn-no-shield", "pqn", "no avoidance layer", "--avoidance none", beside="pqn"),
)
"""What is trained. An entry ``beside`` another is a change of it, by its options, and is compared with it."""


GUEST_STEPS = 1_000_000
"""Of each run of another library's agent, whatever the share."""


def _guest(name: str, command: str, shows: str) -> Guest:
    return Guest(f"{name} + avoidance", f"examples/{command} --avoid", GUEST_STEPS, "main", shows)


GUESTS = {
    "sb3-dqn": _guest(
        "SB3 DQN", "stable_baselines.py --algorithm dqn", "deep Q-learning of Stable-Baselines3"
    ),
    "sb3-ppo": _guest(
        "SB3 PPO", "stable_baselines.py --algorithm ppo", "policy gradients of Stable-Baselines3"
    ),
    "torchrl-ppo": _guest("TorchRL PPO", "torchrl_ppo.py", "policy gradients of TorchRL"),
    "one-file": _guest(
        "PQN in one file", "one_file.py", "parallel Q-learning in plain torch, as CleanRL does"
    ),
}
"""Agents of other libraries, by the folders of their runs. Each learns, plays and writes its own scores."""


class StudyFailed(VitruviusError):
    """A part of the study that all else stands on did not come about."""

    exit_code = 1


@dataclass(frozen=True)
class Trial:
    """An entry with a seed: a training run in its folder."""

    entry: Entry
    seed: int
    out: Path

    @property
    def name(self) -> str:
        """Its entry's."""
        return self.entry.name

    @property
    def folder(self) -> Folder:
        """Its files."""
        return Folder(self.out / f"{self.entry.name}-{self.seed}")

    @property
    def begun(self) -> bool:
        """Whether there is anything of it, if only that it failed."""
        return self.folder.config.exists() or failure(self.folder.path).exists()

    @property
    def finished(self) -> bool:
        """Whether its agent has seen all of its steps."""
        return finished(self.folder, self.entry.steps)

    def plays(self, mode: str) -> bool:
        """Whether it is measured in a target mode: an agent of its own in all, a change in its own."""
        return not self.entry.beside or self.entry.targets == mode

    def training(self, houses: Path) -> Job:
        """What trains it, or goes on with that."""
        entry, folder = self.entry, self.folder.path
        options = (
            "--preset",
            entry.preset,
            *entry.options,
            "--name",
            entry.name,
            "--steps",
            str(entry.steps),
        )
        command = (
            *CLI,
            "train",
            told(houses),
            *options,
            "--seed",
            str(self.seed),
            "--out",
            told(folder),
            "--resume",
        )
        return Job(f"{entry.name}, seed {self.seed}, {entry.steps / 1e6:.2f} M steps", command, folder)

    def require_same(self) -> None:
        """Raise ``RequestError`` where a run of another budget or with other options lies in the folder."""
        require_same(self.folder, self.training(self.out).command)

    def record(self) -> Run:
        """How it went, as far as it did."""
        lines = list(self._reports())
        thin = lines[:: -(-len(lines) // 300)] + lines[-1:] if lines else []
        return Run(
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
                    return  # a kill may tear the last line


@dataclass(frozen=True)
class Visit:
    """A guest with a seed: a run of an example, which is whole or is not there."""

    name: str
    seed: int
    out: Path

    @property
    def guest(self) -> Guest:
        """Who it is."""
        return GUESTS[self.name]

    @property
    def scores(self) -> Path:
        """What it writes."""
        return self.out / f"{self.name}-{self.seed}" / "scores.json"

    @property
    def begun(self) -> bool:
        """Whether it was ever started."""
        return self.scores.parent.exists()

    @property
    def finished(self) -> bool:
        """Whether it has learnt from all of its steps, and played."""
        steps = self.guest.steps
        return self.scores.exists() and json.loads(self.scores.read_text())["training_steps"] == steps

    def training(self, houses: Path) -> Job:
        """What trains and measures it."""
        words = self.guest.command.split()
        options = ("--steps", str(self.guest.steps), "--seed", str(self.seed), "--out", told(self.scores))
        command = (sys.executable, words[0], told(houses), *words[1:], *options)
        return Job(
            f"{self.name}, seed {self.seed}, {self.guest.steps / 1e6:.2f} M steps",
            command,
            self.scores.parent,
        )

    def record(self) -> Run:
        """How it went where it has no score: nothing is seen of it before."""
        return Run(self.guest.name, self.seed, False, why(self.scores.parent), (), None)

    def joined(self, result: Result) -> Result:
        """The result of its targets with this run too. Raises ``StudyFailed`` where it played for others."""
        file, mode, name = scores.load(self.scores), self.guest.targets, self.guest.name
        theirs = scores.result_of(file.targets[mode], mode) if mode in file.targets else None
        if not theirs or name not in theirs.policies or not np.array_equal(theirs.oracle, result.oracle):
            raise StudyFailed(f"{self.scores}: not of {name}, or not of these houses and targets. Remove it")
        return with_run(result, name, theirs.policies[name][0])


def with_run(result: Result, name: str, run: EpisodeScores) -> Result:
    """The result with another run of a policy: of a new one, before all others, or of one that it has."""
    runs = {name: (*result.policies.get(name, ()), run)}
    return replace(result, policies=runs | result.policies | runs)


def finished(folder: Folder, steps: int) -> bool:
    """Whether the agent of a run has seen so many steps."""
    return folder.agent.exists() and checkpoint.load(folder.agent).steps >= steps


def require_same(folder: Folder, command: Sequence[str]) -> None:
    """Raise ``RequestError`` where a run lies in the folder whose config is not the training command's."""
    if not folder.config.exists():
        return
    kept, asked = json.loads(folder.config.read_text()), parse(list(command[command.index("train") :])).config
    try:
        others = list(differences(checkpoint.config_of(kept["algorithm"], kept["config"]), asked))
    except ValueError as error:
        others = [str(error)]
    if others:
        raise RequestError(f"{folder.path}: is a run with other {', '.join(others)}. Give another --out")


def told(path: Path) -> str:
    """A path as commands have it: checkpoints keep these, and should tell nothing of whose machine it was."""
    path = path.resolve()
    return str(path.relative_to(ROOT) if path.is_relative_to(ROOT) else path)
