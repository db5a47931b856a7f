# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportCallIssue=false
# pyright: reportOptionalCall=false, reportIndexIssue=false, reportArgumentType=false
"""The map's cells: what rays have shown, and when.

A cell is half a body wide, so a body that stands on a corner of cells, a node, covers just the four about it.
Cell and node (i, j) share a number: two bits, whether the cell is occupied and whether the node is solid (a
body has no room there), under the step at which the cell was last seen, 0 for never. Houses stand still, so
what is occupied stays so. The grid is a torus: it follows the body wherever an episode starts.
"""

from sim.runtime import ti

WAYS = ((1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1), (0, 1), (1, 1))
"""Steps east and south that ``forward`` makes at each of the eight headings."""

OCCUPIED, SOLID = 1, 2
"""Bits of a cell."""

LATEST = (1 << 14) - 1
"""The last step that a cell can tell."""

AROUND = 0.07
"""Cells about a hit that are taken for occupied too: a centimetre, more than the shield's margin."""

WIDEST = 2.9
"""Cells between two hits on one line that are joined to a wall: less than any door or passage is wide."""

Cells, Bytes = ti.types.ndarray(ti.u16, 1), ti.types.ndarray(ti.u8, 1)
Floats, Wholes = ti.types.ndarray(ti.f32, 1), ti.types.ndarray(ti.i32, 1)
Longs = ti.types.ndarray(ti.i64, 1)


@ti.data_oriented
class Grid:
    """A torus of 2^bits by 2^bits cells for each environment; ``base`` is where one's begins."""

    def __init__(self, bits: int) -> None:
        """Choose the size."""
        self.bits, self.side = bits, 1 << bits
        self.mask, self.area = self.side - 1, 1 << 2 * bits

    @ti.func
    def at(self, x, y):
        """The place of a cell in its environment's grid."""
        return ((y & ti.static(self.mask)) << ti.static(self.bits)) | (x & ti.static(self.mask))

    @ti.func
    def apart(self, one, other):
        """One coordinate less another, the short way about the torus."""
        half = ti.static(self.side // 2)
        return ((one - other + half) & ti.static(self.mask)) - half

    @ti.func
    def solid(self, cells: ti.template(), base, x, y):
        """Whether the body has no room on a node."""
        return (ti.cast(cells[base + self.at(x, y)], ti.i32) & SOLID) >> 1

    @ti.func
    def close(self, cells: ti.template(), base, x, y):
        """Let the body have no room on a node."""
        i = base + self.at(x, y)
        cells[i] = cells[i] | ti.cast(SOLID, ti.u16)

    @ti.func
    def open(self, cells: ti.template(), base, x, y):
        """Let the body have room on a node: it stands there."""
        i = base + self.at(x, y)
        cells[i] = cells[i] & ti.cast(~SOLID, ti.u16)

    @ti.func
    def room(self, cells: ti.template(), base, px, py):
        """Whether the body has room at a pose, in half cells: on all nodes within half a cell of it."""
        free = 1
        for k in range(4):
            free &= 1 - self.solid(cells, base, (px + (k & 1)) >> 1, (py + (k >> 1)) >> 1)
        return free

    @ti.func
    def see(self, cells: ti.template(), base, x, y, time):
        """Note that a cell is seen; whether for the first time."""
        i = base + self.at(x, y)
        cell = ti.cast(cells[i], ti.i32)
        cells[i] = ti.cast((cell & 3) | (time << 2), ti.u16)
        return ti.cast(cell < 4, ti.i32)

    @ti.func
    def see_body(self, cells: ti.template(), base, px, py, time):
        """Note the cells that the body covers wholly, or half of them between two nodes."""
        new = 0
        for k in range(4):
            new += self.see(cells, base, ((px + 1) >> 1) - 1 + (k & 1), ((py + 1) >> 1) - 1 + (k >> 1), time)
        return new

    @ti.func
    def see_line(self, cells: ti.template(), base, x, y, dx, dy, time):
        """Note the cells on the way from the eye at (x, y) to what a ray hits; how many are new."""
        length, new = ti.max(ti.abs(dx), ti.abs(dy)), 0
        slope_x, slope_y = dx / ti.max(length, 1e-6), dy / ti.max(length, 1e-6)
        # Half a cell behind the last place looked at lies what is hit, at the least by a twentieth.
        for k in range(ti.cast(length + 0.45, ti.i32)):
            t = ti.cast(k, ti.f32) + 0.5
            i, j = ti.floor(x + slope_x * t), ti.floor(y + slope_y * t)
            new += self.see(cells, base, ti.cast(i, ti.i32), ti.cast(j, ti.i32), time)
        return new

    @ti.func
    def hit(self, cells: ti.template(), base, x, y, time):
        """Note what stands at a place: the cells within a centimetre; how many were not known to be taken."""
        i0, i1 = ti.cast(ti.floor(x - AROUND), ti.i32), ti.cast(ti.floor(x + AROUND), ti.i32)
        j0, j1 = ti.cast(ti.floor(y - AROUND), ti.i32), ti.cast(ti.floor(y + AROUND), ti.i32)
        new = 0
        for j in range(j0, j1 + 1):
            for i in range(i0, i1 + 1):
                at = base + self.at(i, j)
                cell = ti.cast(cells[at], ti.i32)
                cells[at] = ti.cast((cell & SOLID) | OCCUPIED | (time << 2), ti.u16)
                if cell & OCCUPIED == 0:
                    new += 1
                    for k in range(4):
                        self.close(cells, base, i + (k & 1), j + (k >> 1))
        return new

    @ti.func
    def hides(self, cells: ti.template(), base, x, y, since):
        """Whether a target may lie about a node, unseen since a step: it covers some 4 by 4 cells, the inner
        ones wholly. That is how many of these may be, less all but four.
        """
        inner, outer = 0, 0
        for k in range(4):
            inner += self.may_hide(cells, base, x - 1 + (k & 1), y - 1 + (k >> 1), since)
        if inner == 4:
            for k in range(16):
                outer += self.may_hide(cells, base, x - 2 + (k & 3), y - 2 + (k >> 2), since)
        return ti.cast(outer >= 12, ti.i32)

    @ti.func
    def may_hide(self, cells: ti.template(), base, x, y, since):
        """Whether a cell is not occupied, nor was seen since a step."""
        cell = ti.cast(cells[base + self.at(x, y)], ti.i32)
        return ti.cast((cell & OCCUPIED == 0) & ((cell >> 2) < since), ti.i32)
