"""Cells, arrays and kernels of planners, which depend on the kind of body."""

from typing import Any, NamedTuple

import numpy as np

from vitruvius.agent.planner.core.body import BodyModel
from vitruvius.agent.planner.core.config import PlannerConfig
from vitruvius.agent.planner.core.state import SIZE
from vitruvius.agent.planner.mapping.occupancy import MAX_STEP, TILE, number_type
from vitruvius.agent.planner.mapping.visibility import FINE
from vitruvius.agent.planner.paths import UNREACHED
from vitruvius.agent.planner.viewpoints.choice import views
from vitruvius.agent.planner.viewpoints.reachability import UNKNOWN, WORDS
from vitruvius.sim.config import Config
from vitruvius.sim.runtime import Array, ti


class Setup(NamedTuple):
    """Parts of a ``Planner`` that depend on the kind of its bodies."""

    cell: float
    """Side of a map's cell, metres."""

    body: BodyModel
    arrays: dict[str, Array]

    moved: str
    """Name of the array with what the bodies did: their actions, or their poses."""

    step: Any
    """Kernel of a step."""

    lead: Any = None
    """Kernel that gives viewpoints; None if planners choose theirs."""

    kept: tuple[str, ...] = ()
    """Names of arrays that the next steps depend on, besides those of all planners."""


def require_time(world: Config) -> None:
    """Raise ``ValueError`` for episodes with more steps than a cell can store."""
    if world.steps > MAX_STEP - 2:
        raise ValueError(f"planners support episodes of up to {MAX_STEP - 2:,} steps, not {world.steps:,}")


def body_model(world: Config, cell: float, step: int, *, errs: bool, prior: bool, led: bool) -> BodyModel:
    """Return the model of a body whose step is ``step`` half cells long, on cells of ``cell`` metres."""
    return BodyModel(
        rays=world.rays,
        columns=world.columns,
        step=step,
        touching=world.in_cells,
        target=world.target / 2 / cell,
        ray_range=FINE * world.range / cell,
        noise=world.noise / cell,
        dropout=world.dropout > 0,
        slip=world.most("slip") > 0 and not world.drives,  # a body that drives knows its pose
        eighth=0 if world.drives else world.rays_in_a_turn,
        errs=errs,
        prior=prior,
        led=led,
        drives=world.drives,
    )


def common_arrays(world: Config, config: PlannerConfig, count: int, body: BodyModel) -> dict[str, Array]:
    """Return the arrays of all planners of ``count`` environments: what they are given and what they keep."""
    rays, area = world.rays, count << 2 * config.map_bits
    return {
        "observation": Array(ti.f32, count * rays * world.channels),
        "blocked": Array(ti.u8, count),
        "begun": Array(ti.u8, count),
        "views": Array.of(views(config)),
        "cells": Array(ti.u16, area),
        "distance": Array.of(np.full(area, UNREACHED, np.uint16)),
        "queue": Array(number_type(config), area),
        "dirty": Array(ti.u8, area >> 2 * TILE),
        "reached": Array(ti.i32, count * rays),
        "tiles": Array(ti.u64, WORDS * area >> 2 * TILE),
        "odds": Array.of(np.full(area >> 2, UNKNOWN, np.uint8)),
        "candidates": Array(ti.u8, area >> 2),
        "gains": Array(ti.u16, area // config.viewpoint_pitch**2),
        "evidence": Array(ti.u8, area if body.errs else 1),
        "last": Array(ti.f32, count * rays if body.slip else 1),
        "prior": Array(ti.u16, area >> 2 if body.prior else 1),
        "states": Array(ti.i32, count * SIZE),
    }
