"""Agent that follows the values of views in the true house, backed up over the views that follow.

It shows how much better a label may be that looks ahead: ``vitruvius bench learning --agent
benchmarks.planner.backed_up:backed_up``. From each of the places whose own views have the highest values, it
continues in thought to the best view from there, and so on. Later finds count less, by a discount for each
step.
"""

from functools import cache
from typing import Any

import numpy as np
import torch
from torch import Tensor

from benchmarks.planner.true_views import TrueChooser
from vitruvius.agent.algorithms.search.chooser import best
from vitruvius.agent.algorithms.search.values import TrueValues
from vitruvius.agent.algorithms.search.windows import HEADINGS, PLACES, ViewMaps, views
from vitruvius.agent.baselines.coverage import WORD, LineOfSight, bit
from vitruvius.agent.baselines.posterior import MAX_PLANNING, SAMPLE, SAMPLED, SPOT
from vitruvius.agent.baselines.view_planner import LINES, VIEWPOINT_COST, SearcherArrays, ViewPlanner
from vitruvius.agent.baselines.views import ViewValues
from vitruvius.agent.learning.environments import shield
from vitruvius.agent.planner import Planner
from vitruvius.agent.planner.core.frame import AXES
from vitruvius.agent.policies.policies import Explorer
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.runtime import Array, Floats, Ints, Launch, kernel, start, ti
from vitruvius.sim.world.episodes import Episodes
from vitruvius.sim.world.states import loaded

FIRST = 12
"""Number of places whose best views are tried as the first one."""

AHEAD = 3
"""Number of views in a sequence, including the first one."""

DISCOUNT = 0.99
"""Discount of a find for each step."""

LATER = 60.0
"""Steps after which a target that none of these views show counts as found."""


class ValuesAhead(ViewValues):
    """Values of first views, each with the views that follow."""

    def __init__(self, envs: HouseVectorEnv, side: int, pitch: int) -> None:
        super().__init__(envs, side, pitch)
        count = self.world.num_envs
        self.arrays |= {
            "firsts": Array(ti.i32, 3 * FIRST * count),
            "spent": Array(ti.f32, FIRST * count),
            "values": Array(ti.f32, FIRST * count),
        }
        look = _kernel(start(), self.world.kernels.episodes, pitch)
        self._ahead = Launch(look, self.world.arrays | self.arrays)

    def ahead(self, environments: np.ndarray, firsts: np.ndarray) -> np.ndarray:
        """Return the values of first views (n, ``FIRST``, 3) int, which have i, j and heading.

        i and j are in the lattices of environments (n,). The value is -1 if the body cannot reach the view.
        """
        asked = self.arrays["asked"].view()
        asked[:] = -1
        asked[: len(environments)] = environments
        self.arrays["firsts"].view()[: firsts.size] = firsts.ravel()
        self._ahead()
        return self.arrays["values"].view()[: FIRST * len(environments)].reshape(-1, FIRST).copy()


@cache
def _kernel(program: Any, episodes: Episodes, pitch: int) -> Any:
    planner = ViewPlanner(LineOfSight(episodes), pitch)

    @ti.func
    def strike(world: ti.template(), search: ti.template(), row, e, own, words, state, cell):
        """Remove the remaining samples that a look from a cell shows, and return their weight."""
        gain, corner = ti.f32(0.0), planner.corner(search, state.house)
        if cell[0] % ti.static(pitch) == 0 and cell[1] % ti.static(pitch) == 0:
            view = planner.view(row, cell) * words
            for word in range((row[SAMPLED] + ti.static(WORD - 1)) // ti.static(WORD)):
                both = search.shown[view + word] & search.sampled[own + word]
                gain += search.weights[e * words + word] * ti.cast(ti.math.popcnt(both), ti.f32)
                search.sampled[own + word] ^= both
        else:
            far = planner.sight.distances(world, state.house, state.origin, cell)
            for k in range(row[SAMPLED]):
                at = 2 * (row[SPOT] + search.samples[row[SAMPLE] + k])
                if search.sampled[own + k // ti.static(WORD)] & bit(k):
                    spot = planner.sight.spot(corner, search.spots[at], search.spots[at + 1])
                    if planner.sight.meets(far, state.origin, cell, spot):
                        gain += search.weights[e * words + k // ti.static(WORD)]
                        search.sampled[own + k // ti.static(WORD)] ^= bit(k)
        return gain

    @ti.func
    def follow(search: ti.template(), row, base, e, slot, words, pose, left):
        """Return the best view from a pose, and its cost; -1 without a view.

        The best view shows the most of the samples ``left`` for its cost.
        """
        tail, head, goal, best_, spent, searching = (
            planner.source(search, base, pose),
            0,
            -1,
            ti.f32(0.0),
            ti.f32(0.0),
            1,
        )
        while (searching == 1) & (head < tail):
            here = search.queue[base + head]
            head += 1
            place, heading = here >> 3, here & 7
            i, j = place // row[LINES], place % row[LINES]
            cost = ti.cast(search.distance[base + here], ti.f32) - 1 + ti.static(VIEWPOINT_COST)
            if left / cost <= best_:
                searching = 0
            elif (here != pose) & (i % ti.static(pitch) == 0) & (j % ti.static(pitch) == 0):
                gain = planner.shown(search, row, e, slot, words, ti.Vector([i, j, heading]))
                if gain / cost > best_:
                    goal, best_, spent = here, gain / cost, cost
            if searching == 1:
                tail = planner.spread(search, row, base, tail, here)
        planner.clear(search, base, tail)
        return goal, spent

    @kernel
    def ahead(
        world: episodes.Arrays,
        search: SearcherArrays,
        asked: Ints,
        firsts: Ints,
        spent: Floats,
        values: Floats,
    ):
        """Write the values of first views, each with the views that follow."""
        count = asked.shape[0]
        lanes = ti.min(ti.static(MAX_PLANNING), count)
        words = search.sampled.shape[0] // lanes
        ti.loop_config(block_dim=1)
        for slot in range(lanes):
            for turn in range((count - slot + lanes - 1) // lanes):
                n = slot + turn * lanes
                e = asked[n]
                if e >= 0:
                    state = loaded(world, e)
                    row, base, own = (
                        search.rows[state.house],
                        slot * (search.queue.shape[0] // lanes),
                        slot * words,
                    )
                    tail = planner.reach(search, row, base, planner.pose(row, state.cell))
                    for k in range(ti.static(FIRST)):
                        at = n * ti.static(FIRST) + k
                        away = -1
                        if firsts[3 * at] >= 0:
                            cell = ti.Vector([firsts[3 * at], firsts[3 * at + 1], firsts[3 * at + 2]])
                            pose = planner.pose(row, cell)
                            away = ti.cast(search.distance[base + pose], ti.i32) - 1
                        spent[at] = ti.cast(away, ti.f32) + ti.static(VIEWPOINT_COST)
                    planner.clear(search, base, tail)
                    for k in range(ti.static(FIRST)):
                        at = n * ti.static(FIRST) + k
                        value, time = ti.f32(-1.0), spent[at]
                        if time > ti.static(VIEWPOINT_COST):
                            total = ti.max(1e-9, planner.sample(search, row, e, slot, words))
                            remains, value, h = total, ti.f32(0.0), 0
                            cell = ti.Vector([firsts[3 * at], firsts[3 * at + 1], firsts[3 * at + 2]])
                            while h < ti.static(AHEAD):
                                gain = strike(world, search, row, e, own, words, state, cell)
                                value += gain * ti.static(DISCOUNT) ** time
                                remains -= gain
                                h += 1
                                if h < ti.static(AHEAD):
                                    pose = planner.pose(row, cell)
                                    goal, further = follow(search, row, base, e, slot, words, pose, remains)
                                    if goal < 0:
                                        h = ti.static(AHEAD)
                                    else:
                                        place = goal >> 3
                                        cell = ti.Vector([place // row[LINES], place % row[LINES], goal & 7])
                                        time += further
                            value = (
                                value + remains * ti.static(DISCOUNT) ** (time + ti.static(LATER))
                            ) / total
                        values[at] = value

    return ahead


class ChooserAhead(TrueChooser):
    """Chooser of the view that is best together with those that follow."""

    further: ValuesAhead

    def __call__(self, planner: Planner) -> None:
        """Choose the next views: see ``Chooser``."""
        if self.truth is None:
            self.truth = TrueValues(self.envs, planner)
            self.truth.views = self.further = ValuesAhead(self.envs, PLACES, self.truth.pitch)
        super().__call__(planner)

    def told(self, environments: np.ndarray, maps: ViewMaps) -> Tensor:
        """Return the best views by their values ahead."""
        reader, truth = self.reader, self.truth
        assert reader is not None
        assert truth is not None
        corners = reader.corners(environments)
        worth = torch.where(views(maps), truth.read(environments, corners), -torch.inf)
        bits = torch.arange(HEADINGS)[:, None, None]
        fresh = worth.masked_fill((maps.taken[:, None].int() >> bits & 1).bool(), -torch.inf)
        most, look = fresh.max(1)  # the best heading of each place
        value, place = most.flatten(1).topk(FIRST)
        look = look.flatten(1).gather(1, place)
        firsts = self.poses(environments, corners, place.numpy(), look.numpy())
        firsts[~(value > 0).numpy()] = -1
        ahead = torch.from_numpy(self.further.ahead(environments, firsts))
        choice = ahead.argmax(1, keepdim=True)
        picks = (look * PLACES**2 + place).gather(1, choice)[:, 0]
        return torch.where(ahead.amax(1) > 0, picks, best(worth, maps))

    def poses(
        self, environments: np.ndarray, corners: np.ndarray, place: np.ndarray, look: np.ndarray
    ) -> np.ndarray:
        """Return i, j and heading (n, K, 3) int of views, in the lattices of the houses.

        ``place`` (n, K): flat places of the views in their windows. ``corners``: the corners of the windows.
        """
        truth, world = self.truth, self.envs.unwrapped.world
        assert truth is not None
        axes, (bodies, _, houses) = AXES[truth.quarter[environments]], world.describe()
        corner = truth.start[environments] + truth.steps * (corners[:, ::-1, None] * axes).sum(1)
        corner -= corner % truth.pitch
        south, east = np.divmod(place, PLACES)
        there = corner[:, None] + truth.pitch * (
            east[..., None] * axes[:, :1] + south[..., None] * axes[:, 1:]
        )
        for n, e in enumerate(environments):
            body = np.rint((bodies[e, :2] - world.lattices[houses[e]].origin) / world.config.step)
            there[n, place[n] == PLACES // 2 * (PLACES + 1)] = body.astype(int)
        return np.concatenate([there, (look + 2 * truth.quarter[environments, None] & 7)[..., None]], 2)


def backed_up(envs: HouseVectorEnv) -> Explorer:
    """Return the agent with backed-up values."""
    return Explorer(shield(envs), envs.config, chooser=ChooserAhead(envs))
