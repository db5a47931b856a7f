"""``vitruvius bench drift``: whether a solver process stays quick and small over thousands of houses."""

import contextlib
import csv
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from statistics import quantiles
from time import process_time
from typing import Any

from benchmarks.common.houses import INFERENCES
from benchmarks.common.pages import machine, png, write
from logic.errors import RequestError
from logic.generation.builder import Builder
from logic.grammar import Grammar, find
from logic.placement.plan import StarPlan
from logic.request.request import Request

MEMORY = Path("/proc/self/statm")
PAGE = 4096
PAIRS, HOUSES = 40, 50
"""How often, and with how many houses, the process is timed beside a fresh one."""


@dataclass(frozen=True)
class Stretch:
    """The mean of some houses in a row: CPU time of both stages; memory at their end."""

    houses: int
    """Made so far."""
    layout_ms: float
    place_ms: float
    memory_mb: float

    @property
    def both_ms(self) -> float:
        """CPU time of a house."""
        return self.layout_ms + self.place_ms


@dataclass(frozen=True)
class Drift:
    """Time and memory of one process that makes thousands of houses, into drift.csv and drift.png."""

    grammar: str = "family"
    """A shipped grammar's name, or a directory of rules."""

    rooms: int = 4
    """Number of secondary rooms."""

    houses: int = 20_000
    """How many houses."""

    every: int = 1_000
    """Houses that one point of the curve is the mean of."""

    out: Path = Path("runs/bench")
    """Folder for drift.csv and drift.png."""

    replace: bool = False
    """Write into the folder whatever else it holds."""

    publish: bool = False
    """Put the picture into docs too."""

    def run(self) -> None:
        """Measure, write each row as it is known, draw; at the end, time it beside a fresh process."""
        if not 1 <= self.every <= self.houses // 2 or self.rooms < 1:
            raise RequestError("--rooms needs 1 or more; --houses twice --every or more, --every 1 or more")
        self.out.mkdir(parents=True, exist_ok=True)
        measured, worn = list[Stretch](), Worn(self.grammar, self.rooms)
        with (self.out / "drift.csv").open("w", newline="") as file:
            table = csv.DictWriter(file, list(Stretch.__annotations__))
            table.writeheader()
            for row in stretches(worn, self.houses, self.every):
                measured.append(row)
                table.writerow({name: round(value, 3) for name, value in asdict(row).items()})
                file.flush()
                print(f"{row.houses:,} houses: {row.both_ms:.2f} ms each, {row.memory_mb:.1f} MB", flush=True)
        write({"drift.png": picture(measured, f"{self.grammar}, {self.rooms} rooms")}, self.out, self.publish)
        growth = measured[-1].memory_mb - measured[0].memory_mb
        low, middle, high = quantiles(worn.beside_fresh(self.every), n=4)
        print(
            f"CPU time of the same houses beside a process that has made {self.every:,}, {PAIRS} pairs: "
            f"{middle:.2f} [{low:.2f}, {high:.2f}], median and quartiles; memory {growth:+.1f} MB"
        )


class Worn:
    """A process that makes houses of one request."""

    def __init__(self, grammar: str, rooms: int) -> None:
        """A hundred houses are made before any is timed."""
        self.grammar, self.builder, self.request = grammar, TimedBuilder(find(grammar)), Request(rooms)
        self.make(1, range(100))

    def make(self, seed: int, indices: range) -> float:
        """Make houses; the CPU seconds that it took."""
        began = process_time()
        for index in indices:
            self.builder.house(self.request, seed, index, INFERENCES)
        return process_time() - began

    def beside_fresh(self, made: int) -> list[float]:
        """Its time over that of a process that has made this many, for the same houses, again and again."""
        mine, its = get_context("spawn").Pipe()
        fresh = get_context("spawn").Process(target=_serve, args=(its, self.grammar, self.request.rooms))
        fresh.start()
        try:
            mine.send((3, range(made)))
            mine.recv()
            ratios = []
            for pair in range(PAIRS):
                job = (4, range(pair * HOUSES, (pair + 1) * HOUSES))
                first = self.make(*job) if pair % 2 else 0.0
                mine.send(job)
                other = mine.recv()
                ratios.append((first or self.make(*job)) / other)
            return ratios
        finally:
            mine.close()
            fresh.join()


def _serve(pipe: Connection, grammar: str, rooms: int) -> None:
    fresh = Worn(grammar, rooms)
    with contextlib.suppress(EOFError):
        while True:
            pipe.send(fresh.make(*pipe.recv()))


def stretches(worn: Worn, houses: int, every: int) -> Iterator[Stretch]:
    """The curve, in steps of this many houses."""
    builder = worn.builder
    for begin in range(0, houses - every + 1, every):
        builder.placing = 0.0
        whole = worn.make(0, range(begin, begin + every))
        memory = int(MEMORY.read_text().split()[1]) * PAGE / 1e6 if MEMORY.exists() else 0.0
        scale = 1e3 / every
        yield Stretch(begin + every, scale * (whole - builder.placing), scale * builder.placing, memory)


class TimedBuilder(Builder):
    """A builder that adds up the CPU time of stage 2."""

    placing = 0.0
    """Seconds."""

    def __init__(self, grammar: Grammar) -> None:
        super().__init__(grammar)
        self._place, self.placer.place = self.placer.place, self._timed

    def _timed(self, *arguments: Any, **options: Any) -> StarPlan:
        began = process_time()
        try:
            return self._place(*arguments, **options)
        finally:
            self.placing += process_time() - began


def picture(measured: list[Stretch], title: str) -> bytes:
    """The curve as a PNG: CPU time by stage, memory."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 3.4), dpi=150, layout="constrained")
    times, memory = figure.subplots(1, 2)
    made = [row.houses for row in measured]
    times.plot(made, [row.both_ms for row in measured], "o-", ms=3, label="both")
    times.plot(made, [row.layout_ms for row in measured], "o-", ms=3, label="layout (clingo)")
    times.plot(made, [row.place_ms for row in measured], "o-", ms=3, label="place (SWI-Prolog)")
    times.set(title=title, xlabel="houses made", ylabel="CPU time of a house, ms")
    memory.plot(made, [row.memory_mb for row in measured], "o-", ms=3)
    memory.set(title=machine(), xlabel="houses made", ylabel="memory, MB")
    for axes in (times, memory):
        axes.set_ylim(bottom=0)
        axes.grid(alpha=0.3)
    times.legend(fontsize=8, frameon=False)
    return png(figure)
