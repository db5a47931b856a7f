"""Kernels of the oracle's search: breadth first, backwards from a target, and kept between calls.

A search of an environment has a lattice with a border where no body can be. It also has the distances found
so far, in actions, and a queue of the poses that were found and not yet expanded.

A path that enters the doorway of a closed door must first push the door for its remaining steps. Nothing
stands in a doorway, so a shortest path enters each doorway once: a path that leaves and comes back is no
shorter than one that stays. The pose before such a step waits until the search has reached its distance. If a
door was pushed since the search began, the search begins again.
"""

from functools import cache
from typing import Any, NamedTuple

from vitruvius.sim.backends.doors import Doors
from vitruvius.sim.runtime import Bytes, Floats, Ints, Longs, Shorts, kernel, ti
from vitruvius.sim.tasks.survey import DIAGONAL, STRAIGHT
from vitruvius.sim.world.distance_field import Steps
from vitruvius.sim.world.episodes import Episodes
from vitruvius.sim.world.states import loaded, store

FAR = 1 << 15
"""Distance that is longer than any path, in actions."""

UNKNOWN, NOWHERE = -1, -2
"""Placeholders for a distance: no search has reached this pose yet; the body cannot be there."""

HEAD, TAIL, COLUMN, ROW, COLUMNS, ROWS, WAITING = range(7)
"""Indices of a search's notes: the ends of its queue, the lattice's first place (i, j), its columns and rows
with the border, and the number of waiting poses."""

DOORWAY = 1 << 10
"""Bit of a place, in addition to those of its survey: a step from there may meet a door."""

Notes = ti.types.ndarray(ti.types.vector(7, ti.i32), 1)
Goals = ti.types.ndarray(ti.types.vector(2, ti.f32), 1)


class SearchArrays(NamedTuple):
    """Arrays that searches keep."""

    moves: Shorts
    """Survey of each place, and ``DOORWAY``."""
    distance: Steps
    """Distance of each pose."""
    queue: Ints
    notes: Notes
    goals: Goals
    """Target of each search, metres."""
    first: Ints
    """Environment of the first search."""
    pushed: Bytes
    """Number of pushes of each door when the search began."""
    waiting: Ints
    """Waiting poses."""
    found_at: Ints
    """Distance at which each waiting pose is found."""


class Doorways(NamedTuple):
    """Doors of a world, open or not."""

    doorways: Floats


@cache
def kernels(program: Any, episodes: Episodes) -> dict[str, Any]:
    """Return the kernels compiled for a configuration.

    Arguments have the names of the world's and searches' arrays.
    """
    search = PathSearch(episodes)

    @kernel
    def learn(
        moves: Shorts, distance: Steps, notes: Notes, goals: Goals,
        s: ti.i32, i: ti.i32, j: ti.i32, survey: ti.types.ndarray(ti.u16, 2),
    ):  # fmt: skip
        """Store a survey, with a border where no body can be, and discard the results of the search."""
        columns, rows = survey.shape[0] + 2, survey.shape[1] + 2
        notes[s] = ti.Vector([0, 0, i - 1, j - 1, columns, rows, 0])
        goals[s] = ti.Vector([ti.math.nan, ti.math.nan])
        base = s * (moves.shape[0] // notes.shape[0])
        for column, row in ti.ndrange(columns, rows):
            open_ = ti.u16(0)
            if 0 < column < columns - 1 and 0 < row < rows - 1:
                open_ = survey[column - 1, row - 1]
            place = base + column * rows + row
            moves[place] = open_
            for heading in ti.static(range(8)):
                bit = ti.static(DIAGONAL if heading % 2 else STRAIGHT)
                stands = (ti.cast(open_, ti.i32) & bit) != 0
                distance[8 * place + heading] = ti.cast(ti.select(stands, UNKNOWN, NOWHERE), ti.i16)

    @kernel
    def mark(moves: Shorts, notes: Notes, doors: Doorways, s: ti.i32, house: ti.i32, x: ti.f32, y: ti.f32):
        """Mark the places of a lattice through (x, y) metres from which a step may meet a door."""
        note = notes[s]
        base = s * (moves.shape[0] // notes.shape[0])
        for column, row in ti.ndrange(note[COLUMNS], note[ROWS]):
            cell = ti.Vector([column + note[COLUMN], row + note[ROW], 0])
            if search.doors.near(doors, house, ti.Vector([x, y]), cell):
                place = base + column * note[ROWS] + row
                moves[place] = moves[place] | ti.u16(DOORWAY)

    @kernel
    def act(world: episodes.Arrays, searches: SearchArrays, answer: Longs):
        """Write the first action of a shortest path, or ``NOWHERE`` without a path."""
        ti.loop_config(block_dim=1)
        for s in range(ti.min(searches.notes.shape[0], world.reals.shape[0] - searches.first[0])):
            e = searches.first[0] + s
            answer[s] = search.choose(world, searches, s, e, loaded(world, e))

    @kernel
    def follow(world: episodes.Arrays, searches: SearchArrays, answer: Longs):
        """Write and take the first action of a shortest path; ``UNKNOWN`` after the pick-up of the target."""
        ti.loop_config(block_dim=1)
        for s in range(ti.min(searches.notes.shape[0], world.reals.shape[0] - searches.first[0])):
            e = searches.first[0] + s
            state, action = loaded(world, e), UNKNOWN
            # A picked-up target is not marked otherwise, because nothing else is stepped meanwhile.
            if state.over != UNKNOWN:
                action = search.choose(world, searches, s, e, state)
                if action >= 0:
                    moved, _, met = episodes.move(world, e, state, action)
                    if met.max() < 0:
                        state = moved
                    else:
                        episodes.push(world, e, state, met)
                    if episodes.overlaps(state.origin, state.cell, state.target):
                        state.over = UNKNOWN
                    store(world, e, state)
            answer[s] = action

    @kernel
    def play(world: episodes.Arrays, searches: SearchArrays, answer: Longs):
        """Play episodes to their ends and write the number of picked-up targets."""
        ti.loop_config(block_dim=1)
        for s in range(ti.min(searches.notes.shape[0], world.reals.shape[0] - searches.first[0])):
            e = searches.first[0] + s
            state, count = loaded(world, e), 0
            while not state.over:
                action = ti.max(0, search.choose(world, searches, s, e, state))
                state, _, picked, _, _, _ = episodes.advance(world, e, state, action)
                count += picked
            store(world, e, state)
            answer[s] = count

    return {"learn": learn, "mark": mark, "act": act, "follow": follow, "play": play}


@ti.data_oriented
class PathSearch:
    """Functions of one search on its arrays.

    A place is its number in the lattice with its border, by columns. A pose is eight times its place's number
    plus its heading.
    """

    def __init__(self, episodes: Episodes) -> None:
        self.episodes, self.headings = episodes, episodes.body.headings
        config = episodes.config
        self.step, self.doors = config.step, episodes.overlay(Doors)
        self.closed_doors = self.doors is not None
        # Distance around a target to search for poses that pick it up: more than any body's reach.
        self.near = int((config.target / 2 + max(config.body)) / config.step) + 1

    @ti.func
    def choose(self, world: ti.template(), searches: ti.template(), s, e, state):
        """Search until the next pose of a shortest path is known, and return the action that leads to it."""
        opened = self.opened(world, searches, s, e)
        if not (searches.goals[s] == state.target).all() or opened:  # NaN, at first, equals nothing
            searches.goals[s] = state.target
            self.begin(searches, s, state)
        note, base = searches.notes[s], self.base(searches, s)
        rows = note[ROWS]
        column, row, heading = state.cell[0] - note[COLUMN], state.cell[1] - note[ROW], state.cell[2]
        action = NOWHERE
        if 0 < column < note[COLUMNS] - 1 and 0 < row < rows - 1:
            place = base + column * rows + row
            forward, cost = self.headings[heading], 0
            # Forward first: of two shortest paths the straighter. A pose where the body cannot be is never
            # found.
            options = ti.Vector([8 * place + (heading + 1 & 7), 8 * place + (heading + 7 & 7), -1])
            if searches.moves[place] >> heading & 1:
                options[2] = 8 * (place + forward[0] * rows + forward[1]) + heading
                cost = self.door_cost(world, searches, e, state, note, 8 * base, 8 * place + heading)
            nearest, searching = FAR, True
            while searching:
                # Poses are found in order of distance, so the first of the next poses to be found is the
                # best, except if a door is in front of it.
                for turn in ti.static(range(3)):
                    option = ti.static((2 + turn) % 3)
                    if options[option] >= 0:
                        known = ti.cast(searches.distance[options[option]], ti.i32)
                        if known >= 0:
                            if ti.static(option == 2):
                                known += cost
                            if known < nearest:
                                nearest, action = known, option
                note, searching = self.admit(searches, 8 * base, note), False
                if note[HEAD] < note[TAIL]:
                    head = searches.queue[8 * base + note[HEAD]]
                    searching = nearest > ti.cast(searches.distance[head], ti.i32) + 1
                if searching:
                    note = self.expand(world, searches, e, state, 8 * base, note)
            searches.notes[s] = note  # written as a whole, because Taichi's caching in loops needs that
        return action

    @ti.func
    def base(self, searches: ti.template(), s):
        """Return the first place of a search's lattice."""
        return s * (searches.moves.shape[0] // searches.notes.shape[0])

    @ti.func
    def begin(self, searches: ti.template(), s, state):
        """Begin a search: discard its results and queue the poses that pick up the target.

        If a body is larger at diagonal headings, only places where it can turn count, because it could not
        leave others.
        """
        note, anyhow = searches.notes[s], ti.static(STRAIGHT | DIAGONAL)
        base, rows = self.base(searches, s), note[ROWS]
        for k in range(8 * base, 8 * base + note[TAIL]):
            searches.distance[searches.queue[k]] = ti.cast(UNKNOWN, ti.i16)
        middle = ti.cast(ti.floor((state.target - state.origin) / ti.static(self.step)), ti.i32)
        tail = 0
        for i in range(middle[0] - self.near, middle[0] + self.near + 2):
            for j in range(middle[1] - self.near, middle[1] + self.near + 2):
                column, row = i - note[COLUMN], j - note[ROW]
                if 0 < column < note[COLUMNS] - 1 and 0 < row < rows - 1:
                    place = base + column * rows + row
                    if ti.cast(searches.moves[place], ti.i32) & anyhow == anyhow:
                        for heading in range(8):
                            cell = ti.Vector([i, j, heading])
                            if self.episodes.overlaps(state.origin, cell, state.target):
                                tail = self.found(searches, 8 * base, tail, 8 * place + heading, 0)
        note[HEAD], note[TAIL], note[WAITING] = 0, tail, 0
        searches.notes[s] = note

    @ti.func
    def opened(self, world: ti.template(), searches: ti.template(), s, e):
        """Return True if a door was pushed or closed since the search began, and record the new state."""
        opened = False
        if ti.static(self.closed_doors):
            count = self.doors.count(world)
            for door in range(count):  # pyright: ignore[reportArgumentType]
                pushes = world.pushes[e * count + door]
                opened |= searches.pushed[s * count + door] != pushes
                searches.pushed[s * count + door] = pushes
        return opened

    @ti.func
    def door_cost(self, world: ti.template(), searches: ti.template(), e, state, note, base, pose):
        """Return the number of steps (i32) that push closed doors before a step forward succeeds."""
        cost = 0
        if ti.static(self.closed_doors):
            place = (pose - base) >> 3
            if searches.moves[pose >> 3] & DOORWAY:
                i, j = place // note[ROWS] + note[COLUMN], place % note[ROWS] + note[ROW]
                cell = ti.Vector([i, j, pose & 7])
                cost = self.doors.cost(world, e, state.house, state.origin, cell)
        return cost

    @ti.func
    def admit(self, searches: ti.template(), base, note):
        """Queue the waiting poses with the distance of the next pose in the queue.

        If the queue is empty, queue those with the smallest distance. So all poses at a distance are in the
        queue before the first of them is expanded.
        """
        if ti.static(self.closed_doors):
            admitting = note[WAITING] > 0
            if note[HEAD] < note[TAIL] and note[HEAD] > 0:
                head = base + note[HEAD]
                admitting &= (
                    searches.distance[searches.queue[head]] != searches.distance[searches.queue[head - 1]]
                )
            while admitting:
                level = FAR
                if note[HEAD] < note[TAIL]:
                    level = ti.cast(searches.distance[searches.queue[base + note[HEAD]]], ti.i32)
                else:
                    for k in range(base, base + note[WAITING]):
                        level = ti.min(level, searches.found_at[k])
                k = base
                while k < base + note[WAITING]:
                    if searches.found_at[k] <= level:
                        pose, found_at = searches.waiting[k], searches.found_at[k]
                        note[TAIL] = self.found(searches, base, note[TAIL], pose, found_at)
                        note[WAITING] -= 1
                        last = base + note[WAITING]
                        searches.waiting[k], searches.found_at[k] = (
                            searches.waiting[last],
                            searches.found_at[last],
                        )
                    else:
                        k += 1
                admitting = note[HEAD] == note[TAIL] and note[WAITING] > 0
        return note

    @ti.func
    def expand(self, world: ti.template(), searches: ti.template(), e, state, base, note):
        """Take the next pose from the queue and find the poses from which one action leads to it."""
        pose, tail = searches.queue[base + note[HEAD]], note[TAIL]
        place, heading = pose >> 3, pose & 7
        further = ti.cast(searches.distance[pose], ti.i32) + 1
        tail = self.found(searches, base, tail, 8 * place + (heading + 1 & 7), further)
        tail = self.found(searches, base, tail, 8 * place + (heading + 7 & 7), further)
        forward = self.headings[heading]
        place -= forward[0] * note[ROWS] + forward[1]
        pose = 8 * place + heading
        if searches.moves[place] >> heading & 1:
            cost = self.door_cost(world, searches, e, state, note, base, pose)
            if cost == 0:
                tail = self.found(searches, base, tail, pose, further)
            elif searches.distance[pose] == UNKNOWN:
                searches.waiting[base + note[WAITING]] = pose
                searches.found_at[base + note[WAITING]] = further + cost
                note[WAITING] += 1
        note[HEAD], note[TAIL] = note[HEAD] + 1, tail
        return note

    @ti.func
    def found(self, searches: ti.template(), base, tail, pose, further):
        """Record a pose's distance and queue it, if the body can be there and the pose is new.

        Return the queue's end.
        """
        if searches.distance[pose] == UNKNOWN:
            searches.distance[pose] = ti.cast(further, ti.i16)
            searches.queue[base + tail] = pose
            tail += 1
        return tail
