"""A searcher that knows the house but not its target's place: about the best result of memory and search.

It keeps the exact posterior over the target's places. The posterior is the prior (``priors``), restricted to
the places that remain possible: not near the last target, and not seen since. For most tasks it is uniform.
The searcher takes a shortest path to the viewpoint with the most information gain per step. It plans again
every few steps, and picks up the target once a ray has met it. An agent can learn to close the gap to the
searcher; the gap between the searcher and the oracle cannot be closed by learning.
"""

from functools import cache
from typing import Any

import numpy as np

from vitruvius.agent.baselines.coverage import LineOfSight, in_steps
from vitruvius.agent.baselines.posterior import (
    DONE,
    KNOWN,
    LENGTH,
    MAX_PLANNING,
    VIEW,
    posterior_arrays,
    starts,
)
from vitruvius.agent.baselines.priors import PRIORS, PriorName
from vitruvius.agent.baselines.view_planner import LINES, PLACE, REPLAN_STEPS, SearcherArrays, ViewPlanner
from vitruvius.sim.environment.vector import HouseVectorEnv
from vitruvius.sim.runtime import Array, Launch, Longs, kernel, start, ti
from vitruvius.sim.tasks.survey import survey
from vitruvius.sim.world.episodes import Episodes
from vitruvius.sim.world.states import loaded
from vitruvius.sim.world.world import World

VIEW_PITCH_M, SAMPLE_PITCH_M = 0.57, 0.29
"""Approximate distances, in metres, between the viewpoints, and between the samples of the target's places;
the actual distances are whole numbers of steps. The samples serve to compare viewpoints, while the posterior
covers all places."""


class Searcher:
    """Actions for the E environments of a ``HouseVectorEnv``, whose episodes begin at sampled starts.

    Only for the CPU; the bank must not change. Preparing a house takes 0.3 MB and 30 ms.
    """

    def __init__(self, envs: HouseVectorEnv, prior: PriorName = "task", pitch: int | None = None) -> None:
        """Survey the houses, and find what a look from each viewpoint would show.

        ``pitch``: steps between viewpoints, by default about ``VIEW_PITCH_M``. ``prior``: ``task`` for the
        task's distribution of targets; ``floor`` for all free floor, without knowledge of the task; ``finds``
        for the task's regions, with probabilities that it learns from the found targets. Raises
        ``ValueError`` for a prior that the task does not allow.
        """
        self.world: World = envs.unwrapped.world
        self.world.config.require_lattice("a searcher")
        if self.world.config.closed_doors:
            raise ValueError("the searcher needs open doorways: give it environments with closed_doors=0")
        world, count = self.world, self.world.num_envs
        tables = survey(world.backend, world.bank, list(range(len(world.places))), world.lattices)
        self.prior = PRIORS[prior](world, tables, in_steps(SAMPLE_PITCH_M, world))
        pitch = pitch or in_steps(VIEW_PITCH_M, world)
        shapes = np.array([table.moves.shape for table in tables])
        sizes, views = np.prod(shapes, axis=1), 8 * np.prod(-(-shapes // pitch), axis=1)
        poses, slots = 8 * int(sizes.max()), min(count, MAX_PLANNING)
        more = np.column_stack([starts(sizes), shapes])
        self.arrays = posterior_arrays(world, self.prior, views, more) | {
            "moves": Array.of(np.concatenate([table.moves.ravel() for table in tables])),
            "distance": Array(ti.u16, slots * poses),
            "queue": Array(ti.i32, slots * poses),
            "plan": Array(ti.u8, count * REPLAN_STEPS),
            "answer": Array(ti.i64, count),
        }
        kernels = _kernels(start(), world.kernels.episodes, pitch)
        Launch(kernels["prepare"], world.arrays | self.arrays)()
        self._act = Launch(kernels["act"], world.arrays | self.arrays)
        self.begin()

    def begin(self) -> None:
        """Discard the posteriors, for a reset that repeats an earlier episode."""
        self.arrays["notes"].fill(np.full((self.world.num_envs, 5), -1, np.int32))
        self.prior.begin()

    def act(self) -> np.ndarray:
        """Return the next action (E,) int64 of each environment, from its pose.

        Call ``act`` once before each step.
        """
        self.prior.weigh(self.arrays["weights"].view())
        self._act()
        return self.arrays["answer"].numpy()


@cache
def _kernels(program: Any, episodes: Episodes, pitch: int) -> dict[str, Any]:
    planner = ViewPlanner(LineOfSight(episodes), pitch)

    @kernel
    def prepare(world: episodes.Arrays, search: SearcherArrays):
        """Find the samples that each view of each house shows."""
        words = search.sampled.shape[0] // ti.min(ti.static(MAX_PLANNING), search.notes.shape[0])
        for view in range(search.shown.shape[0] // (8 * words)):
            house = planner.house_of(search, 8 * view)
            row, corner = search.rows[house], planner.corner(search, house)
            across = (row[LINES] + ti.static(pitch - 1)) // ti.static(pitch)
            here = view - row[VIEW] // 8
            i, j = here // across * ti.static(pitch), here % across * ti.static(pitch)
            for heading in range(8):
                can = ti.cast(search.moves[row[PLACE] + i * row[LINES] + j], ti.i32)
                if can >> (8 + heading % 2) & 1:
                    cell = ti.Vector([i, j, heading])
                    planner.show(world, search, house, corner, cell, 8 * view + heading, words)

    @kernel
    def act(world: episodes.Arrays, search: SearcherArrays, answer: Longs):
        """Look, exclude what is seen, plan again at the end of a plan, and write the next action."""
        count = world.reals.shape[0]
        lanes = ti.min(ti.static(MAX_PLANNING), count)
        ti.loop_config(block_dim=1)
        for slot in range(lanes):
            for turn in range((count - slot + lanes - 1) // lanes):
                e = slot + turn * lanes
                state, note = loaded(world, e), planner.watched(world, search, e)
                if note[DONE] >= note[LENGTH]:
                    note[DONE] = 0
                    note[LENGTH] = planner.plan(world, search, e, slot, lanes, state, note[KNOWN])
                answer[e] = 0
                if note[LENGTH] > 0:
                    answer[e] = ti.cast(search.plan[e * ti.static(REPLAN_STEPS) + note[DONE]], ti.i64)
                note[DONE] += 1
                search.notes[e] = note

    return {"prepare": prepare, "act": act}
