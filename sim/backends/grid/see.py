"""Sight in the grid backend: hits are looked up for the eye's cell, and then compared with the target."""

from vitruvius.sim.backends.grid.move import looked_up
from vitruvius.sim.backends.grid.pack import ROW
from vitruvius.sim.backends.rays import RayBody
from vitruvius.sim.runtime import ti


@ti.data_oriented
class Sight(RayBody):
    """Rays in tables."""

    @ti.func
    def see(self, numbers: ti.template(), indices: ti.template(), house, origin, cell, target, ray):
        """Return the distances and kinds of rays: see ``Backend.see``.

        Of hits at the same distance, walls come first, then furniture, then the target.
        """
        eye = self.body.eye(origin, cell)
        first = self.rays.first(cell[2], ray)
        nearest, kinds = self.rays.bits(0), self.rays.bits(0)
        at = (looked_up(indices, house, cell) >> ROW) * ti.static(self.rays.count) + first
        for r in range(ti.static(self.rays.lanes)):
            nearest[r] = ti.bit_cast(numbers[at + r], ti.u32)
        if ti.static(self.config.notes_hits):
            kinds_at = at + numbers.shape[0] // 2
            for r in range(ti.static(self.rays.lanes)):
                kinds[r] = ti.cast(numbers[kinds_at + r], ti.u32)
        if self.rays.may_see(target - eye, ti.static(self.config.target / 2), self.body.headings[cell[2]]):
            over_x, slope_x = self.rays.floats(0.0), self.rays.floats(0.0)
            over_y, slope_y = self.rays.floats(0.0), self.rays.floats(0.0)
            self.rays.across(first, 0, over_x, slope_x)
            self.rays.across(first, 1, over_y, slope_y)
            self.rays.meet_target(nearest, kinds, over_x, slope_x, over_y, slope_y, eye, target)
        return self.rays.metres(nearest), kinds

    @ti.func
    def prefetch(self, numbers: ti.template(), indices: ti.template(), house, origin, cell):
        """Read some distances of the look: see ``Backend.prefetch``."""
        at = (looked_up(indices, house, cell) >> ROW) * ti.static(self.rays.count)
        at += self.rays.first(cell[2], 0)
        half, last = ti.static(self.rays.lanes // 2), ti.static(self.rays.lanes - 1)
        return ti.bit_cast(numbers[at] + numbers[at + half] + numbers[at + last], ti.i32)
