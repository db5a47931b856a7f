"""Values of all views of a grid around a body: labels for agents that learn to choose views.

The value of a view is the probability that it shows the target, by the exact posterior, divided by its cost.
The cost is the length of a shortest path to the view, in steps, and a few more. So it is the searcher's own
criterion, for every view instead of only the best one.
"""

from functools import cache
from typing import Any

import numpy as np

from vitruvius.agent.baselines.coverage import LineOfSight
from vitruvius.agent.baselines.posterior import MAX_PLANNING
from vitruvius.agent.baselines.searcher import Searcher
from vitruvius.agent.baselines.view_planner import COLUMNS, LINES, VIEWPOINT_COST, SearcherArrays, ViewPlanner
from vitruvius.sim.actions import HEADINGS
from vitruvius.sim.environment.vector import HouseVectorEnv
from vitruvius.sim.runtime import Array, Floats, Ints, Launch, kernel, start, ti
from vitruvius.sim.world.episodes import Episodes
from vitruvius.sim.world.states import loaded

FRAME = 3
"""Number of integers of a frame: see ``ViewValues.read``."""


class ViewValues(Searcher):
    """Values of views in E environments. Call ``watch`` before each step."""

    def __init__(self, envs: HouseVectorEnv, side: int, pitch: int) -> None:
        """Value grids of ``side`` by ``side`` places, ``pitch`` steps apart."""
        super().__init__(envs, pitch=pitch)
        self.side, count = side, self.world.num_envs
        self.arrays |= {
            "asked": Array(ti.i32, count),
            "frames": Array(ti.i32, FRAME * count),
            "worth": Array(ti.f32, count * 8 * side**2),
            "costs": Array(ti.f32, count * 8 * side**2),
        }
        watch, value = _kernels(start(), self.world.kernels.episodes, pitch, side)
        self.watch = Launch(watch, self.world.arrays | self.arrays)
        self._value = Launch(value, self.world.arrays | self.arrays)

    def read(self, environments: np.ndarray, frames: np.ndarray) -> np.ndarray:
        """Return the values of views (n, 8, S, S) float32, in targets per step, for environments (n,) int.

        The value is 0 if the body cannot stand at the place or cannot reach it. ``frames`` (n, 3) int: the
        lattice's place i, j at the grid's north-west, a multiple of the pitch, and the number of quarter
        turns, counter-clockwise, of the grid and the eight headings. The place in the middle of the grid, S /
        2 from its corner, is the body's own place, whatever its coordinates.
        """
        asked = self.arrays["asked"].view()
        asked[:] = -1
        asked[: len(environments)] = environments
        self.arrays["frames"].view()[: frames.size] = frames.ravel()
        self._value()
        return self._read("worth", len(environments))

    def costs(self, count: int) -> np.ndarray:
        """Return the costs of the views of the last ``read``, (count, 8, S, S) float32, in steps.

        The cost is 0 if the body cannot stand at the place or cannot reach it.
        """
        return self._read("costs", count)

    def _read(self, name: str, count: int) -> np.ndarray:
        shape = count, 8, self.side, self.side
        return self.arrays[name].view()[: np.prod(shape)].reshape(shape)


@cache
def _kernels(program: Any, episodes: Episodes, pitch: int, side: int) -> tuple[Any, Any]:
    planner = ViewPlanner(LineOfSight(episodes), pitch)
    middle = side // 2 * side + side // 2

    @kernel
    def watch(world: episodes.Arrays, search: SearcherArrays):
        """Look, and exclude what is seen."""
        for e in range(world.reals.shape[0]):
            search.notes[e] = planner.watched(world, search, e)

    @ti.func
    def along(quarter):
        """Return the steps of the lattice, i and j, to the grid's east (2,) and south (2,)."""
        way = ti.Vector([0, 0, 0, 0])
        for q in ti.static(range(4)):
            if quarter == q:
                east, south = ti.static(HEADINGS[2 * q]), ti.static(HEADINGS[(2 * q + 6) % 8])
                way = ti.Vector([east[0], east[1], south[0], south[1]])
        return way

    @ti.func
    def place(row, frame_i, frame_j, way, k):
        """Return the lattice's place, i and j, of the grid's k-th place, and True if the lattice has it."""
        east, south = pitch * (k % ti.static(side)), pitch * (k // ti.static(side))
        i, j = frame_i + east * way[0] + south * way[2], frame_j + east * way[1] + south * way[3]
        return i, j, (i >= 0) & (i < row[COLUMNS]) & (j >= 0) & (j < row[LINES])

    @kernel
    def value(
        world: episodes.Arrays,
        search: SearcherArrays,
        asked: Ints,
        frames: Ints,
        worth: Floats,
        costs: Floats,
    ):
        """Search for paths to all poses, and write the values that are asked for."""
        count = asked.shape[0]
        lanes = ti.min(ti.static(MAX_PLANNING), count)
        words = search.sampled.shape[0] // lanes
        ti.loop_config(block_dim=1)
        for slot in range(lanes):
            for turn in range((count - slot + lanes - 1) // lanes):
                n = slot + turn * lanes
                e, at = asked[n], n * ti.static(8 * side * side)
                if e >= 0:
                    state = loaded(world, e)
                    row, base = search.rows[state.house], slot * (search.queue.shape[0] // lanes)
                    total = ti.max(1e-9, planner.sample(search, row, e, slot, words))
                    tail = planner.reach(search, row, base, planner.pose(row, state.cell))
                    quarter, own = frames[3 * n + 2], slot * words
                    way = along(quarter)
                    for k in range(ti.static(side * side)):
                        i, j, inside = place(row, frames[3 * n], frames[3 * n + 1], way, k)
                        if k == ti.static(middle):
                            i, j, inside = state.cell[0], state.cell[1], 1
                        for look in range(8):
                            gain, cost, cell = (
                                ti.f32(0.0),
                                ti.f32(0.0),
                                ti.Vector([i, j, (look + 2 * quarter) & 7]),
                            )
                            away = 0
                            if inside:
                                away = ti.cast(search.distance[base + planner.pose(row, cell)], ti.i32) - 1
                            if away > 0:
                                if k == ti.static(middle):
                                    gain = planner.turned(world, search, own, e * words, state, cell)
                                else:
                                    gain = planner.shown(search, row, e, slot, words, cell)
                                cost = ti.cast(away, ti.f32) + VIEWPOINT_COST
                                gain /= total * cost
                            view = at + look * ti.static(side * side) + k
                            worth[view], costs[view] = gain, cost
                    planner.clear(search, base, tail)

    return watch, value
