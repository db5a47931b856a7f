"""Solve time against number of rooms, by stage, with rejection sampling and another solver for comparison.

``vitruvius bench generator`` runs this script, and passes the grammar and the amount by environment
variables. Times are CPU seconds, so that other work on the machine counts little; times of several processes
are wall clock.
"""

import itertools
import json
import os
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.sparse import block_diag, coo_array, csr_array

from benchmarks.common.houses import INFERENCES
from vitruvius.logic import House, generate
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.generation.loop import Work
from vitruvius.logic.generation.star import StarDraft
from vitruvius.logic.grammar import find
from vitruvius.logic.language.loaded import LoadedGrammar
from vitruvius.logic.placement import prolog
from vitruvius.logic.placement.layout import Layout
from vitruvius.logic.placement.plan import StarPlan
from vitruvius.logic.request.house_request import HouseRequest

GRAMMAR = os.environ.get("VITRUVIUS_GRAMMAR", "family")
ROOMS = [int(number) for number in os.environ.get("VITRUVIUS_ROOMS", "1 2 4 8 16 32 64 128").split()]
ROUNDS = int(os.environ.get("VITRUVIUS_ROUNDS", "20"))
LIMIT = 20.0
"""Wall-clock seconds for a plan by rejection; longer times are censored."""
REJECTIONS = {
    rooms: min(rounds, ROUNDS)
    for rooms, rounds in {1: 20, 2: 20, 3: 20, 4: 20, 5: 20, 6: 12, 7: 5}.items()
    if rooms <= max(ROOMS)
}
"""Number of plans made by rejection, for each number of rooms."""
HOUSES = min(5, ROUNDS)
"""Number of houses whose linear systems are compared."""
HOUSE, SOLVERS = "a house", "the linear systems of its rooms"
"""Panels of the plot."""


def study(group: str, timer: Callable[[], float] = time.process_time) -> Any:
    return pytest.mark.benchmark(group=group, timer=timer)


@pytest.fixture(scope="module")
def builder() -> Builder:
    made = Builder(find(GRAMMAR))
    for index in range(8):  # The costs of a program's first search and conflict are paid once here.
        made.house(HouseRequest(min(32, max(ROOMS))), 1, index)
    return made


def measure(
    benchmark: Any,
    builder: Builder,
    rooms: int,
    work: Callable[[int], Any],
    *,
    rounds: int = ROUNDS,
    panel: str = HOUSE,
) -> None:
    """Time ``work(0)``, ``work(1)``, ... separately, and count the inferences of each.

    One call before them is not timed.
    """
    numbers, counts = itertools.count(), []

    def setup() -> Any:
        counts.append(inferences())
        return (next(numbers),), {}

    work(0)
    asking = -inferences() + inferences()
    benchmark.pedantic(work, setup=setup, rounds=rounds)
    counts.append(inferences())
    times = benchmark.stats.stats.data
    benchmark.extra_info.update(
        rooms=rooms,
        mean=float(np.mean(times)),
        p95=float(np.percentile(times, 95)),
        inferences=float(np.median(np.diff(counts))) - asking,
        panel=panel,
        versions=builder.versions,
    )


def inferences() -> int:
    """Return the number of inferences that SWI-Prolog has made so far."""
    return prolog.ask("statistics", "inferences", module="system")


# - the generator ------------------------------------------------------------------------------------------


@study("one-off: a grammar is loaded and checked, its programs are grounded", time.perf_counter)
def test_loading(benchmark: Any) -> None:
    builders = []

    def load() -> None:
        builders.append(Builder(find(GRAMMAR), loaded=LoadedGrammar(find(GRAMMAR))))

    benchmark.pedantic(load, rounds=min(5, ROUNDS))
    benchmark.extra_info["versions"] = builders[0].versions


@study("both stages: a furnished house")
@pytest.mark.parametrize("rooms", ROOMS)
def test_house(benchmark: Any, builder: Builder, rooms: int) -> None:
    measure(benchmark, builder, rooms, lambda index: builder.house(HouseRequest(rooms), 0, index))


@study("stage 1: clingo samples a layout")
@pytest.mark.parametrize("rooms", ROOMS)
def test_layout(benchmark: Any, builder: Builder, rooms: int) -> None:
    request, rules = HouseRequest(rooms), (builder.loaded, builder.maker.feasibility)

    def sampled(index: int) -> None:
        StarDraft(*rules, request, Work(np.random.default_rng([0, index]), INFERENCES)).sample()

    measure(benchmark, builder, rooms, sampled)


@study("stage 2: CLP(R) places a layout")
@pytest.mark.parametrize("rooms", ROOMS)
def test_place(benchmark: Any, builder: Builder, rooms: int, monkeypatch: pytest.MonkeyPatch) -> None:
    layouts = placeable(builder, rooms, ROUNDS, monkeypatch)
    rng = np.random.default_rng(0)
    measure(benchmark, builder, rooms, lambda index: builder.placer.place(layouts[index], rng, INFERENCES))


def placeable(builder: Builder, rooms: int, count: int, monkeypatch: pytest.MonkeyPatch) -> list[Layout]:
    """Return the layouts of the first houses that stage 2 finds feasible."""
    placed: list[Layout] = []
    place = builder.placer.place

    def observed(layout: Layout, *arguments: Any, **options: Any) -> StarPlan:
        plan = place(layout, *arguments, **options)
        placed.append(layout)
        return plan

    with monkeypatch.context() as patch:
        patch.setattr(builder.placer, "place", observed)
        for index in range(count):
            builder.house(HouseRequest(rooms), 0, index)
    return placed


@study("processes", time.perf_counter)
@pytest.mark.parametrize("workers", [1, 2])
def test_workers(benchmark: Any, workers: int) -> None:
    count, rooms = 20 * ROUNDS, min(8, max(ROOMS))

    def begun() -> Any:
        houses = generate(rooms=rooms, grammar=GRAMMAR, count=count + 1, workers=workers)
        next(houses)  # Then all one-off work is done.
        return (houses,), {}

    def rest(houses: Iterator[House]) -> list[str]:
        return [json.dumps(house.to_dict()) for house in houses]

    benchmark.pedantic(rest, setup=begun, rounds=min(3, ROUNDS))
    rate = count / benchmark.stats.stats.median
    benchmark.extra_info.update(workers=workers, worked=rooms, houses_per_second=rate)


# - the original's method ----------------------------------------------------------------------------------


@study("baseline: the original's method, rooms only, sampled and rejected")
@pytest.mark.parametrize("rooms", REJECTIONS)
def test_rejection(benchmark: Any, builder: Builder, rooms: int) -> None:
    prolog.load(Path(__file__).with_name("rejection.pl"))
    prolog.run("set_random", prolog.Term("seed", rooms), module="system")
    tries: list[int] = []

    def plan(_: int) -> None:
        tries.append(prolog.ask("tries_until_valid", rooms, LIMIT, module="rejection"))

    rounds = REJECTIONS[rooms]
    measure(benchmark, builder, rooms, plan, rounds=rounds)
    made = tries[-rounds:]
    benchmark.extra_info.update(censored=made.count(0), limit=LIMIT, tries=float(np.median(made)))


# - other solvers of the same systems ----------------------------------------------------------------------


class System(NamedTuple):
    """Rows and right-hand sides of inequalities (at most) and equations, and the number of unknowns."""

    upper: csr_array
    most: np.ndarray
    equal: csr_array
    value: np.ndarray
    unknowns: int


@pytest.fixture
def systems(builder: Builder, rooms: int, monkeypatch: pytest.MonkeyPatch) -> list[list[System]]:
    """Return the linear systems of some houses' rooms with all sizes unknown; SWI-Prolog keeps them too."""
    prolog.load(Path(__file__).with_name("systems.pl"))
    found = []
    for number, layout in enumerate(placeable(builder, rooms, HOUSES, monkeypatch)):
        each = [prolog.Term("room", room.type, room.furniture) for room in layout.rooms]
        prolog.run("stated", number, each, module="systems")
        found.append([matrices(prolog.ask("room_system", *room.arguments)["rows"]) for room in each])
    return found


@study("the same linear systems: is there a solution?")
@pytest.mark.parametrize("rooms", ROOMS)
@pytest.mark.usefixtures("systems")
def test_decide_with_clpr(benchmark: Any, builder: Builder, rooms: int) -> None:
    def decide(turn: int) -> None:
        prolog.run("decided", turn % HOUSES, module="systems")

    measure(benchmark, builder, rooms, decide, panel=SOLVERS)


@study("the same linear systems: is there a solution?")
@pytest.mark.parametrize("rooms", ROOMS)
def test_decide_with_highs(benchmark: Any, builder: Builder, rooms: int, systems: list[list[System]]) -> None:
    def decide(turn: int) -> None:
        assert all(
            extreme(system, np.zeros(system.unknowns)) is not None for system in systems[turn % HOUSES]
        )

    measure(benchmark, builder, rooms, decide, panel=SOLVERS)


@study("the same linear systems: is there a solution?")
@pytest.mark.parametrize("rooms", ROOMS)
def test_decide_with_highs_at_once(
    benchmark: Any, builder: Builder, rooms: int, systems: list[list[System]]
) -> None:
    """Solve all rooms as one program, which avoids SciPy's cost of each call of HiGHS."""
    houses = [joined(house) for house in systems]

    def decide(turn: int) -> None:
        house = houses[turn % HOUSES]
        assert extreme(house, np.zeros(house.unknowns)) is not None

    measure(benchmark, builder, rooms, decide, panel=SOLVERS)


@study("the same linear systems: a solution is sampled")
@pytest.mark.parametrize("rooms", ROOMS)
@pytest.mark.usefixtures("systems")
def test_sample_with_clpr(benchmark: Any, builder: Builder, rooms: int) -> None:
    def sample(turn: int) -> None:
        prolog.run("sampled", turn % HOUSES, turn, module="systems")

    measure(benchmark, builder, rooms, sample, panel=SOLVERS)


@study("the same linear systems: a solution is sampled")
@pytest.mark.parametrize("rooms", [rooms for rooms in ROOMS if rooms <= 16])
def test_sample_with_highs(benchmark: Any, builder: Builder, rooms: int, systems: list[list[System]]) -> None:
    """Sample each unknown in turn, between its smallest and largest value: two programs for each."""

    def sample(turn: int) -> None:
        rng = np.random.default_rng(turn)
        for system in systems[turn % HOUSES]:
            count = system.unknowns
            bounds = np.full((count, 2), (-np.inf, np.inf))
            for unknown, share in enumerate(rng.random(count)):
                objective = np.eye(1, count, unknown)[0]
                low, high = extreme(system, objective, bounds), extreme(system, -objective, bounds)
                assert low is not None
                assert high is not None
                bounds[unknown] = low + share * (-high - low)

    measure(benchmark, builder, rooms, sample, rounds=HOUSES, panel=SOLVERS)


def matrices(rows: list[Any]) -> System:
    """Return rows of linear/linear.pl as matrices.

    A row has pairs of an unknown and its factor, a constant, and a relation.
    """
    count = 1 + max((unknown for pairs, _, _ in rows for unknown, _ in pairs), default=0)
    parts: list[Any] = []
    for relation in ("=<", "="):
        chosen = [(pairs, constant) for pairs, constant, kind in rows if kind == relation]
        cells = [(row, unknown, f) for row, (pairs, _) in enumerate(chosen) for unknown, f in pairs]
        places = np.array([cell[:2] for cell in cells], dtype=int).reshape(-1, 2).T
        table = coo_array(([cell[2] for cell in cells], tuple(places)), shape=(len(chosen), count))
        parts += [table.tocsr(), np.array([-constant for _, constant in chosen])]
    upper, most, equal, value = parts
    return System(upper, most, equal, value, count)


def joined(systems: list[System]) -> System:
    """Return systems that share no unknown as one system."""
    upper, most, equal, value, unknowns = zip(*systems, strict=True)
    tables = csr_array(block_diag(upper)), csr_array(block_diag(equal))
    return System(tables[0], np.concatenate(most), tables[1], np.concatenate(value), sum(unknowns))


def extreme(system: System, objective: np.ndarray, bounds: Any = (None, None)) -> float | None:
    """Return the smallest value of the objective that HiGHS finds, or None without a solution."""
    upper, most, equal, value, _ = system
    solved = linprog(objective, upper, most, equal, value, bounds=bounds, method="highs")
    return solved.fun if solved.status == 0 else None
