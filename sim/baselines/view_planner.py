"""How the searcher goes on: it looks, and plans the path to the viewpoint that gains most for what it costs.

The information gain of a viewpoint is the weight of the places of the target that are left and that a look
from there would show. Its cost is the length of a shortest path there, and a few steps more.
"""

from typing import NamedTuple

from sim.baselines.coverage import WORD, LineOfSight, bit
from sim.baselines.posterior import SPOT, SPOTS, VIEW, Notes, Points, Posterior, Rows
from sim.runtime import Bytes, Floats, Ints, Shorts, Words, ti

REPLAN = 48
"""Steps until it plans again: what it saw on its path may have made another one better."""

VIEWPOINT_COST = 4.0
"""Steps added to a path's length when viewpoints are compared."""

PLACE, COLUMNS, LINES = range(VIEW + 1, VIEW + 4)
"""Of a house: its lattice's first place, columns and rows."""


class SearcherArrays(NamedTuple):
    """What searchers know of the houses, and keep. Those that plan at once have a slot each."""

    spots: Floats
    """Of each house (m, 2): where a target may lie, in steps."""
    samples: Ints
    """Of each house: the spots by which looks are judged."""
    rows: Rows
    origins: Floats
    """Of each house's lattice, metres."""
    moves: Shorts
    """Of each place: its survey."""
    shown: Words
    """Of each view: the samples that it shows."""
    left: Words
    """Of each environment: the spots where its target may still be."""
    sampled: Words
    """Of each slot: the samples that are left."""
    weights: Floats
    """Of each environment and word of samples: how likely each is."""
    distance: Shorts
    """Of each slot and pose: actions to it and one, 0 where it was not found."""
    queue: Ints
    notes: Notes
    last: Points
    """Of each environment: its target, metres."""
    plan: Bytes
    """Of each environment: its next actions."""


@ti.data_oriented
class ViewPlanner(Posterior):
    """What one environment's searcher does, as functions of the arrays."""

    def __init__(self, sight: LineOfSight, pitch: int) -> None:
        """Plan for bodies that see so; viewpoints are ``pitch`` steps apart."""
        super().__init__(sight)
        self.pitch, self.headings = pitch, sight.episodes.body.headings

    @ti.func
    def plan(self, world: ti.template(), search: ti.template(), e, slot, slots, state, known):
        """Search for paths from here to all poses, nearest first, until no pose further away can be better;
        note the first actions of the path to the best. How many.
        """
        row, left, words = (
            search.rows[state.house],
            self.first_left(search, e),
            search.sampled.shape[0] // slots,
        )
        base, total = slot * (search.queue.shape[0] // slots), self.sample(search, row, e, slot, words)
        tail = self.source(search, row, base, state)
        head, goal, best, searching = 0, -1, ti.f32(0.0), True
        while searching and head < tail:
            pose = search.queue[base + head]
            head += 1
            place, heading = pose >> 3, pose & 7
            i, j = place // row[LINES], place % row[LINES]
            away = ti.cast(search.distance[base + pose], ti.i32) - 1
            cost = ti.cast(away, ti.f32) + ti.static(VIEWPOINT_COST)
            if known:
                if self.episodes.overlaps(state.origin, ti.Vector([i, j, heading]), state.target):
                    goal, searching = pose, False
            elif best > 0 and total / cost <= best:
                searching = False
            elif away > 0:
                gain = ti.f32(0.0)
                if i == state.cell[0] and j == state.cell[1]:
                    cell = ti.Vector([i, j, heading])
                    gain = self.turned(world, search, slot * words, e * words, state, cell)
                elif i % ti.static(self.pitch) == 0 and j % ti.static(self.pitch) == 0:
                    gain = self.shown(search, row, e, slot, words, ti.Vector([i, j, heading]))
                if gain / cost > best:
                    goal, best = pose, gain / cost
            if searching:
                tail = self.spread(search, row, base, tail, pose)
        if goal < 0 and not known:
            goal = self.nearest(search, row, left, base)
        length = 0
        if goal >= 0:
            length = self.trace(search, row, e, base, goal)
        for k in range(base, base + tail):
            search.distance[base + search.queue[k]] = ti.u16(0)
        return length

    @ti.func
    def shown(self, search: ti.template(), row, e, slot, words, cell):
        """The weight of the samples that are left and that a view shows."""
        across = (row[LINES] + ti.static(self.pitch - 1)) // ti.static(self.pitch)
        view = cell[0] // ti.static(self.pitch) * across + cell[1] // ti.static(self.pitch)
        return self.weighed(search, row, e, slot, words, row[VIEW] + 8 * view + cell[2])

    @ti.func
    def source(self, search: ti.template(), row, base, state):
        """Begin a search for paths where the body is; the queue's end."""
        pose = 8 * (state.cell[0] * row[LINES] + state.cell[1]) + state.cell[2]
        # A distance is noted as one more than it is: 0 is unknown.
        search.distance[base + pose], search.queue[base] = ti.u16(1), pose
        return 1

    @ti.func
    def spread(self, search: ti.template(), row, base, tail, pose):
        """Note the poses that one action leads to; the queue's end."""
        place, heading = pose >> 3, pose & 7
        away = ti.cast(search.distance[base + pose], ti.i32)
        moves_here = ti.cast(search.moves[row[PLACE] + place], ti.i32)
        for turn in ti.static((1, 7)):
            other = heading + turn & 7
            if moves_here >> (8 + other % 2) & 1:
                tail = self.found(search, base, tail, 8 * place + other, away)
        if moves_here >> heading & 1:
            forward = self.headings[heading]
            ahead = 8 * (place + forward[0] * row[LINES] + forward[1]) + heading
            tail = self.found(search, base, tail, ahead, away)
        return tail

    @ti.func
    def found(self, search: ti.template(), base, tail, pose, away):
        """Note a pose that is new; the queue's end."""
        if search.distance[base + pose] == 0:
            search.distance[base + pose] = ti.cast(away + 1, ti.u16)
            search.queue[base + tail] = pose
            tail += 1
        return tail

    @ti.func
    def nearest(self, search: ti.template(), row, left, base):
        """The nearest pose on a spot that is left, where no view shows one; -1 where none is left."""
        goal, nearest, some = -1, 1 << 15, 0
        for k in range(row[SPOTS]):
            if search.left[left + k // ti.static(WORD)] & bit(k):
                some = 1
                at = 2 * (row[SPOT] + k)
                i, j = ti.round(search.spots[at], ti.i32), ti.round(search.spots[at + 1], ti.i32)
                place = i * row[LINES] + j
                for heading in range(8):
                    away = ti.cast(search.distance[base + 8 * place + heading], ti.i32) - 1
                    if 0 < away < nearest:
                        goal, nearest = 8 * place + heading, away
        if not some:
            # A target that rounding hid: look for it again.
            self.fill(search, row, left)
        return goal

    @ti.func
    def trace(self, search: ti.template(), row, e, base, goal):
        """Go back from a goal to here and write the first actions of the path; how many."""
        pose = goal
        away = ti.cast(search.distance[base + pose], ti.i32) - 1
        length = ti.min(away, ti.static(REPLAN))
        while away > 0:
            place, heading = pose >> 3, pose & 7
            forward = self.headings[heading]
            i, j = place // row[LINES] - forward[0], place % row[LINES] - forward[1]
            before, action = -1, 0
            if 0 <= i < row[COLUMNS] and 0 <= j < row[LINES]:
                back = i * row[LINES] + j
                if (
                    ti.cast(search.moves[row[PLACE] + back], ti.i32) >> heading & 1
                    and search.distance[base + 8 * back + heading] == away
                ):
                    before, action = 8 * back + heading, 2
            if before < 0:
                before, action = 8 * place + (heading + 7 & 7), 0
                if search.distance[base + before] != away:
                    before, action = 8 * place + (heading + 1 & 7), 1
            pose, away = before, away - 1
            if away < ti.static(REPLAN):
                search.plan[e * ti.static(REPLAN) + away] = ti.cast(action, ti.u8)
        return length
