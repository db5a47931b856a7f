"""``vitruvius bench throughput``: how many steps per second training makes, by one process and by two.

Each preset is trained by each number of processes and each seed in turns, for the same number of steps, in
the houses of ``vitruvius bench agents``; each process has a core, and as many environments as the preset.
Then all are measured in the benchmark bank: a gain in speed should be no loss in score. Runs are kept, and
one that was stopped goes on; the table is of whole runs, so leave the machine alone meanwhile.
"""

import json
import os
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median

from agent.algorithms.table import PRESETS
from agent.evaluation import scores
from agent.evaluation.statistics import Estimate
from agent.evaluation.tables import WHERE
from agent.runs.runs import Folder
from benchmarks.agents.entries import BUDGET, RATES
from benchmarks.agents.runs import finished, require_same, training_command
from benchmarks.common.houses import training_houses
from benchmarks.common.pages import machine, table_rows, write
from benchmarks.common.processes import CLI, ONE_THREAD, output, say
from logic.errors import RequestError

HEAD = """\
| preset | processes | environments | steps per second | times one | simulator | learner | ratio |
|---|---|---|---|---|---|---|---|"""


@dataclass(frozen=True)
class TrainingSeries:
    """A preset, trained by a number of processes with some seeds."""

    preset: str
    processes: int
    folders: tuple[Folder, ...]

    @property
    def environments(self) -> int:
        """Of all processes together."""
        return self.processes * PRESETS[self.preset].num_envs

    @property
    def name(self) -> str:
        """What its agents are called."""
        return f"{self.preset} by {self.processes}"

    def rates(self, part: str = "") -> list[float]:
        """Steps per second of each run, of all of it or of a part as if it were alone."""
        lasts = [json.loads(folder.metrics.read_text().splitlines()[-1]) for folder in self.folders]
        return [last[part] if part else last["steps"] / last["seconds"] for last in lasts]

    def row(self, one: "TrainingSeries", ratio: str) -> list[str]:
        """Medians over the runs, the whole with its range; beside them the same preset by one process."""
        parts = (f"{median(self.rates(part)):,.0f}" for part in PARTS)
        rates = self.rates()
        whole = f"{median(rates):,.0f} ({min(rates):,.0f} to {max(rates):,.0f})"
        times = f"{median(rates) / median(one.rates()):.2f}"
        return [self.preset, str(self.processes), str(self.environments), whole, times, *parts, ratio]


PARTS = ("simulator", "learner")


@dataclass(frozen=True)
class Throughput:
    """Measure how fast training is, by one process and by several."""

    presets: tuple[str, ...] = ("pqn", "pqn-recurrent")
    """What is trained."""

    processes: int = 2
    """Processes of the longer rows; the shorter ones have one."""

    share: float = 0.1
    """Part of the whole budget of steps that each run has."""

    seeds: tuple[int, ...] = (0, 1, 2)
    """Of the runs of each row."""

    out: Path = Path("runs/throughput")
    """Folder for all runs and for throughput.md."""

    replace: bool = False
    """Write into the folder whatever else it holds."""

    def run(self) -> None:
        """Train what is not trained yet, measure all, and print the table."""
        known = [name for name, config in PRESETS.items() if config.parallel]
        if unknown := set(self.presets) - set(known):
            raise RequestError(f"--presets {min(unknown)}: none that several can train: {', '.join(known)}")
        if self.processes < 2 or not self.seeds or not 0 < self.share <= 1:
            raise RequestError("--processes must be 2 or more; --seeds some; --share above 0, at most 1")
        if self.processes > (found := len(os.sched_getaffinity(0))):
            raise RequestError(f"--processes {self.processes}: there are {found} cores, and each needs one")
        houses = training_houses(self.out / "learn.jsonl", self.processes)
        table = [self.series(preset, count) for preset in self.presets for count in (1, self.processes)]
        for seed in range(len(self.seeds)):
            for series in table:
                self.train(series, seed, houses)
        ratios = {name: ratio for preset in self.presets for name, ratio in self.measured(preset, table)}
        ones = {series.preset: series for series in table if series.processes == 1}
        rows = table_rows(series.row(ones[series.preset], ratios[series.name]) for series in table)
        page = f"{machine()}.\n\n{HEAD}\n{rows}\n"
        write({"throughput.md": page.encode()}, self.out)
        print(page)

    def series(self, preset: str, processes: int) -> TrainingSeries:
        """A row of the table."""
        folders = (Folder(self.out / f"{preset}-by-{processes}-{seed}") for seed in self.seeds)
        return TrainingSeries(preset, processes, tuple(folders))

    def train(self, series: TrainingSeries, number: int, houses: Path) -> None:
        """Train one of its runs, or go on with it; nothing where it is done."""
        folder, steps = series.folders[number], round(self.share * BUDGET * RATES[series.preset])
        seed, name = self.seeds[number], series.name
        command = [sys.executable, "-m", "torch.distributed.run", "--standalone", "--nproc-per-node"]
        command += [str(series.processes), "-m", "vitruvius.cli"]
        changes = {"steps": steps, "seed": seed, "num_envs": series.environments}
        command += training_command(houses, folder.path, series.preset, name, changes)
        require_same(folder, replace(PRESETS[series.preset], **changes))
        if finished(folder, steps):
            return
        say(f"{name}, seed {seed}, {steps / 1e6:.2f} M steps")
        cores = sorted(os.sched_getaffinity(0))
        os.sched_setaffinity(0, cores[: series.processes])  # what is started keeps to these
        try:
            output(command, **ONE_THREAD)
        finally:
            os.sched_setaffinity(0, cores)

    def measured(self, preset: str, table: list[TrainingSeries]) -> list[tuple[str, str]]:
        """The ratio to the oracle of each row of a preset where its targets lie, with its interval."""
        mode, out = PRESETS[preset].targets, self.out / f"evaluation-{preset}"
        rows = [series for series in table if series.preset == preset]
        agents = [str(folder.agent) for series in rows for folder in series.folders]
        output([*CLI, "evaluate", *agents, "--targets", mode, "--out", str(out)], **ONE_THREAD)
        policies = scores.load(out / "evaluation.json").targets[mode].policies
        ratios = {series.name: Estimate(**policies[series.name].figures["ratio"]) for series in rows}
        return [(name, f"{ratio.text()}, {WHERE[mode]}") for name, ratio in ratios.items()]
