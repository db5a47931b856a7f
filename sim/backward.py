"""The oracle's search in kernels: breadth first, backwards from a target, kept between calls.

A search of an environment has a lattice with a border where no body can be, the distances found so far (in
actions), and a queue of the poses that were found and not yet expanded.
"""

from functools import cache
from typing import Any

from sim.episodes import Episodes, Indices, Numbers, Reals, Wholes, loaded, store
from sim.runtime import ti
from sim.survey import DIAGONAL, STRAIGHT

FAR = 1 << 15
"""More actions than any path takes."""

UNKNOWN, NOWHERE = -1, -2
"""In place of a distance: no search has come to this pose; the body cannot be there."""

HEAD, TAIL, COLUMN, ROW, COLUMNS, ROWS = range(6)
"""Of a search: its queue's ends, the lattice's first place (i, j), its columns and rows with a border."""

Moves, Steps = ti.types.ndarray(ti.u16, 1), ti.types.ndarray(ti.i16, 1)
Notes = ti.types.ndarray(ti.types.vector(6, ti.i32), 1)
Goals = ti.types.ndarray(ti.types.vector(2, ti.f32), 1)


@cache
def kernels(program: Any, episodes: Episodes) -> dict[str, Any]:
    """What is compiled for a configuration. Arguments are named for the arrays of a world and of searches."""
    search = Search(episodes)

    @ti.kernel
    def learn(
        moves: Moves, distance: Steps, notes: Notes, goals: Goals,
        s: ti.i32, i: ti.i32, j: ti.i32, survey: ti.types.ndarray(ti.u16, 2),
    ):  # fmt: skip
        """Take in a survey, with a border where no body can be, and forget what the search found."""
        columns, rows = survey.shape[0] + 2, survey.shape[1] + 2
        notes[s] = ti.Vector([0, 0, i - 1, j - 1, columns, rows])
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

    @ti.kernel
    def act(
        moves: Moves, distance: Steps, queue: Indices, notes: Notes, goals: Goals, first: Indices,
        reals: Reals, wholes: Wholes, answer: ti.types.ndarray(ti.i64, 1),
    ):  # fmt: skip
        """The first action of a shortest path; ``NOWHERE`` if there is none."""
        ti.loop_config(block_dim=1)
        for s in range(ti.min(notes.shape[0], reals.shape[0] - first[0])):
            state = loaded(reals, wholes, first[0] + s)
            answer[s] = search.choose(moves, distance, queue, notes, goals, s, state)

    @ti.kernel
    def follow(
        moves: Moves, distance: Steps, queue: Indices, notes: Notes, goals: Goals, first: Indices,
        numbers: Numbers, indices: Indices, reals: Reals, wholes: Wholes, answer: ti.types.ndarray(ti.i64, 1),
    ):  # fmt: skip
        """The same, and go there; ``UNKNOWN`` where the action before this one picked the target up."""
        ti.loop_config(block_dim=1)
        for s in range(ti.min(notes.shape[0], reals.shape[0] - first[0])):
            e = first[0] + s
            state, action = loaded(reals, wholes, e), UNKNOWN
            # What has been picked up is not marked otherwise, as nothing else is stepped meanwhile.
            if state.over != UNKNOWN:
                action = search.choose(moves, distance, queue, notes, goals, s, state)
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
        moves: Moves, distance: Steps, queue: Indices, notes: Notes, goals: Goals, first: Indices,
        numbers: Numbers, indices: Indices, places: Indices, reals: Reals, wholes: Wholes,
        answer: ti.types.ndarray(ti.i64, 1),
    ):  # fmt: skip
        """Play episodes to their ends; how many targets were picked up."""
        ti.loop_config(block_dim=1)
        for s in range(ti.min(notes.shape[0], reals.shape[0] - first[0])):
            e = first[0] + s
            state, count = loaded(reals, wholes, e), 0
            while not state.over:
                action = ti.max(0, search.choose(moves, distance, queue, notes, goals, s, state))
                state, picked, _, _, _ = episodes.advance(numbers, indices, places, state, action)
                count += picked
            store(reals, wholes, e, state)
            answer[s] = count

    return {"learn": learn, "act": act, "follow": follow, "play": play}


@ti.data_oriented
class Search:
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
        moves: ti.template(),
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
            self.begin(moves, distance, queue, notes, s, state)
        note = notes[s]
        base, rows = s * (moves.shape[0] // notes.shape[0]), note[ROWS]
        column, row, heading = state.cell[0] - note[COLUMN], state.cell[1] - note[ROW], state.cell[2]
        action = NOWHERE
        if 0 < column < note[COLUMNS] - 1 and 0 < row < rows - 1:
            place = base + column * rows + row
            forward = self.headings[heading]
            # Forward first: of two shortest paths the straighter. A pose that cannot be is never found.
            options = ti.Vector([8 * place + (heading + 1 & 7), 8 * place + (heading + 7 & 7), -1])
            if moves[place] >> heading & 1:
                options[2] = 8 * (place + forward[0] * rows + forward[1]) + heading
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
                    tail = self.expand(moves, distance, queue, 8 * base, head, tail, rows)
                    head += 1
            note[HEAD], note[TAIL] = head, tail
            notes[s] = note  # whole, as it is read: what Taichi caches in a loop is so the same
        return action

    @ti.func
    def begin(
        self,
        moves: ti.template(),
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
        base, rows = s * (moves.shape[0] // notes.shape[0]), note[ROWS]
        for k in range(8 * base, 8 * base + note[TAIL]):
            distance[queue[k]] = ti.cast(UNKNOWN, ti.i16)
        middle = ti.cast(ti.floor((state.target - state.origin) / ti.static(self.step)), ti.i32)
        tail = 0
        for i in range(middle[0] - self.near, middle[0] + self.near + 2):
            for j in range(middle[1] - self.near, middle[1] + self.near + 2):
                column, row = i - note[COLUMN], j - note[ROW]
                if 0 < column < note[COLUMNS] - 1 and 0 < row < rows - 1:
                    place = base + column * rows + row
                    if ti.cast(moves[place], ti.i32) & anyhow == anyhow:
                        for heading in range(8):
                            cell = ti.Vector([i, j, heading])
                            if self.episodes.overlaps(state.origin, cell, state.target):
                                tail = self.found(distance, queue, 8 * base, tail, 8 * place + heading, 0)
        note[HEAD], note[TAIL] = 0, tail
        notes[s] = note

    @ti.func
    def expand(
        self, moves: ti.template(), distance: ti.template(), queue: ti.template(), base, head, tail, rows
    ):
        """Take the next pose from the queue and find those that one action leads from to it."""
        pose = queue[base + head]
        place, heading = pose >> 3, pose & 7
        further = ti.cast(distance[pose], ti.i32) + 1
        tail = self.found(distance, queue, base, tail, 8 * place + (heading + 1 & 7), further)
        tail = self.found(distance, queue, base, tail, 8 * place + (heading + 7 & 7), further)
        forward = self.headings[heading]
        place -= forward[0] * rows + forward[1]
        if moves[place] >> heading & 1:
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
