"""Episodes, targets and rewards of one environment, as functions of its state.

The backend defines how bodies move and what they see. Every random number is Philox's word for (seed of the
environment, episode, counter): counter 0 gives the episode's house and start, counter k its k-th target.
Therefore random numbers do not depend on the number of environments or on the resets of others. Targets do
not depend on the agent either.
"""

from typing import Any, cast

from vitruvius.sim.backends.backend import Backend
from vitruvius.sim.backends.targets import OtherTargets
from vitruvius.sim.runtime import ti
from vitruvius.sim.tasks.terms import now_of
from vitruvius.sim.world.distance_field import NOT_YET, look_up
from vitruvius.sim.world.extras import Extras
from vitruvius.sim.world.kind import WorldKind
from vitruvius.sim.world.observing import Observing
from vitruvius.sim.world.philox import EPISODE, WHEELS, below, philox, uniform
from vitruvius.sim.world.place_table import HEADER
from vitruvius.sim.world.surroundings import Surroundings
from vitruvius.sim.world.varying import Varying

TRIES = 32
"""Largest number of samples for a place with a minimum distance to another; the last sample is accepted as it
is."""


@ti.data_oriented
class Episodes(Observing):
    """Step and reset of one environment, for a configuration and a backend."""

    def __init__(self, kind: WorldKind, backend: Backend, lanes: int) -> None:
        """Compile episodes of a kind of world. ``lanes``: number of rays that are cast together."""
        config, at_once = kind.config, kind.at_once
        self.kind, self.Arrays = kind, kind.arrays
        self.config, self.backend, self.body = config, cast(Any, backend), cast(Any, backend.body)
        self.overlays = tuple(make(config, backend.body, lanes) for make in kind.overlays)
        self.varying = Varying(config)
        self.surroundings = Surroundings(backend.body)
        self.extras = Extras(config, backend.body, self.varying, self.surroundings)
        self.ends_on_pick_up, self.terms = kind.ends_on_pick_up, kind.terms
        self.Now = now_of(kind.terms.memory)
        self.knows_distance, self.at_once = kind.knows_distance, at_once
        if at_once > 1:
            self.others = OtherTargets(config, backend.body, lanes, at_once - 1)
        # A body that picked up a target cannot also touch the next target beyond this distance. With several
        # targets, the agent chooses which one it picks up, and no target may depend on the agent.
        self.apart = config.target + max(config.body) if at_once == 1 else -1.0

    @ti.func
    def advance(self, world: ti.template(), e, state, action):
        """Move the body and the episode by one step, without sight.

        Returns the state, the reward (f32), and picked up, terminated, truncated, blocked (i32).
        """
        # move
        moved, blocked, met = self.move(world, e, state, action)
        if ti.static(self.config.most("slip") > 0):
            counter = ti.Vector([state.episode, state.time, 0, WHEELS])
            words = philox(state.seed, ti.cast(counter, ti.u64))
            if uniform(words[0]) < self.varying.value(state, "slip"):
                moved, blocked = state, 0
                for k in ti.static(range(len(self.overlays))):
                    met[k] = -1
        self.push(world, e, state, met)
        bumped = self.bumped(world, state, moved, blocked, met)
        terminated = 0
        if ti.static(self.config.ends_on_collision):
            terminated = blocked
        elif blocked and ti.static(not self.config.drives):
            moved.origin, moved.cell = state.origin, state.cell
        # pick up
        picked, state = self.pick_up(world, e, moved)
        if ti.static(self.ends_on_pick_up):
            terminated |= picked
        state.time += 1
        # reward
        before, distance = -1, -1
        if ti.static(self.knows_distance):
            before, distance = world.distance[e], 0
            if not picked:
                distance = look_up(world, e, state.cell)
            world.distance[e] = distance
        now = self.now(world, e, state, action, picked, blocked, before, distance, bumped)
        earned = self.terms.reward(now)
        terminated |= self.terms.ends(now)
        if ti.static(self.terms.targets > 0):
            terminated |= picked & ti.cast(now.found >= ti.static(self.terms.targets), ti.i32)
        # end
        truncated = ti.cast(state.time >= world.limit[0], ti.i32)
        state.over = terminated | truncated
        if picked:
            if state.over:
                state.found += (
                    1  # The target stays, because the last observation and the info show the reached target.
                )
            else:
                state = self.sample_target(world, state, ti.static(self.apart))
                distance = self.aim(world, e, state)
        if ti.static(self.terms.progress != 0):
            # ``settle`` subtracts a distance that is not known yet.
            left = ti.select(terminated, 0, ti.max(0, distance))
            earned += self.progress(ti.cast(ti.max(0, before), ti.f32), ti.cast(left, ti.f32))
        return state, earned, picked, terminated, truncated, blocked

    @ti.func
    def bumped(self, world: ti.template(), state, moved, blocked, met):
        """Return the code of the obstacle in the way of a blocked body, if terms read it: see ``Now``."""
        bumped = -1
        if ti.static(self.terms.sees_bumped):
            bumped = 0
            if blocked:
                bumped = self.surroundings.bumped(
                    world.surroundings,
                    state.house,
                    state.origin,
                    state.cell,
                    moved.origin,
                    moved.cell,
                    self.varying.value(state, "width"),
                )
                for k, overlay in ti.static(enumerate(self.overlays)):
                    if met[k] >= 0:
                        bumped = overlay.KIND
        return bumped

    @ti.func
    def pick_up(self, world: ti.template(), e, state):
        """Return 1 if the body overlaps a target (i32), and the state with that target as the current one."""
        picked = self.overlaps(state.origin, state.cell, state.target)
        width = self.varying.value(state, "width")
        if ti.static(self.config.varies("width")):
            half = ti.static(self.config.target / 2)
            picked = self.body.overlaps_with(state.origin, state.cell, state.target, half, width)
        if ti.static(self.at_once > 1):
            other = self.others.met(world.others, e, state.origin, state.cell, width)
            if not picked and other >= 0:
                picked, target = 1, self.others.centre(world.others, e, other)
                self.others.put(world.others, e, other, state.target)
                state.target = target
        return picked, state

    @ti.func
    def progress(self, before, after):
        """Return the reward of a step between two distances to the target, in actions (f32)."""
        return ti.static(float(self.terms.progress)) * (
            before - ti.static(float(self.terms.discount)) * after
        )

    @ti.func
    def aim(self, world: ti.template(), e, state):
        """Look up the field of a new target, if it exists yet.

        Return the distance to the target, or ``NOT_YET``.
        """
        distance = NOT_YET
        if ti.static(self.knows_distance):
            corner, step = self.point(world, 1 + HEADER * state.house), ti.static(self.config.step)
            place = ti.cast(ti.round((state.target - corner) / step), ti.i32)
            slot, field = -1, ti.Vector([-1, 0, 0, 0, -1, 0])
            whole = corner + ti.cast(place, ti.f32) * step == state.target
            header = 3 * state.house
            columns, rows = world.slots[header + 1], world.slots[header + 2]
            is_within = 0 <= place[0] < columns and 0 <= place[1] < rows  # a user's target may lie anywhere
            if whole.all() and is_within and (state.origin == corner).all():
                slot = world.slots[world.slots[header] + place[0] * rows + place[1]]
            if slot >= 0:
                field = world.known[slot]
            world.fields[e] = field
            if slot >= 0:
                distance = look_up(world, e, state.cell)
            else:
                world.pending[0] = 1
            world.distance[e] = distance
        return distance

    @ti.func
    def now(self, world: ti.template(), e, state, action, picked, blocked, before, distance, bumped):
        """Return the data of a step for terms (``Now``), and update their memory."""
        now = self.Now()
        now.action, now.picked, now.blocked = self.body.number(action), picked, blocked
        now.time, now.house = state.time, state.house
        now.found = state.found - ti.static(self.at_once) + picked
        now.eye = self.body.eye(state.origin, state.cell)
        now.heading, now.target = self.body.eighth(state.cell), state.target
        now.before, now.distance, now.bumped = before, distance, bumped
        now.room, now.mark, now.marked = -1, 0, 0
        if ti.static(self.terms.sees_room):
            now.room, now.mark, now.marked = self.surroundings.room(
                world.surroundings, world.rooms, e, state.house, now.eye
            )
        if ti.static(self.terms.memory > 0):
            first = e * ti.static(self.terms.memory)
            for k in ti.static(range(self.terms.memory)):
                now.was[k] = world.memory[first + k]
            now.memory = now.was
            now.memory = self.terms.remember(now)
            for k in ti.static(range(self.terms.memory)):
                world.memory[first + k] = now.memory[k]
        return now

    @ti.func
    def move(self, world: ti.template(), e, state, action):
        """Return the result of an action without any change of the arrays.

        The result is the state with the new pose, 1 if something blocks the way (i32), and for each overlay
        the thing that the body meets, -1 for none.
        """
        moved, blocked = state, 0
        met = ti.Vector([-1 for _ in range(ti.static(max(1, len(self.overlays))))])
        if ti.static(self.config.drives):
            shares = ti.Vector([1.0, 1.0, 1.0])
            if ti.static(self.config.varies("speed", "acceleration", "width")):
                shares = ti.Vector([
                    self.varying.value(state, "speed"), self.varying.value(state, "acceleration"),
                    self.varying.value(state, "width"),
                ])  # fmt: skip
            origin, cell, speeds, blocked = self.backend.drive(
                world.numbers,
                world.indices,
                state.house,
                state.origin,
                state.cell,
                state.speeds,
                action,
                shares,
            )
            moved.origin, moved.cell, moved.speeds = origin, cell, speeds
        elif ti.static(self.config.varies("width")):
            width = self.varying.value(state, "width")
            moved.cell, blocked = self.backend.move_with(
                world.numbers, world.indices, state.house, state.origin, state.cell, action, width
            )
        else:
            moved.cell, blocked = self.backend.move(
                world.numbers, world.indices, state.house, state.origin, state.cell, action
            )
        for k, overlay in ti.static(enumerate(self.overlays)):
            moved, blocked, met[k] = overlay.cut(world, e, state, action, moved, blocked)
        return moved, blocked, met

    @ti.func
    def push(self, world: ti.template(), e, state, met):
        """Move the things of all overlays by a step; ``met`` has those that the body pushes, -1 for none."""
        for k, overlay in ti.static(enumerate(self.overlays)):
            overlay.advance(world, e, state, met[k])

    def overlay(self, kind: type) -> Any:
        """Return the overlay of a class, or ``None`` if this world has none of it."""
        return next((each for each in self.overlays if isinstance(each, kind)), None)

    @ti.func
    def begin(self, world: ti.template(), e, state, house):
        """Begin the next episode in the given house; a negative house means a sampled one."""
        state.episode += 1
        state.house = house
        if house < 0:
            state.house = below(self.random(state, 0, 0)[0], world.places[0])
        state.origin = self.point(world, 1 + HEADER * state.house)
        state.time, state.found, state.over = 0, 0, 0
        state = self.sample_target(world, state, -1.0)
        if ti.static(self.at_once > 1):
            target = state.target
            for k in range(ti.static(self.at_once - 1)):
                state = self.sample_target(world, state, -1.0)
                self.others.put(world.others, e, k, state.target)
            state.target = target
        state = self.sample_start(world, state)
        if ti.static(self.config.drives):
            for k in ti.static(range(len(self.config.drive.low))):
                state.speeds[k] = 0.0
        self.aim(world, e, state)
        self.lay(world, e, state)
        for k in ti.static(range(self.terms.memory)):
            world.memory[e * ti.static(self.terms.memory) + k] = 0.0
        return state

    @ti.func
    def point(self, world: ti.template(), at):
        """Return two float32 values of the table ``places``."""
        return ti.Vector([ti.bit_cast(world.places[at + k], ti.f32) for k in range(2)])

    @ti.func
    def lay(self, world: ti.template(), e, state):
        """Put the things of all overlays in their places at the beginning of an episode."""
        for overlay in ti.static(self.overlays):
            overlay.begin(world, e, state)

    @ti.func
    def sample_start(self, world: ti.template(), state):
        """Sample a start that is not on the first target."""
        at = 1 + HEADER * state.house
        first, count, given = world.places[at + 2], world.places[at + 3], world.places[at + 6]
        corner, turn, searching = state.origin, 0, 1
        while searching:
            turn += 1
            words = self.random(state, 0, turn)
            place = world.places[first + below(words[0], count)]
            state.origin, state.cell = self.body.begun(corner, place & 0xFFFF, place >> 16, words[1], given)
            on_target = self.overlaps(state.origin, state.cell, state.target)
            searching = on_target & ti.cast(turn < ti.static(TRIES), ti.i32)
        return state

    @ti.func
    def sample_target(self, world: ti.template(), state, apart):
        """Sample the next target, farther than ``apart`` metres from the last one along at least one axis."""
        state.found += 1
        at = 1 + HEADER * state.house
        first, count = world.places[at + 4], world.places[at + 5]
        if count < 0:
            stage = first + 2 * ((state.found - 1) % -count)
            first, count = world.places[stage], world.places[stage + 1]
        corner, last = self.point(world, at), state.target
        turn, searching = 0, 1
        while searching:
            turn += 1
            place = first + 2 * below(self.random(state, state.found, turn)[0], count)
            state.target = corner + self.point(world, place) * ti.static(self.config.step)
            near = ti.cast(ti.abs(state.target - last).max() < apart, ti.i32)
            searching = near & ti.cast(turn < ti.static(TRIES), ti.i32)
        return state

    @ti.func
    def following(self, world: ti.template(), e, state, k):
        """Return the state with target k + 1, counted over the present and the future targets."""
        is_there = k < ti.static(self.at_once - 1)
        if ti.static(self.at_once > 1):  # noqa: SIM102 - decided as it is compiled
            if is_there:
                state.target = self.others.centre(world.others, e, k)
        if not is_there:
            state = self.sample_target(world, state, ti.static(self.apart))
        return state

    @ti.func
    def random(self, state, counter, turn):
        """Return the random words of the episode for a counter and the number of the sampling attempt."""
        words = ti.Vector([state.episode, counter, turn, EPISODE])
        return philox(state.seed, ti.cast(words, ti.u64))

    @ti.func
    def overlaps(self, origin, cell, target):
        """Return 1 if the body overlaps a target's square (i32); touching is not overlapping."""
        return self.body.overlaps(origin, cell, target, ti.static(self.config.target / 2))
