"""Where the target is, by what the rays showed of it: a square whose sides lie along the walls.

Places are in cells, east and south of the eye.
"""

from sim.runtime import ti

SAME = 4.5
"""A target seen so many cells from the one that is known is another: this one was picked up."""

WITHIN = 12.0
"""Cells from which a target's place is known well enough to say that it is not there."""

FLAT = 0.02
"""Cells that the ends of rays on one of its faces may lie apart across it."""


@ti.data_oriented
class Sight:
    """What is made of looks at a square of half the side ``half``, in cells."""

    def __init__(self, half: float) -> None:
        """Look at squares of this size."""
        self.half = half

    @ti.func
    def centre(self, rays, low, high, way, known, before):
        """The centre of a square that so many rays met between two corners, looking ``way`` on the whole;
        it was known to lie at ``before``, or not known. It is exact along an axis where a face is seen, and
        else one of those places, if it was before, from which the square covers all that is seen of it.
        """
        flat, least, most = high - low < FLAT, high - self.half, low + self.half
        middle = 0.5 * (low + high)
        if known and not self.other(middle, before):
            middle = ti.max(least, ti.min(most, before))
        elif rays == 1:
            middle += way
        if rays > 1:
            if not flat[1]:
                middle[0] = ti.select(way[0] > 0, most[0], least[0])
            if not flat[0]:
                middle[1] = ti.select(way[1] > 0, most[1], least[1])
        return middle

    @ti.func
    def other(self, one, before):
        """Whether a target at one place is another than the one that was known to lie at another place."""
        return ti.cast(ti.abs(one - before).max() > SAME, ti.i32)

    @ti.func
    def gone(self, at, missed):
        """Whether a target that no ray meets is not there any more: the body touches its place, or from near
        rays have ``missed`` it, that should have met it.
        """
        away = ti.abs(at).max()
        touched = away < 1.0 + self.half + 0.125
        return ti.cast(touched | ((missed > 0) & (away < WITHIN)), ti.i32)
