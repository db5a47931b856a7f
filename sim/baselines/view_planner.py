"""How the searcher goes on: it looks, and plans the path to the viewpoint that gains most for what it costs.

The information gain of a viewpoint is the weight of the places of the target that are left and that a look
from there would show. Its cost is the length of a shortest path there, and a few steps more.
"""

from sim.backends.backend import TARGET
from sim.baselines.lookout import WORD, Looks, bit
from sim.runtime import ti

REPLAN = 48
"""Steps until it plans again: what it saw on its path may have made another one better."""

HASTE = 4.0
"""Steps added to a path's length when viewpoints are compared."""

Rows = ti.types.ndarray(ti.types.vector(8, ti.i32), 1)
SPOT, SPOTS, SAMPLE, SAMPLED, VIEW, PLACE, COLUMNS, LINES = range(8)
"""Of a house: its first spot and their number, its samples, its first view; its lattice's first place,
columns and rows."""


@ti.data_oriented
class ViewPlanner:
    """What one environment's searcher does, as functions of the arrays."""

    def __init__(self, looks: Looks, pitch: int) -> None:
        """Plan for bodies with these looks; viewpoints are ``pitch`` steps apart."""
        self.pitch = pitch
        self.looks, self.episodes, self.headings = looks, looks.episodes, looks.episodes.body.headings

    @ti.func
    def restart(
        self, spots: ti.template(), origins: ti.template(), left: ti.template(), row, e, count, state, near
    ):
        """A new target: it may be anywhere but too near to the last one, where none is sampled."""
        words, some = left.shape[0] // count, 0
        corner = ti.Vector([origins[2 * state.house], origins[2 * state.house + 1]])
        self.fill(left, row, e, words)
        for k in range(row[SPOTS]):
            at = 2 * (row[SPOT] + k)
            spot = self.looks.spot(corner, spots[at], spots[at + 1])
            if ti.abs(spot - near).max() < ti.static(self.episodes.apart):  # never where near is NaN
                left[e * words + k // ti.static(WORD)] ^= bit(k)
            else:
                some = 1
        if not some:
            self.fill(left, row, e, words)

    @ti.func
    def fill(self, left: ti.template(), row, e, words):
        """The target may be anywhere."""
        for word in range(words):
            left[e * words + word] = 0
        for k in range(row[SPOTS]):
            left[e * words + k // ti.static(WORD)] |= bit(k)

    @ti.func
    def look(
        self, numbers: ti.template(), indices: ti.template(), spots: ti.template(), origins: ti.template(),
        left: ti.template(), row, e, count, state,
    ):  # fmt: skip
        """Whether a ray meets the target; if not, strike out the spots where one would have."""
        distance, kinds = self.looks.backend.see(
            numbers, indices, state.house, state.origin, state.cell, state.target, 0
        )
        known = 0
        for r in range(ti.static(self.looks.config.rays)):
            known |= ti.cast(kinds[r] == ti.static(TARGET), ti.i32)
        if not known:
            words = left.shape[0] // count
            corner = ti.Vector([origins[2 * state.house], origins[2 * state.house + 1]])
            window = self.looks.window(distance, corner, state.origin, state.cell)
            for word in range((row[SPOTS] + ti.static(WORD - 1)) // ti.static(WORD)):
                first = row[SPOT] + word * ti.static(WORD)
                end = ti.min(first + ti.static(WORD), row[SPOT] + row[SPOTS])
                # Spots are in the order of their i: most words are outside the window as a whole.
                if left[e * words + word] != 0 and spots[2 * first] <= window[1]:  # noqa: SIM102
                    if spots[2 * (end - 1)] >= window[0]:
                        for k in range(first, end):
                            i, j = spots[2 * k], spots[2 * k + 1]
                            if left[e * words + word] & bit(k - row[SPOT]) and window[2] <= j <= window[3]:
                                spot = self.looks.spot(corner, i, j)
                                if self.looks.meets(distance, state.origin, state.cell, spot):
                                    left[e * words + word] ^= bit(k - row[SPOT])
        return known

    @ti.func
    def plan(
        self, numbers: ti.template(), indices: ti.template(), rows: ti.template(), spots: ti.template(),
        samples: ti.template(), origins: ti.template(), moves: ti.template(), shown: ti.template(),
        left: ti.template(), sampled: ti.template(), weights: ti.template(), distance: ti.template(),
        queue: ti.template(), plan: ti.template(), row, e, slot, slots, count, state, known,
    ):  # fmt: skip
        """Search for paths from here to all poses, nearest first, until no pose further away can be better;
        note the first actions of the path to the best. How many.
        """
        words, finer = sampled.shape[0] // slots, left.shape[0] // count
        base = slot * (queue.shape[0] // slots)
        total = ti.f32(0.0)
        for word in range(words):
            sampled[slot * words + word] = 0
        for k in range(row[SAMPLED]):
            spot = samples[row[SAMPLE] + k]
            if left[e * finer + spot // ti.static(WORD)] & bit(spot):
                sampled[slot * words + k // ti.static(WORD)] |= bit(k)
                total += weights[e * words + k // ti.static(WORD)]
        across = (row[LINES] + ti.static(self.pitch - 1)) // ti.static(self.pitch)
        pose = 8 * (state.cell[0] * row[LINES] + state.cell[1]) + state.cell[2]
        distance[base + pose], queue[base] = ti.u16(1), pose  # one more than it is: 0 is unknown
        head, tail, goal, best, searching = 0, 1, -1, ti.f32(0.0), True
        while searching and head < tail:
            pose = queue[base + head]
            head += 1
            place, heading = pose >> 3, pose & 7
            i, j = place // row[LINES], place % row[LINES]
            away = ti.cast(distance[base + pose], ti.i32) - 1
            cost = ti.cast(away, ti.f32) + ti.static(HASTE)
            if known:
                if self.episodes.overlaps(state.origin, ti.Vector([i, j, heading]), state.target):
                    goal, searching = pose, False
            elif best > 0 and total / cost <= best:
                searching = False
            elif away > 0:
                gain = ti.f32(0.0)
                if i == state.cell[0] and j == state.cell[1]:
                    cell = ti.Vector([i, j, heading])
                    gain = self.turned(
                        numbers, indices, spots, samples, origins, sampled, weights, row,
                        slot * words, e * words, state, cell,
                    )  # fmt: skip
                elif i % ti.static(self.pitch) == 0 and j % ti.static(self.pitch) == 0:
                    view = i // ti.static(self.pitch) * across + j // ti.static(self.pitch)
                    view = (row[VIEW] + 8 * view + heading) * words
                    for word in range((row[SAMPLED] + ti.static(WORD - 1)) // ti.static(WORD)):
                        both = shown[view + word] & sampled[slot * words + word]
                        gain += weights[e * words + word] * ti.cast(ti.math.popcnt(both), ti.f32)
                if gain / cost > best:
                    goal, best = pose, gain / cost
            if searching:
                moves_here = ti.cast(moves[row[PLACE] + place], ti.i32)
                for turn in ti.static((1, 7)):
                    other = heading + turn & 7
                    if moves_here >> (8 + other % 2) & 1:
                        tail = self.found(distance, queue, base, tail, 8 * place + other, away + 1)
                if moves_here >> heading & 1:
                    forward = self.headings[heading]
                    ahead = 8 * (place + forward[0] * row[LINES] + forward[1]) + heading
                    tail = self.found(distance, queue, base, tail, ahead, away + 1)
        if goal < 0 and not known:
            goal = self.nearest(spots, left, distance, row, e, base, finer)
        length = 0
        if goal >= 0:
            length = self.trace(moves, distance, plan, row, e, base, goal)
        for k in range(base, base + tail):
            distance[base + queue[k]] = ti.u16(0)
        return length

    @ti.func
    def turned(
        self, numbers: ti.template(), indices: ti.template(), spots: ti.template(), samples: ti.template(),
        origins: ti.template(), sampled: ti.template(), weights: ti.template(), row,
        base, weight, state, cell,
    ):  # fmt: skip
        """The weight of the samples that are left and that a look from a cell would show."""
        corner = ti.Vector([origins[2 * state.house], origins[2 * state.house + 1]])
        distance = self.looks.distances(numbers, indices, state.house, state.origin, cell)
        window, gain = self.looks.window(distance, corner, state.origin, cell), ti.f32(0.0)
        for k in range(row[SAMPLED]):
            at = 2 * (row[SPOT] + samples[row[SAMPLE] + k])
            i, j = spots[at], spots[at + 1]
            inside = window[0] <= i <= window[1] and window[2] <= j <= window[3]
            if inside and sampled[base + k // ti.static(WORD)] & bit(k):
                met = self.looks.meets(distance, state.origin, cell, self.looks.spot(corner, i, j))
                gain += weights[weight + k // ti.static(WORD)] * ti.cast(met, ti.f32)
        return gain

    @ti.func
    def found(self, distance: ti.template(), queue: ti.template(), base, tail, pose, away):
        """Note a pose that is new; the queue's end."""
        if distance[base + pose] == 0:
            distance[base + pose] = ti.cast(away + 1, ti.u16)
            queue[base + tail] = pose
            tail += 1
        return tail

    @ti.func
    def nearest(
        self, spots: ti.template(), left: ti.template(), distance: ti.template(), row, e, base, words
    ):
        """The nearest pose on a spot that is left, where no view shows one; -1 where none is left."""
        goal, nearest, some = -1, 1 << 15, 0
        for k in range(row[SPOTS]):
            if left[e * words + k // ti.static(WORD)] & bit(k):
                some = 1
                at = 2 * (row[SPOT] + k)
                i, j = ti.round(spots[at], ti.i32), ti.round(spots[at + 1], ti.i32)
                place = i * row[LINES] + j
                for heading in range(8):
                    away = ti.cast(distance[base + 8 * place + heading], ti.i32) - 1
                    if 0 < away < nearest:
                        goal, nearest = 8 * place + heading, away
        if not some:
            # A target that rounding hid: look for it again.
            self.fill(left, row, e, words)
        return goal

    @ti.func
    def trace(self, moves: ti.template(), distance: ti.template(), plan: ti.template(), row, e, base, goal):
        """Go back from a goal to here and write the first actions of the path; how many."""
        pose = goal
        away = ti.cast(distance[base + pose], ti.i32) - 1
        length = ti.min(away, ti.static(REPLAN))
        while away > 0:
            place, heading = pose >> 3, pose & 7
            forward = self.headings[heading]
            i, j = place // row[LINES] - forward[0], place % row[LINES] - forward[1]
            before, action = -1, 0
            if 0 <= i < row[COLUMNS] and 0 <= j < row[LINES]:
                back = i * row[LINES] + j
                if (
                    ti.cast(moves[row[PLACE] + back], ti.i32) >> heading & 1
                    and distance[base + 8 * back + heading] == away
                ):
                    before, action = 8 * back + heading, 2
            if before < 0:
                before, action = 8 * place + (heading + 7 & 7), 0
                if distance[base + before] != away:
                    before, action = 8 * place + (heading + 1 & 7), 1
            pose, away = before, away - 1
            if away < ti.static(REPLAN):
                plan[e * ti.static(REPLAN) + away] = ti.cast(action, ti.u8)
        return length
