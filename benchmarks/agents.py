"""The study of agents: every preset, what its parts are worth, by several seeds, in houses not seen before.

``python -m benchmarks.agents`` makes the houses to learn in, trains each entry with each seed, measures all
in the benchmark bank and writes the page of results: with ``--publish`` into docs. Killed at any moment and
started again it goes on, and what is finished is not done again.
"""

import ctypes
import json
import os
import platform
import signal
import subprocess
import sys
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import partial
from importlib.metadata import version
from pathlib import Path
from time import sleep
from typing import Any, Literal

import tyro

from agent import checkpoint
from agent.banks import bank_hash
from agent.config import PRESETS
from agent.protocol import MODES
from agent.results.agent_plots import pictures
from agent.results.agents import Entry, Run, Study, agents_page, result_of
from agent.results.series import machine
from agent.runs import Folder
from logic import generate, load, save
from logic.errors import RequestError, VitruviusError
from logic.files import write_whole

ROOT = Path(__file__).parents[1]

ROOMS, COUNT = (2, 3, 4, 5, 6), 205
BANK = "0caaed03d5bb8fc50bfaffabf8a4fdcfcc09199ed328cb57dbaf51fa37280a1f"
"""The houses to learn in: so many of `family` with each number of rooms, seeds 102 to 106; their hash."""

BUDGET = 15 * 60
RATES = {"pqn": 46_000, "pqn-map": 21_500, "dqn": 12_000, "paper": 1_800, "pqn-recurrent": 20_000}
"""The whole budget of a run: as many steps as 15 minutes gave on one quiet core of the machine that the study
began on, at so many a second. Counted in steps, it does not depend on the machine."""


def _entry(
    name: str, preset: str, shows: str, said: str = "", beside: str = "", whole: bool = False
) -> Entry:
    """An entry with its preset's budget; its targets are the preset's, where no option says otherwise."""
    options = tuple(said.split())
    targets = options[options.index("--targets") + 1] if "--targets" in options else PRESETS[preset].targets
    return Entry(name, preset, options, BUDGET * RATES[preset], targets, shows, beside, whole)


def _changed(name: str, shows: str, said: str) -> Entry:
    """A change of the agent with a map."""
    return _entry(f"map-{name}", "pqn-map", shows, said, beside="pqn-map")


ENTRIES = (
    _entry("pqn-map", "pqn-map", "the agent with a map"),
    _entry("pqn-map-long", "pqn-map", "the whole budget of steps", beside="pqn-map", whole=True),
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
"""What is trained. An entry ``beside`` another is a change of it, by its options, and is compared with it;
one that is ``whole`` has its whole budget, whatever the share of the others."""


class StudyFailed(VitruviusError):
    """A part of the study that all else stands on did not come about."""

    exit_code = 1


@dataclass(frozen=True)
class Agents:
    """Train and measure all agents, and write the page of results; what is done already is not done again."""

    share: float = 1.0
    """Part of the whole budget of each run; the schedules follow it."""

    only: tuple[str, ...] = ()
    """Entries to train, by name; by default all. The page has all that are finished."""

    seeds: tuple[int, ...] = (0, 1, 2)
    """Of the training runs of each entry."""

    modes: tuple[Literal["main", "secondary", "mixed"], ...] = MODES
    """Where targets lie when agents are measured; the page has these."""

    workers: int = 2
    """Processes at a time, each on a processor of its own."""

    out: Path = Path("runs/study")
    """Folder for all runs and records, of one share."""

    publish: bool = False
    """Put the page and its pictures into docs."""

    def run(self) -> None:
        """Do all of it."""
        entries = [self.shared(entry) for entry in ENTRIES if self.share < 1 or not entry.whole]
        if unknown := set(self.only) - {entry.name for entry in entries}:
            known = ", ".join(entry.name for entry in entries)
            raise RequestError(f"--only {min(unknown)}: no entry. They are {known}")
        if not 0 < self.share <= 1 or self.workers < 1 or not self.seeds:
            raise RequestError("--share must lie above 0 and be at most 1; --workers 1 or more; --seeds some")
        out = self.out.resolve()
        houses = bank(out / "learn.jsonl", self.workers)
        # Seed by seed: wherever the study is stopped, the entries have about equally many runs.
        trials = [Trial(entry, seed, out) for seed in self.seeds for entry in entries]
        for trial in trials:
            trial.require_same_budget()
        asked = [t for t in trials if not self.only or t.entry.name in self.only]
        run_all([t.training(houses) for t in asked if not t.finished], self.workers)
        finished = [trial for trial in trials if trial.finished]
        if not finished:
            raise StudyFailed(f"{self.out}: no run is finished, there is nothing to measure")
        places = {mode: out / f"evaluation-{mode}" for mode in self.modes}
        players = {mode: [trial for trial in finished if trial.plays(mode)] for mode in self.modes}
        late = [mode for mode in self.modes if not measured(places[mode], players[mode])]
        run_all([measuring(mode, players[mode], places[mode]) for mode in late], self.workers)
        if left := [places[mode] for mode in late if not measured(places[mode], players[mode])]:
            raise StudyFailed(f"{left[0]}: was not measured: see {left[0] / 'log.txt'}")
        self.write(self.study(entries, trials, places))

    def shared(self, entry: Entry) -> Entry:
        """The entry with the share of its budget that it has here."""
        return entry if entry.whole else replace(entry, steps=max(1, round(self.share * entry.steps)))

    def study(self, entries: Sequence[Entry], trials: Iterable["Trial"], places: dict[str, Path]) -> Study:
        """The records as the page wants them."""
        runs = [trial.record() for trial in trials if trial.begun]
        told = {run.entry for run in runs}
        records = {
            mode: json.loads((place / "evaluation.json").read_text()) for mode, place in places.items()
        }
        dates = [path.stat().st_mtime for path in self.out.rglob("*.*") if path.name != "study.json"]
        test = records[self.modes[0]]["bank"]
        seeds = " ".join(map(str, self.seeds))
        days = sorted({str(datetime.fromtimestamp(date, UTC).date()) for date in dates})
        return Study(
            share=self.share,
            command=f"python -m benchmarks.agents --share {self.share:g} --seeds {seeds}",
            days=days[0] if len(days) == 1 else f"{days[0]} to {days[-1]}",
            machine=machine({"machine_info": machine_info()}),
            versions={"Python": platform.python_version()}
            | {name: version(name) for name in ("torch", "taichi", "numpy")}
            | {"revision": revision()},
            learnt_in=f"1025 houses of `family`, 2 to 6 rooms, seeds 102 to 106 (hash `{BANK[:12]}`)",
            measured_in=f"{test['file']}, {test['houses']} houses (hash `{test['hash'][:12]}`)",
            entries=tuple(entry for entry in entries if entry.name in told),
            runs=tuple(runs),
            results={mode: result_of(record["targets"][mode], mode) for mode, record in records.items()},
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
class Job:
    """A process of the study: what it does, and where it notes how that went."""

    name: str
    command: tuple[str, ...]
    folder: Path

    def start(self, processor: int) -> subprocess.Popen[bytes]:
        """Start it on one processor; what it prints goes to a file."""
        self.folder.mkdir(parents=True, exist_ok=True)
        failure(self.folder).unlink(missing_ok=True)
        one = {f"{library}_NUM_THREADS": "1" for library in ("OMP", "MKL", "OPENBLAS")}
        with (self.folder / "log.txt").open("ab") as log:
            return subprocess.Popen(
                self.command,
                stdout=log,
                stderr=log,
                stdin=subprocess.DEVNULL,
                cwd=ROOT,
                env=os.environ | one,
                preexec_fn=partial(_keep_to, processor),  # noqa: PLW1509 (no threads are at work here)
            )

    def end(self, code: int) -> None:
        """Tell how it went; a failure is noted too."""
        words = "done"
        if code:
            lines = (self.folder / "log.txt").read_text(errors="replace").strip().splitlines()
            words = f"failed, exit code {code}: {lines[-1] if lines else 'it said nothing'}"
            write_whole(failure(self.folder), words.encode())
        say(f"{self.name}: {words}")


@dataclass(frozen=True)
class Trial:
    """An entry with a seed: a training run in its folder."""

    entry: Entry
    seed: int
    out: Path

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
        return self.entry.everywhere or self.entry.targets == mode

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

    def require_same_budget(self) -> None:
        """Raise ``RequestError`` where a run with another budget lies in the folder: schedules would jump."""
        require_same_budget(self.folder, self.entry.steps)

    def record(self) -> Run:
        """How it went, as far as it did."""
        lines = list(self._reports())
        thin = lines[:: -(-len(lines) // 300)] + lines[-1:] if lines else []
        note = failure(self.folder.path)
        return Run(
            entry=self.entry.name,
            seed=self.seed,
            finished=self.finished,
            failed=note.read_text() if note.exists() else "",
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


CLI = (sys.executable, "-m", "agent.cli")


def finished(folder: Folder, steps: int) -> bool:
    """Whether the agent of a run has seen so many steps."""
    return folder.agent.exists() and checkpoint.load(folder.agent).steps >= steps


def require_same_budget(folder: Folder, steps: int) -> None:
    """Raise ``RequestError`` where a run of other than so many steps lies in the folder."""
    if folder.config.exists():
        kept = json.loads(folder.config.read_text())["config"]["steps"]
        if kept != steps:
            raise RequestError(
                f"{folder.path}: is a run of {kept:,} steps, not {steps:,}. "
                "Give another --out for another --share"
            )


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
    """Whether the record in the folder is of just these agents, none of them newer."""
    file, agents = folder / "evaluation.json", [trial.folder.agent for trial in trials]
    if not file.exists():
        return False
    known = [(ROOT / agent).resolve() for agent in json.loads(file.read_text())["agents"]]
    if known != [agent.resolve() for agent in agents]:
        return False
    return all(agent.stat().st_mtime <= file.stat().st_mtime for agent in agents)


def run_all(jobs: Iterable[Job], workers: int) -> None:
    """Run jobs, so many at a time, each on a processor of its own as long as there are some."""
    processors = sorted(os.sched_getaffinity(0))
    free = [processors[number % len(processors)] for number in range(workers)]
    waiting, running = deque(jobs), dict[subprocess.Popen[bytes], tuple[Job, int]]()
    try:
        while waiting or running:
            while waiting and free:
                job, processor = waiting.popleft(), free.pop(0)
                say(f"{job.name}: begins, {len(waiting)} wait")
                running[job.start(processor)] = job, processor
            sleep(0.5)
            for process in [each for each in running if each.poll() is not None]:
                job, processor = running.pop(process)
                free.append(processor)
                job.end(process.returncode)
    finally:
        for process in running:
            process.terminate()
        for process in running:
            process.wait()


def _told(path: Path) -> str:
    """A path as commands have it: checkpoints keep these, and should tell nothing of whose machine it was."""
    path = path.resolve()
    return str(path.relative_to(ROOT) if path.is_relative_to(ROOT) else path)


def failure(folder: Path) -> Path:
    """Where it is noted why the last try failed."""
    return folder / "failed.txt"


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


def say(text: str) -> None:
    """A line for who watches."""
    print(f"{datetime.now(UTC):%H:%M:%S} {text}", file=sys.stderr, flush=True)


LIBC = ctypes.CDLL(None)


def _keep_to(processor: int) -> None:
    """In a new process: keep to one processor, or Taichi's workers crowd; end if the study is killed."""
    os.sched_setaffinity(0, {processor})
    LIBC.prctl(1, signal.SIGTERM)  # PR_SET_PDEATHSIG


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
