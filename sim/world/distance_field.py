"""The fewest actions to a target, as kernels look them up: what ``sim.world.geodesic`` has found."""

from sim.runtime import ti

TILE_BITS, PROFILE_BITS = 3, 20
TILE = 1 << TILE_BITS
"""Places along a tile of a field of distances, and bits of a profile's number: ``sim.world.geodesic``."""

MOST_DISTANCE = (1 << (32 - PROFILE_BITS)) - 1
"""Least distance of a tile, at most."""

NOT_YET = -2
"""In place of the distance to a target that is new."""

FIELD = 6
"""Numbers of an environment's field: where its tiles begin, first i and j, tiles in a column; then the tile
where the body was last and what it is, so that most looks read one number.
"""
Fields = ti.types.ndarray(ti.types.vector(FIELD, ti.i32), 1)


@ti.func
def look_up(world: ti.template(), e, cell):
    """The fewest actions from a cell to the target of an environment, -1 where no path leads there."""
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
    """Where the tile of a cell is."""
    bits = ti.static(TILE_BITS)
    return field[0] + ((cell[0] - field[1]) >> bits) * field[3] + ((cell[1] - field[2]) >> bits)


@ti.func
def pose_of(field, entry, cell):
    """Where the pose of a cell is among profiles, in its tile's."""
    bits, last = ti.static(TILE_BITS), ti.static(TILE - 1)
    i, j = (cell[0] - field[1]) & last, (cell[1] - field[2]) & last
    number = entry & ti.static((1 << PROFILE_BITS) - 1)
    return 8 * ((((number << bits) + i) << bits) + j) + cell[2]


@ti.func
def touch(world: ti.template(), e, cell):
    """Read what ``look_up`` reads next, most often; any number."""
    field = world.fields[e]
    return ti.cast(world.profiles[pose_of(field, field[5], cell)], ti.i32)
