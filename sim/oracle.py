# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportCallIssue=false
# pyright: reportOptionalCall=false, reportArgumentType=false, reportIndexIssue=false
"""The fewest actions to a target, exactly: breadth-first search over (x, y, heading) on the true map.

It knows the house, which no agent does: it bounds what an agent can reach, one target at a time. A search
runs backwards from all poses that pick the target up, no further than it must, and goes on from where it
stopped when it is asked about a pose further away. It moves as ``step`` does, bit for bit.
"""

import numpy as np

from sim.episodes import Indices, Numbers, Reals, Wholes, loaded, store
from sim.runtime import ti
from sim.survey import DIAGONAL, STRAIGHT, survey
from sim.vector import HouseVectorEnv

FAR = 1 << 15
"""More actions than any way takes."""


@ti.data_oriented
class Oracle:
    """Shortest ways for the E environments of a ``HouseVectorEnv``, from wherever their bodies are.

    It keeps a search for each environment: 50 bytes a place of the largest house's lattice, some 2 MB.
    ``close`` gives them back.
    """

    def __init__(self, envs: HouseVectorEnv) -> None:
        """Make room for searches; each house is surveyed when an environment is first found in it."""
        self.world, count = envs.unwrapped.world, envs.num_envs
        self.config, self.episodes = self.world.config, self.world.kernels.episodes
        self.body = self.episodes.body
        # A lattice through another origin may have one place more along each axis.
        columns, rows = np.array([lattice.shape for lattice in self.world.lattices]).max(axis=0) + 1
        self.columns, self.rows = int(columns), int(rows)
        # Places to look at around a target for poses that pick it up: more than any body's reach.
        config = self.config
        self.near = int((config.target / 2 + max(config.body)) / config.step) + 1
        self.house = np.full(count, -1)
        self.origin = np.full((count, 2), np.nan)

        self.ways = ti.field(ti.u16)
        self.distance = ti.field(ti.i16)
        self.queue = ti.field(ti.i32)
        self.head, self.tail = ti.field(ti.i32), ti.field(ti.i32)
        self.first = ti.Vector.field(2, ti.i32)
        self.target = ti.Vector.field(2, ti.f32)
        memory = ti.FieldsBuilder()
        memory.dense(ti.ijk, (count, self.columns, self.rows)).place(self.ways)
        memory.dense(ti.ijkl, (count, self.columns, self.rows, 8)).place(self.distance)
        memory.dense(ti.ij, (count, self.columns * self.rows * 8)).place(self.queue)
        memory.dense(ti.i, count).place(self.head, self.tail, self.first, self.target)
        self._memory = memory.finalize()

    def act(self) -> np.ndarray:
        """The first action (E,) int64 of a shortest way from each environment's pose to its target.

        Where no way leads there, 0. After an episode's end the action means nothing: ``step`` ignores it.
        """
        self._survey()
        action = np.zeros(len(self.house), np.int64)
        self._act(self.world.arrays["reals"].ndarray, self.world.arrays["wholes"].ndarray, action)
        return action

    def play(self) -> np.ndarray:
        """Play the episodes that run to their ends, and count the targets (E,) int32 on the way.

        Nothing is seen meanwhile: reset the environments before you step them again.
        """
        self._survey()
        count = np.zeros(len(self.house), np.int32)
        names = ("numbers", "indices", "places", "reals", "wholes")
        self._play(*(self.world.arrays[name].ndarray for name in names), count)
        return count

    def close(self) -> None:
        """Give the memory back; the oracle is of no use after that."""
        self._memory.destroy()

    def _survey(self) -> None:
        """Survey the houses of the environments whose house or lattice has changed; their searches lapse."""
        world, state = self.world, self.world.state
        house, origin = state["wholes"][:, 3], state["reals"][:, :2]
        new = np.flatnonzero((house != self.house) | (origin != self.origin).any(axis=1)).tolist()
        lattices = [world.backend.lattice(world.bank.geometries[house[e]], origin[e]) for e in new]
        if new:
            tables = survey(world.backend, world.bank, house[new].tolist(), lattices)
            for e, lattice, table in zip(new, lattices, tables, strict=True):
                self._learn(e, *lattice.first, table.ways)
        self.house, self.origin = house, origin

    @ti.kernel
    def _learn(self, e: ti.i32, i: ti.i32, j: ti.i32, survey: ti.types.ndarray(ti.u16, 2)):
        self.first[e] = ti.Vector([i, j])
        self.target[e] = ti.Vector([ti.math.nan, ti.math.nan])
        for column, row in ti.ndrange(self.columns, self.rows):
            ways = ti.u16(0)
            if column < survey.shape[0] and row < survey.shape[1]:
                ways = survey[column, row]
            self.ways[e, column, row] = ways
            for heading in range(8):
                self.distance[e, column, row, heading] = -1
        self.head[e], self.tail[e] = 0, 0

    @ti.kernel
    def _act(self, reals: Reals, wholes: Wholes, action: ti.types.ndarray(ti.i64, 1)):
        for e in range(action.shape[0]):
            action[e] = self.choose(e, loaded(reals, wholes, e))

    @ti.kernel
    def _play(
        self,
        numbers: Numbers,
        indices: Indices,
        places: Indices,
        reals: Reals,
        wholes: Wholes,
        count: ti.types.ndarray(ti.i32, 1),
    ):
        for e in range(count.shape[0]):
            state = loaded(reals, wholes, e)
            while not state.over:
                action = self.choose(e, state)
                state, picked, _, _, _ = self.episodes.advance(numbers, indices, places, state, action)
                count[e] += picked
            store(reals, wholes, e, state)

    @ti.func
    def choose(self, e, state):
        """Search until a pose that an action leads to is known to lead to the target; say which action."""
        if not (self.target[e] == state.target).all():  # NaN, at first, equals nothing
            self.target[e] = state.target
            self.begin(e, state)
        here = state.cell
        column, row = here[0] - self.first[e][0], here[1] - self.first[e][1]
        nearest, action, searching = FAR, 0, 1
        while searching:
            # Poses are found in order of distance, so the first of the next poses to be found is the best.
            for turn in range(3):
                option = (2 + turn) % 3  # forward first: of two shortest ways the straighter
                known = self.after(e, column, row, here[2], option)
                if known < nearest:
                    nearest, action = known, option
            searching = ti.cast((nearest == FAR) & (self.head[e] < self.tail[e]), ti.i32)
            if searching:
                self.expand(e)
        return action

    @ti.func
    def begin(self, e, state):
        """Begin a search: forget what was found and queue the poses that pick the target up.

        Where a body is larger on the diagonal, only poses where it can turn: it could not leave others.
        """
        for k in range(self.tail[e]):
            column, row, heading = self.unpacked(self.queue[e, k])
            self.distance[e, column, row, heading] = -1
        self.head[e], self.tail[e] = 0, 0
        middle = (state.target - state.origin) / ti.static(self.config.step)
        place = ti.cast(ti.floor(middle), ti.i32) - self.first[e]
        for column in range(place[0] - self.near, place[0] + self.near + 2):
            for row in range(place[1] - self.near, place[1] + self.near + 2):
                if self.inside(column, row):
                    turns = self.stands(e, column, row, 0) and self.stands(e, column, row, 1)
                    for heading in range(8):
                        cell = ti.Vector([column + self.first[e][0], row + self.first[e][1], heading])
                        if turns and self.episodes.overlaps(state.origin, cell, state.target) != 0:
                            self.found(e, column, row, heading, 0)

    @ti.func
    def expand(self, e):
        """Take the next pose from the queue and find those that one action leads from to it."""
        column, row, heading = self.unpacked(self.queue[e, self.head[e]])
        self.head[e] += 1
        further = self.distance[e, column, row, heading] + 1
        self.found(e, column, row, (heading + 1) % 8, further)
        self.found(e, column, row, (heading + 7) % 8, further)
        way = self.body.headings[heading]
        column, row = column - way[0], row - way[1]
        if self.open(e, column, row, heading):
            self.found(e, column, row, heading, further)

    @ti.func
    def found(self, e, column, row, heading, distance):
        """Note a pose's distance and queue it, if the body can be there and it is new."""
        new = self.distance[e, column, row, heading] < 0
        if new and self.stands(e, column, row, heading):
            self.distance[e, column, row, heading] = ti.cast(distance, ti.i16)
            self.queue[e, self.tail[e]] = (column * self.rows + row) * 8 + heading
            self.tail[e] += 1

    @ti.func
    def unpacked(self, pose):
        """A queued pose's column, row and heading."""
        return pose // (8 * self.rows), pose // 8 % self.rows, pose % 8

    @ti.func
    def after(self, e, column, row, heading, action):
        """How far it is from where an action leads; FAR if that is not known or something is in the way."""
        known, free = FAR, True
        if action == 2:
            free = self.open(e, column, row, heading)
            way = self.body.headings[heading]
            column, row = column + way[0], row + way[1]
        else:
            heading = (heading + ti.select(action == 0, 1, 7)) % 8
        if free and self.inside(column, row):
            distance = ti.cast(self.distance[e, column, row, heading], ti.i32)
            known = ti.select(distance < 0, FAR, distance)
        return known

    @ti.func
    def open(self, e, column, row, heading):
        """Whether the lattice has such a place and one step forward from it is free."""
        ways = 0
        if self.inside(column, row):
            ways = ti.cast(self.ways[e, column, row], ti.i32)
        return (ways >> heading & 1) != 0

    @ti.func
    def stands(self, e, column, row, heading):
        """Whether the body can be at a pose."""
        bit = ti.select(heading % 2, ti.static(DIAGONAL), ti.static(STRAIGHT))
        return (ti.cast(self.ways[e, column, row], ti.i32) & bit) != 0

    @ti.func
    def inside(self, column, row):
        """Whether the lattice has such a place."""
        return 0 <= column < self.columns and 0 <= row < self.rows
