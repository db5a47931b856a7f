"""Planning of the searcher: it looks, and plans the path to the viewpoint with the best gain for its cost.

The information gain of a viewpoint is the weight of the target's places that remain possible and that a look
from there would show. The cost is the length of a shortest path to it, and a few more steps.
"""

from typing import NamedTuple

from vitruvius.agent.baselines.coverage import WORD, LineOfSight, bit
from vitruvius.agent.baselines.posterior import SPOT, SPOTS, VIEW, Notes, Points, Posterior, Rows
from vitruvius.sim.runtime import Bytes, Floats, Ints, Shorts, Words, ti

REPLAN_STEPS = 48
"""Number of steps until the searcher plans again: observations on its path may have made another viewpoint
better."""

VIEWPOINT_COST = 4.0
"""Steps added to a path's length when viewpoints are compared."""

PLACE, COLUMNS, LINES = range(VIEW + 1, VIEW + 4)
"""Indices of a house's row: its lattice's first place, columns and rows."""


class SearcherArrays(NamedTuple):
    """Arrays of searchers: knowledge of the houses, and the state of each search.

    Searchers that plan together have a slot each.
    """

    spots: Floats
    """For each house (m, 2): possible places of a target, in steps."""
    samples: Ints
    """For each house: the spots that serve as samples."""
    rows: Rows
    origins: Floats
    """Origin of each house's lattice, metres."""
    moves: Shorts
    """Survey of each place."""
    shown: Words
    """For each view: the samples that it shows."""
    left: Words
    """For each environment: the spots where its target may still be."""
    sampled: Words
    """For each slot: the samples that remain possible."""
    weights: Floats
    """For each environment and word of samples: their weight."""
    distance: Shorts
    """For each slot and pose: number of actions to the pose, plus one; 0 if it was not found."""
    queue: Ints
    notes: Notes
    last: Points
    """Target of each environment, metres."""
    plan: Bytes
    """Next actions of each environment."""


@ti.data_oriented
class ViewPlanner(Posterior):
    """Actions of one environment's searcher, as functions of the arrays."""

    def __init__(self, sight: LineOfSight, pitch: int) -> None:
        """Plan for bodies with this line of sight; viewpoints are ``pitch`` steps apart."""
        super().__init__(sight)
        self.pitch, self.headings = pitch, sight.episodes.body.headings

    @ti.func
    def plan(self, world: ti.template(), search: ti.template(), e, slot, slots, state, known):
        """Search for paths to all poses, nearest first, until no pose further away can be better.

        Write the first actions of the path to the best pose, and return their number.
        """
        row, left, words = (
            search.rows[state.house],
            self.first_left(search, e),
            search.sampled.shape[0] // slots,
        )
        base, total = slot * (search.queue.shape[0] // slots), self.sample(search, row, e, slot, words)
        tail = self.source(search, base, self.pose(row, state.cell))
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
        self.clear(search, base, tail)
        return length

    @ti.func
    def shown(self, search: ti.template(), row, e, slot, words, cell):
        """Return the weight of the samples that remain possible and that a view shows."""
        return self.weighed(search, row, e, slot, words, self.view(row, cell))

    @ti.func
    def view(self, row, cell):
        """Return the number of the view from a cell whose place is a viewpoint."""
        across = (row[LINES] + ti.static(self.pitch - 1)) // ti.static(self.pitch)
        view = cell[0] // ti.static(self.pitch) * across + cell[1] // ti.static(self.pitch)
        return row[VIEW] + 8 * view + cell[2]

    @ti.func
    def pose(self, row, cell):
        """Return the number of a cell's pose: eight times that of its place, plus the heading."""
        return 8 * (cell[0] * row[LINES] + cell[1]) + cell[2]

    @ti.func
    def reach(self, search: ti.template(), row, base, pose):
        """Search for paths from a pose to all others. Return the queue's end."""
        head, tail = 0, self.source(search, base, pose)
        while head < tail:
            tail = self.spread(search, row, base, tail, search.queue[base + head])
            head += 1
        return tail

    @ti.func
    def clear(self, search: ti.template(), base, tail):
        """Discard the distances of a search; ``tail`` is the queue's end."""
        for k in range(base, base + tail):
            search.distance[base + search.queue[k]] = ti.u16(0)

    @ti.func
    def source(self, search: ti.template(), base, pose):
        """Begin a search for paths at a pose. Return the queue's end."""
        # Distances are stored plus one: 0 is unknown.
        search.distance[base + pose], search.queue[base] = ti.u16(1), pose
        return 1

    @ti.func
    def spread(self, search: ti.template(), row, base, tail, pose):
        """Record the poses that one action leads to. Return the queue's end."""
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
        """Record a pose that is new. Return the queue's end."""
        if search.distance[base + pose] == 0:
            search.distance[base + pose] = ti.cast(away + 1, ti.u16)
            search.queue[base + tail] = pose
            tail += 1
        return tail

    @ti.func
    def nearest(self, search: ti.template(), row, left, base):
        """Return the nearest pose on a spot that remains possible, or -1, for a target that no view shows."""
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
            # Rounding hid the target: look for it again.
            self.fill(search, row, left)
        return goal

    @ti.func
    def trace(self, search: ti.template(), row, e, base, goal):
        """Trace the path back from a goal and write its first actions. Return their number."""
        pose = goal
        away = ti.cast(search.distance[base + pose], ti.i32) - 1
        length = ti.min(away, ti.static(REPLAN_STEPS))
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
            if away < ti.static(REPLAN_STEPS):
                search.plan[e * ti.static(REPLAN_STEPS) + away] = ti.cast(action, ti.u8)
        return length
