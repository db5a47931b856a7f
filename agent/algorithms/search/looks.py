"""Visible targets of each view of a window, by rays cast over the map and over the predictions.

This is geometry alone, as are the lengths of paths: the network learns what it is worth.
"""

from functools import cache
from typing import Any

import numpy as np
import torch
from torch import Tensor

from vitruvius.agent.algorithms.search.network import expected
from vitruvius.agent.algorithms.search.windows import HEADINGS, PLACES, ViewMaps
from vitruvius.agent.planner.core.arrays import PlannerArrays, PlannerTables
from vitruvius.agent.planner.core.body import BodyModel
from vitruvius.agent.planner.core.config import PlannerConfig
from vitruvius.agent.planner.mapping.occupancy import FLAGS, OCCUPIED, SOLID, Occupancy
from vitruvius.sim.runtime import Array, Floats, Ints, Launch, Shorts, kernel, start, ti

BLOCKS = 2 * PLACES

UNREACHED = (1 << 16) - 1
"""Distance of places to which no path is known."""

MIN_REACH_PROBABILITY = 0.02
"""Probability of getting so far below which a ray is not followed."""


class ViewLooks:
    """Caster of rays over the maps of E planners."""

    def __init__(self, arrays: dict[str, Array], config: PlannerConfig, body: BodyModel, count: int) -> None:
        """Cast rays with ``arrays``: a planner's, and those of a reader of its maps."""
        self.arrays = arrays | {
            "dense": Array(ti.f32, count * BLOCKS**2),
            "passes": Array(ti.f32, count * BLOCKS**2),
            "shown": Array(ti.f32, count * HEADINGS * PLACES**2),
        }
        self._look = Launch(_kernel(start(), config, body), self.arrays)

    def __call__(self, maps: ViewMaps) -> Tensor:
        """Return what each octant shows from the places, (n, 8, G, G) float16.

        Values are fractions of all targets that are expected in the window. The windows are those that the
        reader read last.
        """
        dense, passes = expected(maps)
        count = len(dense)
        for name, field in (("dense", dense), ("passes", passes)):
            self.arrays[name].view()[: field.numel()] = field.flatten().numpy()
        self._look()
        shape = count, HEADINGS, PLACES, PLACES
        shown = torch.from_numpy(self.arrays["shown"].view()[: np.prod(shape)].reshape(shape))
        total = dense.sum((1, 2)).clamp(min=1e-6)
        return (shown / total[:, None, None, None]).clamp(max=1.0).half()


@cache
def _kernel(program: Any, config: PlannerConfig, body: BodyModel) -> Any:
    """Return the kernel for a running Taichi.

    The kernel's arguments have the names of the planner's arrays.
    """
    occupancy = Occupancy(config, body.step, body.touching, body.errs)
    rays, ends, pitch = config.viewpoint_rays, config.view_range // config.view_stride, config.viewpoint_pitch
    # Blocks that a place on a ray stands for: it is as wide as the gap between rays there.
    weight = config.view_stride**2 * np.pi / 4 / rays / 4

    @ti.func
    def sight(memory: ti.template(), tables: ti.template(), dense: ti.template(), passes: ti.template(), base,
              first, node, cy, cx, octant):  # fmt: skip
        """Return the density of targets that is expected in an octant of a view."""
        gain = 0.0
        for ray in range(rays):
            j, k, reaches = ends * (rays * octant + ray), 0, 1.0
            while (k < ends) & (reaches >= MIN_REACH_PROBABILITY):
                there = occupancy.beside(node, tables.views[j + k])
                k += 1
                cell = ti.cast(memory.cells[base + there], ti.i32)
                # On the torus, places before the window lie far behind it.
                south = ((occupancy.down(there) - cy + 2) & ti.static(occupancy.mask)) >> 1
                east = ((occupancy.across(there) - cx + 2) & ti.static(occupancy.mask)) >> 1
                if (cell & (OCCUPIED | SOLID) != 0) | (ti.max(south, east) >= ti.static(BLOCKS)):
                    reaches = 0.0
                else:
                    at = first + south * ti.static(BLOCKS) + east
                    gain += reaches * ti.cast(k, ti.f32) * dense[at]
                    if cell < 1 << FLAGS:
                        reaches *= passes[at]
        return gain * weight

    @kernel
    def look(
        asked: Ints, corners: Ints, ways: Shorts, here: Ints, dense: Floats, passes: Floats, shown: Floats,
        memory: PlannerArrays, tables: PlannerTables,
    ):  # fmt: skip
        ti.loop_config(block_dim=1)
        for n in range(asked.shape[0]):
            e = asked[n]
            if e >= 0:
                base, cy, cx = e * occupancy.area, corners[2 * n], corners[2 * n + 1]
                for k in range(ti.static(PLACES * PLACES)):
                    way = ti.cast(ways[n * ti.static(PLACES * PLACES) + k], ti.i32)
                    node = occupancy.at(
                        cx + pitch * (k % ti.static(PLACES)), cy + pitch * (k // ti.static(PLACES))
                    )
                    if k == ti.static(PLACES // 2 * PLACES + PLACES // 2):
                        node = here[n]
                    for octant in range(HEADINGS):
                        gain = 0.0
                        if way != UNREACHED:
                            gain = sight(
                                memory, tables, dense, passes, base, n * ti.static(BLOCKS * BLOCKS), node, cy,
                                cx, octant,
                            )  # fmt: skip
                        shown[(n * HEADINGS + octant) * ti.static(PLACES * PLACES) + k] = gain

    return look
