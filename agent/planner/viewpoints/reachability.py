"""Reachable places and their distances: a distance field over blocks of 2 by 2 nodes.

A choice of a viewpoint needs the lengths of the paths to all places, but not the paths. So blocks are exact
enough, and the 64 blocks of a tile are the bits of one word. Two blocks are connected if two adjacent nodes,
one of each, are both open. In a step the front moves to the east and the west, and from there to the north
and the south, so diagonally, too. Except at its start, the front reaches only what paths of nodes reach as
well. The connections of a tile are kept until the tile or one next to it is dirty.
"""

from vitruvius.agent.planner.mapping.occupancy import TILE, Occupancy
from vitruvius.sim.runtime import ti

NODES, SIDE = 1 << TILE, 1 << TILE - 1
"""Nodes and blocks along each side of a tile, whose 64 blocks are the bits of one word, row by row."""

EAST, SOUTH, OPEN, KNOWN, REACHED, LATEST, NEXT = range(7)
"""Words of a tile. ``EAST``, ``SOUTH``: blocks connected with the next block to the east or south. ``OPEN``:
blocks whose first node is open. ``KNOWN``: 1 if these are computed. ``REACHED``, ``LATEST``, ``NEXT``: blocks
that the front has reached, reached in the last step, and reaches in this step."""

WORDS = NEXT + 1
"""Number of words in a tile."""

UNKNOWN = (1 << 8) - 1
"""Weight of a block as a candidate that is not computed yet."""

# Bits of a tile's first and last blocks in each column and in each row.
ALL = (1 << SIDE * SIDE) - 1
FIRST_ROW = (1 << SIDE) - 1
FIRST_COLUMN = sum(1 << SIDE * row for row in range(SIDE))
LAST_ROW, LAST_COLUMN = FIRST_ROW << SIDE * (SIDE - 1), FIRST_COLUMN << SIDE - 1


@ti.func
def masked(word, mask: ti.template()):
    """Return the bits of a word that are in a mask."""
    return word & ti.u64(mask)


@ti.data_oriented
class DistanceField:
    """Distance fields on a map.

    A front moves from the body outwards, in steps of a block. The tiles that it has reached are a list in
    ``queue``, and those that it reaches next another list.
    """

    def __init__(self, occupancy: Occupancy) -> None:
        self.occupancy, self.across = occupancy, occupancy.side // NODES
        self.number = self.across**2

    @ti.func
    def bit(self, node):
        """Return the bit of a node's block."""
        x, y = self.occupancy.across(node) >> 1, self.occupancy.down(node) >> 1
        return ti.u64(1) << ti.cast(y % SIDE * SIDE + x % SIDE, ti.u64)

    @ti.func
    def node(self, tile, k):
        """Return the first node of a tile's k-th block."""
        x = tile % ti.static(self.across) * SIDE + k % SIDE
        y = tile // ti.static(self.across) * SIDE + k // SIDE
        return self.occupancy.at(2 * x, 2 * y)

    @ti.func
    def at(self, base, word: ti.template(), tile):
        """Return the index of one of a tile's words: words of a kind lie together."""
        return (base >> 2 * TILE) * WORDS + ti.static(word * self.number) + tile

    @ti.func
    def of_tile(self, base, tile):
        """Return the first index in ``odds`` of a tile's blocks."""
        return (base >> 2) + tile * SIDE * SIDE

    @ti.func
    def begin(self, memory: ti.template(), base):
        """Clear the front, and forget what was computed for dirty tiles and those next to them."""
        for tile in range(ti.static(self.number)):
            memory.tiles[self.at(base, REACHED, tile)] = ti.u64(0)
            if memory.dirty[(base >> 2 * TILE) + tile]:
                memory.dirty[(base >> 2 * TILE) + tile] = ti.cast(0, ti.u8)
                for k in range(9):
                    near = self.beside(tile, k % 3 - 1, k // 3 - 1)
                    if memory.tiles[self.at(base, KNOWN, near)] != 0:
                        memory.tiles[self.at(base, KNOWN, near)] = ti.u64(0)
                        for i in range(SIDE * SIDE):
                            memory.odds[self.of_tile(base, near) + i] = ti.cast(UNKNOWN, ti.u8)

    @ti.func
    def beside(self, tile, east, south):
        """Return the tile at an offset of some tiles to the east and to the south."""
        last = ti.static(self.across - 1)
        x, y = tile % ti.static(self.across), tile // ti.static(self.across)
        return ((y + south) & last) * ti.static(self.across) + ((x + east) & last)

    @ti.func
    def reach(self, memory: ti.template(), base, to, tile, bits, tail):
        """Reach blocks of a tile, which joins the list that begins at ``to``; return the list's new end."""
        if bits != 0:
            if memory.tiles[self.at(base, NEXT, tile)] == 0:
                memory.queue[to + tail] = ti.cast(tile, self.occupancy.number)
                tail += 1
            memory.tiles[self.at(base, NEXT, tile)] = memory.tiles[self.at(base, NEXT, tile)] | bits
        return tail

    @ti.func
    def source(self, memory: ti.template(), base, to, px, py):
        """Begin at the body: on the nodes within half a cell, and on the open nodes next to them.

        Returns the list's end, and one of the body's nodes.
        """
        tail, here = 0, self.occupancy.at(px >> 1, py >> 1)
        for k in range(4):
            x, y = (px + (k & 1)) >> 1, (py + (k >> 1)) >> 1
            if not self.occupancy.solid(memory, base, x, y):
                here = self.occupancy.at(x, y)
            for h in range(5):
                i = x + ti.select(h == 1, 1, 0) - ti.select(h == 2, 1, 0)
                j = y + ti.select(h == 3, 1, 0) - ti.select(h == 4, 1, 0)
                node = self.occupancy.at(i, j)
                if h == 0 or self.occupancy.open(memory, base, node):
                    tile, bit = self.occupancy.tile(node), self.bit(node)
                    tail = self.reach(memory, base, to, tile, bit, tail)
        return tail, here

    @ti.func
    def settle(self, memory: ti.template(), base, tile):
        """Return the blocks of a tile that the front has just reached for the first time."""
        latest = memory.tiles[self.at(base, NEXT, tile)] & ~memory.tiles[self.at(base, REACHED, tile)]
        memory.tiles[self.at(base, NEXT, tile)] = ti.u64(0)
        memory.tiles[self.at(base, LATEST, tile)] = latest
        memory.tiles[self.at(base, REACHED, tile)] = memory.tiles[self.at(base, REACHED, tile)] | latest
        return latest

    @ti.func
    def spread_vertically(self, memory: ti.template(), base, to, tile, bits, tail):
        """Reach blocks of a tile, and those north and south of them; return the list's new end."""
        north, south = self.beside(tile, 0, -1), self.beside(tile, 0, 1)
        joined, above = memory.tiles[self.at(base, SOUTH, tile)], memory.tiles[self.at(base, SOUTH, north)]
        down = bits & joined
        near = bits | (masked(down, ALL ^ LAST_ROW) << SIDE) | ((bits >> SIDE) & joined)
        tail = self.reach(memory, base, to, tile, near, tail)
        over = masked(down, LAST_ROW) >> ti.static(SIDE * (SIDE - 1))
        tail = self.reach(memory, base, to, south, over, tail)
        under = (masked(bits, FIRST_ROW) << ti.static(SIDE * (SIDE - 1))) & above
        return self.reach(memory, base, to, north, under, tail)

    @ti.func
    def spread(self, memory: ti.template(), base, to, tile, tail):
        """Move the front on from the blocks of a tile that it reached last; return the list's new end."""
        west, east = self.beside(tile, -1, 0), self.beside(tile, 1, 0)
        for k in range(6):
            self.connect(memory, base, self.beside(tile, k % 3 - 1, k // 3 - 1))
        bits, joined = memory.tiles[self.at(base, LATEST, tile)], memory.tiles[self.at(base, EAST, tile)]
        ahead = bits & joined
        near = (
            bits | (masked(ahead, ALL ^ LAST_COLUMN) << 1) | ((bits >> 1) & masked(joined, ALL ^ LAST_COLUMN))
        )
        tail = self.spread_vertically(memory, base, to, tile, near, tail)
        over = masked(ahead, LAST_COLUMN) >> ti.static(SIDE - 1)
        if over != 0:
            tail = self.spread_vertically(memory, base, to, east, over, tail)
        under = (masked(bits, FIRST_COLUMN) << ti.static(SIDE - 1)) & memory.tiles[self.at(base, EAST, west)]
        if under != 0:
            tail = self.spread_vertically(memory, base, to, west, under, tail)
        return tail

    @ti.func
    def connect(self, memory: ti.template(), base, tile):
        """Compute which blocks of a tile are connected with the next ones, if that is not known.

        A block whose open nodes touch only at a corner is connected with none.
        """
        if memory.tiles[self.at(base, KNOWN, tile)] == 0:
            memory.tiles[self.at(base, KNOWN, tile)] = ti.u64(1)
            x, y = (tile % ti.static(self.across)) * NODES, (tile // ti.static(self.across)) * NODES
            east, south, open_ = ti.u64(0), ti.u64(0), ti.u64(0)
            c_, d_ = ti.u32(0), ti.u32(0)
            for j in range(SIDE + 1):
                a, b = self.row(memory, base, x, y + 2 * j)
                c, d = self.row(memory, base, x, y + 2 * j + 1)
                upper = self.packed(a)
                whole = ~((a & d & ~b & ~c) | (b & c & ~a & ~d))
                a, b, c, d = a & whole, b & whole, c & whole, d & whole
                if j < SIDE:
                    open_ |= upper << ti.cast(SIDE * j, ti.u64)
                    along = self.packed((b & (a >> 2)) | (d & (c >> 2)))
                    east |= along << ti.cast(SIDE * j, ti.u64)
                if j > 0:
                    down = self.packed((c_ & a) | (d_ & b))
                    south |= down << ti.cast(SIDE * (j - 1), ti.u64)
                c_, d_ = c, d
            memory.tiles[self.at(base, EAST, tile)], memory.tiles[self.at(base, SOUTH, tile)] = east, south
            memory.tiles[self.at(base, OPEN, tile)] = open_

    @ti.func
    def row(self, memory: ti.template(), base, x, y):
        """Return the open nodes in a row of a tile's blocks and the next tile's, on even bits.

        The first word has the first node of each block, the second word the second.
        """
        bits = ti.u32(0)
        for k in range(NODES + 2):
            open_ = self.occupancy.open(memory, base, self.occupancy.at(x + k, y))
            bits |= ti.cast(open_, ti.u32) << ti.cast(k, ti.u32)
        even = ti.u32(0x15555)
        return bits & even, (bits >> 1) & even

    @ti.func
    def packed(self, bits):
        """Return the even bits of a 16-bit word as 8 bits of a 64-bit word."""
        bits &= ti.u32(0x5555)
        bits = (bits | (bits >> 1)) & ti.u32(0x3333)
        bits = (bits | (bits >> 2)) & ti.u32(0x0F0F)
        return ti.cast((bits | (bits >> 4)) & ti.u32(0xFF), ti.u64)
