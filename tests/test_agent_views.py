# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false
"""Which view a map chooses: against all views by NumPy, and what it keeps against looking all anew."""

from collections import deque

import numpy as np
import pytest

from agent.map.belief import SURE
from agent.map.cells import FLAGS, NEAR, OCCUPIED, SOLID, Bytes, Cells, Grid, Wholes
from agent.map.counts import COUNTS, HEADING, SINCE, X, Y
from agent.map.views import (
    HASTE,
    LEAST,
    LOOKED,
    PITCH,
    PLENTY,
    RAYS,
    STRIDE,
    TRIED,
    UNTOLD,
    Views,
    looks,
)
from agent.map.ways import FAR, Ways
from sim.runtime import Array, Launch, start, ti

BITS, BEFORE, SINCE_STEP, AFTER = 8, 10, 50, 60
SIDE = 1 << BITS
LOW, HIGH = 20, 90
"""The walls of the test's house, cells."""


def house(seed: int) -> np.ndarray:
    """Cells (SIDE, SIDE) u16 of a house that was all seen, but for parts of it since the last pick-up."""
    random = np.random.default_rng(seed)
    taken, seen = np.zeros((SIDE, SIDE), bool), np.full((SIDE, SIDE), AFTER)
    inside = np.zeros_like(taken)
    inside[LOW:HIGH, LOW:HIGH] = True
    taken[LOW:HIGH, [LOW, HIGH - 1]] = taken[[LOW, HIGH - 1], LOW:HIGH] = True
    for _ in range(random.integers(4, 10)):
        y, x = random.integers(LOW + 4, HIGH - 4, 2)
        high, wide = random.integers(1, 26, 2)
        taken[y : y + high, x : x + min(wide, 3)] = True
    for _ in range(random.integers(2, 8)):
        y, x = random.integers(LOW, HIGH, 2)
        high, wide = random.integers(5, 30, 2)
        seen[y : y + high, x : x + wide] = BEFORE
    taken &= inside
    solid = taken | np.roll(taken, 1, 0) | np.roll(taken, 1, 1) | np.roll(taken, (1, 1), (0, 1))
    cells = taken * OCCUPIED | solid * SOLID | inside * (NEAR | seen << FLAGS)
    return cells.astype(np.uint16)


class Chooser:
    """A kernel's choices on one map, from one after the other."""

    def __init__(self, cells: np.ndarray) -> None:
        start()
        grid = Grid(BITS)
        views = Views(grid, Ways(grid))

        @ti.kernel
        def choose(
            cells: Cells,
            field: Cells,
            queue: Cells,
            hidden: Bytes,
            shown: Cells,
            rays: Wholes,
            counts: Wholes,
            answer: Wholes,
        ):
            for e in range(1):
                goal, look, within, tail = views.choose(cells, field, queue, hidden, shown, rays, counts, e)
                for k in ti.static(range(4)):
                    answer[k] = (goal, look, within, tail)[k]
                views.ways.forget(field, queue, 0, tail)

        self.arrays = {
            "cells": Array.of(cells.ravel()),
            "field": Array.of(np.full(SIDE**2, FAR, np.uint16)),
            "queue": Array(ti.u16, SIDE**2),
            "hidden": Array(ti.u8, SIDE**2 // 2),
            "shown": Array(ti.u16, views.places),
            "rays": Array.of(looks()),
            "counts": Array(ti.i32, COUNTS),
            "answer": Array(ti.i32, 4),
        }
        self.forget()
        self.launch = Launch(choose, self.arrays)

    def forget(self) -> None:
        """As after a pick-up."""
        self.arrays["shown"].view()[:] = UNTOLD
        self.arrays["hidden"].view()[:] = 0

    def __call__(self, x: int, y: int, heading: int) -> tuple[int, int, int]:
        """The goal, the heading to look at and how many nodes were come to, from a node."""
        counts = self.arrays["counts"].view()
        counts[[X, Y, HEADING, SINCE]] = 2 * x, 2 * y, heading, SINCE_STEP
        self.launch()
        goal, look, _, tail = self.arrays["answer"].numpy().tolist()
        assert (self.arrays["field"].numpy() == FAR).all()
        return goal, look, tail


def distances(cells: np.ndarray, x: int, y: int) -> dict[tuple[int, int], int]:
    """Nodes (x, y) that the body can come to, and how many steps away they are."""
    free = (cells & (SOLID | NEAR)) == NEAR
    found, queue = {(x, y): 0}, deque([(x, y)])
    while queue:
        i, j = queue.popleft()
        for dx in (-1, 0, 1):
            for dy in (-1, 0, 1):
                there = (i + dx, j + dy)
                if there not in found and free[j + dy, i + dx] and free[j, i + dx] and free[j + dy, i]:
                    found[there] = found[i, j] + 1
                    queue.append(there)
    return found


def places(cells: np.ndarray, reached: dict[tuple[int, int], int]) -> dict[tuple[int, int], int]:
    """What each hiding place counts."""
    may = (cells & OCCUPIED == 0) & (cells >> FLAGS < SINCE_STEP)
    return {
        (x, y): SURE
        for x, y in reached
        if x % 2 == y % 2 == 0 and may[y - 1 : y + 1, x - 1 : x + 1].all()
        if may[y - 2 : y + 2, x - 2 : x + 2].sum() >= 12
    }


def octant(
    cells: np.ndarray, counted: dict[tuple[int, int], int], node: tuple[int, int], o: int
) -> tuple[float, set]:
    """What an octant shows from a node, and which places."""
    gain, met = 0, set()
    for ray in range(RAYS):
        angle = np.pi / 4 * (o + (ray - RAYS // 2) / RAYS)
        for k in range(1, LOOKED + 1):
            x = node[0] + round(STRIDE * k * np.cos(angle))
            y = node[1] - round(STRIDE * k * np.sin(angle))
            if cells[y, x] & (OCCUPIED | SOLID):
                break
            even = (x & ~1, y & ~1)
            gain += k * counted.get(even, 0)
            met.add(even)
    return gain * STRIDE**2 * np.pi / 4 / RAYS / 4, met


def worths(cells: np.ndarray, x: int, y: int, heading: int) -> dict[tuple[int, int], float]:
    """What every view is worth, by node and heading: what it shows for its way and its turns."""
    reached = distances(cells, x, y)
    counted = places(cells, reached)
    for k in (-1, 0, 1):
        for place in octant(cells, counted, (x, y), (heading + k) % 8)[1]:
            counted.pop(place, None)
    most, found = min(PLENTY * SURE, sum(counted.values())), {}
    for (i, j), distance in reached.items():
        if (i % PITCH or j % PITCH) and distance:
            continue
        gains = [octant(cells, counted, (i, j), o)[0] for o in range(8)]
        bearing = heading
        if distance:
            bearing = round(np.arctan2(y - j, i - x) / (np.pi / 4)) % 8
        for h in range(8):
            gain = min(most, gains[h] + gains[(h + 1) % 8] + gains[(h - 1) % 8])
            turns = sum(min((a - b) % 8, (b - a) % 8) for a, b in [(heading, bearing), (bearing, h)])
            if gain >= SURE * LEAST and (distance or turns):
                found[(j << BITS) | i, h] = gain / (2 * distance + HASTE + turns)
    return found


def starts(cells: np.ndarray, seed: int, number: int) -> list[tuple[int, int, int]]:
    """Poses on free nodes that ways join."""
    random = np.random.default_rng(seed)
    free = np.argwhere((cells & (SOLID | NEAR)) == NEAR)
    y, x = random.choice(free)
    nodes = list(distances(cells, x, y))
    return [(*nodes[random.integers(len(nodes))], int(random.integers(8))) for _ in range(number)]


@pytest.mark.parametrize("seed", range(4))
def test_the_view_is_the_best_of_all(seed: int) -> None:
    cells = house(seed)
    [(x, y, heading)] = starts(cells, seed, 1)
    goal, look, _ = Chooser(cells)(x, y, heading)
    found = worths(cells, x, y, heading)
    assert len(found) > 100
    assert found[goal, look] == pytest.approx(max(found.values()), rel=1e-5)


def test_what_is_kept_changes_no_choice_and_spares_most_looks() -> None:
    """As long as nothing is new. Choices one after the other, as what was tried is kept, too."""
    again, looks_at_all = 0, 0
    for seed in range(4):
        cells = house(seed)
        lazy, anew = Chooser(cells), Chooser(cells)
        kept, forgotten = lazy.arrays["shown"].view(), anew.arrays["shown"].view()
        for x, y, heading in starts(cells, seed, 6):
            forgotten[:] = UNTOLD
            # One more than it was, so that a look tells: it puts back what there is.
            marked = np.where(kept < UNTOLD, kept + 1, UNTOLD)
            kept[:] = marked
            assert lazy(x, y, heading) == anew(x, y, heading)
            told = marked < UNTOLD
            again += np.sum(told & (kept != marked))
            looks_at_all += np.sum(told & (forgotten < UNTOLD))
            for chooser in (lazy, anew):
                assert set(np.unique(chooser.arrays["hidden"].view())) <= {0, TRIED}
    assert looks_at_all > 100
    assert again < 0.5 * looks_at_all


def test_what_new_ground_may_cost_is_little() -> None:
    """A room that opens between two choices: what is kept may mislead them, but not by much."""
    shares = []
    for seed in range(6):
        cells = house(seed)
        shut = cells.copy()
        shut[:, (LOW + HIGH) // 2 :] = 0  # not yet seen, and not near to what was
        shut[:, (LOW + HIGH) // 2] = OCCUPIED | SOLID | BEFORE << FLAGS
        chooser = Chooser(shut)
        x, y, heading = next(
            pose
            for pose in starts(cells, seed, 99)
            if pose[0] < (LOW + HIGH) // 2 - 2 and shut[pose[1], pose[0]] & SOLID == 0
        )
        chooser(x, y, heading)
        chooser.arrays["cells"].fill(cells.ravel())
        chooser.arrays["hidden"].view()[:] = 0
        found = worths(cells, x, y, heading)
        shares.append(found[chooser(x, y, heading)[:2]] / max(found.values()))
    assert min(shares) > 0.5
    assert np.mean(shares) > 0.9


def test_what_views_showed_is_believed_until_it_is_forgotten() -> None:
    cells = house(0)
    [(x, y, heading)] = starts(cells, 0, 1)
    chooser, found = Chooser(cells), worths(cells, x, y, heading)
    shown = chooser.arrays["shown"].view()
    shown[:] = 0
    assert found.get(chooser(x, y, heading)[:2], 0) < max(found.values())
    chooser.forget()
    assert found[chooser(x, y, heading)[:2]] == pytest.approx(max(found.values()), rel=1e-5)
