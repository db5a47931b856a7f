"""A searcher that knows the house but not where its target is: about the best that memory and search can do.

It keeps the exact posterior over the target's places. Targets are drawn alike from all of them, so it is
uniform over those that are left: not near the last target, and nowhere that it has looked since. It goes,
by a shortest way, to where a look would show most of that for each step that it costs, thinks again every
few steps, and once a ray has met the target it goes and picks it up. What lies between an agent and the
searcher is learning; what lies between the searcher and the oracle, nobody can know.
"""

from functools import cache
from typing import Any

import numpy as np

from sim.backend import TARGET
from sim.episodes import Episodes, Indices, Numbers, Reals, Wholes, loaded
from sim.lookout import WORD, Looks, Words, bit, in_steps, origins_of, thinned
from sim.runtime import Array, Launch, start, ti
from sim.survey import survey
from sim.vector import HouseVectorEnv
from sim.world import World

THOUGHT = 48
"""Steps until it thinks again: what it saw on its way may have made another way better."""

VIEWS, SAMPLES = 0.57, 0.29
"""Metres between the places that it may go to for a look, and between those places of the target by which it
judges a look, about: whole numbers of steps. The posterior itself is of all places."""

HASTE = 4.0
"""Steps added to a way's length when looks are compared: what a few steps cost is not all that they cost."""

AT_ONCE = 32
"""Environments that think at a time: it bounds the memory of their searches for ways."""

EPISODE, FOUND, KNOWN, DONE, LENGTH = range(5)
"""Of an environment: which target of which episode it looks for, if it has seen it; its plan."""

Notes = ti.types.ndarray(ti.types.vector(5, ti.i32), 1)
Counts, Bytes = ti.types.ndarray(ti.u16, 1), ti.types.ndarray(ti.u8, 1)
Points = ti.types.ndarray(ti.types.vector(2, ti.f32), 1)
Rows = ti.types.ndarray(ti.types.vector(8, ti.i32), 1)
SPOT, SPOTS, SAMPLE, SAMPLED, VIEW, WAY, COLUMNS, LINES = range(8)
"""Of a house: its first spot and their number, its samples, its first view; its lattice's first place,
columns and rows."""


class Searcher:
    """Actions for the E environments of a ``HouseVectorEnv``, whose episodes begin where it draws them.

    Only on the CPU; the bank must stay as it is. It takes 0.3 MB and 30 ms a house to prepare.
    """

    def __init__(self, envs: HouseVectorEnv) -> None:
        """Learn the houses: ways, and what each look would show."""
        self.world: World = envs.unwrapped.world
        world, count = self.world, self.world.num_envs
        spots = [here.targets for here in world.places]
        pitch = in_steps(VIEWS, world)
        samples = [thinned(each, in_steps(SAMPLES, world)) for each in spots]
        tables = survey(world.backend, world.bank, list(range(len(spots))), world.lattices)
        shapes = np.array([table.ways.shape for table in tables])
        words = -(-max(map(len, samples)) // WORD)
        views = 8 * np.prod(-(-shapes // pitch), axis=1)
        rows = np.column_stack(
            [
                _starts(map(len, spots)), [len(each) for each in spots],
                _starts(map(len, samples)), [len(each) for each in samples],
                _starts(views), _starts(np.prod(shapes, axis=1)), shapes,
            ]
        )  # fmt: skip
        if views.sum() * words >= 1 << 31:
            raise ValueError(f"{len(spots)} houses are too many for a searcher: give it some at a time")
        poses, slots = 8 * int(np.prod(shapes, axis=1).max()), min(count, AT_ONCE)
        self.arrays = {
            "spots": Array.of(np.concatenate(spots).astype(np.int32).ravel()),
            "samples": Array.of(np.concatenate(samples).astype(np.int32)),
            "rows": Array(ti.i32, len(rows), 8),
            "origins": Array.of(origins_of(world)),
            "ways": Array.of(np.concatenate([table.ways.ravel() for table in tables])),
            "shown": Array(ti.u64, int(views.sum()) * words),
            "left": Array(ti.u64, count * -(-max(map(len, spots)) // WORD)),
            "sampled": Array(ti.u64, slots * words),
            "distance": Array(ti.u16, slots * poses),
            "queue": Array(ti.i32, slots * poses),
            "notes": Array(ti.i32, count, 5),
            "last": Array(ti.f32, count, 2),
            "plan": Array(ti.u8, count * THOUGHT),
            "answer": Array(ti.i64, count),
        }
        self.arrays["rows"].fill(rows.astype(np.int32))
        kernels = _kernels(start(), world.kernels.episodes, pitch)
        Launch(kernels["prepare"], world.arrays | self.arrays)()
        self._act = Launch(kernels["act"], world.arrays | self.arrays)
        self.begin()

    def begin(self) -> None:
        """Forget all: for a reset that goes back to an episode that it knows."""
        self.arrays["notes"].fill(np.full((self.world.num_envs, 5), -1, np.int32))

    def act(self) -> np.ndarray:
        """The next action (E,) int64 of each environment, from where it is. Ask once before each step."""
        self._act()
        return self.arrays["answer"].numpy()


def _starts(counts: Any) -> np.ndarray:
    """Where each part begins when parts of these lengths stand one behind the other."""
    return np.cumsum([0, *counts])[:-1]


@cache
def _kernels(program: Any, episodes: Episodes, pitch: int) -> dict[str, Any]:
    looks = Looks(episodes)
    think = _Thought(looks, pitch)

    @ti.kernel
    def prepare(
        numbers: Numbers, indices: Indices, rows: Rows, spots: Indices, samples: Indices, origins: Numbers,
        ways: Counts, shown: Words, sampled: Words, answer: ti.types.ndarray(ti.i64, 1), queue: Indices,
    ):  # fmt: skip
        """Look from every view of every house at its samples."""
        slots = ti.min(ti.static(AT_ONCE), answer.shape[0])
        words = sampled.shape[0] // slots
        for view in range(shown.shape[0] // (8 * words)):
            house, last = 0, rows.shape[0] - 1
            while house < last and rows[house + 1][VIEW] <= 8 * view:
                house += 1
            row = rows[house]
            across = (row[LINES] + ti.static(pitch - 1)) // ti.static(pitch)
            here = view - row[VIEW] // 8
            i, j = here // across * ti.static(pitch), here % across * ti.static(pitch)
            corner = ti.Vector([origins[2 * house], origins[2 * house + 1]])
            for heading in range(8):
                if ti.cast(ways[row[WAY] + i * row[LINES] + j], ti.i32) >> (8 + heading % 2) & 1:
                    cell = ti.Vector([i, j, heading])
                    distance = looks.distances(numbers, indices, house, corner, cell)
                    window = looks.window(distance, corner, corner, cell)
                    for k in range(row[SAMPLED]):
                        at = 2 * (row[SPOT] + samples[row[SAMPLE] + k])
                        i_, j_ = spots[at], spots[at + 1]
                        # Nested: Taichi's ``and`` computes both sides.
                        if window[0] <= i_ <= window[1] and window[2] <= j_ <= window[3]:  # noqa: SIM102
                            if looks.meets(distance, corner, cell, looks.spot(corner, i_, j_)):
                                shown[(8 * view + heading) * words + k // ti.static(WORD)] |= bit(k)

    @ti.kernel
    def act(
        numbers: Numbers, indices: Indices, reals: Reals, wholes: Wholes, rows: Rows, spots: Indices,
        samples: Indices, origins: Numbers, ways: Counts, shown: Words, left: Words, sampled: Words,
        distance: Counts, queue: Indices, notes: Notes, last: Points, plan: Bytes,
        answer: ti.types.ndarray(ti.i64, 1),
    ):  # fmt: skip
        """Look, strike out what is seen, think where the plan is at its end, and say its next action."""
        count = reals.shape[0]
        slots = ti.min(ti.static(AT_ONCE), count)
        ti.loop_config(block_dim=1)
        for slot in range(slots):
            for turn in range((count - slot + slots - 1) // slots):
                e = slot + turn * slots
                state, note = loaded(reals, wholes, e), notes[e]
                row = rows[state.house]
                if note[EPISODE] != state.episode or note[FOUND] != state.found:
                    near = ti.Vector([ti.math.nan, ti.math.nan])
                    if note[EPISODE] == state.episode:
                        near = last[e]
                    think.anew(spots, origins, left, row, e, count, state, near)
                    note = ti.Vector([state.episode, state.found, 0, 0, 0])
                    last[e] = state.target
                if not note[KNOWN]:
                    known = think.look(numbers, indices, spots, origins, left, row, e, count, state)
                    if known:
                        note[KNOWN], note[LENGTH] = 1, 0
                if note[DONE] >= note[LENGTH]:
                    note[DONE] = 0
                    note[LENGTH] = think.plan(
                        numbers, indices, rows, spots, samples, origins, ways, shown, left, sampled,
                        distance, queue, plan, row, e, slot, slots, count, state, note[KNOWN],
                    )  # fmt: skip
                answer[e] = 0
                if note[LENGTH] > 0:
                    answer[e] = ti.cast(plan[e * ti.static(THOUGHT) + note[DONE]], ti.i64)
                note[DONE] += 1
                notes[e] = note

    return {"prepare": prepare, "act": act}


@ti.data_oriented
class _Thought:
    """What one environment's searcher does, as functions of the arrays."""

    def __init__(self, looks: Looks, pitch: int) -> None:
        """Think about bodies that look so, at places so many steps apart."""
        self.pitch = pitch
        self.looks, self.episodes, self.headings = looks, looks.episodes, looks.episodes.body.headings

    @ti.func
    def anew(
        self, spots: ti.template(), origins: ti.template(), left: ti.template(), row, e, count, state, near
    ):
        """A new target: it may be anywhere but where the world does not draw one so near to the last."""
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
        """Anywhere at all."""
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
        samples: ti.template(), origins: ti.template(), ways: ti.template(), shown: ti.template(),
        left: ti.template(), sampled: ti.template(), distance: ti.template(), queue: ti.template(),
        plan: ti.template(), row, e, slot, slots, count, state, known,
    ):  # fmt: skip
        """Search for ways from here to all poses, nearest first, until no pose further away can be better;
        note the first actions of the way to the best. How many.
        """
        words, finer = sampled.shape[0] // slots, left.shape[0] // count
        base = slot * (queue.shape[0] // slots)
        total = 0
        for word in range(words):
            sampled[slot * words + word] = 0
        for k in range(row[SAMPLED]):
            spot = samples[row[SAMPLE] + k]
            if left[e * finer + spot // ti.static(WORD)] & bit(spot):
                sampled[slot * words + k // ti.static(WORD)] |= bit(k)
                total += 1
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
            elif total / cost <= best:
                searching = False
            elif away > 0:
                gain = 0
                if i == state.cell[0] and j == state.cell[1]:
                    cell = ti.Vector([i, j, heading])
                    gain = self.turned(
                        numbers, indices, spots, samples, origins, sampled, row, slot * words, state, cell
                    )
                elif i % ti.static(self.pitch) == 0 and j % ti.static(self.pitch) == 0:
                    view = i // ti.static(self.pitch) * across + j // ti.static(self.pitch)
                    view = (row[VIEW] + 8 * view + heading) * words
                    for word in range((row[SAMPLED] + ti.static(WORD - 1)) // ti.static(WORD)):
                        both = shown[view + word] & sampled[slot * words + word]
                        gain += ti.math.popcnt(both)
                if gain / cost > best:
                    goal, best = pose, gain / cost
            if searching:
                ways_here = ti.cast(ways[row[WAY] + place], ti.i32)
                for turn in ti.static((1, 7)):
                    other = heading + turn & 7
                    if ways_here >> (8 + other % 2) & 1:
                        tail = self.found(distance, queue, base, tail, 8 * place + other, away + 1)
                if ways_here >> heading & 1:
                    way = self.headings[heading]
                    ahead = 8 * (place + way[0] * row[LINES] + way[1]) + heading
                    tail = self.found(distance, queue, base, tail, ahead, away + 1)
        if goal < 0 and not known:
            goal = self.nearest(spots, left, distance, row, e, base, finer)
        length = 0
        if goal >= 0:
            length = self.trace(ways, distance, plan, row, e, base, goal)
        for k in range(base, base + tail):
            distance[base + queue[k]] = ti.u16(0)
        return length

    @ti.func
    def turned(
        self, numbers: ti.template(), indices: ti.template(), spots: ti.template(), samples: ti.template(),
        origins: ti.template(), sampled: ti.template(), row, base, state, cell,
    ):  # fmt: skip
        """How many of the samples that are left a look from a cell would show."""
        corner = ti.Vector([origins[2 * state.house], origins[2 * state.house + 1]])
        distance = self.looks.distances(numbers, indices, state.house, state.origin, cell)
        window, gain = self.looks.window(distance, corner, state.origin, cell), 0
        for k in range(row[SAMPLED]):
            at = 2 * (row[SPOT] + samples[row[SAMPLE] + k])
            i, j = spots[at], spots[at + 1]
            inside = window[0] <= i <= window[1] and window[2] <= j <= window[3]
            if inside and sampled[base + k // ti.static(WORD)] & bit(k):
                gain += self.looks.meets(distance, state.origin, cell, self.looks.spot(corner, i, j))
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
                place = spots[2 * (row[SPOT] + k)] * row[LINES] + spots[2 * (row[SPOT] + k) + 1]
                for heading in range(8):
                    away = ti.cast(distance[base + 8 * place + heading], ti.i32) - 1
                    if 0 < away < nearest:
                        goal, nearest = 8 * place + heading, away
        if not some:
            # A target that rounding hid: look for it anew.
            self.fill(left, row, e, words)
        return goal

    @ti.func
    def trace(self, ways: ti.template(), distance: ti.template(), plan: ti.template(), row, e, base, goal):
        """Go back from a goal to here and write the first actions of the way; how many."""
        pose = goal
        away = ti.cast(distance[base + pose], ti.i32) - 1
        length = ti.min(away, ti.static(THOUGHT))
        while away > 0:
            place, heading = pose >> 3, pose & 7
            way = self.headings[heading]
            i, j = place // row[LINES] - way[0], place % row[LINES] - way[1]
            before, action = -1, 0
            if 0 <= i < row[COLUMNS] and 0 <= j < row[LINES]:
                back = i * row[LINES] + j
                if (
                    ti.cast(ways[row[WAY] + back], ti.i32) >> heading & 1
                    and distance[base + 8 * back + heading] == away
                ):
                    before, action = 8 * back + heading, 2
            if before < 0:
                before, action = 8 * place + (heading + 7 & 7), 0
                if distance[base + before] != away:
                    before, action = 8 * place + (heading + 1 & 7), 1
            pose, away = before, away - 1
            if away < ti.static(THOUGHT):
                plan[e * ti.static(THOUGHT) + away] = ti.cast(action, ti.u8)
        return length
