"""Look-up of the fewest actions to a target in kernels; ``sim.world.geodesic`` computes them."""

from vitruvius.sim.runtime import ti

TILE_BITS, PROFILE_BITS = 3, 20
TILE = 1 << TILE_BITS
"""Places along a tile of a distance field, and bits of a profile's number: see ``sim.world.geodesic``."""

PROFILE = TILE * TILE * 8
"""Number of values of a profile."""

TILES = 1 << 16
"""Number of tiles for which there is room at first."""

MOST_DISTANCE = (1 << (32 - PROFILE_BITS)) - 1
"""Largest value of a tile's smallest distance."""

NOT_YET = -2
"""Placeholder for the distance to a target that is new."""

FIELD = 6
"""Number of integers of an environment's field: index of its first tile, first i and j, and tiles in a
column. Then the tile of the body's last place and that tile's entry, so that most look-ups read only one
number."""

Steps = ti.types.ndarray(ti.i16, 1)
"""Annotation of a kernel's array of distances, in actions."""


@ti.func
def look_up(world: ti.template(), e, cell):
    """Return the fewest actions from a cell to the target of an environment, or -1 if no path leads there."""
    field = world.fields[e]
    found, at = -1, tile_of(field, cell)
    if field[0] >= 0:
        entry = field[5]
        if field[4] != at:
            entry = world.tiles[at]
            world.fields[e][4], world.fields[e][5] = at, entry
        further = ti.cast(world.profiles[pose_of(field, entry, cell)], ti.i32)
        if further >= 0:
            found = (entry >> ti.static(PROFILE_BITS) & ti.static(MOST_DISTANCE)) + further
    return found


@ti.func
def tile_of(field, cell):
    """Return the index of the tile of a cell."""
    bits = ti.static(TILE_BITS)
    return field[0] + ((cell[0] - field[1]) >> bits) * field[3] + ((cell[1] - field[2]) >> bits)


@ti.func
def pose_of(field, entry, cell):
    """Return the index in ``profiles`` of a cell's pose, in the profile of its tile."""
    bits, last = ti.static(TILE_BITS), ti.static(TILE - 1)
    i, j = (cell[0] - field[1]) & last, (cell[1] - field[2]) & last
    number = entry & ti.static((1 << PROFILE_BITS) - 1)
    return 8 * ((((number << bits) + i) << bits) + j) + cell[2]


@ti.func
def touch(world: ti.template(), e, cell):
    """Read the value that ``look_up`` most likely reads next, to bring it into the cache.

    The returned number has no meaning.
    """
    field = world.fields[e]
    return ti.cast(world.profiles[pose_of(field, field[5], cell)], ti.i32)
