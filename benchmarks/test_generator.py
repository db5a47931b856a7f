"""Solve time against room count, by stage, beside rejection sampling and another solver of the same systems.

``vitruvius bench generator --grammar DIR`` runs it on a grammar of one's own (``VITRUVIUS_GRAMMAR``).
"""

import itertools
import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.sparse import coo_array

from logic import generate
from logic.builder import Builder
from logic.grammar import find
from logic.placement import Layout, Refuted
from logic.request import Request

GRAMMAR = os.environ.get("VITRUVIUS_GRAMMAR", "family")
ROOMS = [1, 2, 4, 8, 16, 32, 64, 128]
ROUNDS = 20
INFERENCES = 10**9
LIMIT = 20.0
"""Seconds for a plan by rejection; what takes longer is censored."""


@pytest.fixture(scope="module")
def builder() -> Builder:
    return Builder(find(GRAMMAR))


def note(benchmark: Any, rooms: int, **more: Any) -> None:
    """What the study reports beside the median."""
    times = benchmark.stats.stats.data
    p95 = float(np.percentile(times, 95))
    benchmark.extra_info.update({"rooms": rooms, "p95": p95, "mean": float(np.mean(times)), **more})


@pytest.mark.benchmark(group="one-off: a grammar is loaded and checked, its programs are grounded")
def test_loading(benchmark) -> None:
    benchmark.pedantic(lambda: Builder(find(GRAMMAR)), rounds=5)


@pytest.mark.benchmark(group="stage 1: clingo draws a layout")
@pytest.mark.parametrize("rooms", ROOMS)
def test_layout(benchmark, builder: Builder, rooms: int) -> None:
    builder.layout(Request(rooms), np.random.default_rng(0))
    seeds = itertools.count()
    benchmark.pedantic(
        lambda: builder.layout(Request(rooms), np.random.default_rng(next(seeds))), rounds=ROUNDS
    )
    note(benchmark, rooms)


def placeable(builder: Builder, rooms: int, count: int) -> list[tuple[Layout, int]]:
    """Layouts that stage 2 does not refute, and their inferences: refutations count in a house's time."""
    found: list[tuple[Layout, int]] = []
    for seed in itertools.count():
        rng = np.random.default_rng([rooms, seed])
        layout = builder.layout(Request(rooms), rng)
        try:
            plan = builder.place(layout, np.random.default_rng(0), INFERENCES)
        except Refuted:
            if seed > 50 * count:
                pytest.skip("too many layouts of this size are refuted")
            continue
        found.append((layout, plan["inferences"]))
        if len(found) == count:
            return found
    raise AssertionError


@pytest.mark.benchmark(group="stage 2: CLP(R) places a layout")
@pytest.mark.parametrize("rooms", ROOMS[:7])
def test_place(benchmark, builder: Builder, rooms: int) -> None:
    layouts = placeable(builder, rooms, ROUNDS if rooms < 32 else 5)
    turns = itertools.cycle(layouts)
    benchmark.pedantic(
        builder.place,
        setup=lambda: ((next(turns)[0], np.random.default_rng(0), INFERENCES), {}),
        rounds=ROUNDS,
    )
    note(benchmark, rooms, inferences=float(np.median([inferences for _, inferences in layouts])))


@pytest.mark.benchmark(group="both stages: a furnished house")
@pytest.mark.parametrize("rooms", ROOMS)
def test_house(benchmark, builder: Builder, rooms: int) -> None:
    builder.house(Request(rooms), 0, 0, INFERENCES)
    indices = itertools.count()
    benchmark.pedantic(lambda: builder.house(Request(rooms), 0, next(indices), INFERENCES), rounds=ROUNDS)
    note(benchmark, rooms)


@pytest.mark.benchmark(group="baseline: the original's method, rooms only, drawn and rejected")
@pytest.mark.parametrize("rooms", [1, 2, 3, 4, 5, 6, 7])
def test_rejection(benchmark, builder: Builder, rooms: int) -> None:
    from pyswip import Prolog

    list(Prolog.query(f"use_module('{Path(__file__).with_name('rejection.pl')}'), set_random(seed({rooms}))"))
    tries: list[int] = []

    def plan() -> None:
        goal = f"rejection:tries_until_valid({rooms},{LIMIT},Tries)"
        tries.append(next(iter(Prolog.query(goal, maxresult=1)))["Tries"])

    benchmark.pedantic(plan, rounds=9 if rooms < 6 else 3)
    censored = tries.count(0)
    note(benchmark, rooms, censored=censored, tries=float(np.median(tries)))


def systems(builder: Builder, rooms: int) -> list[tuple[str, list[Any]]]:
    """The linear systems of a house's rooms: goal for CLP(R), and the rows of numbers (rules/linear.pl)."""
    ((layout, _),) = placeable(builder, rooms, 1)
    terms = [f"{r.type},[{','.join(map(str, r.furniture))}]" for r in layout.rooms]
    return [(term, builder._placer._json(f"room_system({term},Json)")) for term in terms]


@pytest.mark.benchmark(group="the same linear systems: is there a solution?")
@pytest.mark.parametrize("rooms", ROOMS[:6])
def test_decide_with_clpr(benchmark, builder: Builder, rooms: int) -> None:
    goals = [f"room_clash({term},[],Json)" for term, _ in systems(builder, rooms)]
    assert (
        benchmark.pedantic(lambda: [builder._placer._json(goal) for goal in goals], rounds=5)
        == [None] * rooms
    )
    note(benchmark, rooms)


@pytest.mark.benchmark(group="the same linear systems: is there a solution?")
@pytest.mark.parametrize("rooms", ROOMS[:6])
def test_decide_with_highs(benchmark, builder: Builder, rooms: int) -> None:
    rows = [rows for _, rows in systems(builder, rooms)]
    done = benchmark.pedantic(lambda: [feasible(each) for each in rows], rounds=5)
    assert all(done)
    note(benchmark, rooms)


def feasible(rows: list[Any]) -> bool:
    """Whether HiGHS finds a solution of these rows."""
    matrices = {}
    count = 1 + max((v for pairs, _, _ in rows for v, _ in pairs), default=0)
    for relation in ("=<", "="):
        chosen = [(pairs, constant) for pairs, constant, kind in rows if kind == relation]
        cells = [(f, (i, v)) for i, (pairs, _) in enumerate(chosen) for v, f in pairs]
        if chosen:
            values, places = [f for f, _ in cells], np.array([p for _, p in cells]).reshape(-1, 2).T
            matrices[relation] = (
                coo_array((values, places), shape=(len(chosen), count)).tocsr(),
                [-constant for _, constant in chosen],
            )
    upper, equal = matrices.get("=<", (None, None)), matrices.get("=", (None, None))
    solved = linprog(np.zeros(count), *upper, *equal, bounds=(None, None), method="highs")
    return solved.status == 0


@pytest.mark.benchmark(group="processes: 400 houses of 8 rooms")
@pytest.mark.parametrize("workers", [1, 2])
def test_workers(benchmark, workers: int) -> None:
    def houses() -> list[str]:
        made = generate(rooms=8, grammar=GRAMMAR, count=400, workers=workers)
        return [json.dumps(house.to_dict()) for house in made]

    benchmark.pedantic(houses, rounds=3)
    benchmark.extra_info["workers"] = workers
