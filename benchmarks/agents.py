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
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

import tyro

from agent.banks import HASH, bank_hash
from agent.config import TARGET_MODES
from agent.evaluation import scores
from agent.results.agent_plots import pictures
from agent.results.agents import agents_page
from agent.results.series import machine
from agent.results.study import Entry, Study
from benchmarks.jobs import ROOT, Job, run_all, say
from benchmarks.trials import CLI, ENTRIES, GUESTS, StudyFailed, Trial, Visit, told
from logic import generate, load, save
from logic.errors import RequestError, VitruviusError
from logic.files import write_whole

ROOMS, COUNT = (2, 3, 4, 5, 6), 205
BANK = "0caaed03d5bb8fc50bfaffabf8a4fdcfcc09199ed328cb57dbaf51fa37280a1f"
"""The houses to learn in: so many of `family` with each number of rooms, seeds 102 to 106; their hash."""


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
        places = {mode: out / f"evaluation-{mode}" for mode in TARGET_MODES}
        players = {mode: [trial for trial in finished if trial.plays(mode)] for mode in TARGET_MODES}
        late = [mode for mode in TARGET_MODES if not measured(places[mode], players[mode])]
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
        records = {mode: scores.load(file) for mode, file in files.items()}
        results = {mode: scores.result_of(record.targets[mode], mode) for mode, record in records.items()}
        came = [visit for visit in visits if visit.finished]
        for visit in came:
            results[visit.guest.targets] = visit.joined(results[visit.guest.targets])
        test = records[TARGET_MODES[0]].bank
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
            measured_in=f"{test.file}, {test.houses} houses (hash `{test.hash[:12]}`)",
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
    agents = (told(trial.folder.agent) for trial in trials)
    command = (*CLI, "evaluate", *agents, "--targets", mode, "--out", told(folder))
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
