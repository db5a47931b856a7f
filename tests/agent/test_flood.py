# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false
"""How far away places are by the flood of blocks: against NumPy, and against ways of nodes."""

from collections import deque
from itertools import product

import numpy as np
import pytest

from agent.planner.cells import NEAR, SOLID, TILE, Bytes, Cells, Grid, Wholes
from agent.planner.flood import UNASKED, Flood, Words
from agent.planner.survey import Survey
from sim.runtime import Array, Launch, start, ti

BITS = 8
SIDE = 1 << BITS


def opened(cells: np.ndarray) -> np.ndarray:
    """Nodes (SIDE, SIDE) bool that a way may lead over."""
    return cells & (SOLID | NEAR) == NEAR


def edges(cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which blocks (SIDE / 2, SIDE / 2) bool are one with the next one to the east, and to the south."""
    a, b, c, d = (opened(cells)[j::2, i::2] for j in range(2) for i in range(2))
    whole = ~((a & d & ~b & ~c) | (b & c & ~a & ~d))
    a, b, c, d = a & whole, b & whole, c & whole, d & whole
    east = b & np.roll(a, -1, 1) | d & np.roll(c, -1, 1)
    south = c & np.roll(a, -1, 0) | d & np.roll(b, -1, 0)
    return east, south


def flood(cells: np.ndarray, px: int, py: int) -> np.ndarray:
    """After how many steps it comes to each block (SIDE / 2, SIDE / 2), from a pose in half cells; -1 for
    never.
    """
    east, south = edges(cells)
    level = np.full(east.shape, -1)
    for x, y in product({px // 2, (px + 1) // 2}, {py // 2, (py + 1) // 2}):
        for dx, dy in ((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)):
            if not (dx or dy) or opened(cells)[(y + dy) % SIDE, (x + dx) % SIDE]:
                level[(y + dy) % SIDE // 2, (x + dx) % SIDE // 2] = 0
    for step in range(1, SIDE**2):
        wet = level >= 0
        wet = wet | np.roll(wet & east, 1, 1) | np.roll(wet, -1, 1) & east
        wet = wet | np.roll(wet & south, 1, 0) | np.roll(wet, -1, 0) & south
        if (wet == (level >= 0)).all():
            break
        level[wet & (level < 0)] = step
    return level


def ways(cells: np.ndarray, x: int, y: int) -> np.ndarray:
    """Steps to each node (SIDE, SIDE) for a body that cuts no corners; -1 for none."""
    free, far, queue = opened(cells), np.full(cells.shape, -1), deque([(x, y)])
    far[y, x] = 0
    while queue:
        i, j = queue.popleft()
        for dx in (-1, 0, 1):
            for dy in (-1, 0, 1):
                u, v = (i + dx) % SIDE, (j + dy) % SIDE
                if far[v, u] < 0 and free[v, u] and free[j, u] and free[v, i]:
                    far[v, u] = far[j, i] + 1
                    queue.append((u, v))
    return far


def mazes(seed: int, number: int, thick: int) -> np.ndarray:
    """Cells (number, SIDE, SIDE) u16 of rooms and pieces with gaps of any width, across the torus's seams."""
    random = np.random.default_rng(seed)
    cells = np.full((number, SIDE, SIDE), NEAR, np.uint16)
    for e in range(number):
        for _ in range(260):
            y, x = random.integers(SIDE, size=2)
            high, wide = (thick, random.integers(2, 60))[:: random.choice([1, -1])]
            rows, columns = np.arange(y, y + high) % SIDE, np.arange(x, x + wide) % SIDE
            cells[e][np.ix_(rows, columns)] = random.choice([SOLID | NEAR, SOLID, 0])
    return cells


class Flooder:
    """A kernel that floods maps, and tells after how many steps it comes to each block."""

    def __init__(self, cells: np.ndarray) -> None:
        start()
        flood, count = Flood(Grid(BITS)), len(cells)
        survey = Survey(Grid(BITS))

        @ti.kernel
        def rise(
            cells: Cells,
            queue: Cells,
            news: Bytes,
            tiles: Words,
            guesses: Bytes,
            poses: Wholes,
            levels: Wholes,
        ):
            for e in range(count):
                base, first = e * SIDE * SIDE, e * flood.words
                these, those = base + survey.agenda, base + survey.agenda + flood.number
                flood.begin(tiles, news, guesses, base, first)
                tail, _ = flood.source(
                    cells, tiles, queue, base, first, these, poses[2 * e], poses[2 * e + 1]
                )
                level = 0
                while tail > 0:
                    risen = 0
                    for k in range(tail):
                        tile = ti.cast(queue[these + k], ti.i32)
                        rising = flood.settle(tiles, first, tile)
                        if rising != 0:
                            queue[these + risen] = ti.cast(tile, ti.u16)
                            risen += 1
                        for block in range(64):
                            if (rising >> ti.cast(block, ti.u64)) & ti.u64(1):
                                node = flood.node(tile, block)
                                levels[(base >> 2) + survey.at(node)] = level
                    tail = 0
                    for k in range(risen):
                        tile = ti.cast(queue[these + k], ti.i32)
                        tail = flood.rise(cells, tiles, queue, base, first, those, tile, tail)
                    these, those = those, these
                    level += 1

        self.arrays = {
            "cells": Array.of(cells.ravel()),
            "queue": Array(ti.u16, cells.size),
            "news": Array.of(np.ones(cells.size >> 2 * TILE, np.uint8)),
            "tiles": Array(ti.u64, count * flood.words),
            "guesses": Array.of(np.full(cells.size >> 2, UNASKED, np.uint8)),
            "poses": Array(ti.i32, 2 * count),
            "levels": Array(ti.i32, cells.size >> 2),
        }
        self.launch = Launch(rise, self.arrays)

    def __call__(self, poses: np.ndarray) -> np.ndarray:
        """Steps (E, SIDE / 2, SIDE / 2) to each block from a pose (E, 2) on each map, -1 for never."""
        self.arrays["poses"].fill(poses.astype(np.int32).ravel())
        self.arrays["levels"].view()[:] = -1
        self.launch()
        return self.arrays["levels"].numpy().reshape(-1, SIDE // 2, SIDE // 2)


def poses_on(cells: np.ndarray, seed: int) -> np.ndarray:
    """An open node (E, 2) of each map, or half a cell from it along one axis or both; half cells."""
    random = np.random.default_rng(seed)
    nodes = np.array([random.choice(np.argwhere(opened(each)))[::-1] for each in cells])
    return 2 * nodes + random.integers(-1, 2, nodes.shape)


@pytest.mark.parametrize("thick", [1, 2, 5])
def test_it_rises_as_blocks_are_joined(thick: int) -> None:
    """By the same rule, in NumPy, in mazes with walls so thick, of which some ways cross the seams."""
    cells = mazes(thick, 6, thick)
    flooder = Flooder(cells)
    for seed in range(3):
        poses = poses_on(cells, seed)
        if seed == 2:  # bodies may stand on what their maps took for solid
            for each, (x, y) in zip(flooder.arrays["cells"].view().reshape(cells.shape), poses, strict=True):
                each[y // 2 % SIDE, x // 2 % SIDE] |= SOLID
            cells = flooder.arrays["cells"].numpy().reshape(cells.shape)
            flooder.arrays["news"].view()[:] = 1
        found = flooder(poses)
        expected = np.stack([flood(each, *pose) for each, pose in zip(cells, poses, strict=True)])
        assert np.array_equal(found, expected)
        assert found.max() > 60


def test_where_it_comes_a_body_comes_and_the_way_is_about_as_long() -> None:
    """Walls are two nodes thick, as what rays hit is on the map. It cuts corners, which bodies do not."""
    missed, reached = 0, 0
    for e, cells in enumerate(mazes(0, 6, 2)):
        x, y = np.random.default_rng(e).choice(np.argwhere(opened(cells)))[::-1]
        level, way = flood(cells, 2 * x, 2 * y), ways(cells, x, y)
        by_block = way.reshape(SIDE // 2, 2, SIDE // 2, 2).swapaxes(1, 2).reshape(SIDE // 2, SIDE // 2, 4)
        comes = np.max(by_block, axis=-1) >= 0
        nearest = np.where(by_block >= 0, by_block, SIDE**2).min(axis=-1)
        assert comes[level >= 0].all()
        missed += (comes & (level < 0)).sum()
        reached += comes.sum()
        wet = level > 3
        ratio = 2 * level[wet] / nearest[wet]
        assert 0.85 < np.median(ratio) < 1.02
        assert ((ratio > 0.6) & (ratio < 1.3)).all()
    assert missed < 0.02 * reached


def test_what_is_kept_of_tiles_is_true_as_long_as_news_are_told() -> None:
    """Nodes close and open, and the tiles that they are in have news: as if all was found anew."""
    cells, random = mazes(3, 4, 2), np.random.default_rng(1)
    flooder, nodes = Flooder(cells), poses_on(cells, 5) // 2
    kept = flooder.arrays["cells"].view().reshape(cells.shape)
    news = flooder.arrays["news"].view().reshape(len(cells), SIDE >> TILE, SIDE >> TILE)
    for _ in range(8):
        for e, (x, y) in enumerate(nodes):
            j, i = (np.array([y, x]) + random.integers(-40, 40, 2)) % SIDE
            kept[e, j : j + 3, i : i + 3] ^= SOLID
            kept[e, y, x] = NEAR
            for v, u in ((j, i), (j + 2, i + 2), (j, i + 2), (j + 2, i), (y, x)):
                news[e, min(v, SIDE - 1) >> TILE, min(u, SIDE - 1) >> TILE] = 1
        expected = np.stack([flood(each, *2 * node) for each, node in zip(kept, nodes, strict=True)])
        assert np.array_equal(flooder(2 * nodes), expected)
        assert not news.any()
