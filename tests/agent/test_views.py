# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false
"""Which view a map chooses: against all views by NumPy, and what it keeps against looking all anew."""

import numpy as np

from agent.planner.belief import SURE
from agent.planner.cells import FLAGS, NEAR, OCCUPIED, SOLID, TILE, Bytes, Cells, Grid, Wholes
from agent.planner.counts import COUNTS, HEADING, SINCE, X, Y
from agent.planner.flood import UNASKED, Words
from agent.planner.survey import HASTE, PITCH, UNTOLD
from agent.planner.views import (
    LEAST,
    LOOKED,
    PLENTY,
    RAYS,
    SPARE,
    STRIDE,
    TRIED,
    Views,
    looks,
)
from sim.runtime import Array, Launch, start, ti
from tests.agent.test_flood import flood, opened

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
        views = Views(Grid(BITS))

        @ti.kernel
        def choose(
            cells: Cells,
            queue: Cells,
            news: Bytes,
            tiles: Words,
            guesses: Bytes,
            hidden: Bytes,
            shown: Cells,
            rays: Wholes,
            counts: Wholes,
            answer: Wholes,
        ):
            for e in range(1):
                goal, look, within = views.choose(
                    cells, queue, news, tiles, guesses, hidden, shown, rays, counts, e
                )
                for k in ti.static(range(3)):
                    answer[k] = (goal, look, within)[k]

        self.arrays = {
            "cells": Array.of(cells.ravel()),
            "queue": Array(ti.u16, SIDE**2),
            "news": Array.of(np.ones(SIDE**2 >> 2 * TILE, np.uint8)),
            "tiles": Array(ti.u64, views.survey.flood.words),
            "guesses": Array.of(np.full(SIDE**2 >> 2, UNASKED, np.uint8)),
            "hidden": Array(ti.u8, SIDE**2 >> 2),
            "shown": Array(ti.u16, views.places),
            "rays": Array.of(looks()),
            "counts": Array(ti.i32, COUNTS),
            "answer": Array(ti.i32, 3),
        }
        self.forget()
        self.launch = Launch(choose, self.arrays)

    def forget(self) -> None:
        """As after a pick-up."""
        self.arrays["shown"].view()[:] = UNTOLD
        self.arrays["hidden"].view()[:] = 0

    def show(self, cells: np.ndarray) -> None:
        """Let the map have other cells."""
        self.arrays["cells"].fill(cells.ravel())
        self.arrays["news"].view()[:] = 1

    def __call__(self, x: int, y: int, heading: int) -> tuple[int, int]:
        """The goal, and the heading to look at, from a node."""
        counts = self.arrays["counts"].view()
        counts[[X, Y, HEADING, SINCE]] = 2 * x, 2 * y, heading, SINCE_STEP
        self.launch()
        goal, look, _ = self.arrays["answer"].numpy().tolist()
        return goal, look


def distances(cells: np.ndarray, x: int, y: int) -> dict[tuple[int, int], int]:
    """How far away the first nodes (x, y) of blocks are by the flood, where they are open; and the body's."""
    found = {}
    for (j, i), level in np.ndenumerate(flood(cells, 2 * x, 2 * y)):
        if level >= 0 and opened(cells)[2 * j, 2 * i]:
            found[2 * i, 2 * j] = max(2 * level - 1, abs(2 * i - x), abs(2 * j - y)) if level else 0
    return found | {(x, y): 0}


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
        if (i, j) != (x, y) and (i % PITCH or j % PITCH or not distance):
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
    y, x = random.choice(np.argwhere(opened(cells)))
    nodes = list(distances(cells, x, y))
    return [(*nodes[random.integers(len(nodes))], int(random.integers(8))) for _ in range(number)]


def test_the_view_is_mostly_the_best_of_all_and_never_far_from_it() -> None:
    """Between places from which it has looked, it looks only where these tell that it may be worth it."""
    shares = []
    for seed in range(8):
        cells = house(seed)
        chooser = Chooser(cells)
        for x, y, heading in starts(cells, seed, 6):
            chooser.forget()
            found = worths(cells, x, y, heading)
            assert len(found) > 100
            shares.append(found[chooser(x, y, heading)] / max(found.values()))
    assert np.mean(np.array(shares) > 1 - 1e-5) > 0.9
    assert min(shares) > 0.8


def test_what_is_kept_changes_next_to_no_choice_and_spares_looks() -> None:
    """As long as nothing is new. Choices one after the other, as what was tried is kept, too."""
    again, lazily, in_all, known, same = 0, 0, 0, 0, []
    for seed in range(4):
        cells = house(seed)
        lazy, anew = Chooser(cells), Chooser(cells)
        kept, forgotten = lazy.arrays["shown"].view(), anew.arrays["shown"].view()
        for x, y, heading in starts(cells, seed, 24):
            forgotten[:] = UNTOLD
            # One more than it was, so that a look tells: it puts back what there is.
            marked = np.where(kept < UNTOLD, kept + 1, UNTOLD)
            kept[:] = marked
            same.append(lazy(x, y, heading) == anew(x, y, heading))
            told = marked < UNTOLD
            again += np.sum(told & (kept != marked))
            lazily += np.sum((kept < UNTOLD) & (kept != marked))
            in_all += np.sum(forgotten < UNTOLD)
            known += np.sum(told)
            for chooser in (lazy, anew):
                assert set(np.unique(chooser.arrays["hidden"].view())) <= {0, TRIED}
    assert np.mean(same) > 0.9
    assert again > 100
    assert again < 0.2 * known
    assert lazily < 0.9 * in_all


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
        chooser.show(cells)
        chooser.arrays["hidden"].view()[:] = 0
        found = worths(cells, x, y, heading)
        shares.append(found[chooser(x, y, heading)] / max(found.values()))
    assert min(shares) > 0.5
    assert np.mean(shares) > 0.9


def test_what_views_showed_is_believed_until_it_is_forgotten() -> None:
    """Where all others are believed to show nothing, it turns where it stands."""
    cells, elsewhere = house(0), 0
    chooser = Chooser(cells)
    for x, y, heading in starts(cells, 0, 12):
        found, here = worths(cells, x, y, heading), (y << BITS) | x
        turning = max((worth for view, worth in found.items() if view[0] == here), default=0)
        if turning > SPARE:
            chooser.forget()
            chooser.arrays["shown"].view()[:] = 0
            assert chooser(x, y, heading)[0] == here
            chooser.forget()
            assert found[chooser(x, y, heading)] > 0.8 * max(found.values())
            elsewhere += max(found, key=lambda view: found[view])[0] != here
    assert elsewhere >= 2
