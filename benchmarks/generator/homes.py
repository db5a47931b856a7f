"""``vitruvius bench homes``: cost of flats and houses, and their comparison with published ones."""

from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from io import BytesIO
from pathlib import Path
from statistics import median, quantiles
from time import process_time

import msgspec
import numpy as np
from clingo import Symbol

from benchmarks import SECTIONS
from benchmarks.common.pages import machine, table_rows, versions, write
from benchmarks.common.processes import say
from benchmarks.generator.published import PAGE, beside_published, spread
from benchmarks.generator.section import Times
from vitruvius.agent.report.folder import write_report
from vitruvius.logic import check
from vitruvius.logic.drawing.draw import contact_sheet
from vitruvius.logic.errors import RequestError
from vitruvius.logic.files.house_files import save
from vitruvius.logic.files.writing import write_whole
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.generation.furnish import Unfurnishable
from vitruvius.logic.generation.loop import Maker, Stages, Work, made
from vitruvius.logic.generation.shared_walls import Furnishing, Making, PlanDraft, PlanRules
from vitruvius.logic.generation.shared_walls import house as house_of
from vitruvius.logic.grammar import find
from vitruvius.logic.house.house import House
from vitruvius.logic.placement.placer import Failure, Infeasible
from vitruvius.logic.placement.plan import Plan
from vitruvius.logic.request.house_request import HouseRequest

WARM = 20
"""Number of houses that are made before any is timed, because the first searches of a program take longer."""
WINDOW = 1.4
"""Assumed height of a window, in metres, since plans have no heights."""
LARGER = {"clinic": (4, 8, 16, 32, 64), "apartments": (8, 16, 32, 64, 128)}
"""Grammars of larger plans, and the numbers of rooms of their houses."""
SHOWN = 20
"""Number of houses of each size in the report."""
COLOURS = 64
"""Number of colours of the picture, so that its file is small."""


class PlanCost:
    """Cost of the unfurnished plans of houses, and the layout of the last one."""

    def __init__(self) -> None:
        """Begin without plans."""
        self.plans, self.refuted, self.seconds = 0, 0, list[float]()
        self.layout: list[Symbol] = []

    def maker(self, builder: Builder) -> Maker:
        """Return the builder's generator, which records the cost of each unfurnished plan."""
        rules = PlanRules(builder.grammar, builder.loaded, builder.maker.feasibility, builder.programs)

        def plan(request: HouseRequest, work: Work) -> tuple[House, Making]:
            draft = PlanDraft(rules, request, work, rules.assumed(request, work))
            return house_of(rules, made(self._stages(draft)))

        return replace(builder.maker, made=plan)

    def _stages(self, draft: PlanDraft) -> Stages[list[Symbol], Plan, Furnishing]:
        began = process_time()

        def furnish(layout: list[Symbol], plan: Plan) -> Furnishing:
            nonlocal began
            self.seconds.append(process_time() - began)
            self.plans += 1
            self.layout = layout
            try:
                return draft.furnish(layout, plan)
            finally:
                began = process_time()

        def learn(layout: list[Symbol], failure: Failure) -> None:
            nonlocal began
            self.refuted += isinstance(failure, Infeasible)
            draft.learn(layout, failure)
            if isinstance(failure, Unfurnishable):
                began = process_time()

        return Stages(draft.sample, draft.place, furnish, learn)

    @property
    def topology(self) -> frozenset[str]:
        """Topology of the last plan: the types of its rooms, shared walls, and doors."""
        return frozenset(str(atom) for atom in self.layout if atom.name in ("room", "edge", "door"))


@dataclass
class Measured:
    """Houses of one size: CPU seconds of each house, and of each unfurnished plan."""

    rooms: int
    houses: list[House] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    unfurnished: list[float] = field(default_factory=list)
    topologies: set[frozenset[str]] = field(default_factory=set)
    plans: int = 0
    refuted: int = 0

    @property
    def row(self) -> list[str]:
        """Row of the table of sizes."""
        count = len(self.houses)
        return [
            str(self.rooms),
            *(f"{1e3 * each:.0f}" for each in (median(self.unfurnished), p95(self.unfurnished))),
            *(f"{1e3 * each:.0f}" for each in (median(self.seconds), p95(self.seconds))),
            f"{self.refuted / self.plans:.2f}",
            f"{self.plans / count:.2f}",
            f"{100 * len(self.topologies) / count:.0f} %",
        ]


@dataclass(frozen=True)
class Homes:
    """Time, refuted layouts and topologies by size; areas, doors and windows compared with published ones."""

    grammar: str = "home"
    """Grammar whose houses are plans, with the room types of ``home``."""

    rooms: tuple[int, ...] = tuple(range(4, 13))
    """Numbers of rooms."""

    houses: int = 200
    """Number of houses of each number of rooms."""

    larger: int | None = None
    """Number of clinics and buildings of flats of each number of rooms, for time against rooms; by default 40
    for the grammar ``home``, and none for other grammars."""

    out: Path = Path("runs/bench")
    """Folder for report.html, homes.md, its picture homes.png, and their data."""

    replace: bool = False
    """Write into the folder even if it holds other files."""

    publish: bool = False
    """Copy the page, with its pictures and data, into docs."""

    def run(self) -> None:
        """Make the houses, measure them, and write the page and the picture."""
        if not self.rooms or min(self.rooms) < 1 or self.houses < 2:
            raise RequestError("--rooms needs one number or more, each 1 or more; --houses 2 or more")
        builder = Builder(find(self.grammar))
        sizes = [self.measured(builder, rooms) for rooms in self.rooms]
        houses = [house for size in sizes for house in size.houses]
        count = self.larger if self.larger is not None else 40 * (self.grammar == Homes.grammar)
        larger = [row for grammar in LARGER if count for row in larger_rows(grammar, count)]
        command = f"./run bench homes --grammar {self.grammar} --houses {self.houses} --larger {count}"
        page = PAGE.format(
            command=command,
            machine=machine(),
            versions=versions(**{name: builder.versions[name] for name in ("clingo", "swi-prolog")}),
            sizes=table_rows(size.row for size in sizes),
            larger=table_rows(larger),
            types=table_rows(type_rows(houses)),
            published=table_rows(beside_published(houses, WINDOW)),
            window=WINDOW,
            houses=self.houses,
        )
        write({"homes.md": page.encode(), "homes.png": picture(sizes)}, self.out, self.publish)
        save((house for size in sizes for house in size.houses[:SHOWN]), self.out / "homes.jsonl")
        times = [Times(size.rooms, size.unfurnished, size.seconds) for size in sizes]
        write_whole(self.out / "homes.json", msgspec.json.encode(times))
        write_report(self.out, studies=SECTIONS)
        print(page)

    def measured(self, builder: Builder, rooms: int) -> Measured:
        """Return the measurements of houses of one size; house ``i`` has seed 0 and index ``i``."""
        size, request = Measured(rooms), HouseRequest(rooms)
        for index in range(WARM):
            builder.house(request, 1, index)
        counting = PlanCost()
        builder.maker = counting.maker(builder)
        for index in range(self.houses):
            began = process_time()
            size.houses.append(builder.house(request, 0, index))
            size.seconds.append(process_time() - began)
            size.topologies.add(counting.topology)
        size.unfurnished, size.plans, size.refuted = counting.seconds, counting.plans, counting.refuted
        say(f"{rooms} rooms: {1e3 * median(size.seconds):.0f} ms a house")
        return size


def larger_rows(grammar: str, houses: int) -> Iterator[list[str]]:
    """Yield a row for each number of rooms: CPU time of a furnished house, and violations.

    The last row is the growth of the time.
    """
    builder, times = Builder(find(grammar)), dict[int, float]()
    for rooms in LARGER[grammar]:
        request, seconds, violations = HouseRequest(rooms), list[float](), 0
        builder.house(request, 1, 0)
        for index in range(houses):
            began = process_time()
            house = builder.house(request, 0, index)
            seconds.append(process_time() - began)
            violations += bool(check(house))
        times[rooms] = median(seconds)
        say(f"{grammar}, {rooms} rooms: {1e3 * times[rooms]:.0f} ms a house")
        spent = [f"{1e3 * each:.0f}" for each in (times[rooms], p95(seconds))]
        yield [grammar, str(rooms), *spent, str(violations)]
    sizes = sorted(times)
    growth = np.polyfit(np.log(sizes), np.log([times[rooms] for rooms in sizes]), 1)[0]
    yield [grammar, f"{sizes[0]} to {sizes[-1]}", f"rooms^{growth:.2f}", "", ""]


def p95(values: list[float]) -> float:
    """Return the 95th percentile."""
    return quantiles(values, n=20, method="inclusive")[-1]


def type_rows(houses: Iterable[House]) -> Iterator[list[str]]:
    """Yield a row for each type of room: rooms in a house, quartiles of the area, doors of a room."""
    areas, doors, count = defaultdict[str, list[float]](list), defaultdict[str, int](int), 0
    for house in houses:
        count += 1
        for room in house.rooms:
            areas[room.type].append(room.area)
            doors[room.type] += len(house.doors_of(room.name))
    for type_, found in sorted(areas.items(), key=lambda item: -median(item[1])):
        yield [
            type_,
            f"{len(found) / count:.2f}",
            spread(found),
            f"{min(found):.1f} to {max(found):.1f}",
            f"{doors[type_] / len(found):.2f}",
        ]


def picture(sizes: list[Measured]) -> bytes:
    """Return a sheet of twelve homes on one scale: the first of each size, then second ones."""
    first = [size.houses[0] for size in sizes] + [size.houses[1] for size in reversed(sizes)]
    shown = sorted(first[:12], key=lambda house: len(house.rooms))
    buffer = BytesIO()
    contact_sheet(shown, 4, one_scale=True).quantize(COLOURS).save(buffer, "PNG", optimize=True)
    return buffer.getvalue()
