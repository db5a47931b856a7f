"""What a searcher knows of a house, as a graph: poses and actions, what a look shows, how far a target is."""

from functools import cache
from typing import Any

import numpy as np

from benchmarks.planner.known_house import ACTIONS, NEVER, Bytes, Search
from sim.backends.body import HEADINGS
from sim.baselines.lookout import Looks, in_steps, origins_of
from sim.baselines.searcher import SAMPLES, VIEWS
from sim.environment.vector import HouseVectorEnv
from sim.runtime import Array, Launch, start, ti
from sim.tasks.survey import survey
from sim.world.episodes import Episodes, Indices, Numbers

AT_ONCE = 8
"""Searches for paths at a time: it bounds their memory."""


def search_of(envs: HouseVectorEnv, house: int) -> Search:
    """A house of these environments: its poses are 8 for each place of its lattice, its places the task's,
    about ``SAMPLES`` apart.
    """
    world = envs.unwrapped.world
    table = survey(world.backend, world.bank, [house], [world.lattices[house]])[0]
    here, episodes = world.places[house], world.kernels.episodes
    spots = here.targets[here.spread(in_steps(SAMPLES, world))].astype(np.float32)
    shape = np.array(table.moves.shape)
    cells = np.stack(np.meshgrid(*map(np.arange, shape), np.arange(8), indexing="ij"), axis=-1).reshape(-1, 3)
    i, j, heading = cells.T
    number = (i * shape[1] + j) * 8 + heading
    moves = table.moves[i, j].astype(int)
    stands, free = moves >> (8 + heading % 2) & 1 == 1, moves >> heading & 1 == 1
    east, south = HEADINGS[heading].T
    after = np.stack([number - heading + (heading + 1) % 8, number - heading + (heading - 1) % 8], axis=1)
    after[~stands[after]] = -1
    inside = (i + east >= 0) & (i + east < shape[0]) & (j + south >= 0) & (j + south < shape[1])
    ahead = np.where(free & inside, number + 8 * (east * shape[1] + south), -1)
    after = np.concatenate([after, ahead[:, None]], axis=1).astype(np.int32)
    after[~stands] = -1
    arrays = {
        "cells": Array.of(cells.astype(np.int32).ravel()),
        "stands": Array.of(stands.astype(np.uint8)),
        "spots": Array.of(spots.ravel()),
        "corner": Array.of(origins_of(world)[2 * house : 2 * house + 2]),
        "which": Array.of(np.array([house], np.int32)),
        "shown": Array(ti.u8, len(cells) * len(spots)),
    }
    Launch(_looks(start(), episodes), world.arrays | arrays)()
    seen = arrays["shown"].numpy().reshape(len(cells), len(spots))
    pitch = in_steps(VIEWS, world)
    views = stands & (i % pitch == 0) & (j % pitch == 0)
    return Search(after, seen > 0, _away(after, seen > 1), views)


def _away(after: np.ndarray, picked: np.ndarray) -> np.ndarray:
    """Steps (P, N) from each pose to the nearest at which a place's target is ``picked`` (P, N) up."""
    before = np.full_like(after, -1)
    for action in range(ACTIONS):
        possible = np.flatnonzero(after[:, action] >= 0)
        before[after[possible, action], action] = possible
    poses, places = picked.shape
    arrays = {
        "before": Array.of(before.astype(np.int32).ravel()),
        "picked": Array.of(np.ascontiguousarray(picked.T).astype(np.uint8).ravel()),
        "away": Array.of(np.full(poses * places, NEVER, np.int32)),
        "queue": Array(ti.i32, min(places, AT_ONCE) * poses),
    }
    Launch(_searches(start()), arrays)()
    return np.ascontiguousarray(arrays["away"].view().reshape(places, poses).T)


@cache
def _searches(program: Any) -> Any:
    @ti.kernel
    def search(before: Indices, picked: Bytes, away: Indices, queue: Indices):
        """Breadth first from all poses that pick a place's target up, against the actions."""
        poses = before.shape[0] // ti.static(ACTIONS)
        places, slots = picked.shape[0] // poses, queue.shape[0] // poses
        ti.loop_config(block_dim=1)
        for slot in range(slots):
            for turn in range((places - slot + slots - 1) // slots):
                place, head, tail, base = slot + turn * slots, 0, 0, slot * poses
                for pose in range(poses):
                    if picked[place * poses + pose] == 1:
                        away[place * poses + pose], queue[base + tail] = 0, pose
                        tail += 1
                while head < tail:
                    pose = queue[base + head]
                    head += 1
                    for action in range(ti.static(ACTIONS)):
                        there = before[pose * ti.static(ACTIONS) + action]
                        # Nested: Taichi's ``and`` computes both sides.
                        if there >= 0:  # noqa: SIM102
                            if away[place * poses + there] == ti.static(NEVER):
                                away[place * poses + there] = away[place * poses + pose] + 1
                                queue[base + tail] = there
                                tail += 1

    return search


@cache
def _looks(program: Any, episodes: Episodes) -> Any:
    looks = Looks(episodes)

    @ti.kernel
    def look(
        numbers: Numbers, indices: Indices, cells: Indices, stands: Bytes, spots: Numbers, corner: Numbers,
        which: Indices, shown: Bytes,
    ):  # fmt: skip
        """1 where a look from a pose shows a target at a place, 2 where the body picks it up."""
        places = spots.shape[0] // 2
        for pose in range(stands.shape[0]):
            if stands[pose] == 1:
                cell = ti.Vector([cells[3 * pose], cells[3 * pose + 1], cells[3 * pose + 2]])
                origin = ti.Vector([corner[0], corner[1]])
                distance = looks.distances(numbers, indices, which[0], origin, cell)
                for n in range(places):
                    spot = looks.spot(origin, spots[2 * n], spots[2 * n + 1])
                    if episodes.overlaps(origin, cell, spot):
                        shown[pose * places + n] = ti.cast(2, ti.u8)
                    elif looks.meets(distance, origin, cell, spot):
                        shown[pose * places + n] = ti.cast(1, ti.u8)

    return look
