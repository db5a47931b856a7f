"""The fewest actions to a target, exactly: breadth-first search over (x, y, heading) on the true map.

It knows the house, which no agent does: it bounds what an agent can reach, one target at a time. A search
runs backwards from all poses that pick the target up, no further than it must, and goes on from where it
stopped when it is asked about a pose further away. It moves as ``step`` does, bit for bit, on any backend.
Where doors are closed it walks at them until they open: a path counts those steps too.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from logic import House
from sim.baselines.backward import NOWHERE, kernels
from sim.environment.vector import HouseVectorEnv
from sim.runtime import Array, Launch, start, ti
from sim.tasks.survey import survey
from sim.tasks.tasks import Box
from sim.world.episodes import HOUSE
from sim.world.world import World

AT_ONCE = 64
"""Episodes that ``play`` plays at a time: it bounds the memory that searches take."""


class Oracle:
    """Shortest paths for the E environments of a ``HouseVectorEnv``, from wherever their bodies are.

    It keeps a search for each environment that it is asked about: 50 bytes a place of the largest house's
    lattice, some 2 MB.
    """

    def __init__(self, envs: HouseVectorEnv) -> None:
        """Ask about these environments; each house is surveyed when one of them is first found in it."""
        self.world: World = envs.unwrapped.world
        self.world.config.require_lattice("an oracle")
        self._searches: _Searches | None = None

    def act(self) -> np.ndarray:
        """The first action (E,) int64 of a shortest path from each environment's pose to its target.

        Where no path leads there, 0. After an episode's end the action means nothing: ``step`` ignores it.
        """
        return np.maximum(self._all().ask("act"), 0)

    def paths(self) -> list[np.ndarray | None]:
        """Each environment's shortest path from its pose to its target: actions (n,) int64, of which the last
        picks it up, or ``None`` where no path leads there. Nothing is stepped.
        """
        searches, state, plans = self._all(), self.world.state, []
        while not plans or (plans[-1] >= 0).any():
            plans.append(searches.ask("follow"))
        self.world.state = state
        plan = np.array(plans).T
        lost = plan[:, 0] == NOWHERE
        return [None if none else actions[actions >= 0] for none, actions in zip(lost, plan, strict=True)]

    def play(self) -> np.ndarray:
        """Play the episodes that run to their ends, and count the targets (E,) int32 that they pick up.

        Nothing is seen meanwhile: reset the environments before you step them again. Raises ``ValueError``
        where the task's terms see the distance to the target, which may end an episode.
        """
        if self.world.kernels.episodes.terms.sees_distance:
            raise ValueError("the oracle plays no task whose terms see the distance: step it by act()")
        count = self.world.num_envs
        searches = _Searches(self.world, min(count, AT_ONCE))
        found = [searches.about(first).ask("play") for first in range(0, count, AT_ONCE)]
        return np.concatenate(found)[:count].astype(np.int32)

    def close(self) -> None:
        """Give the memory back."""
        self._searches = None

    def _all(self) -> "_Searches":
        if self._searches is None or self._searches.bank is not self.world.bank:
            self._searches = _Searches(self.world, self.world.num_envs)
        return self._searches.about(0)


def shortest_path(
    house: House, pose: Sequence[float], target: Sequence[float], **arguments: Any
) -> np.ndarray | None:
    """The fewest actions (n,) int64 from a pose (x, y, heading: metres, radians) to picking up a target at
    (x, y), or ``None`` where no path leads there. ``len`` of it is their number.

    ``arguments``: ``preset`` and ``backend``, as for ``HouseVectorEnv``. To ask about many poses or targets
    in a house give them to the environments of one, and ask ``Oracle(envs).paths()``: that packs the house
    once. Raises ``ValueError`` where the body cannot be.
    """
    envs = HouseVectorEnv([house], targets=_Anywhere(), **arguments)
    envs.reset(seed=0, options={"house": [0], "pose": [pose], "target": [target]})
    return Oracle(envs).paths()[0]


@dataclass(frozen=True)
class _Anywhere:
    """Targets lie in all of a house that can be reached."""

    ends_on_pick_up: ClassVar[bool] = False

    def spaces(self, house: House) -> list[Box]:
        """See ``Task``."""
        west, north, east, south = np.array([room.box for room in house.rooms]).T
        return [(west.min(), north.min(), east.max(), south.max())]


class _Searches:
    """Searches for some environments of a world, those from a first one on."""

    def __init__(self, world: World, count: int) -> None:
        """Make room for ``count`` searches over the world's bank."""
        self.world, self.bank, self.count = world, world.bank, count
        self.kernels = kernels(start(), world.kernels.episodes)
        # A lattice through another origin may have one place more along each axis, and each has a border.
        columns, rows = np.array([lattice.shape for lattice in world.lattices]).max(axis=0) + 3
        places = count * int(columns * rows)
        if 8 * places >= 1 << 31:
            raise ValueError(f"{count} searches at once are too many in houses of {columns} x {rows} places")
        closed = world.config.closed_doors > 0
        self.arrays = {
            "moves": Array(ti.u16, places),
            "distance": Array(ti.i16, 8 * places),
            "queue": Array(ti.i32, 8 * places),
            "notes": Array(ti.i32, count, 7),
            "goals": Array(ti.f32, count, 2),
            "first": Array(ti.i32, 1),
            "answer": Array(ti.i64, count),
            "pushed": Array(ti.u8, count * world.arrays["pushes"].shape[0] // world.num_envs),
            "waiting": Array(ti.i32, 8 * places if closed else 1),
            "found_at": Array(ti.i32, 8 * places if closed else 1),
        }
        self.house, self.origin = np.full(count, -1), np.full((count, 2), np.nan)
        self.launches: dict[str, Launch] = {}

    def about(self, first: int) -> "_Searches":
        """Take on the environments from a first one on: survey the houses of those whose house or lattice is
        another one than before. Their searches lapse.
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
        """Run a kernel, ``act``, ``follow`` or ``play``; its answer for each search, (count,) int64."""
        if name not in self.launches:
            self.launches[name] = Launch(self.kernels[name], self.world.arrays | self.arrays)
        self.launches[name]()
        return self.arrays["answer"].numpy()
