"""The study of agents: every preset, what its parts are worth, by several seeds, in houses not seen before.

``python -m benchmarks.agents`` makes the houses to learn in, trains each entry with each seed, measures all
in the benchmark bank and writes the page of results: with ``--publish`` into docs. Killed at any moment and
started again it goes on, and what is finished is not done again.
"""

import json
import os
import platform
import signal
import subprocess
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import tyro

from agent import checkpoint
from agent.banks import HASH, bank_hash
from agent.cli import parse
from agent.config import PRESETS, differences
from agent.evaluate import Score
from agent.protocol import MODES, Result
from agent.results.agent_plots import pictures
from agent.results.agents import agents_page
from agent.results.series import machine
from agent.results.study import Entry, Guest, Run, Study, result_of
from agent.runs import Folder
from benchmarks.jobs import ROOT, Job, failure, run_all, say, why
from logic import generate, load, save
from logic.errors import RequestError, VitruviusError
from logic.files import write_whole

ROOMS, COUNT = (2, 3, 4, 5, 6), 205
BANK = "0caaed03d5bb8fc50bfaffabf8a4fdcfcc09199ed328cb57dbaf51fa37280a1f"
"""The houses to learn in: so many of `family` with each number of rooms, seeds 102 to 106; their hash."""

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
    _entry("pqn", "pqn", "rays and fading traces of the past, no map"),
    _entry("dqn", "dqn", "deep Q-learning from a replay memory"),
    _entry("paper", "paper", "the paper's network, learnt by the paper's method in the paper's world"),
    _entry("pqn-recurrent", "pqn-recurrent", "a recurrent layer in place of the traces"),
    _entry("pqn-secondary", "pqn", "no map at all", "--targets secondary", beside="pqn-map"),
    _changed("no-shield", "no avoidance layer", "--avoidance none"),
    _changed("paper-rule", "the paper's avoidance in place of the shield", "--avoidance paper"),
    _changed("no-mirror", "nothing learnt from its mirror image", "--no-mirror"),
    _changed("curriculum", "easier worlds first", "--curriculum"),
    _changed("levels", "houses chosen by what is left to learn", "--levels"),
    _changed("no-novelty", "no reward for exploring", "--novelty 0"),
    _changed("no-guide", "random actions never follow the map's advice", "--guided 0"),
    _entry("pqn-no-shield", "pqn", "no avoidance layer", "--avoidance none", beside="pqn"),
    _entry("pqn-mirror", "pqn", "half of it learnt from its mirror image", "--mirror", beside="pqn"),
    _entry("pqn-curriculum", "pqn", "easier worlds first", "--curriculum", beside="pqn"),
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
class Agents:
    """Train and measure all agents, and write the page of results; what is done already is not done again."""

    share: float = 1.0
    """Part of the whole budget of each run; the schedules follow it."""

    only: tuple[str, ...] = ()
    """Entries and guests to train, by name; by default all. The page has all that are finished."""

    seeds: tuple[int, ...] = (0, 1, 2)
    """Of the training runs of each entry."""

    workers: int = 2
    """Processes at a time, each on a processor of its own."""

    out: Path = Path("runs/study")
    """Folder for all runs and records, of one share."""

    publish: bool = False
    """Put the page and its pictures into docs."""

    def run(self) -> None:
        """Do all of it."""
        entries = [replace(entry, steps=max(1, round(self.share * entry.steps))) for entry in ENTRIES]
        names = [*(entry.name for entry in entries), *GUESTS]
        if unknown := set(self.only) - set(names):
            known = ", ".join(names)
            raise RequestError(f"--only {min(unknown)}: no entry. They are {known}")
        if not 0 < self.share <= 1 or self.workers < 1 or not self.seeds:
            raise RequestError("--share must lie above 0 and be at most 1; --workers 1 or more; --seeds some")
        out = self.out.resolve()
        houses = bank(out / "learn.jsonl", self.workers)
        # Seed by seed: wherever the study is stopped, the entries have about equally many runs.
        trials = [Trial(entry, seed, out) for seed in self.seeds for entry in entries]
        for trial in trials:
            trial.require_same()
        visits = [Visit(name, seed, out) for seed in self.seeds for name in GUESTS]
        asked = [each for each in (*trials, *visits) if not self.only or each.name in self.only]
        run_all([each.training(houses) for each in asked if not each.finished], self.workers)
        finished = [trial for trial in trials if trial.finished]
        if not finished:
            raise StudyFailed(f"{self.out}: no entry is finished, and guests stand beside one: train one too")
        places = {mode: out / f"evaluation-{mode}" for mode in MODES}
        players = {mode: [trial for trial in finished if trial.plays(mode)] for mode in MODES}
        late = [mode for mode in MODES if not measured(places[mode], players[mode])]
        run_all([measuring(mode, players[mode], places[mode]) for mode in late], self.workers)
        if left := [places[mode] for mode in late if not measured(places[mode], players[mode])]:
            raise StudyFailed(f"{left[0]}: was not measured: see {left[0] / 'log.txt'}")
        self.write(self.study(entries, trials, visits, places))

    def study(
        self,
        entries: Sequence[Entry],
        trials: Sequence["Trial"],
        visits: Sequence["Visit"],
        places: dict[str, Path],
    ) -> Study:
        """The records as the page wants them."""
        runs = [trial.record() for trial in trials if trial.begun]
        told = {run.entry for run in runs}
        files = {mode: place / "evaluation.json" for mode, place in places.items()}
        records = {mode: json.loads(file.read_text()) for mode, file in files.items()}
        results = {mode: result_of(record["targets"][mode], mode) for mode, record in records.items()}
        came = [visit for visit in visits if visit.finished]
        for visit in came:
            results[visit.guest.targets] = visit.joined(results[visit.guest.targets])
        test = records[MODES[0]]["bank"]
        made = [*files.values(), *(visit.scores for visit in came)]
        made += [
            file for t in trials if t.begun for file in (t.folder.config, t.folder.agent) if file.exists()
        ]
        dates = [file.stat().st_mtime for file in made]
        seeds = " ".join(map(str, self.seeds))
        days = sorted({str(datetime.fromtimestamp(date, UTC).date()) for date in dates})
        return Study(
            share=self.share,
            command=f"./run python -m benchmarks.agents --share {self.share:g} --seeds {seeds}",
            days=days[0] if len(days) == 1 else f"{days[0]} to {days[-1]}",
            machine=machine({"machine_info": machine_info()}),
            versions={"Python": platform.python_version()}
            | {name: version(name) for name in ("torch", "taichi", "numpy")}
            | {"revision": revision()},
            learnt_in=f"1025 houses of `family`, 2 to 6 rooms, seeds 102 to 106 (hash `{BANK[:12]}`)",
            measured_in=f"{test['file']}, {test['houses']} houses (hash `{test['hash'][:12]}`)",
            entries=tuple(entry for entry in entries if entry.name in told),
            runs=tuple(runs),
            results=results,
            guests=tuple(dict.fromkeys(visit.guest for visit in came)),
            absent=tuple(visit.record() for visit in visits if visit.begun and not visit.finished),
        )

    def write(self, study: Study) -> None:
        """Write the page and its pictures, into the study's folder or docs."""
        notes = ROOT / "docs" / "agent-notes.md"
        page = agents_page(study, notes.read_text() if notes.exists() else "")
        out = ROOT / "docs" if self.publish else self.out
        for name, content in {"agent.md": page.encode(), **pictures(study)}.items():
            write_whole(out / name, content)
        print(out / "agent.md")


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
            _told(houses),
            *options,
            "--seed",
            str(self.seed),
            "--out",
            _told(folder),
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
        return self.scores.exists() and json.loads(self.scores.read_text())["steps"] == self.guest.steps

    def training(self, houses: Path) -> Job:
        """What trains and measures it."""
        words = self.guest.command.split()
        options = ("--steps", str(self.guest.steps), "--seed", str(self.seed), "--out", _told(self.scores))
        command = (sys.executable, words[0], _told(houses), *words[1:], *options)
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
        record, mode, name = json.loads(self.scores.read_text()), self.guest.targets, self.guest.name
        theirs = result_of(record["targets"][mode], mode) if mode in record["targets"] else None
        if not theirs or name not in theirs.players or not np.array_equal(theirs.oracle, result.oracle):
            raise StudyFailed(f"{self.scores}: not of {name}, or not of these houses and targets. Remove it")
        return with_score(result, theirs.players[name][0])


def with_score(result: Result, score: Score) -> Result:
    """The result with another run of a player: of a new one, before all others, or of one that it has."""
    runs = {score.player: (*result.players.get(score.player, ()), score)}
    return replace(result, players=runs | result.players | runs)


CLI = (sys.executable, "-m", "agent.cli")


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


def bank(path: Path, workers: int) -> Path:
    """The houses to learn in, made if they are not there. Raises ``StudyFailed`` where they are others."""
    if not path.exists():
        say(f"{path}: making {len(ROOMS) * COUNT} houses")
        made = (generate(rooms, seed=100 + rooms, count=COUNT, workers=workers) for rooms in ROOMS)
        save([house for houses in made for house in houses], path)
    if (found := bank_hash(load(path))) != BANK:
        raise StudyFailed(f"{path}: other houses ({found[:12]}) than the study's ({BANK[:12]})")
    return path


def measuring(mode: str, trials: Iterable[Trial], folder: Path) -> Job:
    """What measures all agents and baselines in a target mode, in one go."""
    agents = (_told(trial.folder.agent) for trial in trials)
    command = (*CLI, "evaluate", *agents, "--targets", mode, "--out", _told(folder))
    return Job(f"measuring, {mode}", command, folder)


def measured(folder: Path, trials: Iterable[Trial]) -> bool:
    """Whether the record in the folder is of just these agents, none of them newer, in the benchmark bank."""
    file, agents = folder / "evaluation.json", [trial.folder.agent for trial in trials]
    if not file.exists():
        return False
    record = json.loads(file.read_text())
    known = [(ROOT / agent).resolve() for agent in record["agents"]]
    if record["bank"]["hash"] != HASH or known != [agent.resolve() for agent in agents]:
        return False
    return all(agent.stat().st_mtime <= file.stat().st_mtime for agent in agents)


def _told(path: Path) -> str:
    """A path as commands have it: checkpoints keep these, and should tell nothing of whose machine it was."""
    path = path.resolve()
    return str(path.relative_to(ROOT) if path.is_relative_to(ROOT) else path)


def machine_info() -> dict[str, Any]:
    """As pytest-benchmark notes it."""
    from cpuinfo import get_cpu_info

    brand = get_cpu_info().get("brand_raw", platform.machine())
    return {
        "machine": platform.machine(),
        "system": platform.system(),
        "cpu": {"brand_raw": brand, "count": os.cpu_count()},
    }


def revision() -> str:
    """The checkout's commit."""
    asked = ["git", "describe", "--always", "--dirty"]
    return (
        subprocess.run(asked, cwd=ROOT, capture_output=True, text=True, check=False).stdout.strip()
        or "unknown"
    )


def _stop(*_: object) -> None:
    raise KeyboardInterrupt


def main() -> None:
    """Run the study; errors are one line."""
    signal.signal(signal.SIGTERM, _stop)
    try:
        tyro.cli(Agents).run()
    except VitruviusError as error:
        say(f"error: {error}")
        sys.exit(error.exit_code)
    except KeyboardInterrupt:
        say("interrupted: start again to go on")
        sys.exit(130)


if __name__ == "__main__":
    main()
