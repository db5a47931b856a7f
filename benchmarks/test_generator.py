"""Solve time against room count, by stage. Set-up (grounding, loading) is outside the time."""

import itertools

import numpy as np
import pytest

from logic.builder import Builder, Request
from logic.grammar import find

ROOMS = [1, 2, 4, 8, 16, 32, 64]
ROUNDS = 20
INFERENCES = 10**9


@pytest.fixture(scope="module")
def builder() -> Builder:
    return Builder(find("family"))


@pytest.mark.benchmark(group="generator, stage 1: clingo draws a layout")
@pytest.mark.parametrize("rooms", ROOMS)
def test_layout(benchmark, builder: Builder, rooms: int) -> None:
    benchmark.extra_info["rooms"] = rooms
    builder.layout(Request(rooms), np.random.default_rng(0))
    seeds = itertools.count()
    benchmark.pedantic(
        lambda: builder.layout(Request(rooms), np.random.default_rng(next(seeds))), rounds=ROUNDS
    )


@pytest.mark.benchmark(group="generator, both stages: a furnished house")
@pytest.mark.parametrize("rooms", ROOMS)
def test_house(benchmark, builder: Builder, rooms: int) -> None:
    benchmark.extra_info["rooms"] = rooms
    builder.house(Request(rooms), 0, 0, INFERENCES)
    indices = itertools.count()
    benchmark.pedantic(lambda: builder.house(Request(rooms), 0, next(indices), INFERENCES), rounds=ROUNDS)


@pytest.mark.benchmark(group="generator, stage 2: CLP(R) places a layout")
@pytest.mark.parametrize("rooms", ROOMS)
def test_place(benchmark, builder: Builder, rooms: int) -> None:
    layouts = []
    inferences = []

    def fresh() -> tuple[tuple, dict]:
        """A layout that stage 2 does not refute: refutations count in the time of a house, not here."""
        while True:
            rng = np.random.default_rng([rooms, len(layouts)])
            layouts.append(builder.layout(Request(rooms), rng))
            try:
                inferences.append(
                    builder.place(layouts[-1], np.random.default_rng(0), INFERENCES)["inferences"]
                )
            except Exception as refuted:
                if type(refuted).__name__ != "Refuted":
                    raise
            else:
                return (layouts[-1], np.random.default_rng(0), INFERENCES), {}

    benchmark.pedantic(builder.place, setup=fresh, rounds=ROUNDS)
    benchmark.extra_info["rooms"] = rooms
    benchmark.extra_info["inferences"] = float(np.median(inferences))
