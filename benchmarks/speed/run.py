"""``vitruvius bench speed``: steps per second and processor time of a step, alone and as part of more.

Each row of the table is a part of the work on a device, by a number of processes with environments of their
own. A process keeps to its own cores. The clocks of the processes of a row start together after a warm-up.
Rounds measure all rows in turn, each in new processes.
"""

import json
import os
import sys
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from itertools import product
from pathlib import Path
from statistics import median
from typing import Any, Literal

from benchmarks.common.pages import machine, table_rows, versions, write
from benchmarks.common.processes import ONE_THREAD, output, say
from benchmarks.planner.contenders import contender
from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.logic.errors import RequestError

Part = Literal["kernel", "step", "planner", "play", "train"]

HEAD = """\
| part | of | device | processes | environments | steps per second | of processes x one | processor time |
|---|---|---|---|---|---|---|---|"""


@dataclass(frozen=True)
class SpeedRow:
    """A row of the table."""

    part: Part
    of: str
    """A backend, an agent or a preset of training."""

    device: str
    environments: int
    """Environments of each process."""

    processes: int


@dataclass(frozen=True)
class Speed:
    """Steps per second of the simulator, of planners, of agents that play and of training."""

    part: tuple[Part, ...] = ("step", "play", "train")
    """Parts to measure: the kernel of a step, step_torch, a planner with the robot that follows it, an agent
    that plays, and training."""

    backend: tuple[str, ...] = ("continuous",)
    """Backends of the parts kernel and step."""

    agent: tuple[str, ...] = ("explorer",)
    """Agents of the part play: each a baseline, a released agent or a checkpoint."""

    preset: tuple[str, ...] = ("pqn",)
    """Presets of the part train."""

    device: tuple[Literal["cpu", "cuda"], ...] = ("cpu",)
    """Devices: the part play runs on the CPU."""

    environments: tuple[int, ...] = (512,)
    """Numbers of environments of each process."""

    processes: tuple[int, ...] = (1,)
    """Numbers of processes. Those that train are the ranks of one run."""

    cores: int = 1
    """Cores of each process."""

    seconds: float = 2.0
    """Least time of a measurement."""

    rounds: int = 3
    """Rounds over all rows; the table has their median and range."""

    out: Path = Path("runs/speed")
    """Folder for speed.json and speed.md."""

    replace: bool = False
    """Write into the folder even if it holds other files."""

    def run(self) -> None:
        """Measure all rows and print the table."""
        self.require()
        cases = list(self.cases())
        found: dict[SpeedRow, list[dict[str, float]]] = {case: [] for case in cases}
        for number in range(self.rounds):
            for case in cases[:: -1 if number % 2 else 1]:
                found[case].append(self.measured(case))
                say(f"{case}: {found[case][-1]}")
        loads = [each["load"] for rounds in found.values() for each in rounds]
        page = (
            f"{machine()}, {self.cores} for each process; load average {min(loads):.1f} to {max(loads):.1f}. "
            f"{versions('taichi', 'torch', 'numpy')}. Medians of {self.rounds} rounds and ranges.\n\n"
            f"{HEAD}\n{table_rows(row(case, found) for case in cases)}\n"
        )
        record = [asdict(case) | {"rounds": rounds} for case, rounds in found.items()]
        write({"speed.json": json.dumps(record, indent=1).encode(), "speed.md": page.encode()}, self.out)
        print(page)

    def require(self) -> None:
        """Raise ``RequestError`` for options that cannot be measured."""
        least = min(*self.environments, *self.processes, self.cores, self.rounds)
        if least < 1 or self.seconds <= 0:
            raise RequestError("--environments, --processes, --cores, --rounds and --seconds must be above 0")
        needed, cores = max(self.processes) * self.cores, len(os.sched_getaffinity(0))
        if needed > cores:
            raise RequestError(f"--processes x --cores is {needed}: there are {cores} cores")
        for name in self.agent if "play" in self.part else ():
            contender(name)
        parallel = [name for name, config in PRESETS.items() if config.parallel]
        known = parallel if max(self.processes) > 1 else PRESETS
        if "train" in self.part and (unknown := set(self.preset) - set(known)):
            raise RequestError(f"--preset {min(unknown)}: none of {', '.join(known)}")
        if "cuda" in self.device:
            import torch

            if not torch.cuda.is_available():
                raise RequestError("--device cuda: there is no NVIDIA GPU here")

    def cases(self) -> Iterator[SpeedRow]:
        """Yield the rows of the table in its order."""
        of = {"planner": ("explorer",), "play": self.agent, "train": self.preset}
        for part in self.part:
            devices = ("cpu",) if part == "play" else self.device
            for each, device in product(of.get(part, self.backend), devices):
                for environments, processes in product(self.environments, self.processes):
                    yield SpeedRow(part, each, device, environments, processes)

    def measured(self, case: SpeedRow) -> dict[str, float]:
        """Return the steps, seconds and processor seconds of all processes, and the load average before."""
        load, cores = os.getloadavg()[0], sorted(os.sched_getaffinity(0))
        command = [sys.executable, "-m", "benchmarks.speed.worker", json.dumps(asdict(case))]
        if case.processes > 1:
            several = ["torch.distributed.run", "--standalone", "--nproc-per-node", str(case.processes)]
            command[2:2] = [*several, "-m"]
        os.sched_setaffinity(0, cores[: case.processes * self.cores])  # the started processes keep to these
        try:
            said = output([*command, str(self.seconds)], **ONE_THREAD)
        finally:
            os.sched_setaffinity(0, cores)
        return json.loads(said.splitlines()[-1]) | {"load": load}


def row(case: SpeedRow, found: dict[SpeedRow, list[dict[str, Any]]]) -> list[str]:
    """Return a row of the table: environments of each process, processor time of a step.

    The rate is compared with that of one process within each round.
    """
    rounds, one = found[case], replace(case, processes=1)
    rates = [each["steps"] / each["seconds"] for each in rounds]
    ones = [each["steps"] / each["seconds"] for each in found.get(one, [])]
    share = [rate / (case.processes * alone) for rate, alone in zip(rates, ones, strict=False)]
    spent = [1e6 * each["processor_seconds"] / each["steps"] for each in rounds]
    names = [case.part, case.of, case.device, str(case.processes), f"{case.environments:,}"]
    return [*names, spread(rates, ",.0f"), spread(share, ".2f"), f"{spread(spent, '.3g')} µs"]


def spread(values: list[float], form: str) -> str:
    """Return the median of some values with their range; empty for no value."""
    if not values:
        return ""
    return f"{median(values):{form}} ({min(values):{form}} to {max(values):{form}})"
