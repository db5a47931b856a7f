"""Odds that unseen ground hides a target: ``vitruvius bench odds`` prints ``PlannerConfig.floor_odds``.

The command prints the measured odds and those of the tuned configuration. Explorers play in 100 houses of
training seeds. At intervals, each explorer that seeks a target is asked for some of the candidates on its
map. The house itself shows in which of them a target could lie that was not seen since the last pick-up. An
entry is the fraction of those among the places with one count of their surroundings, as the belief counts it,
divided by the fraction among places that had been seen before. Errors are over houses.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import torch
from scipy.ndimage import label
from scipy.optimize import isotonic_regression
from scipy.spatial import KDTree

from benchmarks.common.houses import ROOMS, by_rooms
from vitruvius.agent.baselines.coverage import SPOT_PITCH_M, Coverage
from vitruvius.agent.evaluation.tables import Table
from vitruvius.agent.learning.environments import make_envs, shield
from vitruvius.agent.planner import TUNED, Planner
from vitruvius.agent.planner.core.config import CERTAIN
from vitruvius.agent.planner.core.frame import metres
from vitruvius.agent.planner.mapping.occupancy import NEAR, SOLID, Occupancy
from vitruvius.agent.planner.viewpoints.belief import Belief
from vitruvius.agent.policies.episodes import moments
from vitruvius.agent.policies.policies import Explorer
from vitruvius.logic import House
from vitruvius.logic.errors import RequestError
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.config import DEFAULT
from vitruvius.sim.runtime import Array, Bytes, Ints, Launch, Shorts, kernel, ti

SIDE = 1 << TUNED.map_bits

ENTRIES = len(TUNED.floor_odds)
"""Number of the table's entries. Places that were seen before are counted after these entries."""

FIRST, EVERY, PLACES = 15, 30, 8
"""Steps before the first question to an explorer, steps between questions, and number of places in a
question."""

BESIDE = 0.75 * SPOT_PITCH_M
"""Largest distance in metres from a place to a spot of a target that counts as the same place: a little more
than half the diagonal between spots."""

TRIFLE = 5
"""Smallest entry that counts: errors of observation are as large as smaller entries."""

RESAMPLES = 2000


@dataclass(frozen=True)
class Odds:
    """Measure the table of odds in training houses."""

    houses: int = 20
    """Number of houses of each number of rooms, 2 to 6: the first of the training houses of the study of
    agents."""

    steps: int = DEFAULT.steps
    """Number of steps of an episode that are played."""

    def run(self) -> None:
        """Measure and print."""
        if self.houses < 1 or not FIRST < self.steps <= DEFAULT.steps:
            raise RequestError(f"--houses must be 1 or more, --steps {FIRST + 1} to {DEFAULT.steps}")
        torch.set_num_threads(1)
        free, asked = collect(list(by_rooms(ROOMS, self.houses, seed=100)), self.steps)
        if not free[:, ENTRIES].any():
            raise RequestError(
                "no target was asked for at a place already seen: give more --houses or --steps"
            )
        print(sheet(free, asked).markdown())
        print(f"\nfloor_odds = {table(free.sum(axis=0), asked.sum(axis=0))}")


class MapCells(NamedTuple):
    """The part of ``agent.planner.core.arrays.PlannerArrays`` that this study reads."""

    cells: Shorts


class MapPlaces:
    """Candidates on maps, by their surroundings."""

    def __init__(self, planner: Planner) -> None:
        self.planner, number, half = planner, len(planner.advice), SIDE // 2
        occupancy = Occupancy(planner.config)
        # In a table whose entries are their own indices, the belief looks up the entry that it would take.
        belief = Belief(replace(planner.config, floor_odds=tuple(range(ENTRIES))), occupancy)

        @kernel
        def ask(memory: MapCells, asked: Bytes, since: Ints, entries: Ints):
            for k in range(asked.shape[0]):
                e, x, y = k // (half * half), 2 * (k % half), 2 * (k // half % half)
                entries[k] = -1
                if asked[k] and occupancy.hides(memory, e * occupancy.area, x, y, since[e]):
                    entries[k] = belief.odds(memory, e * occupancy.area, x, y)

        self.arrays = {
            "cells": planner.arrays["cells"],
            "asked": Array(ti.u8, number * half * half),
            "since": Array(ti.i32, number),
            "entries": Array(ti.i32, number * half * half),
        }
        self._ask = Launch(ask, self.arrays)

    def ask(self) -> np.ndarray:
        """Return the entries (E, 128, 128) int32 of every other node along both axes.

        Nodes are south by east of the start. An entry is ``CERTAIN`` if the place was seen before, and -1 if
        it is out of reach or hides nothing.
        """
        number, half = len(self.planner.advice), SIDE // 2
        self.arrays["since"].view()[:] = self.planner.read("since").numpy()
        within = np.stack([self.within_reach(e)[::2, ::2] for e in range(number)])
        self.arrays["asked"].view()[:] = within.ravel()
        self._ask()
        return self.arrays["entries"].numpy().reshape(number, half, half)

    def within_reach(self, environment: int) -> np.ndarray:
        """Return a mask (256, 256) bool of the nodes that a search from the body may reach."""
        cells = self.planner.arrays["cells"].view().reshape(-1, SIDE, SIDE)[environment]
        # The grid is a torus: with the body in its middle, the surroundings are contiguous.
        x, y = self.body(environment)
        shift = SIDE // 2 - y, SIDE // 2 - x
        parts, _ = label(np.roll(cells & (NEAR | SOLID) == NEAR, shift, axis=(0, 1)), np.ones((3, 3)))
        part = parts[SIDE // 2, SIDE // 2]
        return np.roll((parts == part) & (part > 0), (-shift[0], -shift[1]), axis=(0, 1))

    def body(self, environment: int) -> np.ndarray:
        """Return the node (2,) int that the body is on, east and south of its start."""
        return np.floor(self.planner.pose(environment)[:2]).astype(int)


class TargetSpots:
    """Places where targets may lie in the explorers' houses, and the part that explorers have seen."""

    def __init__(self, envs: HouseVectorEnv, starts: np.ndarray, cell: float) -> None:
        """Begin at the bodies' ``starts`` (E, 3), for maps with cells of ``cell`` metres."""
        self.watch, self.starts, self.cell = Coverage(envs), starts, cell
        self.watch.begin()
        self.trees = [KDTree(spots) for spots in self.watch.spots]

    def look(self, picked: np.ndarray) -> None:
        """Look from the bodies' poses. After a pick-up (``picked`` (E,) bool), the next target is sought."""
        self.watch.forget(picked)
        self.watch.look()

    def where(self, environment: int, nodes: np.ndarray) -> np.ndarray:
        """Return the places of nodes (n, 2) of a map in the house, metres.

        Nodes are cells east and south of the start.
        """
        return metres(self.starts[environment], nodes, self.cell)

    def free(self, environment: int, nodes: np.ndarray) -> np.ndarray:
        """Return a mask of the nodes (n, 2) that may hide a target: no place near them was seen.

        Only what was seen since the last pick-up counts.
        """
        away, spot = self.trees[environment].query(self.where(environment, nodes))
        seen = np.unpackbits(self.watch.seen[environment].view(np.uint8), bitorder="little")[spot]
        return (away < BESIDE) & (seen == 0)


def collect(houses: list[House], steps: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the number of places (H, 18) that could hide a target, and of all places asked for.

    Places are counted in each house by their entry; those that were seen before come last.
    """
    number, chance = len(houses), np.random.default_rng(0)
    envs = make_envs(houses, number, "mixed")
    observation, info = envs.reset(seed=0, options={"house": np.arange(number)})
    policy = Explorer(shield(envs), envs.config)
    policy.begin(number)
    planner = policy.tracker.planner
    places, truth = MapPlaces(planner), TargetSpots(envs, info["pose"], planner.cell)
    free, asked = np.zeros((2, number, ENTRIES + 1), int)
    for now in moments(envs, policy, torch.as_tensor(observation), steps):
        if now.step:
            truth.look(now.reward.numpy() > 0)
        if now.actions is not None and now.step % EVERY == FIRST:
            entries = places.ask()
            for e in np.flatnonzero(planner.seeks.numpy()):
                nodes = chance.permutation(np.argwhere(entries[e] >= 0))[:PLACES]
                entry = np.minimum(entries[e][tuple(nodes.T)], ENTRIES)
                body = places.body(e)
                away = (2 * nodes[:, ::-1] - body + SIDE // 2) % SIDE - SIDE // 2
                np.add.at(asked[e], entry, 1)
                np.add.at(free[e], entry, truth.free(e, body + away))
    return free, asked


def odds(free: np.ndarray, asked: np.ndarray) -> np.ndarray:
    """Return the odds of places (..., 17), in units of ``CERTAIN``, from counts (..., 18); else NaN."""
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = free / asked
        return CERTAIN * shares[..., :ENTRIES] / shares[..., ENTRIES:]


def table(free: np.ndarray, asked: np.ndarray) -> tuple[int, ...]:
    """Return the table for counts (18,): whole numbers that do not decrease, and 0 for trifles.

    More floor around a place never makes a target less likely.
    """
    measured, weights = np.nan_to_num(odds(free, asked)), np.maximum(asked[:ENTRIES], 1e-6)
    rising = isotonic_regression(measured, weights=weights).x
    return tuple(int(min(round(each), CERTAIN)) if each >= TRIFLE else 0 for each in rising)


def sheet(free: np.ndarray, asked: np.ndarray) -> Table:
    """Return the measurements in H houses (H, 18), with the tuned table."""
    drawn = np.random.default_rng(0).integers(len(free), size=(RESAMPLES, len(free)))
    others = odds(free[drawn].sum(axis=1), asked[drawn].sum(axis=1))
    errors = np.ma.masked_invalid(others).std(axis=0)
    free, asked = free.sum(axis=0), asked.sum(axis=0)
    rows = zip(odds(free, asked), errors, table(free, asked), TUNED.floor_odds, strict=True)
    lines = [
        (
            f"{k - 8:+d}",
            f"{free[k]}",
            f"{asked[k]}",
            f"{found:.1f} ± {error:.1f}" if asked[k] else "-",
            f"{entry}",
            f"{held}",
        )
        for k, (found, error, entry, held) in enumerate(rows)
    ]
    lines.append(("seen before", f"{free[ENTRIES]}", f"{asked[ENTRIES]}", f"{CERTAIN}", "", ""))
    return Table(
        f"What a place counts as a candidate, {asked[:ENTRIES].sum()} that were never seen",
        ("floor less walls about it", "free", "of", "measured", "table", "tuned"),
        lines,
    )
