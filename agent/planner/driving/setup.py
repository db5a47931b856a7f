"""Setup of planners whose bodies drive, in the backend ``free``."""

import math

from vitruvius.agent.planner.core.config import PlannerConfig
from vitruvius.agent.planner.driving.step import driving_kernel
from vitruvius.agent.planner.driving.sweep import rays_of
from vitruvius.agent.planner.setup import Setup, body_model, common_arrays
from vitruvius.sim.config import Config
from vitruvius.sim.runtime import Array, start, ti

MAX_SPACING_DEG, MIN_FAN_DEG = 15.0, 90.0
"""Largest angle between neighbouring rays, and smallest angle from the first to the last ray, degrees."""


def driving_setup(world: Config, config: PlannerConfig, count: int, prior: bool, led: bool) -> Setup:
    """Set up planners of ``count`` environments: see ``Planner``.

    Raises ``ValueError`` for rays that do not look ahead, are few or late, or have an error in their
    direction, and for planners that are ``led``.
    """
    require_rays(world)
    world.drive.require_heading("a planner")
    if led:
        raise ValueError("planners of bodies that drive choose their viewpoints: they cannot be led")
    cell = world.body[0] / 2
    travel = world.drive.travel / cell
    errs = world.noise > 0 or world.dropout > 0
    body = body_model(world, cell, max(1, round(2 * travel)), errs=errs, prior=prior, led=led)
    arrays = common_arrays(world, config, count, body) | {
        "pose": Array(ti.f32, 3 * count),
        "start": Array(ti.f32, 2 * count),
        "place": Array(ti.f32, 2 * count),
        "advice": Array(ti.f32, 2 * count),
        "rays": Array.of(rays_of(world.ray_angles).ravel()),
    }
    step = driving_kernel(start(), config, body, cell, travel, math.radians(world.ray_spacing))
    return Setup(cell, body, arrays, "pose", step, kept=("start", "place"))


def require_rays(world: Config) -> None:
    """Raise ``ValueError`` for rays from which a planner of a body that drives cannot keep its map."""
    first, spacing = world.first_ray, world.ray_spacing
    last = first - spacing * (world.rays - 1)
    half = MIN_FAN_DEG / 2
    for wrong, words in (
        (spacing > MAX_SPACING_DEG, f"rays at most {MAX_SPACING_DEG:g} degrees apart, not {spacing:g}"),
        (not first >= half >= -half >= last, f"rays from {half:g} degrees left to {half:g} right at least"),
        (first - last > 360, "at most one full turn of rays"),
        (world.latency, f"current rays, not those of {world.latency} steps ago"),
        (world.angle_noise, "rays without angle_noise"),
    ):
        if wrong:
            raise ValueError(f"a planner that drives needs {words}")
