"""Setup of planners whose bodies move on a lattice."""

import numpy as np

from vitruvius.agent.avoidance import air, clearance
from vitruvius.agent.planner.core.config import PlannerConfig
from vitruvius.agent.planner.lattice.step import lead_kernel, step_kernel
from vitruvius.agent.planner.mapping.visibility import fan
from vitruvius.agent.planner.setup import Setup, body_model, common_arrays
from vitruvius.sim.config import Config
from vitruvius.sim.runtime import Array, start, ti


def lattice_setup(world: Config, config: PlannerConfig, count: int, prior: bool, led: bool) -> Setup:
    """Set up planners of ``count`` environments: see ``Planner``."""
    side = max(world.body)
    step = max(1, round(4 * world.step / side))
    cell = 2 * world.step / step
    angles = world.ray_angles
    turned = angles + np.pi / 4 * np.arange(8)[:, None]
    directions = np.stack([np.cos(turned), -np.sin(turned)], axis=-1) * world.range / cell
    clear = clearance(angles, side, world.step, air(world)) / world.range
    starts, skips, cells = fan(config, angles, world.range / cell)
    errs = (world.most("noise") > 0 or world.most("slip") > 0) and not world.in_cells
    body = body_model(world, cell, step, errs=errs, prior=prior, led=led)
    arrays = common_arrays(world, config, count, body) | {
        "action": Array(ti.i64, count),
        "advice": Array(ti.i64, count),
        "goals": Array(ti.i32, 3 * count),
        "directions": Array.of(directions.astype(np.float32).ravel()),
        "clear": Array.of(clear.astype(np.float32).ravel()),
        "starts": Array.of(starts.ravel()),
        "skips": Array.of(skips.ravel()),
        "fan": Array.of(cells),
    }
    program = start()
    lead = lead_kernel(program, config, body) if led else None
    return Setup(cell, body, arrays, "action", step_kernel(program, config, body), lead)
