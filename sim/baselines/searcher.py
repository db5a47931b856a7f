"""A searcher that knows the house but not where its target is: about the best that memory and search can do.

It keeps the exact posterior over the target's places. It is its prior (``priors``) over those that are
left: not near the last target, and nowhere that it has looked since. For most tasks that is uniform. It goes,
by a shortest path, to where a look would show most of that for each step that it costs, plans again every
few steps, and once a ray has met the target it goes and picks it up. The difference between an agent and the
searcher can be learnt; the difference between the searcher and the oracle cannot.
"""

from functools import cache
from typing import Any

import numpy as np

from sim.baselines.coverage import LineOfSight, in_steps
from sim.baselines.posterior import AT_ONCE, DONE, KNOWN, LENGTH, VIEW, posterior_arrays, starts
from sim.baselines.priors import PRIORS, PriorName
from sim.baselines.view_planner import LINES, PLACE, REPLAN, SearcherArrays, ViewPlanner
from sim.environment.vector import HouseVectorEnv
from sim.runtime import Array, Launch, Longs, kernel, start, ti
from sim.tasks.survey import survey
from sim.world.episodes import Episodes, WorldArrays, loaded
from sim.world.world import World

VIEWS, SAMPLES = 0.57, 0.29
"""Metres between the places that it may go to for a look, and between those places of the target by which it
judges a look, about: whole numbers of steps. The posterior itself is of all places."""


class Searcher:
    """Actions for the E environments of a ``HouseVectorEnv``, whose episodes begin at sampled starts.

    Only on the CPU; the bank must stay as it is. It takes 0.3 MB and 30 ms a house to prepare.
    """

    def __init__(self, envs: HouseVectorEnv, prior: PriorName = "task", pitch: int | None = None) -> None:
        """Survey the houses, and find what a look from each viewpoint would show; viewpoints are ``pitch``
        steps apart, ``VIEWS`` by default.

        ``prior`` is what it believes: ``task``, where the task puts targets and how often; ``floor``, all
        free floor of the house alike, as if it did not know the task; ``finds``, the task's regions, which of
        them is likely from where it has found targets. Raises ``ValueError`` for a prior that the task does
        not allow.
        """
        self.world: World = envs.unwrapped.world
        self.world.config.require_lattice("a searcher")
        if self.world.config.closed_doors:
            raise ValueError("a searcher looks through doorways: give it environments with closed_doors=0")
        world, count = self.world, self.world.num_envs
        tables = survey(world.backend, world.bank, list(range(len(world.places))), world.lattices)
        self.prior = PRIORS[prior](world, tables, in_steps(SAMPLES, world))
        pitch = pitch or in_steps(VIEWS, world)
        shapes = np.array([table.moves.shape for table in tables])
        sizes, views = np.prod(shapes, axis=1), 8 * np.prod(-(-shapes // pitch), axis=1)
        poses, slots = 8 * int(sizes.max()), min(count, AT_ONCE)
        more = np.column_stack([starts(sizes), shapes])
        self.arrays = posterior_arrays(world, self.prior, views, more) | {
            "moves": Array.of(np.concatenate([table.moves.ravel() for table in tables])),
            "distance": Array(ti.u16, slots * poses),
            "queue": Array(ti.i32, slots * poses),
            "plan": Array(ti.u8, count * REPLAN),
            "answer": Array(ti.i64, count),
        }
        kernels = _kernels(start(), world.kernels.episodes, pitch)
        Launch(kernels["prepare"], world.arrays | self.arrays)()
        self._act = Launch(kernels["act"], world.arrays | self.arrays)
        self.begin()

    def begin(self) -> None:
        """Forget all: for a reset that goes back to an episode that it knows."""
        self.arrays["notes"].fill(np.full((self.world.num_envs, 5), -1, np.int32))
        self.prior.begin()

    def act(self) -> np.ndarray:
        """The next action (E,) int64 of each environment, from where it is. Ask once before each step."""
        self.prior.weigh(self.arrays["weights"].view())
        self._act()
        return self.arrays["answer"].numpy()


@cache
def _kernels(program: Any, episodes: Episodes, pitch: int) -> dict[str, Any]:
    planner = ViewPlanner(LineOfSight(episodes), pitch)

    @kernel
    def prepare(world: WorldArrays, search: SearcherArrays):
        """Look from every view of every house at its samples."""
        words = search.sampled.shape[0] // ti.min(ti.static(AT_ONCE), search.notes.shape[0])
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
    def act(world: WorldArrays, search: SearcherArrays, answer: Longs):
        """Look, strike out what is seen, plan again where a plan is at its end, and say the next action."""
        count = world.reals.shape[0]
        lanes = ti.min(ti.static(AT_ONCE), count)
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
                    answer[e] = ti.cast(search.plan[e * ti.static(REPLAN) + note[DONE]], ti.i64)
                note[DONE] += 1
                search.notes[e] = note

    return {"prepare": prepare, "act": act}
