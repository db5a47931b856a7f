"""Sight in the continuous backend: rays hit the nearest of the lines that are listed for the eye's cell."""

from vitruvius.sim.backends.blocks import AHEAD, HEADER, LINE, cell_of, end_of
from vitruvius.sim.backends.continuous.layout import FIRST_LINE, listed
from vitruvius.sim.backends.rays import RayBody
from vitruvius.sim.runtime import ti


@ti.data_oriented
class Sight(RayBody):
    """Rays among lines."""

    @ti.func
    def see(self, numbers: ti.template(), indices: ti.template(), house, origin, cell, target, ray):
        """Return the distances and kinds of rays: see ``Backend.see``.

        Of hits at the same distance, walls come first, then furniture, then the target.
        """
        eye = self.body.eye(origin, cell)
        first = self.rays.first(cell[2], ray)
        over_x, slope_x = self.rays.floats(0.0), self.rays.floats(0.0)
        over_y, slope_y = self.rays.floats(0.0), self.rays.floats(0.0)
        self.rays.across(first, 0, over_x, slope_x)
        self.rays.across(first, 1, over_y, slope_y)
        nearest, kinds = self.rays.bits(ti.static(self.rays.none)), self.rays.bits(0)
        block, first_line = cell_of(numbers, indices, house, eye), indices[house * HEADER + FIRST_LINE]
        across_x, row = 1 + 2 * cell[2], 2 + 2 * cell[2]
        for k in range(end_of(indices, block, across_x), end_of(indices, block, row)):
            line = first_line + 4 * listed(indices, block, k)
            ahead, aside, half, kind = self.line(numbers, line, eye[0], eye[1])
            self.rays.meet(
                nearest, kinds, over_x, slope_x, ahead, aside, half, kind, ti.static(self.config.notes_hits)
            )
        for k in range(end_of(indices, block, row), end_of(indices, block, row + 1)):
            line = first_line + 4 * listed(indices, block, k)
            ahead, aside, half, kind = self.line(numbers, line, eye[1], eye[0])
            self.rays.meet(
                nearest, kinds, over_y, slope_y, ahead, aside, half, kind, ti.static(self.config.notes_hits)
            )
        if self.rays.may_see(target - eye, ti.static(self.config.target / 2), self.body.headings[cell[2]]):
            self.rays.meet_target(nearest, kinds, over_x, slope_x, over_y, slope_y, eye, target)
        return self.rays.metres(nearest), kinds

    @ti.func
    def prefetch(self, numbers: ti.template(), indices: ti.template(), house, origin, cell):
        """Read the first cache lines of a block: see ``Backend.prefetch``. Most blocks fit into them."""
        block = cell_of(numbers, indices, house, self.body.eye(origin, cell))
        some = indices[block]
        for k in ti.static(range(LINE, AHEAD, LINE)):
            some &= indices[block + k]
        return some

    @ti.func
    def line(self, numbers: ti.template(), at, along, across):
        """Return a line relative to the eye: distance ahead, middle, half length, kind."""
        kind = ti.cast(ti.abs(numbers[at + 3]), ti.u32)
        return numbers[at] - along, numbers[at + 1] - across, numbers[at + 2], kind
