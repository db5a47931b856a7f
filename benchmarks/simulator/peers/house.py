"""House for the peers that accept any scene: four rooms, a door between neighbours, 12 pieces of furniture.

::

    +------------+------------+
    |  bbb     b | b     bbb  |    8 by 8 m, the origin in the middle, doors of 1 m. Walls are 10 lines,
    |                         |    pieces are 12 boxes: 58 segments for a ray to meet, where a house of
    | b          |          b |    ours has 76.
    +---  ---------------  ---+

A robot starts in the middle of a room. Lengths are metres.
"""

HALF, DOOR = 4.0, (1.5, 2.5)
RADIUS, RANGE, RAYS, FIELD = 0.15, 7.9, 40, 120
"""The robot's radius and the range of its rays in metres, the number of its rays, and their field of view in
degrees."""

PIECES = [((3.5, 3.5), (0.8, 0.8)), ((1.0, 3.6), (1.2, 0.6)), ((3.6, 1.0), (0.6, 1.2))]
"""Middle and sides of the furniture of the north-eastern room; the other rooms have it mirrored."""

SIGNS = [(1, 1), (-1, 1), (-1, -1), (1, -1)]
ROOMS = [(2.0 * x, 2.0 * y) for x, y in SIGNS]
BOXES = [((x * sx, y * sy), sides) for sx, sy in SIGNS for (x, y), sides in PIECES]
SPANS = [(-HALF, -DOOR[1]), (-DOOR[0], DOOR[0]), (DOOR[1], HALF)]
WALLS = [
    *(((-HALF, y), (HALF, y)) for y in (-HALF, HALF)),
    *(((x, -HALF), (x, HALF)) for x in (-HALF, HALF)),
    *(((a, 0.0), (b, 0.0)) for a, b in SPANS),
    *(((0.0, a), (0.0, b)) for a, b in SPANS),
]
"""Walls as lines between their ends, x then y."""
