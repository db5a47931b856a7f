"""The map's cells: what rays have shown, and when.

A cell is half a body wide, so a body that stands on a corner of cells, a node, covers just the four about it.
Cell and node (i, j) share a number: the step at which the cell was last seen, 0 for never; above it whether
the cell is occupied; and below it whether the node is near to what was seen, and whether it is solid (a body
has no room there). So one comparison tells the cells that are occupied or were seen since a step from all
others. Houses stand still, so what is occupied stays so. The grid is a torus: it follows the body wherever an
episode starts.
"""

from sim.runtime import ti

WAYS = ((1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1), (0, 1), (1, 1))
"""Steps east and south that ``forward`` makes at each of the eight headings."""

SOLID, NEAR, OCCUPIED = 1, 2, 1 << 15
"""Bits of a cell."""

FLAGS = 2
"""How many of them lie below the step."""

DEPTH = 8
"""Nodes beyond what was seen that are near: further on anything may be, most likely nothing."""

LATEST = (1 << 15 - FLAGS) - 1
"""The last step that a cell can tell."""

TILE = 4
"""Tiles are of 2^4 by 2^4 cells. ``news`` tells of each whether more is known of its cells or its nodes
than when it was asked last (``agent.planner.flood``).
"""

AROUND = 0.07
"""Cells about a hit that are taken for occupied too: a centimetre, more than the shield's margin."""

WIDEST, WIDEST_TOUCHING = 2.9, 1.9
"""Cells between two hits on one line that are joined to a wall: less than any door or passage is wide, which
is a body's width at least where bodies touch."""

Cells, Bytes = ti.types.ndarray(ti.u16, 1), ti.types.ndarray(ti.u8, 1)
Floats, Wholes = ti.types.ndarray(ti.f32, 1), ti.types.ndarray(ti.i32, 1)
Longs = ti.types.ndarray(ti.i64, 1)


@ti.data_oriented
class Grid:
    """A torus of 2^bits by 2^bits cells for each environment; ``base`` is where one's begins.

    Where bodies fill the cells of a house that lies on a grid (``sim.grid``), its walls are lines between
    them, that a body may touch: ``touching``. Cells on both sides of a line are taken for occupied, as ever,
    but only nodes on the line are solid.
    """

    def __init__(self, bits: int, step: int = 1, touching: bool = False) -> None:
        """Choose the size, for bodies that go so many half cells a step: four where they are ``touching``."""
        self.bits, self.side, self.step = bits, 1 << bits, step
        self.mask, self.area = self.side - 1, 1 << 2 * bits
        self.touching, self.widest = touching, WIDEST_TOUCHING if touching else WIDEST

    @ti.func
    def at(self, x, y):
        """The place of a cell in its environment's grid."""
        return ((y & ti.static(self.mask)) << ti.static(self.bits)) | (x & ti.static(self.mask))

    @ti.func
    def across(self, node):
        """How far east a cell lies."""
        return node & ti.static(self.mask)

    @ti.func
    def down(self, node):
        """How far south a cell lies."""
        return node >> ti.static(self.bits)

    @ti.func
    def apart(self, one, other):
        """One coordinate less another, the short way about the torus."""
        half = ti.static(self.side // 2)
        return ((one - other + half) & ti.static(self.mask)) - half

    @ti.func
    def solid(self, cells: ti.template(), base, x, y):
        """Whether the body has no room on a node."""
        return ti.cast(ti.cast(cells[base + self.at(x, y)], ti.i32) & SOLID != 0, ti.i32)

    @ti.func
    def open(self, cells: ti.template(), base, node):
        """Whether a way may lead to a node: it is near to what was seen, and not solid."""
        return ti.cast(ti.cast(cells[base + node], ti.i32) & (SOLID | NEAR) == NEAR, ti.i32)

    @ti.func
    def tile(self, node):
        """The tile that a cell is in."""
        return ((self.down(node) >> TILE) << ti.static(self.bits - TILE)) | (self.across(node) >> TILE)

    @ti.func
    def note(self, news: ti.template(), base, node):
        """Note that something is known of a cell, or of the node, that was not."""
        news[(base >> 2 * TILE) + self.tile(node)] = ti.cast(1, ti.u8)

    @ti.func
    def close(self, cells: ti.template(), news: ti.template(), base, x, y):
        """Let the body have no room on a node; whether it had some."""
        node, had = self.at(x, y), 1 - self.solid(cells, base, x, y)
        if had:
            cells[base + node] = cells[base + node] | ti.cast(SOLID, ti.u16)
            self.note(news, base, node)
        return had

    @ti.func
    def clear(self, cells: ti.template(), news: ti.template(), base, x, y):
        """Let the body have room on a node: it stands there."""
        if self.solid(cells, base, x, y):
            node = self.at(x, y)
            cells[base + node] = cells[base + node] & ti.cast(~SOLID, ti.u16)
            self.note(news, base, node)

    @ti.func
    def room(self, cells: ti.template(), base, px, py):
        """Whether the body has room at a pose, in half cells: on all nodes within half a cell of it."""
        free = 1
        for k in range(4):
            free &= 1 - self.solid(cells, base, (px + (k & 1)) >> 1, (py + (k >> 1)) >> 1)
        return free

    @ti.func
    def passes(self, cells: ti.template(), base, px, py, dx, dy, step: ti.template()):
        """Whether the body has room all along a way of ``step`` half cells."""
        free = self.room(cells, base, px + step * dx, py + step * dy)
        for k in ti.static(range(2, step, 2)):
            free &= self.room(cells, base, px + k * dx, py + k * dy)
        return free

    @ti.func
    def beside(self, node, way):
        """The place that lies a packed way, south and east, from another."""
        mask = ti.static(self.mask)
        return (((node & ~mask) + (way & ~mask)) & ti.static(self.area - 1)) | ((node + way) & mask)

    @ti.func
    def see(self, cells: ti.template(), news: ti.template(), base, node, bits, time):
        """Note that a cell is seen, and bits of it; what it was before."""
        cell = ti.cast(cells[base + node], ti.i32)
        cells[base + node] = ti.cast((cell & (SOLID | OCCUPIED)) | NEAR | bits | (time << FLAGS), ti.u16)
        if (cell < 1 << FLAGS) | (bits & ~cell != 0):
            self.note(news, base, node)
        if cell < 1 << FLAGS:
            x, y = self.across(node), self.down(node)
            for k in ti.static(range(8)):
                near = base + self.at(x + WAYS[k][0] * DEPTH, y + WAYS[k][1] * DEPTH)
                cells[near] = cells[near] | ti.cast(NEAR, ti.u16)
        return cell

    @ti.func
    def unseen(self, cell):
        """Whether a cell that was so had never been seen."""
        return ti.cast(cell < 1 << FLAGS, ti.i32)

    @ti.func
    def see_body(self, cells: ti.template(), news: ti.template(), base, px, py, time):
        """Note the cells that the body covers wholly, or half of them between two nodes; how many are new."""
        new = 0
        for k in range(4):
            node = self.at(((px + 1) >> 1) - 1 + (k & 1), ((py + 1) >> 1) - 1 + (k >> 1))
            new += self.unseen(self.see(cells, news, base, node, 0, time))
        return new

    @ti.func
    def hit(self, cells: ti.template(), news: ti.template(), base, x, y, time):
        """Note what stands at a place: the cells within a centimetre. How many were not known to be taken, or
        where bodies touch, how many nodes to be solid.
        """
        i0, i1 = ti.cast(ti.floor(x - AROUND), ti.i32), ti.cast(ti.floor(x + AROUND), ti.i32)
        j0, j1 = ti.cast(ti.floor(y - AROUND), ti.i32), ti.cast(ti.floor(y + AROUND), ti.i32)
        new = 0
        for j in range(j0, j1 + 1):
            for i in range(i0, i1 + 1):
                if self.see(cells, news, base, self.at(i, j), OCCUPIED, time) & OCCUPIED == 0:
                    new += 1
                    if ti.static(not self.touching):
                        for k in range(4):
                            self.close(cells, news, base, i + (k & 1), j + (k >> 1))
        if ti.static(self.touching):
            new = self.line(cells, news, base, x, y)
        return new

    @ti.func
    def line(self, cells: ti.template(), news: ti.template(), base, x, y):
        """Let the body have no room on the nodes about a hit on the line of a wall that it lies on: bodies
        stand on even nodes, so lines run along odd ones. How many had some.
        """
        new = 0
        across, down = 2.0 * ti.floor(0.5 * x) + 1.0, 2.0 * ti.floor(0.5 * y) + 1.0
        upright = ti.abs(x - across) < ti.abs(y - down)
        line, along = ti.select(upright, across, down), ti.select(upright, y, x)
        for k in range(2):
            node = ti.floor(along) + ti.cast(k, ti.f32)
            # Not the next one to a wall's end: there a door may begin.
            if ti.abs(along - node) < 1.0 - AROUND:
                i = ti.cast(ti.select(upright, line, node), ti.i32)
                j = ti.cast(ti.select(upright, node, line), ti.i32)
                new += self.close(cells, news, base, i, j)
        return new

    @ti.func
    def hides(self, cells: ti.template(), base, x, y, since):
        """Whether a target may lie about a node, unseen since a step: it covers some 4 by 4 cells, the inner
        ones wholly. That is how many of these may be, less all but four.
        """
        rows, columns = ti.Vector([0, 0, 0, 0]), ti.Vector([0, 0, 0, 0])
        for k in ti.static(range(4)):
            rows[k] = base + self.at(0, y - 2 + k)
            columns[k] = self.at(x - 2 + k, 0)
        limit, hides, outer = since << FLAGS, 1, 0
        for j, i in ti.static(((1, 1), (1, 2), (2, 1), (2, 2))):
            if hides:
                hides = ti.cast(ti.cast(cells[rows[j] + columns[i]], ti.i32) < limit, ti.i32)
        if hides:
            for j in ti.static(range(4)):
                for i in ti.static(range(4)):
                    if ti.static(i in (0, 3) or j in (0, 3)):
                        outer += ti.cast(ti.cast(cells[rows[j] + columns[i]], ti.i32) < limit, ti.i32)
            hides = ti.cast(outer >= 8, ti.i32)
        return hides
