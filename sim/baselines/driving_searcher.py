"""A searcher that drives, in the backend ``free``: it knows the house and its pose, but not the target.

It keeps the exact posterior over the target's places, as the searcher on a lattice does (``searcher``), by
rays without any error, whatever the environment's rays show. It drives along a shortest path to the view
that gains most for the time that it takes (``view_goals``), chooses again as it goes, and once a ray has met
the target it drives there as a ``TruePath`` does.
"""

from functools import cache
from typing import Any

import numpy as np

from sim.baselines.coverage import FreeLineOfSight, in_steps
from sim.baselines.path_follower import PathFollower
from sim.baselines.posterior import AT_ONCE, EPISODE, FOUND, VIEW, posterior_arrays, starts
from sim.baselines.priors import PRIORS, PriorName
from sim.baselines.roadmap import FAR
from sim.baselines.steering import steered
from sim.baselines.view_goals import HEADINGS, NEAR, PLACES, GoalArrays, ViewGoals
from sim.environment.vector import HouseVectorEnv
from sim.runtime import Array, Launch, kernel, start, ti
from sim.tasks.survey import Survey, survey
from sim.world.episodes import Episodes, WorldArrays, loaded
from sim.world.world import World

VIEWS, SAMPLES = 0.57, 0.29
"""Metres between the places that it may go to for a look, and between those places of the target by which it
judges a look, about. The posterior itself is of all places."""

REPLAN = 0.8
"""Seconds until it chooses again: what it saw on its path may have made another view better."""

ASIDE = 1.2
"""Radians: a body that is to turn by more where it looks stops there."""


class DrivingSearcher:
    """What to tell the E bodies of a ``HouseVectorEnv``, whose episodes begin at sampled starts.

    Only on the CPU; the bank must stay as it is.
    """

    def __init__(self, envs: HouseVectorEnv, prior: PriorName = "task") -> None:
        """Find paths and what a look from each view would show; ``prior``: see ``Searcher``.

        Raises ``ValueError`` where bodies do not drive as they head, for a prior that the task does not
        allow, and for houses too many or of too many corners.
        """
        self.world: World = envs.unwrapped.world
        world, count = self.world, self.world.num_envs
        if not world.config.drives:
            raise ValueError("a searcher that drives: take the backend free, or a Searcher")
        world.config.drive.require_heading("a searcher")
        tables = survey(world.backend, world.bank, list(range(len(world.places))), world.lattices)
        self.prior = PRIORS[prior](world, tables, in_steps(SAMPLES, world))
        self.follower = PathFollower(world)
        roads = self.follower.roads
        places = _places(world, tables)
        numbers = np.array([len(each) for each in places])
        corners = np.diff(roads.arrays["firsts"].view()[: len(numbers) + 1])
        ways = numbers * corners
        if ways.sum() >= 1 << 31:
            raise ValueError(f"{len(numbers)} houses are too many for a searcher: give it some at a time")
        more = np.column_stack([numbers, starts(ways), corners])
        self.arrays = {
            **roads.arrays,
            **{name: self.follower.arrays[name] for name in ("goal", "half")},
            **posterior_arrays(world, self.prior, HEADINGS * numbers, more),
            "viewpoints": Array.of(np.concatenate(places).ravel()),
            "ways": Array(ti.f32, int(ways.sum())),
            "through": Array(ti.i32, int(ways.sum())),
            "near": Array(ti.f32, min(count, AT_ONCE) * roads.most),
            "tried": Array(ti.u8, count * (int(numbers.max()) + 1)),
            "stood": Array(ti.f32, count, 2),
            "chosen": Array(ti.i32, count),
            "due": Array(ti.i32, count),
            "facing": Array(ti.f32, count),
        }
        replan = max(1, round(REPLAN / world.config.drive.time_step))
        prepare, decide = _kernels(start(), world.kernels.episodes, replan)
        Launch(prepare, world.arrays | self.arrays)()
        self._decide = Launch(decide, world.arrays | self.arrays)
        self.begin()

    def begin(self) -> None:
        """Forget all: for a reset that goes back to an episode that it knows."""
        count = self.world.num_envs
        self.arrays["notes"].fill(np.full((count, 5), -1, np.int32))
        self.arrays["stood"].fill(np.full((count, 2), FAR, np.float32))
        self.prior.begin()

    def act(self) -> np.ndarray:
        """What to do next: (v, w) (E, 2) float32, or the numbers (E,) int64 of the nearest commands. Ask once
        before each step.
        """
        self.prior.weigh(self.arrays["weights"].view())
        self._decide()
        pose, _, house = self.world.describe()
        aim, way = self.follower.follow(house, pose)
        goal, facing = self.arrays["goal"].view().reshape(-1, 2), self.arrays["facing"].view()
        looks = self.arrays["chosen"].view() >= 0
        there = looks & (np.hypot(*(goal - pose[:, :2]).T) < NEAR)
        aside = np.abs(np.angle(np.exp(1j * (facing - aim)))) > ASIDE
        room = np.where(looks & aside, np.where(there, 0.0, way), np.inf)
        return steered(self.world.config.drive, np.where(there, facing, aim) - pose[:, 2], room)


def _places(world: World, tables: list[Survey]) -> list[np.ndarray]:
    """For each house the places (n, 2) float32 from which it may look, metres: on a grid, where a body can
    come to from where episodes start.
    """
    pitch, found = in_steps(VIEWS, world), []
    for here, table, lattice in zip(world.places, tables, world.lattices, strict=True):
        part = table.part[tuple(here.starts[0])]
        cells = np.argwhere(table.part[::pitch, ::pitch] == part) * pitch
        origin = np.asarray(lattice.origin, np.float32)
        found.append((origin + np.float32(lattice.pitch) * cells).astype(np.float32))
    return found


@cache
def _kernels(program: Any, episodes: Episodes, replan: int) -> tuple[Any, Any]:
    goals = ViewGoals(FreeLineOfSight(episodes))

    @kernel
    def prepare(world: WorldArrays, search: GoalArrays):
        """Find the ways from every place of views of every house, and what a look from there shows."""
        words = search.sampled.shape[0] // ti.min(ti.static(AT_ONCE), search.notes.shape[0])
        for k in range(search.viewpoints.shape[0] // 2):
            house = goals.house_of(search, HEADINGS * k)
            v = k - search.rows[house][VIEW] // HEADINGS
            if v < search.rows[house][PLACES]:
                goals.join(world, search, house, v)
                place = ti.Vector([search.viewpoints[2 * k], search.viewpoints[2 * k + 1]])
                for look in range(HEADINGS):
                    goals.show(world, search, house, place, goals.looking(look), HEADINGS * k + look, words)

    @kernel
    def decide(world: WorldArrays, search: GoalArrays):
        """Look, strike out what is seen, and choose again where that is due."""
        count = world.reals.shape[0]
        lanes = ti.min(ti.static(AT_ONCE), count)
        ti.loop_config(block_dim=1)
        for slot in range(lanes):
            for turn in range((count - slot + lanes - 1) // lanes):
                e = slot + turn * lanes
                before = search.notes[e]
                state, note = loaded(world, e), goals.watched(world, search, e)
                if before[EPISODE] != note[EPISODE] or before[FOUND] != note[FOUND]:
                    goals.forget(search, e)
                search.notes[e] = goals.decide(world, search, e, slot, lanes, state, note, replan)

    return prepare, decide
