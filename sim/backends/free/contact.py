"""Contact of a disc that moves straight with a solid: a rectangle at any angle, or a segment."""

from vitruvius.sim.runtime import ti

NEVER = 2.0
"""Fraction of a path that stands for "the disc touches nothing"."""


@ti.func
def into(solid, v):
    """Return a vector in the axes of a solid: along its length and its width."""
    return ti.Vector([v[0] * solid[2] + v[1] * solid[3], v[1] * solid[2] - v[0] * solid[3]])


@ti.func
def out_of(solid, v):
    """Return a vector, given in the axes of a solid, in the axes of the house."""
    return ti.Vector([v[0] * solid[2] - v[1] * solid[3], v[0] * solid[3] + v[1] * solid[2]])


@ti.func
def gap(solid, place):
    """Return the vector from the nearest point of a solid to a place, in the solid's axes: 0 inside."""
    own = into(solid, place - ti.Vector([solid[0], solid[1]]))
    half = ti.Vector([solid[4], solid[5]])
    return own - ti.max(-half, ti.min(half, own))


@ti.func
def touches(solid, place, way, radius, inner, outer):
    """Return where a disc that moves by ``way`` (x, y) first touches a solid.

    The values are the fraction of ``way`` before the contact (``NEVER`` without a contact), the unit vector
    from the contact to the disc, and the depth by which the disc is already in the solid, metres.

    A contact counts if the disc would enter the solid by more than the skin; the disc then stops at half a
    skin. Therefore rounding never makes a wall block a body that slides along it, nor does a joint of two
    walls. ``inner`` is the radius minus the skin, ``outer`` the radius minus half the skin.
    """
    share, normal, depth = NEVER, ti.Vector([0.0, 0.0]), 0.0
    away = gap(solid, place)
    near, length = away.dot(away), way.dot(way)
    reach = radius + ti.sqrt(length)
    if near < reach * reach:
        half = ti.Vector([solid[4], solid[5]])
        own, along = into(solid, place - ti.Vector([solid[0], solid[1]])), into(solid, way)
        if near < outer * outer:
            distance = ti.sqrt(near)
            if distance > 0.0:
                normal = away / distance
            else:  # The middle is inside: the nearest side is the way out.
                inward = half - ti.abs(own)
                side = ti.select(own >= 0.0, 1.0, -1.0)
                if inward[0] < inward[1]:
                    normal[0], distance = side[0], -inward[0]
                else:
                    normal[1], distance = side[1], -inward[1]
            depth = outer - distance
            further = along.dot(normal)
            if (further < 0.0) & (distance + further < inner):
                share = 0.0
        else:
            for axis in ti.static(range(2)):  # a side
                other = ti.static(1 - axis)
                if along[axis] != 0.0:
                    sign = ti.select(along[axis] < 0.0, 1.0, -1.0)
                    at = (sign * (half[axis] + outer) - own[axis]) / along[axis]
                    in_ = (sign * (half[axis] + inner) - own[axis]) / along[axis]
                    across = own[other] + in_ * along[other]
                    if (at >= 0.0) & (at < share) & (in_ <= 1.0) & (ti.abs(across) <= half[other]):
                        share = at
            for k in ti.static(range(4)):  # a corner
                corner = half * ti.Vector(
                    [1.0 if ti.static(k & 1) else -1.0, 1.0 if ti.static(k & 2) else -1.0]
                )
                start = own - corner
                ahead, square = start.dot(along), start.dot(start)
                beyond, within = square - outer * outer, square - inner * inner
                under = ahead * ahead - length * within
                if (ahead < 0.0) & (under >= 0.0):
                    # The smaller root, without the difference of two nearly equal numbers.
                    at = beyond / (ti.sqrt(ahead * ahead - length * beyond) - ahead)
                    if (at >= 0.0) & (at < share) & (within <= ti.sqrt(under) - ahead):
                        share = at
            if share <= 1.0:
                there = own + share * along
                leaned = there - ti.max(-half, ti.min(half, there))
                normal = leaned / ti.max(1e-12, leaned.norm())
    return share, out_of(solid, normal), depth
