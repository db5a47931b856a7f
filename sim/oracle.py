"""The fewest actions to a target, exactly: breadth-first search over (x, y, heading) on the true map.

It knows the house, which no agent does: it bounds what an agent can reach, one target at a time. A search
runs backwards from all poses that pick the target up, no further than it must, and goes on from where it
stopped when it is asked about a pose further away. It moves as ``step`` does, bit for bit, on any backend.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, ClassVar

import numpy as np

from logic import House
from sim.episodes import Episodes, Indices, Numbers, Reals, Wholes, loaded, store
from sim.runtime import Array, Launch, start, ti
from sim.survey import DIAGONAL, STRAIGHT, survey
from sim.tasks import Box
from sim.vector import HouseVectorEnv
from sim.world import World

FAR = 1 << 15
"""More actions than any way takes."""

UNKNOWN, NOWHERE = -1, -2
"""In place of a distance: no search has come to this pose; the body cannot be there."""

AT_ONCE = 64
"""Episodes that ``play`` plays at a time: it bounds the memory that searches take."""

HEAD, TAIL, COLUMN, ROW, COLUMNS, ROWS = range(6)
"""Of a search: its queue's ends, the lattice's first place (i, j), its columns and rows with a border."""

Ways, Steps = ti.types.ndarray(ti.u16, 1), ti.types.ndarray(ti.i16, 1)
Notes = ti.types.ndarray(ti.types.vector(6, ti.i32), 1)
Goals = ti.types.ndarray(ti.types.vector(2, ti.f32), 1)


class Oracle:
    """Shortest ways for the E environments of a ``HouseVectorEnv``, from wherever their bodies are.

    It keeps a search for each environment that it is asked about: 50 bytes a place of the largest house's
    lattice, some 2 MB.
    """

    def __init__(self, envs: HouseVectorEnv) -> None:
        """Ask about these environments; each house is surveyed when one of them is first found in it."""
        self.world: World = envs.unwrapped.world
        self._searches: _Searches | None = None

    def act(self) -> np.ndarray:
        """The first action (E,) int64 of a shortest way from each environment's pose to its target.

        Where no way leads there, 0. After an episode's end the action means nothing: ``step`` ignores it.
        """
        return np.maximum(self._all().ask("act"), 0)

    def paths(self) -> list[np.ndarray | None]:
        """Each environment's shortest way from its pose to its target: actions (n,) int64, of which the last
        picks it up, or ``None`` where no way leads there. Nothing is stepped.
        """
        searches, state, plans = self._all(), self.world.state, []
        while not plans or (plans[-1] >= 0).any():
            plans.append(searches.ask("follow"))
        self.world.state = state
        plan = np.array(plans).T
        lost = plan[:, 0] == NOWHERE
        return [None if none else actions[actions >= 0] for none, actions in zip(lost, plan, strict=True)]

    def play(self) -> np.ndarray:
        """Play the episodes that run to their ends, and count the targets (E,) int32 on the way.

        Nothing is seen meanwhile: reset the environments before you step them again.
        """
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
    (x, y), or ``None`` where no way leads there. ``len`` of it is their number.

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
        west, north, east, south = np.array([house.floor.box, *(room.box for room in house.rooms)]).T
        return [(west.min(), north.min(), east.max(), south.max())]


class _Searches:
    """Searches for some environments of a world, those from a first one on."""

    def __init__(self, world: World, count: int) -> None:
        """Make room for ``count`` searches over the world's bank."""
        self.world, self.bank, self.count = world, world.bank, count
        self.kernels = _kernels(start(), world.kernels.episodes)
        # A lattice through another origin may have one place more along each axis, and each has a border.
        columns, rows = np.array([lattice.shape for lattice in world.lattices]).max(axis=0) + 3
        places = count * int(columns * rows)
        if 8 * places >= 1 << 31:
            raise ValueError(f"{count} searches at once are too many in houses of {columns} x {rows} places")
        self.arrays = {
            "ways": Array(ti.u16, places),
            "distance": Array(ti.i16, 8 * places),
            "queue": Array(ti.i32, 8 * places),
            "notes": Array(ti.i32, count, 6),
            "goals": Array(ti.f32, count, 2),
            "first": Array(ti.i32, 1),
            "answer": Array(ti.i64, count),
        }
        self.house, self.origin = np.full(count, -1), np.full((count, 2), np.nan)
        self.launches: dict[str, Launch] = {}

    def about(self, first: int) -> "_Searches":
        """Take on the environments from a first one on: survey the houses of those whose house or lattice is
        another one than before. Their searches lapse.
        """
        world, state = self.world, self.world.state
        house, origin = (
            values[first : first + self.count] for values in (state["wholes"][:, 3], state["reals"][:, :2])
        )
        self.arrays["first"].fill(np.array([first], np.int32))
        count = len(house)
        new = np.flatnonzero(
            (house != self.house[:count]) | (origin != self.origin[:count]).any(axis=1)
        ).tolist()
        if new:
            lattices = [world.backend.lattice(world.bank.geometries[house[s]], origin[s]) for s in new]
            surveys = survey(world.backend, world.bank, house[new].tolist(), lattices)
            names = ("ways", "distance", "notes", "goals")
            arrays = [self.arrays[name].ndarray for name in names]
            for s, lattice, table in zip(new, lattices, surveys, strict=True):
                self.kernels["learn"](*arrays, s, *lattice.first, table.ways)
        self.house[:count], self.origin[:count] = house, origin
        return self

    def ask(self, name: str) -> np.ndarray:
        """Run a kernel, ``act``, ``follow`` or ``play``; its answer for each search, (count,) int64."""
        if name not in self.launches:
            self.launches[name] = Launch(self.kernels[name], self.world.arrays | self.arrays)
        self.launches[name]()
        return self.arrays["answer"].numpy()


@cache
def _kernels(program: Any, episodes: Episodes) -> dict[str, Any]:
    """What is compiled for a configuration. Arguments are named for the arrays of a world and of searches."""
    search = _Search(episodes)

    @ti.kernel
    def learn(
        ways: Ways, distance: Steps, notes: Notes, goals: Goals,
        s: ti.i32, i: ti.i32, j: ti.i32, survey: ti.types.ndarray(ti.u16, 2),
    ):  # fmt: skip
        """Take in a survey, with a border where no body can be, and forget what the search found."""
        columns, rows = survey.shape[0] + 2, survey.shape[1] + 2
        notes[s] = ti.Vector([0, 0, i - 1, j - 1, columns, rows])
        goals[s] = ti.Vector([ti.math.nan, ti.math.nan])
        base = s * (ways.shape[0] // notes.shape[0])
        for column, row in ti.ndrange(columns, rows):
            open_ = ti.u16(0)
            if 0 < column < columns - 1 and 0 < row < rows - 1:
                open_ = survey[column - 1, row - 1]
            place = base + column * rows + row
            ways[place] = open_
            for heading in ti.static(range(8)):
                bit = ti.static(DIAGONAL if heading % 2 else STRAIGHT)
                stands = (ti.cast(open_, ti.i32) & bit) != 0
                distance[8 * place + heading] = ti.cast(ti.select(stands, UNKNOWN, NOWHERE), ti.i16)

    @ti.kernel
    def act(
        ways: Ways, distance: Steps, queue: Indices, notes: Notes, goals: Goals, first: Indices,
        reals: Reals, wholes: Wholes, answer: ti.types.ndarray(ti.i64, 1),
    ):  # fmt: skip
        """The first action of a shortest way; ``NOWHERE`` if there is none."""
        ti.loop_config(block_dim=1)
        for s in range(ti.min(notes.shape[0], reals.shape[0] - first[0])):
            state = loaded(reals, wholes, first[0] + s)
            answer[s] = search.choose(ways, distance, queue, notes, goals, s, state)

    @ti.kernel
    def follow(
        ways: Ways, distance: Steps, queue: Indices, notes: Notes, goals: Goals, first: Indices,
        numbers: Numbers, indices: Indices, reals: Reals, wholes: Wholes, answer: ti.types.ndarray(ti.i64, 1),
    ):  # fmt: skip
        """The same, and go there; ``UNKNOWN`` where the action before this one picked the target up."""
        ti.loop_config(block_dim=1)
        for s in range(ti.min(notes.shape[0], reals.shape[0] - first[0])):
            e = first[0] + s
            state, action = loaded(reals, wholes, e), UNKNOWN
            # What has been picked up is not marked otherwise, as nothing else is stepped meanwhile.
            if state.over != UNKNOWN:
                action = search.choose(ways, distance, queue, notes, goals, s, state)
                if action >= 0:
                    state.cell, _ = episodes.backend.move(
                        numbers, indices, state.house, state.origin, state.cell, action
                    )
                    if episodes.overlaps(state.origin, state.cell, state.target):
                        state.over = UNKNOWN
                    store(reals, wholes, e, state)
            answer[s] = action

    @ti.kernel
    def play(
        ways: Ways, distance: Steps, queue: Indices, notes: Notes, goals: Goals, first: Indices,
        numbers: Numbers, indices: Indices, places: Indices, reals: Reals, wholes: Wholes,
        answer: ti.types.ndarray(ti.i64, 1),
    ):  # fmt: skip
        """Play episodes to their ends; how many targets were picked up."""
        ti.loop_config(block_dim=1)
        for s in range(ti.min(notes.shape[0], reals.shape[0] - first[0])):
            e = first[0] + s
            state, count = loaded(reals, wholes, e), 0
            while not state.over:
                action = ti.max(0, search.choose(ways, distance, queue, notes, goals, s, state))
                state, picked, _, _, _ = episodes.advance(numbers, indices, places, state, action)
                count += picked
            store(reals, wholes, e, state)
            answer[s] = count

    return {"learn": learn, "act": act, "follow": follow, "play": play}


@ti.data_oriented
class _Search:
    """One search, as functions of its arrays. A place is its number in the lattice with its border, by
    columns; a pose is eight times that and its heading.
    """

    def __init__(self, episodes: Episodes) -> None:
        """Search among the poses of a configuration."""
        self.episodes, self.headings = episodes, episodes.body.headings
        config = episodes.config
        self.step = config.step
        # Places to look at around a target for poses that pick it up: more than any body's reach.
        self.near = int((config.target / 2 + max(config.body)) / config.step) + 1

    @ti.func
    def choose(
        self,
        ways: ti.template(),
        distance: ti.template(),
        queue: ti.template(),
        notes: ti.template(),
        goals: ti.template(),
        s,
        state,
    ):
        """Search until a pose that an action leads to is known to lead to the target; say which action."""
        if not (goals[s] == state.target).all():  # NaN, at first, equals nothing
            goals[s] = state.target
            self.begin(ways, distance, queue, notes, s, state)
        note = notes[s]
        base, rows = s * (ways.shape[0] // notes.shape[0]), note[ROWS]
        column, row, heading = state.cell[0] - note[COLUMN], state.cell[1] - note[ROW], state.cell[2]
        action = NOWHERE
        if 0 < column < note[COLUMNS] - 1 and 0 < row < rows - 1:
            place = base + column * rows + row
            way = self.headings[heading]
            # Forward first: of two shortest ways the straighter. A pose that cannot be is never found.
            options = ti.Vector([8 * place + (heading + 1 & 7), 8 * place + (heading + 7 & 7), -1])
            if ways[place] >> heading & 1:
                options[2] = 8 * (place + way[0] * rows + way[1]) + heading
            head, tail, nearest, searching = note[HEAD], note[TAIL], FAR, True
            while searching:
                # Poses are found in order of distance: the first of the next poses to be found is the best.
                for turn in ti.static(range(3)):
                    option = ti.static((2 + turn) % 3)
                    if options[option] >= 0:
                        known = ti.cast(distance[options[option]], ti.i32)
                        if 0 <= known < nearest:
                            nearest, action = known, option
                searching = nearest == FAR and head < tail
                if searching:
                    tail = self.expand(ways, distance, queue, 8 * base, head, tail, rows)
                    head += 1
            note[HEAD], note[TAIL] = head, tail
            notes[s] = note  # whole, as it is read: what Taichi caches in a loop is so the same
        return action

    @ti.func
    def begin(
        self,
        ways: ti.template(),
        distance: ti.template(),
        queue: ti.template(),
        notes: ti.template(),
        s,
        state,
    ):
        """Begin a search: forget what was found and queue the poses that pick the target up.

        Where a body is larger on the diagonal, only poses where it can turn: it could not leave others.
        """
        note, anyhow = notes[s], ti.static(STRAIGHT | DIAGONAL)
        base, rows = s * (ways.shape[0] // notes.shape[0]), note[ROWS]
        for k in range(8 * base, 8 * base + note[TAIL]):
            distance[queue[k]] = ti.cast(UNKNOWN, ti.i16)
        middle = ti.cast(ti.floor((state.target - state.origin) / ti.static(self.step)), ti.i32)
        tail = 0
        for i in range(middle[0] - self.near, middle[0] + self.near + 2):
            for j in range(middle[1] - self.near, middle[1] + self.near + 2):
                column, row = i - note[COLUMN], j - note[ROW]
                if 0 < column < note[COLUMNS] - 1 and 0 < row < rows - 1:
                    place = base + column * rows + row
                    if ti.cast(ways[place], ti.i32) & anyhow == anyhow:
                        for heading in range(8):
                            cell = ti.Vector([i, j, heading])
                            if self.episodes.overlaps(state.origin, cell, state.target):
                                tail = self.found(distance, queue, 8 * base, tail, 8 * place + heading, 0)
        note[HEAD], note[TAIL] = 0, tail
        notes[s] = note

    @ti.func
    def expand(
        self, ways: ti.template(), distance: ti.template(), queue: ti.template(), base, head, tail, rows
    ):
        """Take the next pose from the queue and find those that one action leads from to it."""
        pose = queue[base + head]
        place, heading = pose >> 3, pose & 7
        further = ti.cast(distance[pose], ti.i32) + 1
        tail = self.found(distance, queue, base, tail, 8 * place + (heading + 1 & 7), further)
        tail = self.found(distance, queue, base, tail, 8 * place + (heading + 7 & 7), further)
        way = self.headings[heading]
        place -= way[0] * rows + way[1]
        if ways[place] >> heading & 1:
            tail = self.found(distance, queue, base, tail, 8 * place + heading, further)
        return tail

    @ti.func
    def found(self, distance: ti.template(), queue: ti.template(), base, tail, pose, further):
        """Note a pose's distance and queue it, if the body can be there and it is new; the queue's end."""
        if distance[pose] == UNKNOWN:
            distance[pose] = ti.cast(further, ti.i16)
            queue[base + tail] = pose
            tail += 1
        return tail
