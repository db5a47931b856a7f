"""``vitruvius bench agents``: every preset and its changes, with several seeds, in houses not seen before.

The study makes the training houses, trains each entry with each seed, evaluates all agents on the benchmark
bank and writes the page. A stopped study continues where it stopped, and does not repeat finished work.
"""

import json
import signal
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Literal

from benchmarks.agents.entries import ENTRIES, EXTERNALS
from benchmarks.agents.page import agents_page
from benchmarks.agents.pictures import pictures
from benchmarks.agents.records import Study, TrainingEntry
from benchmarks.agents.runs import EntryRun, ExternalRun, given
from benchmarks.common.houses import TRAINING, training_houses
from benchmarks.common.pages import ROOT, machine, revision, versions, write
from benchmarks.common.processes import CLI, Job, StudyFailed, run_all
from vitruvius.agent.banks import BANKS, NAME
from vitruvius.agent.evaluation import scores
from vitruvius.agent.learning.config import TARGET_MODES
from vitruvius.agent.report.folder import describe, write_report
from vitruvius.logic.cluster import Cluster, engine
from vitruvius.logic.errors import RequestError
from vitruvius.logic.spelling import unknown


@dataclass(frozen=True)
class Agents:
    """Train and evaluate all agents, and write the page of results. Finished work is not repeated."""

    share: float = 1.0
    """Fraction of the whole budget of each run; the schedules follow it."""

    only: tuple[str, ...] = ()
    """Entries and external agents to train, by name; by default all. The page has all that are finished."""

    seeds: tuple[int, ...] = (0, 1, 2)
    """Seeds of the training runs of each entry."""

    workers: int | None = None
    """Number of processes at a time, each on another processor: by default 2, or with --engine as many as the
    cluster's processors can take."""

    engine: Literal["ray"] | None = None
    """Train and measure by Ray, here or on a cluster whose machines share this checkout and --out."""

    address: str | None = None
    """Address of Ray's cluster: HOST:PORT, or auto for the one on this machine; by default the study starts
    one here."""

    out: Path = Path("runs/study")
    """Folder for all runs and records of one share, and for agents.md."""

    replace: bool = False
    """Write into the folder even if it holds other files."""

    publish: bool = False
    """Copy the page, with its pictures and data, into docs."""

    def run(self) -> None:
        """Train, evaluate and write the page."""
        entries = [replace(entry, steps=max(1, round(self.share * entry.steps))) for entry in ENTRIES]
        names = [*(entry.name for entry in entries), *EXTERNALS]
        if wrong := set(self.only) - set(names):
            raise RequestError(f"--only: {unknown('entry', min(wrong), names)}")
        workers = 2 if self.workers is None else self.workers
        if not 0 < self.share <= 1 or workers < 1 or not self.seeds:
            raise RequestError(
                "--share must be above 0 and at most 1, --workers 1 or more, --seeds at least one number"
            )
        signal.signal(signal.SIGTERM, signal.default_int_handler)  # ends the processes that it started, too
        out = self.out.resolve()
        # Seed by seed: if the study is stopped, all entries have about the same number of runs.
        runs = [EntryRun(entry, seed, out) for seed in self.seeds for entry in entries]
        for run in runs:
            run.require_same()
        others = [ExternalRun(name, seed, out) for seed in self.seeds for name in EXTERNALS]
        asked = [each for each in (*runs, *others) if not self.only or each.name in self.only]
        with engine(self.engine, self.address, self.workers) as cluster:
            houses = training_houses(out / "learn.jsonl", workers)
            run_all([each.training(houses) for each in asked if not each.finished], workers, cluster)
            places = measured_all([run for run in runs if run.finished], out, workers, cluster)
        study = self.study(entries, runs, others, places)
        write({"agents.md": agents_page(study).encode(), **pictures(study)}, self.out, self.publish)
        describe(self.out, "Agents", f"Made by `{study.command}`. {study.machine}.")
        print(self.out / "agents.md", write_report(self.out))

    def study(
        self,
        entries: Sequence[TrainingEntry],
        runs: Sequence[EntryRun],
        others: Sequence[ExternalRun],
        places: dict[str, Path],
    ) -> Study:
        """Return the records for the page."""
        begun = [run for run in runs if run.begun]
        came = [run for run in others if run.finished]
        files = {mode: place / "evaluation.json" for mode, place in places.items()}
        records = {mode: scores.load(file) for mode, file in files.items()}
        results = {mode: scores.result_of(record.targets[mode], mode) for mode, record in records.items()}
        for run in came:
            results[run.agent.targets] = run.joined(results[run.agent.targets])
        made = [*files.values(), *(run.scores for run in came)]
        made += [file for run in begun for file in (run.folder.config, run.folder.agent) if file.exists()]
        days = sorted({str(datetime.fromtimestamp(file.stat().st_mtime, UTC).date()) for file in made})
        test, seeds = records[TARGET_MODES[0]].bank, " ".join(map(str, self.seeds))
        return Study(
            share=self.share,
            command=f"./run bench agents --share {self.share:g} --seeds {seeds}",
            days=days[0] if len(days) == 1 else f"{days[0]} to {days[-1]}",
            machine=machine(),
            versions=versions("torch", "taichi", "numpy", revision=revision()),
            learnt_in=f"1025 houses of `family`, 2 to 6 rooms, seeds 102 to 106 (hash `{TRAINING[:12]}`)",
            measured_in=f"{test.file}, {test.houses} houses (hash `{test.hash[:12]}`)",
            entries=tuple(entry for entry in entries if any(run.entry == entry for run in begun)),
            runs=tuple(run.record() for run in begun),
            results=results,
            externals=tuple(dict.fromkeys(run.agent for run in came)),
            absent=tuple(run.record() for run in others if run.begun and not run.finished),
        )


def measured_all(
    finished: Sequence[EntryRun], out: Path, workers: int, cluster: Cluster | None
) -> dict[str, Path]:
    """Evaluate finished runs in each target mode, unless that is done. Return the folder of each record."""
    if not finished:
        raise StudyFailed(f"{out}: no entry is finished, and external agents alone make no page")
    places = {mode: out / f"evaluation-{mode}" for mode in TARGET_MODES}
    agents = {mode: [run for run in finished if run.plays(mode)] for mode in TARGET_MODES}
    late = [mode for mode in TARGET_MODES if not measured(places[mode], agents[mode])]
    run_all([measuring(mode, agents[mode], places[mode]) for mode in late], workers, cluster)
    if left := [places[mode] for mode in late if not measured(places[mode], agents[mode])]:
        raise StudyFailed(f"{left[0]}: was not measured: see {left[0] / 'log.txt'}")
    return places


def measuring(mode: str, runs: Iterable[EntryRun], folder: Path) -> Job:
    """Return the job that evaluates all agents and baselines in a target mode."""
    agents = (given(run.folder.agent) for run in runs)
    command = (*CLI, "evaluate", *agents, "--targets", mode, "--out", given(folder))
    return Job(f"measuring, {mode}", command, folder)


def measured(folder: Path, runs: Iterable[EntryRun]) -> bool:
    """Return True if the folder's record is of exactly these agents, none newer, on the benchmark bank."""
    file, agents = folder / "evaluation.json", [run.folder.agent for run in runs]
    if not file.exists():
        return False
    record = json.loads(file.read_text())
    known = [(ROOT / agent).resolve() for agent in record["agents"]]
    if record["bank"]["hash"] != BANKS[NAME].hash or known != [agent.resolve() for agent in agents]:
        return False
    return all(agent.stat().st_mtime <= file.stat().st_mtime for agent in agents)
