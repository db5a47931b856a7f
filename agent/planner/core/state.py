"""State of one environment's planner: integers and the target's place, besides the planner's arrays."""

from vitruvius.sim.runtime import ti

NONE, SEARCH, TARGET = range(3)
"""Kinds of goals: none; a viewpoint or a candidate; the target that was seen."""

State = ti.types.struct(
    time=ti.i32,  # steps in this episode
    x=ti.i32,  # the eye's place, half cells east of its start
    y=ti.i32,  # and south
    heading=ti.i32,  # eighths of a turn
    aligned=ti.i32,  # 1 if a wall has shown how the heading lies to the house
    straight=ti.i32,  # half cells gone straight on since the last sweep; -1: the next sweep skips nothing
    since=ti.i32,  # step since which an unknown target may have lain where it lies
    known=ti.i32,  # 1 if a target is known
    target=ti.math.vec2,  # its centre, cells east and south of the start
    kind=ti.i32,  # kind of the goal
    goal=ti.i32,  # node of the goal; for a target, approximately
    look=ti.i32,  # the viewpoint's heading, -1 for none
    plan_age=ti.i32,  # steps since the viewpoint was chosen
    queued=ti.i32,  # length of the last path search's queue
    path_age=ti.i32,  # steps since that search
    stale=ti.i32,  # cells found to be occupied since that search
    forward=ti.i32,  # 1 if the rays leave the body room to go forward
    path=ti.i32,  # half cells to the goal, 65535 without a known path
    new=ti.i32,  # cells seen for the first time in the last step
    seen=ti.i32,  # cells seen in this episode
    found=ti.i32,  # targets picked up, as far as the planner can tell
    found_here=ti.i32,  # number of these in the start room
)

NAMES = tuple(State.members)
SIZE = len(NAMES) + 1
"""Numbers in a state: the target's place takes two."""

AT = {name: k + (k > NAMES.index("target")) for k, name in enumerate(NAMES)}
"""Index of each number in its environment's part of the array: integers, and the float32 bits of the
target."""


@ti.func
def loaded(states: ti.template(), e):
    """Return an environment's state."""
    at = e * SIZE
    return State(
        time=states[at],
        x=states[at + 1],
        y=states[at + 2],
        heading=states[at + 3],
        aligned=states[at + 4],
        straight=states[at + 5],
        since=states[at + 6],
        known=states[at + 7],
        target=ti.Vector([ti.bit_cast(states[at + 8], ti.f32), ti.bit_cast(states[at + 9], ti.f32)]),
        kind=states[at + 10],
        goal=states[at + 11],
        look=states[at + 12],
        plan_age=states[at + 13],
        queued=states[at + 14],
        path_age=states[at + 15],
        stale=states[at + 16],
        forward=states[at + 17],
        path=states[at + 18],
        new=states[at + 19],
        seen=states[at + 20],
        found=states[at + 21],
        found_here=states[at + 22],
    )


@ti.func
def store(states: ti.template(), e, state):
    """Write an environment's state."""
    at = e * SIZE
    x, y = ti.bit_cast(state.target[0], ti.i32), ti.bit_cast(state.target[1], ti.i32)
    whole = ti.Vector(
        [
            state.time, state.x, state.y, state.heading, state.aligned, state.straight, state.since,
            state.known, x, y, state.kind, state.goal, state.look, state.plan_age, state.queued,
            state.path_age, state.stale, state.forward, state.path, state.new, state.seen, state.found,
            state.found_here,
        ]
    )  # fmt: skip
    for k in ti.static(range(SIZE)):
        states[at + k] = whole[k]


@ti.func
def first_state(heading):
    """Return the state of an episode that begins."""
    state = State(0)
    state.heading, state.since, state.straight = heading, 1, -1
    return state
