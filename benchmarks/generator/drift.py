"""``vitruvius bench drift``: whether a solver process stays quick and small over thousands of houses."""

import csv
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from io import BytesIO
from pathlib import Path
from time import process_time
from typing import Any

from benchmarks.common.pages import machine, write
from logic.builder import Builder
from logic.errors import RequestError
from logic.grammar import find
from logic.request import Request

MEMORY = Path("/proc/self/statm")
PAGE = 4096
LIMIT = 10**9


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

    publish: bool = False
    """Put the picture into docs too."""

    def run(self) -> None:
        """Measure, write each row as it is known, draw, print how much slower the last houses are."""
        if not 1 <= self.every <= self.houses // 2 or self.rooms < 1:
            raise RequestError("--rooms needs 1 or more; --houses twice --every or more, --every 1 or more")
        self.out.mkdir(parents=True, exist_ok=True)
        measured: list[Stretch] = []
        with (self.out / "drift.csv").open("w", newline="") as file:
            table = csv.DictWriter(file, list(Stretch.__annotations__))
            table.writeheader()
            for row in stretches(self.grammar, self.rooms, self.houses, self.every):
                measured.append(row)
                table.writerow({name: round(value, 3) for name, value in asdict(row).items()})
                file.flush()
                print(f"{row.houses:,} houses: {row.both_ms:.2f} ms each, {row.memory_mb:.1f} MB", flush=True)
        write({"drift.png": picture(measured, f"{self.grammar}, {self.rooms} rooms")}, self.out, self.publish)
        some = -(-len(measured) // 4)
        first, last = (sum(row.both_ms for row in rows) for rows in (measured[:some], measured[-some:]))
        growth = measured[-1].memory_mb - measured[0].memory_mb
        print(f"last quarter / first: {last / first:.2f} of the time, {growth:+.1f} MB")


def stretches(grammar: str, rooms: int, houses: int, every: int) -> Iterator[Stretch]:
    """The curve, in steps of this many houses; a hundred houses are made before any is timed."""
    builder, request = TimedBuilder(find(grammar)), Request(rooms)
    for index in range(100):
        builder.house(request, 1, index, LIMIT)
    for begin in range(0, houses - every + 1, every):
        builder.placing, began = 0.0, process_time()
        for index in range(begin, begin + every):
            builder.house(request, 0, index, LIMIT)
        whole = process_time() - began
        memory = int(MEMORY.read_text().split()[1]) * PAGE / 1e6 if MEMORY.exists() else 0.0
        scale = 1e3 / every
        yield Stretch(begin + every, scale * (whole - builder.placing), scale * builder.placing, memory)


class TimedBuilder(Builder):
    """A builder that adds up the CPU time of stage 2."""

    placing = 0.0
    """Seconds."""

    def place(self, *arguments: Any, **options: Any) -> dict[str, Any]:
        """Stage 2, timed."""
        began = process_time()
        try:
            return super().place(*arguments, **options)
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
    png = BytesIO()
    figure.savefig(png, format="png")
    return png.getvalue()
