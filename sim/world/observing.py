"""Observations: rays, their sensor with its errors and latency, and the other parts."""

import math
from typing import Any

from vitruvius.sim.backends.backend import NAMED, PIECE, TARGET, WALL
from vitruvius.sim.backends.targets import OtherTargets
from vitruvius.sim.config import DEVIATIONS, Config
from vitruvius.sim.runtime import ti
from vitruvius.sim.world.arrays import HEADING
from vitruvius.sim.world.extras import Extras
from vitruvius.sim.world.philox import DIRECTION, SENSOR, normal, philox, uniform
from vitruvius.sim.world.varying import Varying


@ti.data_oriented
class Observing:
    """Observation of one environment, computed from its state."""

    config: Config
    backend: Any
    body: Any
    overlays: tuple[Any, ...]
    others: OtherTargets
    at_once: int
    varying: Varying
    extras: Extras

    @ti.func
    def notice(self, world: ti.template(), e, state, action, blocked):
        """Write the parts of an observation other than rays after an action; -1 at the start of an episode.

        With latency, also record the places of the body and its target, which are observed later.
        """
        self.extras.notice(world, e, state, action, blocked)
        if ti.static(self.config.latency > 0):
            kept = ti.static(self.config.latency + 1)
            for k in range(kept):
                if action < 0 or k == state.time % kept:
                    origin, target = state.origin, state.target
                    if ti.static(self.config.drives):
                        here = ti.Vector([origin[0], origin[1], target[0], target[1], state.cell])
                        world.past_reals[e * kept + k] = here
                    else:
                        here = ti.Vector([origin[0], origin[1], target[0], target[1]])
                        world.past_reals[e * kept + k] = here
                        world.past_cells[e * kept + k] = state.cell

    @ti.func
    def late(self, world: ti.template(), e, state):
        """Return the state with the observed places of the body and the target.

        With latency, the observed places are earlier ones.
        """
        if ti.static(self.config.latency > 0):
            kept = ti.static(self.config.latency + 1)
            at = e * kept + (state.time + 1) % kept
            where = world.past_reals[at]
            state.origin, state.target = ti.Vector([where[0], where[1]]), ti.Vector([where[2], where[3]])
            if ti.static(self.config.drives):
                state.cell = where[ti.static(HEADING)]
            else:
                state.cell = world.past_cells[at]
        return state

    @ti.func
    def look(self, world: ti.template(), e, now, ray, lanes: ti.template(), observation: ti.template()):
        """Write the values of ``lanes`` rays, from number ``ray`` on, as in ``Config.columns``.

        The angle is in units of 359 degrees, and the distance in units of the range.
        """
        state = self.late(world, e, now)
        distance, kind = self.seen(world, e, state, ray, lanes)
        for overlay in ti.static(self.overlays):
            overlay.hide(world, e, state, ray, distance, kind)
        if ti.static(self.config.most("noise") > 0 or self.config.most("dropout") > 0):
            noise, dropout = self.varying.value(state, "noise"), self.varying.value(state, "dropout")
            for r in range(ti.static(lanes)):
                distance[r], kind[r] = self.disturbed(state, ray + r, distance[r], kind[r], noise, dropout)
        at = e * ti.static(self.config.rays) + ray
        if ti.static(self.config.channels == 2):
            # Both columns of a ray are written as one number of 64 bits. Rows of such numbers are stored by
            # vector instructions; two float32 in turn would be scattered.
            pairs = ti.Vector([ti.u64(0) for _ in range(ti.static(lanes))])
            for r in range(ti.static(lanes)):
                first = ti.bit_cast(distance[r] * ti.static(1 / self.config.range), ti.u32)
                second = ti.bit_cast(ti.select(kind[r] == TARGET, 1.0, 0.0), ti.u32)
                pairs[r] = ti.cast(first, ti.u64) | (ti.cast(second, ti.u64) << ti.u64(32))
            for r in range(ti.static(lanes)):
                observation[at + r] = pairs[r]
        else:
            for r in range(ti.static(lanes)):
                to = (at + r) * ti.static(self.config.channels)
                if ti.static(self.config.sees_angle):
                    angle = self.body.degrees(state.cell) + ti.static(self.config.first_ray)
                    angle -= ti.static(self.config.ray_spacing) * (ray + r)
                    turned = angle - 360.0 * ti.floor(angle / 360.0)
                    self.write(observation, to, "angle", turned / 359.0)
                if ti.static(self.config.kinds):
                    first = to + ti.static(self.config.column("distance") - len(self.config.kinds))
                    for place in range(ti.static(len(self.config.kinds))):
                        named = ti.cast(kind[r], ti.i32) == NAMED + place
                        observation[first + place] = ti.select(named, 1.0, 0.0)
                self.write(observation, to, "distance", distance[r] * ti.static(1 / self.config.range))
                if ti.static(self.config.sees_kind):
                    is_piece = (kind[r] == PIECE) | (kind[r] >= NAMED)
                    self.write(observation, to, "is wall", ti.select(kind[r] == WALL, 1.0, 0.0))
                    self.write(observation, to, "is piece", ti.select(is_piece, 1.0, 0.0))
                for overlay in ti.static(self.overlays):
                    if ti.static(overlay.COLUMN in self.config.columns):
                        is_thing = kind[r] == ti.static(overlay.KIND)
                        self.write(observation, to, overlay.COLUMN, ti.select(is_thing, 1.0, 0.0))
                self.write(observation, to, "is target", ti.select(kind[r] == TARGET, 1.0, 0.0))

    @ti.func
    def seen(self, world: ti.template(), e, state, ray, lanes: ti.template()):
        """Return the distances and kinds of ``lanes`` rays, with errors of their directions.

        The results are those of ``Backend.see``.
        """
        off = ti.Vector([0.0 for _ in range(ti.static(lanes))])
        if ti.static(self.config.angle_noise > 0):
            for r in range(ti.static(lanes)):
                counter = ti.Vector([state.episode, state.time, ray + r, DIRECTION])
                error = normal(philox(state.seed, ti.cast(counter, ti.u64)))
                cut = ti.max(-ti.static(DEVIATIONS), ti.min(ti.static(DEVIATIONS), error))
                off[r] = ti.static(math.radians(self.config.angle_noise)) * cut
        distance, kind = self.nearest(world, state, ray, off)
        if ti.static(self.at_once > 1):
            self.others.show(world.others, e, state.origin, state.cell, ray, off, distance, kind)
        return distance, kind

    @ti.func
    def nearest(self, world: ti.template(), state, ray, off: ti.template()):
        """Return the distances and kinds of rays, for a house and its first target."""
        if ti.static(self.config.angle_noise > 0):
            return self.backend.look(
                world.numbers, world.indices, state.house, state.origin, state.cell, state.target, ray, off
            )
        return self.backend.see(
            world.numbers, world.indices, state.house, state.origin, state.cell, state.target, ray
        )

    @ti.func
    def write(self, observation: ti.template(), ray, column: ti.template(), number):
        """Write a number into a column of a ray: see ``Config.columns``."""
        observation[ray + ti.static(self.config.column(column))] = number

    @ti.func
    def disturbed(self, state, ray, distance, kind, noise, dropout):
        """Apply the sensor's errors to a ray: a normal error of the distance, or no hit at all."""
        counter = ti.Vector([state.episode, state.time, ray, SENSOR])
        words = philox(state.seed, ti.cast(counter, ti.u64))
        if ti.static(self.config.most("noise") > 0):
            distance += noise * normal(words)
            distance = ti.max(0.0, ti.min(ti.static(self.config.range), distance))
        if uniform(words[2]) < dropout:
            distance, kind = ti.static(self.config.range), ti.u32(0)
        return distance, kind
