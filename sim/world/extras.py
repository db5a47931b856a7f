"""Writer of the parts of an observation other than rays, which ``sim.parts`` lists."""

from typing import Any

import numpy as np

from vitruvius.sim.actions import ACTIONS, FORWARD, LEFT
from vitruvius.sim.config import Config
from vitruvius.sim.parts import MEMORY
from vitruvius.sim.runtime import ti
from vitruvius.sim.world.philox import ODOMETER, normal, philox
from vitruvius.sim.world.surroundings import Surroundings
from vitruvius.sim.world.varying import Varying


@ti.data_oriented
class Extras:
    """Writer of the parts of an observation that ``Config.observe`` names."""

    def __init__(self, config: Config, body: Any, varying: Varying, surroundings: Surroundings) -> None:
        """Take a configuration, the body of its backend, and the functions that look up the body's room."""
        self.config, self.body, self.varying, self.surroundings = config, body, varying, surroundings

    @ti.func
    def notice(self, world: ti.template(), e, state, action, blocked):
        """Write the parts of an observation other than rays after an action; see ``Config.observe``.

        ``action`` is -1 at the start of an episode. Speeds are read from the body's state, whatever the
        action.
        """
        at = e * ti.static(self.config.extra_numbers)
        if ti.static("bump" in self.config.observe):
            world.extras[at + ti.static(self.config.extra("bump"))] = ti.cast(blocked, ti.f32)
        if ti.static("last_action" in self.config.observe):
            for k in ti.static(range(ACTIONS)):
                world.extras[at + ti.static(self.config.extra("last_action") + k)] = ti.select(
                    action == k, 1.0, 0.0
                )
        if ti.static("odometry" in self.config.observe):
            pose = self.odometer(world, e, state, action, blocked)
            first = at + ti.static(self.config.extra("odometry"))
            world.extras[first], world.extras[first + 1] = pose[0], pose[1]
            world.extras[first + 2], world.extras[first + 3] = ti.cos(pose[2]), ti.sin(pose[2])
        if ti.static("goal" in self.config.observe):
            heading = self.body.heading(state.cell)
            away = state.target - self.body.eye(state.origin, state.cell)
            cosine, sine = ti.cos(heading), ti.sin(heading)
            first = at + ti.static(self.config.extra("goal"))
            world.extras[first] = away[0] * cosine - away[1] * sine
            world.extras[first + 1] = -away[0] * sine - away[1] * cosine
        if ti.static("speed" in self.config.observe):
            first = at + ti.static(self.config.extra("speed"))
            for k in ti.static(range(len(self.config.drive.low))):
                world.extras[first + k] = state.speeds[k]
        if ti.static(MEMORY in self.config.observe):
            first = at + ti.static(self.config.extra(MEMORY))
            for k in ti.static(range(self.config.memory)):
                world.extras[first + k] = world.memory[e * ti.static(self.config.memory) + k]
        self.notice_distance(world, e)

    @ti.func
    def notice_distance(self, world: ti.template(), e):
        """Write the distance to the target."""
        if ti.static("geodesic" in self.config.observe):
            at = e * ti.static(self.config.extra_numbers) + ti.static(self.config.extra("geodesic"))
            world.extras[at] = ti.cast(world.distance[e], ti.f32)

    @ti.func
    def odometer(self, world: ti.template(), e, state, action, blocked):
        """Return the pose that the body estimates itself: metres forward and left of the start, and radians.

        The estimate is the sum of the body's unblocked moves with their errors.
        """
        pose = world.odometer[e]
        if action < 0:
            pose = ti.Vector([0.0, 0.0, 0.0, 0.0])
        elif ti.static(self.config.drives) or not blocked:
            share = 1.0
            if ti.static(self.config.most("drift") > 0):
                counter = ti.Vector([state.episode, state.time, 0, ODOMETER])
                words = philox(state.seed, ti.cast(counter, ti.u64))
                share += self.varying.value(state, "drift") * normal(words)
            if ti.static(self.config.drives):
                speeds = ti.static(self.config.drive.time_step) * share * state.speeds
                turn = speeds[ti.static(len(self.config.drive.low) - 1)]
                cosine, sine = ti.cos(pose[2] + 0.5 * turn), ti.sin(pose[2] + 0.5 * turn)
                pose[0] += speeds[0] * cosine
                pose[1] += speeds[0] * sine
                if ti.static(self.config.drive.sideways > 0):
                    pose[0] -= speeds[1] * sine
                    pose[1] += speeds[1] * cosine
                pose[2] += turn
            elif action == FORWARD:
                long = ti.static(self.config.step) * ti.select(state.cell[2] & 1, ti.static(2**0.5), 1.0)
                pose[0] += share * long * ti.cos(pose[2])
                pose[1] += share * long * ti.sin(pose[2])
            else:
                pose[2] += share * ti.select(action == LEFT, ti.static(np.pi / 4), ti.static(-np.pi / 4))
        world.odometer[e] = pose
        return pose
