"""Part of a planner's map about the body, as a picture that an agent can read."""

from functools import cache
from typing import Any

import numpy as np
from torch import Tensor

from vitruvius.agent.planner.core.arrays import PlannerArrays
from vitruvius.agent.planner.core.body import BodyModel
from vitruvius.agent.planner.core.config import PlannerConfig
from vitruvius.agent.planner.core.state import SIZE, loaded
from vitruvius.agent.planner.mapping.occupancy import FLAGS, OCCUPIED, Occupancy
from vitruvius.agent.planner.planner import Planner
from vitruvius.sim.runtime import Array, Bytes, Ints, Launch, kernel, start, ti

LAYERS = TAKEN, SEEN, FRONTIER, AGE = range(4)
"""Layers of a window. ``TAKEN``: 255 where a cell is occupied. ``SEEN``: 255 where a cell was ever seen.
``FRONTIER``: 255 where a seen, free cell lies next to an unseen one. ``AGE``: steps since a cell was last
seen, 0 for now, 254 for an episode, 255 for never."""


class LocalMap:
    """Windows of ``side`` by ``side`` cells, cut out of E planners' maps.

    The body stands in the middle. By its nearest eighth of a turn it looks up, or halfway between up and
    left.
    """

    cells: Tensor
    """(E, 4, side, side) uint8: see ``LAYERS``. The same memory after every ``read``."""

    def __init__(self, planner: Planner, side: int) -> None:
        """Cut windows from this planner's maps.

        Raises ``ValueError`` for a side that is odd or larger than a map.
        """
        most, count = 1 << planner.config.map_bits, len(planner.advice)
        if side % 2 or not 2 <= side <= most:
            raise ValueError(f"a window is an even number of cells wide, 2 to {most}, not {side}")
        made = _kernel(start(), planner.config, planner.body, side, planner.world.steps)
        array = Array(ti.u8, count * len(LAYERS) * side**2)
        self._launch = Launch(made, planner.arrays | {"window": array})
        self.cells = array.tensor(np.uint8, (count, len(LAYERS), side, side))

    def read(self) -> Tensor:
        """Return the windows of the maps as they are now."""
        self._launch()
        return self.cells


@cache
def _kernel(program: Any, config: PlannerConfig, body: BodyModel, side: int, steps: int) -> Any:
    """Return the kernel for a running Taichi.

    The kernel's arguments have the names of the planner's arrays.
    """
    occupancy = Occupancy(config, body.step, body.touching, body.errs)

    @ti.func
    def when(cell):
        """Return the step at which a cell was last seen, 0 for never."""
        return (cell & ti.static(OCCUPIED - 1)) >> FLAGS

    @kernel
    def cut(memory: PlannerArrays, states: Ints, window: Bytes):
        for e, i in ti.ndrange(states.shape[0] // ti.static(SIZE), side):
            base, state = e * occupancy.area, loaded(states, e)
            up = occupancy.ahead(state.heading & 6)
            right = ti.Vector([-up[1], up[0]])
            for j in range(side):
                # Middle of a cell, half cells from the body's node: rows and columns lie between nodes.
                middle = up * (side - 1 - 2 * i) + right * (2 * j + 1 - side)
                x, y = (state.x >> 1) + ((middle[0] - 1) >> 1), (state.y >> 1) + ((middle[1] - 1) >> 1)
                cell = ti.cast(memory.cells[base + occupancy.at(x, y)], ti.i32)
                taken, known, edge, age = ti.cast(cell >= OCCUPIED, ti.i32), when(cell), 0, 255
                if known > 0:
                    for k in ti.static(range(4)):
                        beside = occupancy.at(x + (1, 0, -1, 0)[k], y + (0, 1, 0, -1)[k])
                        unseen = when(ti.cast(memory.cells[base + beside], ti.i32)) == 0
                        edge |= ti.cast(unseen, ti.i32) & (1 - taken)
                    age = ti.min(254, (state.time - known) * 254 // steps)
                layers = ti.Vector([255 * taken, 255 * ti.cast(known > 0, ti.i32), 255 * edge, age])
                for layer in ti.static(range(4)):
                    at = ((e * 4 + layer) * side + i) * side + j
                    window[at] = ti.cast(layers[layer], ti.u8)

    return cut
