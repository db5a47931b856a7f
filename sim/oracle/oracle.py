"""Fewest actions to a target, exactly: breadth-first search over (x, y, heading) on the true map.

The oracle knows the house, which no agent does, so it bounds an agent's results, one target at a time. A
search runs backwards from all poses that pick up the target, no further than necessary. For a pose further
away, it continues where it stopped. Moves are those of ``step``, bit for bit, on any backend. The oracle
pushes closed doors until they open, and paths count those steps too.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from vitruvius.logic import House
from vitruvius.sim.environment.vector import HouseVectorEnv
from vitruvius.sim.oracle.backward import NOWHERE, kernels
from vitruvius.sim.runtime import Array, Launch, start, ti
from vitruvius.sim.tasks.survey import survey
from vitruvius.sim.tasks.tasks import Box
from vitruvius.sim.world.arrays import HOUSE
from vitruvius.sim.world.world import World

AT_ONCE = 64
"""Number of episodes that ``play`` plays together; it bounds the memory of searches."""


class Oracle:
    """Shortest paths for the E environments of a ``HouseVectorEnv``, from the bodies' current poses.

    The oracle keeps a search for each environment, which takes 50 bytes per place of the largest house's
    lattice, about 2 MB.
    """

    def __init__(self, envs: HouseVectorEnv) -> None:
        """Take the environments. A house is surveyed when the first environment needs it."""
        self.world: World = envs.unwrapped.world
        self.world.config.require_lattice("an oracle")
        self._searches: _Searches | None = None

    def act(self) -> np.ndarray:
        """Return the first action (E,) int64 of a shortest path from each environment's pose to its target.

        The action is 0 if no path leads there. After an episode's end the action means nothing, because
        ``step`` ignores it.
        """
        return np.maximum(self._all().ask("act"), 0)

    def paths(self) -> list[np.ndarray | None]:
        """Return each environment's shortest path to its target, as actions (n,) int64.

        The last action picks up the target. The path is ``None`` if no path leads there. Nothing is stepped.
        """
        searches, state, plans = self._all(), self.world.state, []
        while not plans or (plans[-1] >= 0).any():
            plans.append(searches.ask("follow"))
        self.world.state = state
        plan = np.array(plans).T
        lost = plan[:, 0] == NOWHERE
        return [None if none else actions[actions >= 0] for none, actions in zip(lost, plan, strict=True)]

    def play(self) -> np.ndarray:
        """Play the current episodes to their ends. Return the number of picked-up targets (E,) int32.

        No observation is computed: reset the environments before you step them again. Raises ``ValueError``
        if the task's terms read the distance to the target, which may end an episode.
        """
        if self.world.kernels.episodes.terms.sees_distance:
            raise ValueError(
                "the oracle cannot run a task whose terms use the distance to the target: step it by act()"
            )
        count = self.world.num_envs
        searches = _Searches(self.world, min(count, AT_ONCE))
        found = [searches.about(first).ask("play") for first in range(0, count, AT_ONCE)]
        return np.concatenate(found)[:count].astype(np.int32)

    def close(self) -> None:
        """Release the memory."""
        self._searches = None

    def _all(self) -> "_Searches":
        if self._searches is None or self._searches.bank is not self.world.bank:
            self._searches = _Searches(self.world, self.world.num_envs)
        return self._searches.about(0)


def shortest_path(
    house: House, pose: Sequence[float], target: Sequence[float], **arguments: Any
) -> np.ndarray | None:
    """Return the fewest actions (n,) int64 from a pose (x, y, heading) to the pick-up of a target at (x, y).

    Lengths are metres, headings radians. The result is ``None`` if no path leads there; ``len`` gives the
    number of actions. ``arguments``: ``preset`` and ``backend``, as for ``HouseVectorEnv``. For many poses or
    targets in one house, use ``Oracle(envs).paths()``, which packs the house only once. Raises ``ValueError``
    if the body cannot be at the pose.
    """
    envs = HouseVectorEnv([house], targets=_Anywhere(), **arguments)
    envs.reset(seed=0, options={"house": [0], "pose": [pose], "target": [target]})
    return Oracle(envs).paths()[0]


@dataclass(frozen=True)
class _Anywhere:
    """Task with targets in all of a house that can be reached."""

    ends_on_pick_up: ClassVar[bool] = False

    def spaces(self, house: House) -> list[Box]:
        """Return the bounds of the house: see ``Task``."""
        west, north, east, south = np.array([room.box for room in house.rooms]).T
        return [(west.min(), north.min(), east.max(), south.max())]


class _Searches:
    """Searches for consecutive environments of a world."""

    def __init__(self, world: World, count: int) -> None:
        """Allocate ``count`` searches over the world's bank."""
        self.world, self.bank, self.count = world, world.bank, count
        self.kernels = kernels(start(), world.kernels.episodes)
        # A lattice through another origin may have one more place along each axis, and each has a border.
        columns, rows = np.array([lattice.shape for lattice in world.lattices]).max(axis=0) + 3
        places = count * int(columns * rows)
        if 8 * places >= 1 << 31:
            raise ValueError(
                f"{count} parallel searches need too much memory in houses of {columns} x "
                f"{rows} positions: use fewer"
            )
        closed = world.config.closed_doors > 0
        self.arrays = {
            "moves": Array(ti.u16, places),
            "distance": Array(ti.i16, 8 * places),
            "queue": Array(ti.i32, 8 * places),
            "notes": Array(ti.i32, count, 7),
            "goals": Array(ti.f32, count, 2),
            "first": Array(ti.i32, 1),
            "answer": Array(ti.i64, count),
            "pushed": Array(
                ti.u8, count * world.arrays["pushes"].shape[0] // world.num_envs if closed else 1
            ),
            "waiting": Array(ti.i32, 8 * places if closed else 1),
            "found_at": Array(ti.i32, 8 * places if closed else 1),
        }
        self.house, self.origin = np.full(count, -1), np.full((count, 2), np.nan)
        self.launches: dict[str, Launch] = {}

    def about(self, first: int) -> "_Searches":
        """Assign the searches to the environments from ``first`` on.

        If an environment has another house or lattice than before, its house is surveyed and its search
        begins again.
        """
        world, state = self.world, self.world.state
        house, origin = (
            values[first : first + self.count]
            for values in (state["wholes"][:, HOUSE], state["reals"][:, :2])
        )
        self.arrays["first"].fill(np.array([first], np.int32))
        count = len(house)
        new = np.flatnonzero(
            (house != self.house[:count]) | (origin != self.origin[:count]).any(axis=1)
        ).tolist()
        if new:
            lattices = [world.backend.lattice(world.bank.geometries[house[s]], origin[s]) for s in new]
            surveys = survey(world.backend, world.bank, house[new].tolist(), lattices)
            names = ("moves", "distance", "notes", "goals")
            arrays = [self.arrays[name].ndarray for name in names]
            for s, lattice, table in zip(new, lattices, surveys, strict=True):
                self.kernels["learn"](*arrays, s, *lattice.first, table.moves)
                if world.config.closed_doors:
                    moves, notes = arrays[0], arrays[2]
                    rows = world.arrays["doorways"].ndarray
                    self.kernels["mark"](moves, notes, rows, s, int(house[s]), *origin[s].tolist())
        self.house[:count], self.origin[:count] = house, origin
        return self

    def ask(self, name: str) -> np.ndarray:
        """Run a kernel, ``act``, ``follow`` or ``play``.

        Return its answer for each search, (count,) int64.
        """
        if name not in self.launches:
            self.launches[name] = Launch(self.kernels[name], self.world.arrays | self.arrays)
        self.launches[name]()
        return self.arrays["answer"].numpy()
