"""Occupancy map: the cells that rays have shown, the step of the last sight, and the occupied cells.

A cell is half a body wide. So a body that stands on a node, a corner of cells, covers exactly the four cells
about it. Cell and node (i, j) share a number. Its middle bits are the step at which the cell was last seen, 0
for never. The bit above the step is set if the cell is occupied. The bits below it are set if the node is
near to seen cells, and if it is solid (a body has no room there). So one comparison separates the cells that
are occupied or were seen since a step from all others.

Houses stand still, so with exact rays an occupied cell stays occupied. If rays or wheels err, a cell has a
count in place of its log-odds of being occupied. Rays that end in the cell raise the count, rays that pass
lower it. The map is a torus: it follows the body wherever an episode starts.
"""

from typing import Any

from vitruvius.agent.planner.core.config import PlannerConfig
from vitruvius.sim.actions import HEADINGS
from vitruvius.sim.runtime import ti

SOLID, NEAR, OCCUPIED = 1, 2, 1 << 15
"""Flags of a cell."""

FLAGS = 2
"""Number of flags below the step."""

MAX_STEP = (1 << 15 - FLAGS) - 1
"""Last step that a cell can store."""

TILE = 4
"""Exponent of a tile's side: tiles have 2^4 by 2^4 cells. A tile is dirty if its cells or nodes changed since
the last choice of a viewpoint."""


def number_type(config: PlannerConfig) -> Any:
    """Return the Taichi type that stores the number of a node."""
    return ti.u16 if config.map_bits == 8 else ti.i32


@ti.data_oriented
class Occupancy:
    """Torus of 2^bits by 2^bits cells (``map_bits``) for each environment; ``base`` is its first cell.

    If bodies fill the cells of a house on a grid (backend ``grid``), its walls are lines between cells, which
    a body may touch: ``touching``. Cells on both sides of a line count as occupied, as elsewhere, but only
    nodes on the line are solid.
    """

    def __init__(
        self,
        config: PlannerConfig,
        step: int = 1,
        touching: bool = False,
        noisy: bool = False,
    ) -> None:
        """Make a map for bodies that go ``step`` half cells a step: four if they are ``touching``.

        ``noisy``: rays or wheels err.
        """
        self.noisy = noisy
        self.config, self.bits, self.side, self.step = config, config.map_bits, 1 << config.map_bits, step
        self.mask, self.area, self.touching = self.side - 1, 1 << 2 * self.bits, touching
        self.number = number_type(config)
        self.wall_gap = config.wall_gap_touching if touching else config.wall_gap

    @ti.func
    def at(self, x, y):
        """Return the index of a cell in its environment's map."""
        return ((y & ti.static(self.mask)) << ti.static(self.bits)) | (x & ti.static(self.mask))

    @ti.func
    def across(self, node):
        """Return the east coordinate of a cell."""
        return node & ti.static(self.mask)

    @ti.func
    def down(self, node):
        """Return the south coordinate of a cell."""
        return node >> ti.static(self.bits)

    @ti.func
    def apart(self, one, other):
        """Return the difference of two coordinates, the short way around the torus."""
        half = ti.static(self.side // 2)
        return ((one - other + half) & ti.static(self.mask)) - half

    @ti.func
    def beside(self, node, way):
        """Return the index at a packed offset, 8 bits south and 8 bits east, from a node."""
        mask, there = ti.static(self.mask), 0
        if ti.static(self.bits == 8):
            there = (((node & ~mask) + (way & ~mask)) & ti.static(self.area - 1)) | ((node + way) & mask)
        else:
            south, east = ((way >> 8) ^ 0x80) - 0x80, ((way & 0xFF) ^ 0x80) - 0x80
            there = self.at(self.across(node) + east, self.down(node) + south)
        return there

    @ti.func
    def ahead(self, heading):
        """Return the unit step (east, south) at a heading."""
        x, y = 0, 0
        for h in ti.static(range(8)):
            if heading == h:
                x, y = HEADINGS[h][0], HEADINGS[h][1]
        return ti.Vector([x, y])

    @ti.func
    def tile(self, node):
        """Return the tile of a cell."""
        return ((self.down(node) >> TILE) << ti.static(self.bits - TILE)) | (self.across(node) >> TILE)

    @ti.func
    def forget(self, memory: ti.template(), base):
        """Clear the map of an environment."""
        for k in range(self.area):
            memory.cells[base + k] = ti.cast(0, ti.u16)
        if ti.static(self.noisy):
            for k in range(self.area):
                memory.evidence[base + k] = ti.cast(0, ti.u8)
        for k in range(ti.static(self.area >> 2 * TILE)):
            memory.dirty[(base >> 2 * TILE) + k] = ti.cast(1, ti.u8)

    @ti.func
    def change(self, memory: ti.template(), base, node):
        """Mark the tile of a cell or node as dirty."""
        memory.dirty[(base >> 2 * TILE) + self.tile(node)] = ti.cast(1, ti.u8)

    @ti.func
    def solid(self, memory: ti.template(), base, x, y):
        """Return 1 if the body has no room on a node."""
        return ti.cast(ti.cast(memory.cells[base + self.at(x, y)], ti.i32) & SOLID != 0, ti.i32)

    @ti.func
    def open(self, memory: ti.template(), base, node):
        """Return 1 if a path may lead through a node: the node is near to seen cells and not solid."""
        return ti.cast(ti.cast(memory.cells[base + node], ti.i32) & (SOLID | NEAR) == NEAR, ti.i32)

    @ti.func
    def close(self, memory: ti.template(), base, x, y):
        """Make a node solid; return 1 if it was not."""
        node, had = self.at(x, y), 1 - self.solid(memory, base, x, y)
        if had:
            memory.cells[base + node] = memory.cells[base + node] | ti.cast(SOLID, ti.u16)
            self.change(memory, base, node)
        return had

    @ti.func
    def clear(self, memory: ti.template(), base, x, y):
        """Make a node not solid: the body stands there."""
        if self.solid(memory, base, x, y):
            node = self.at(x, y)
            memory.cells[base + node] = memory.cells[base + node] & ti.cast(~SOLID, ti.u16)
            self.change(memory, base, node)

    @ti.func
    def room(self, memory: ti.template(), base, px, py):
        """Return 1 if the body has room at a pose in half cells: on all nodes within half a cell."""
        free = 1
        for k in range(4):
            free &= 1 - self.solid(memory, base, (px + (k & 1)) >> 1, (py + (k >> 1)) >> 1)
        return free

    @ti.func
    def passes(self, memory: ti.template(), base, px, py, dx, dy, step: ti.template()):
        """Return 1 if the body has room all along ``step`` half cells from a pose."""
        free = self.room(memory, base, px + step * dx, py + step * dy)
        for k in ti.static(range(2, step, 2)):
            free &= self.room(memory, base, px + k * dx, py + k * dy)
        return free

    @ti.func
    def see(self, memory: ti.template(), base, node, bits, time):
        """Mark a cell as seen, with some of its bits; return its value before."""
        cell = ti.cast(memory.cells[base + node], ti.i32)
        if ti.static(self.noisy):
            cell, occupied = self.weigh(memory, base, node, bits, cell)
            bits = occupied * OCCUPIED if bits else 0
        now = (cell & (SOLID | OCCUPIED)) | NEAR | bits | (time << FLAGS)
        memory.cells[base + node] = ti.cast(now, ti.u16)
        if (cell < 1 << FLAGS) | (bits & ~cell != 0):
            self.change(memory, base, node)
        if cell < 1 << FLAGS:
            x, y = self.across(node), self.down(node)
            for k in ti.static(range(8)):
                far = ti.static(self.config.near)
                near = base + self.at(x + HEADINGS[k][0] * far, y + HEADINGS[k][1] * far)
                memory.cells[near] = memory.cells[near] | ti.cast(NEAR, ti.u16)
        return cell

    @ti.func
    def weigh(self, memory: ti.template(), base, node, hit, cell):
        """Weigh a ray that ends in a cell (``hit``) or passes it.

        Return the cell, and 1 if it is occupied.
        """
        count = ti.cast(memory.evidence[base + node], ti.i32)
        if hit:
            count = ti.min(count + self.config.evidence_hit, ti.static(self.config.evidence_most))
        else:
            count = ti.max(count - 1, 0)
        memory.evidence[base + node] = ti.cast(count, ti.u8)
        if (count == 0) & (cell >= OCCUPIED):
            cell -= OCCUPIED
            memory.cells[base + node] = ti.cast(cell, ti.u16)
            x, y = self.across(node), self.down(node)
            for k in range(4):
                self.reopen(memory, base, x + (k & 1), y + (k >> 1))
        return cell, ti.cast(count >= ti.static(self.config.evidence_occupied), ti.i32)

    @ti.func
    def reopen(self, memory: ti.template(), base, x, y):
        """Make a node not solid if none of the four cells about it is occupied."""
        taken = 0
        for k in range(4):
            taken |= ti.cast(memory.cells[base + self.at(x - (k & 1), y - (k >> 1))], ti.i32)
        if taken < OCCUPIED:
            self.clear(memory, base, x, y)

    @ti.func
    def unseen(self, cell):
        """Return 1 if a cell with this value was never seen."""
        return ti.cast(cell < 1 << FLAGS, ti.i32)

    @ti.func
    def see_body(self, memory: ti.template(), base, px, py, time):
        """Mark the cells that the body covers wholly, or half of them between two nodes.

        Returns the number of cells that were never seen.
        """
        new = 0
        for k in range(4):
            node = self.at(((px + 1) >> 1) - 1 + (k & 1), ((py + 1) >> 1) - 1 + (k >> 1))
            new += self.unseen(self.see(memory, base, node, 0, time))
        return new

    @ti.func
    def hit(self, memory: ti.template(), base, x, y, time):
        """Mark an obstacle at a place, in the cells within ``hit_margin``.

        Returns how many cells were not known to be occupied or, for bodies that touch walls, how many nodes
        were not known to be solid.
        """
        margin = ti.static(self.config.hit_margin)
        i0, i1 = ti.cast(ti.floor(x - margin), ti.i32), ti.cast(ti.floor(x + margin), ti.i32)
        j0, j1 = ti.cast(ti.floor(y - margin), ti.i32), ti.cast(ti.floor(y + margin), ti.i32)
        new = 0
        for j in range(j0, j1 + 1):
            for i in range(i0, i1 + 1):
                taken = 1 - (self.see(memory, base, self.at(i, j), OCCUPIED, time) // OCCUPIED)
                if ti.static(self.noisy):
                    taken &= ti.cast(memory.cells[base + self.at(i, j)], ti.i32) // OCCUPIED
                if taken:
                    new += 1
                    if ti.static(not self.touching):
                        for k in range(4):
                            self.close(memory, base, i + (k & 1), j + (k >> 1))
        if ti.static(self.touching):
            new = self.line(memory, base, x, y)
        return new

    @ti.func
    def line(self, memory: ti.template(), base, x, y):
        """Make nodes solid about a hit on the line of a wall; return how many were not.

        Bodies stand on even nodes, so lines run along odd ones.
        """
        new = 0
        across, down = 2.0 * ti.floor(0.5 * x) + 1.0, 2.0 * ti.floor(0.5 * y) + 1.0
        upright = ti.abs(x - across) < ti.abs(y - down)
        line, along = ti.select(upright, across, down), ti.select(upright, y, x)
        for k in range(2):
            node = ti.floor(along) + ti.cast(k, ti.f32)
            # The node next to a wall's end stays free: a door may begin there.
            if ti.abs(along - node) < ti.static(1.0 - self.config.hit_margin):
                i = ti.cast(ti.select(upright, line, node), ti.i32)
                j = ti.cast(ti.select(upright, node, line), ti.i32)
                new += self.close(memory, base, i, j)
        return new

    @ti.func
    def hides(self, memory: ti.template(), base, x, y, since):
        """Return 1 if a target about a node may have been unseen since a step.

        A target covers some of 4 by 4 cells, the inner four wholly. None of the inner four may have been seen
        since, and at least ``outer_cells`` of the others must be unseen.
        """
        rows, columns = ti.Vector([0, 0, 0, 0]), ti.Vector([0, 0, 0, 0])
        for k in ti.static(range(4)):
            rows[k] = base + self.at(0, y - 2 + k)
            columns[k] = self.at(x - 2 + k, 0)
        limit, hides, outer = since << FLAGS, 1, 0
        for j, i in ti.static(((1, 1), (1, 2), (2, 1), (2, 2))):
            if hides:
                hides = ti.cast(ti.cast(memory.cells[rows[j] + columns[i]], ti.i32) < limit, ti.i32)
        if hides:
            for j in ti.static(range(4)):
                for i in ti.static(range(4)):
                    if ti.static(i in (0, 3) or j in (0, 3)):
                        outer += ti.cast(ti.cast(memory.cells[rows[j] + columns[i]], ti.i32) < limit, ti.i32)
            hides = ti.cast(outer >= ti.static(self.config.outer_cells), ti.i32)
        return hides
