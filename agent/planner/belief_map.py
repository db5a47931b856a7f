"""Map of a planner's belief about the target's place, for pictures: weights of places in its choice."""

from functools import cache
from typing import Any

import numpy as np

from vitruvius.agent.planner.core.arrays import PlannerArrays
from vitruvius.agent.planner.core.body import BodyModel
from vitruvius.agent.planner.core.config import PlannerConfig
from vitruvius.agent.planner.core.state import SIZE, loaded
from vitruvius.agent.planner.mapping.occupancy import FLAGS, Occupancy
from vitruvius.agent.planner.planner import Planner
from vitruvius.agent.planner.viewpoints.belief import Belief
from vitruvius.agent.planner.viewpoints.candidates import Candidates
from vitruvius.agent.planner.viewpoints.choice import TRIED
from vitruvius.agent.planner.viewpoints.reachability import SIDE, UNKNOWN
from vitruvius.sim.runtime import Array, Bytes, Ints, Launch, kernel, start, ti


class BeliefMap:
    """Reader of what planners believe. Reading changes nothing that the planners' next steps depend on."""

    def __init__(self, planner: Planner) -> None:
        self.side = 1 << planner.config.map_bits - 1  # blocks of two by two cells
        self.counts = Array(ti.u8, len(planner.advice) * self.side**2)
        kernel = _kernel(start(), planner.config, planner.body)
        self._launch = Launch(kernel, planner.arrays | {"counts": self.counts})

    def read(self, environment: int = 0) -> np.ndarray:
        """Return the weight of each block of two by two cells, (S / 2, S / 2) uint8, from 0 to ``CERTAIN``.

        Blocks lie south by east with the start in the middle. Floor that was seen before the last pick-up
        counts. Places never seen count by the probability that they are free floor. A block counts less in
        the start room, or outside it, if the pick-ups so far suggest that targets are rare there. A block
        counts 0 if a view has shown that no target is there.
        """
        self._launch()
        blocks = self.counts.view().reshape(-1, self.side, self.side)[environment]
        return np.roll(blocks, (self.side // 2, self.side // 2), axis=(0, 1))


@cache
def _kernel(program: Any, config: PlannerConfig, body: BodyModel) -> Any:
    """Return the kernel for a running Taichi.

    The kernel's arguments have the names of the planner's arrays.
    """
    occupancy = Occupancy(config, body.step, body.touching, body.errs)
    belief = Belief(config, occupancy, body.prior)
    parts = Candidates(config, occupancy, belief)

    @kernel
    def belief_map(memory: PlannerArrays, states: Ints, counts: Bytes):
        for e in range(states.shape[0] // ti.static(SIZE)):
            base, state = e * occupancy.area, loaded(states, e)
            room, shares = belief.start_room(memory, base), belief.shares(state.found_here, state.found)
            for tile, block in ti.ndrange(parts.field.number, SIDE * SIDE):
                node = parts.field.node(tile, block)
                x, y, i = occupancy.across(node), occupancy.down(node), parts.first(base) + parts.at(node)
                count, kept = 0, ti.cast(memory.odds[parts.field.of_tile(base, tile) + block], ti.i32)
                # Each choice computes the weights that are not kept. Without a choice, only seen floor has a
                # weight.
                known = (kept != UNKNOWN) | (memory.cells[base + node] >> FLAGS != 0)
                if (
                    known
                    and memory.candidates[i] & TRIED == 0
                    and occupancy.hides(memory, base, x, y, state.since)
                ):
                    count = ti.select(kept != UNKNOWN, kept, belief.odds(memory, base, x, y))
                share = ti.select(belief.within(room, x, y), shares[0], shares[1])
                counts[i] = ti.cast(ti.ceil(share * ti.cast(count, ti.f32)), ti.u8)

    return belief_map
