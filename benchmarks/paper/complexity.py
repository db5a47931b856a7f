"""Growth of the work with the number of rooms: the original's placing of rooms against our whole houses.

Both make houses of the grammar ``paper`` with the same rooms of each type, in turn in one process, with the
same limit of Prolog's inferences. The houses of the generator here are also furnished, which counts against
it.
"""

import json
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import cycle, islice
from pathlib import Path
from time import process_time
from typing import Any, Literal, NamedTuple

import numpy as np

from benchmarks.common.pages import DOCS, machine, png, table_rows
from benchmarks.common.processes import say
from vitruvius.logic.cluster import engine
from vitruvius.logic.errors import LimitReached, RequestError, VitruviusError
from vitruvius.logic.files.writing import write_whole
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import find
from vitruvius.logic.placement import prolog
from vitruvius.logic.request.house_request import HouseRequest

TYPES = ("bedroom", "bathroom", "kitchen", "hall")
"""Types of rooms in turn, so that a house has one room of each type before it has two: the original allows
two of each."""
SAMPLED = {1: 30, 2: 30, 3: 30, 4: 30, 5: 20, 6: 10, 7: 5, 8: 5}
"""Number of houses that the original's method places, for each number of rooms."""
COMMAND = "./run bench paper complexity"
ORIGINAL, OURS = "original", "ours"
LABELS = {ORIGINAL: "the original: sample and test, rooms alone", OURS: "here: furnished houses"}


class OtherMachine(VitruviusError):
    """Times of several machines cannot be compared."""

    exit_code = 1


class StudyCell(NamedTuple):
    """A measurement: some houses with a number of rooms, by a method."""

    method: str
    rooms: int
    houses: int
    inferences: int
    """Limit of inferences for a house."""


@dataclass(frozen=True)
class Complexity:
    """Success rate and CPU time against the rooms, for the original's method and for the generator."""

    rooms: tuple[int, ...] = (1, 2, 3, 4, 5, 6, 7, 8, 16, 32, 64)
    """Numbers of rooms; the original's method is tried up to 8."""

    houses: int = 100
    """Number of houses that the generator makes for each number of rooms; the original's method makes at most
    as many."""

    inferences: int = 200_000_000
    """Limit of inferences for a house: about 10 s of CPU."""

    out: Path = DOCS
    """Folder for paper-complexity.json and .png. Existing measurements with the same limit are not
    repeated."""

    engine: Literal["ray"] | None = None
    """Measure by Ray, here or on a cluster: each number of rooms by a method has a whole machine."""

    address: str | None = None
    """Address of Ray's cluster; by default the study starts one here."""

    def run(self) -> None:
        """Run the measurements that are missing, draw all of them and print a table."""
        if self.houses < 1 or self.inferences < 1 or not self.rooms or min(self.rooms) < 1:
            raise RequestError("--rooms, --houses and --inferences need numbers of 1 or more")
        file = self.out / "paper-complexity.json"
        study = json.loads(file.read_bytes()) if file.exists() else {}
        if study.get("inferences") != self.inferences:
            study = {"command": COMMAND, "inferences": self.inferences, "measured": []}
        known = {(each["method"], each["rooms"]) for each in study["measured"]}
        wanted = [
            StudyCell(method, rooms, count, self.inferences)
            for rooms in sorted(set(self.rooms))
            for method, count in ((ORIGINAL, min(SAMPLED.get(rooms, 0), self.houses)), (OURS, self.houses))
            if count and (method, rooms) not in known
        ]
        for entry in self._measured(wanted):
            study["measured"].append(entry)
            write_whole(file, json.dumps(study, indent=1).encode())
            say(_row(entry))
        write_whole(self.out / "paper-complexity.png", picture(study))
        print(table(study))

    def _measured(self, wanted: list[StudyCell]) -> Iterator[dict[str, Any]]:
        """Yield the results of cells, as they are measured."""
        if wanted:
            with engine(self.engine, self.address) as cluster:
                cells = enumerate(map(measured, wanted))
                for _, entry in cluster.each(measured, wanted, alone=True) if cluster else cells:
                    yield entry


def measured(cell: StudyCell) -> dict[str, Any]:
    """Measure a cell: CPU seconds of each house, number of houses within the limit, and the machine."""
    builder = _warm()
    types = list(islice(cycle(TYPES), cell.rooms))
    wanted = {type_: (number, number) for type_, number in Counter(types).items()}
    request = HouseRequest(cell.rooms, wanted, inferences=cell.inferences)
    seconds, tries = [], []
    for index in range(cell.houses):
        prolog.run("set_random", prolog.Term("seed", 1000 * cell.rooms + index), module="system")
        began = process_time()
        if cell.method == ORIGINAL:
            made = prolog.ask("tries_until_placed", types, cell.inferences, module="original_rooms")
            tries.append(made)
        else:
            made = _is_made(builder, request, index)
        if made:
            seconds.append(process_time() - began)
    found = {
        "method": cell.method,
        "rooms": cell.rooms,
        "asked": cell.houses,
        "made": len(seconds),
        "cpu_seconds": seconds,
        "machine": machine(),
    }
    return found | ({"tries": [number for number in tries if number]} if tries else {})


@cache
def _warm() -> Builder:
    """Return the builder of this process, after the costs of its programs' first searches."""
    builder = Builder(find("paper"))
    prolog.load(Path(__file__).with_name("original_rooms.pl").resolve())
    for index in range(8):
        builder.house(HouseRequest(4), 1, index)
    return builder


def _is_made(builder: Builder, request: HouseRequest, index: int) -> bool:
    try:
        builder.house(request, 0, index)
    except LimitReached:
        return False
    return True


def median(entry: dict[str, Any]) -> float:
    """Return the median CPU time of all houses; infinite if the limit stopped half of them."""
    times = [*entry["cpu_seconds"], *[np.inf] * (entry["asked"] - entry["made"])]
    return float(np.percentile(times, 50, method="lower"))


def growth(study: dict[str, Any], method: str) -> tuple[float, float]:
    """Return the growth of the median: its factor for each room, and its power of the number of rooms.

    Both are least squares on logarithms from 2 rooms on. Raises ``OtherMachine`` for measurements of several
    machines.
    """
    machines = sorted({e["machine"] for e in study["measured"] if e["method"] == method})
    if len(machines) > 1:
        named = "; ".join(machines)
        raise OtherMachine(
            f"times of several machines are not of one law ({named}): measure in another folder"
        )
    found = [e for e in study["measured"] if e["method"] == method and e["rooms"] >= 2 and median(e) < np.inf]
    rooms, times = np.array([e["rooms"] for e in found]), np.log([median(e) for e in found])
    if len(found) < 2:
        return np.nan, np.nan
    return float(np.exp(np.polyfit(rooms, times, 1)[0])), float(np.polyfit(np.log(rooms), times, 1)[0])


def table(study: dict[str, Any]) -> str:
    """Return all measurements as a Markdown table, with the fitted laws."""
    cells = {(entry["rooms"], entry["method"]): _cells(entry) for entry in study["measured"]}
    rows = [
        [str(rooms), *cells.get((rooms, ORIGINAL), [""] * 3), *cells.get((rooms, OURS), [""] * 3)[:2]]
        for rooms in sorted({rooms for rooms, _ in cells})
    ]
    head = (
        f"| rooms | {LABELS[ORIGINAL]}: made | CPU time, median | tries, median "
        f"| {LABELS[OURS]}: made | CPU time, median |\n|{'---|' * 6}\n"
    )
    factor, exponent = growth(study, ORIGINAL)[0], growth(study, OURS)[1]
    law = f"The original's median grows {factor:.1f} times per room; here it grows as rooms^{exponent:.2f}."
    return f"{head}{table_rows(rows)}\n\n{law}"


def _ordered(study: dict[str, Any]) -> list[dict[str, Any]]:
    return sorted(study["measured"], key=lambda entry: (entry["method"] == OURS, entry["rooms"]))


def _cells(entry: dict[str, Any]) -> list[str]:
    middle = median(entry)
    time = f"{1e3 * middle:,.1f} ms" if middle < np.inf else "over the limit"
    tries = f"{np.median(entry['tries']):,.0f}" if entry.get("tries") and middle < np.inf else ""
    return [f"{entry['made']} of {entry['asked']}", time, tries]


def _row(entry: dict[str, Any]) -> str:
    return f"{entry['rooms']} rooms, {entry['method']}: {', '.join(filter(None, _cells(entry)))}"


def picture(study: dict[str, Any]) -> bytes:
    """Return a PNG: the fraction of houses that were made, and their CPU time, against the rooms."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11, 4.2), dpi=150, layout="constrained")
    share, time = figure.subplots(1, 2)
    for method in (ORIGINAL, OURS):
        found = [entry for entry in _ordered(study) if entry["method"] == method]
        rooms = [entry["rooms"] for entry in found]
        share.plot(rooms, [e["made"] / e["asked"] for e in found], "o-", label=LABELS[method])
        done = [e for e in found if median(e) < np.inf]
        (line,) = time.plot([e["rooms"] for e in done], [median(e) for e in done], "o-", label=LABELS[method])
        for entry in found:
            spread = [entry["rooms"]] * entry["made"]
            time.plot(spread, entry["cpu_seconds"], ".", ms=2, alpha=0.3, color=line.get_color())
    share.set(xlabel="rooms", ylabel="share that is made within the limit", ylim=(-0.03, 1.03))
    time.set(xlabel="rooms", ylabel="CPU seconds of a house: medians, and each", yscale="log")
    for axes in (share, time):
        axes.set_xscale("log", base=2)
        ticks = sorted({entry["rooms"] for entry in study["measured"]})
        axes.set_xticks(ticks, [str(tick) for tick in ticks])
        axes.minorticks_off()
        axes.grid(alpha=0.3)
        axes.legend(frameon=False, fontsize=8)
    machines = "; ".join(sorted({entry["machine"] for entry in study["measured"]}))
    figure.suptitle(f"Limit {study['inferences']:,} inferences. {machines}", fontsize=8)
    return png(figure)


def measure(out: Path, **options: Any) -> dict[str, Any]:
    """Run the measurements that are missing in a folder, and return all of them."""
    Complexity(out=out, **options).run()
    return json.loads((out / "paper-complexity.json").read_bytes())


def section(data: dict[str, Any]) -> str:
    """Return the table and the picture."""
    return f"    {data['command']}\n\n{table(data)}\n\n![CPU time against the rooms](paper-complexity.png)"
