"""Planners of bodies that drive, in the backend ``free``."""

import math

import numpy as np
from torch import Tensor

from vitruvius.agent.planner.core.body import BodyModel
from vitruvius.agent.planner.core.config import TUNED, PlannerConfig
from vitruvius.agent.planner.driving.step import driving_kernel
from vitruvius.agent.planner.driving.sweep import rays_of
from vitruvius.agent.planner.mapping.visibility import FINE
from vitruvius.agent.planner.planner import Planner, memory_arrays, require_time
from vitruvius.agent.planner.viewpoints.choice import views
from vitruvius.sim.config import Config
from vitruvius.sim.runtime import Array, Launch, start, ti

WIDEST, NARROWEST = 15.0, 90.0
"""Largest angle between neighbouring rays, and smallest angle from the first to the last ray, degrees."""


class DrivingPlanner(Planner):
    """Planners of E environments whose bodies drive: see ``Planner``.

    The planners get the bodies' poses. Their maps have the house's axes and begin where the body was.

    ``course`` (E, 2) float32 is their advice: the radians to turn to the left, and the distance in metres
    after which the body should stand, negative if it should not stop. The same memory after every step.
    """

    def __init__(
        self, world: Config, environments: int, config: PlannerConfig = TUNED, prior: bool = False
    ) -> None:
        """Make planners for E environments of the configuration ``world``. ``prior``: see ``Planner``.

        Raises ``ValueError`` for rays that do not look ahead, are few or late, or have an error in their
        direction.
        """
        require_time(world)
        require_rays(world)
        world.drive.require_heading("a planner")
        count, rays, drive = environments, world.rays, world.drive
        self.world, self.config, self.cell = world, config, world.body[0] / 2
        errs, travel = world.noise > 0 or world.dropout > 0, drive.travel / self.cell
        self.body = BodyModel(
            rays=rays,
            columns=world.columns,
            step=max(1, round(2 * travel)),
            touching=False,
            target=world.target / 2 / self.cell,
            ray_range=FINE * world.range / self.cell,
            noise=world.noise / self.cell,
            dropout=world.dropout > 0,
            slip=False,
            eighth=0,
            errs=errs,
            prior=prior,
            led=False,
            drives=True,
        )
        self.arrays = memory_arrays(config, count, rays, errs, prior, slips=False) | {
            "observation": Array(ti.f32, count * rays * world.channels),
            "blocked": Array(ti.u8, count),
            "begun": Array(ti.u8, count),
            "rays": Array.of(rays_of(world.ray_angles).ravel()),
            "views": Array.of(views(config)),
            "pose": Array(ti.f32, 3 * count),
            "start": Array(ti.f32, 2 * count),
            "place": Array(ti.f32, 2 * count),
            "course": Array(ti.f32, 2 * count),
        }
        spacing = math.radians(world.ray_spacing)
        made = driving_kernel(start(), config, self.body, self.cell, travel, spacing)
        self._launch, self._lead = Launch(made, self.arrays), None
        self._open(("observation", "blocked", "begun", "pose"))
        self.course = self.arrays["course"].tensor(np.float32, (count, 2))

    def drive(self, observation: Tensor, blocked: Tensor, begun: Tensor, pose: Tensor) -> None:
        """Take the result of the last actions.

        ``observation`` (E, R, C); ``blocked`` (E,) bool; ``pose`` (E, 3): x, y in metres, heading in radians.
        Where ``begun`` (E,) bool is true, an episode begins.
        """
        self._take(observation, blocked, begun, pose)


def require_rays(world: Config) -> None:
    """Raise ``ValueError`` for rays from which a planner of a body that drives cannot keep its map."""
    first, spacing = world.first_ray, world.ray_spacing
    last = first - spacing * (world.rays - 1)
    half = NARROWEST / 2
    for wrong, words in (
        (not world.drives, "a body of the backend free"),
        (spacing > WIDEST, f"rays at most {WIDEST:g} degrees apart, not {spacing:g}"),
        (not first >= half >= -half >= last, f"rays from {half:g} degrees left to {half:g} right at least"),
        (first - last > 360, "rays around once at most"),
        (world.latency, f"rays of now, not of {world.latency} steps ago"),
        (world.angle_noise, "rays whose directions have no error (angle_noise)"),
    ):
        if wrong:
            raise ValueError(f"a planner that drives needs {words}")
