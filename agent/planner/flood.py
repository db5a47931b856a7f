"""How far away all places are: a flood that rises from the body by blocks of 2 by 2 nodes, 64 in a word.

A choice of a view asks for the length of the ways to all places, but not which way to go: so blocks will
do, and whole words of them can be flooded at a time. A block is one with the next where two nodes that lie
side by side, one of each, are both open. In a step the flood rises to the east and the west, and then from
all that to the north and the south, so diagonally too. Where it comes, but for where it begins, ways of nodes
lead as well. What was found of a tile, 8 by 8 blocks, is kept until there are news in it or beside it.
"""

from agent.planner.cells import TILE, Grid
from sim.runtime import ti

NODES, SIDE = 1 << TILE, 1 << TILE - 1
"""Nodes and blocks along each side of a tile, whose 64 blocks are the bits of one word, row by row."""

EAST, SOUTH, OPEN, KNOWN, WET, RISING, COMING = range(7)
"""A tile's words: which blocks are one with the next one to the east, and to the south; of which the first
node is open; whether these are known; and which the flood has come to, came to last, and comes to now."""

WORDS = COMING + 1
"""How many words a tile has."""

UNASKED = (1 << 8) - 1
"""A guess that was not made yet, of what a hiding place counts."""

Words = ti.types.ndarray(ti.u64, 1)

# The bits of a tile's first and last blocks in each column and in each row.
ALL = (1 << SIDE * SIDE) - 1
FIRST_ROW = (1 << SIDE) - 1
FIRST_COLUMN = sum(1 << SIDE * row for row in range(SIDE))
LAST_ROW, LAST_COLUMN = FIRST_ROW << SIDE * (SIDE - 1), FIRST_COLUMN << SIDE - 1


@ti.func
def masked(word, mask: ti.template()):
    """The bits of a word that are in a mask."""
    return word & ti.u64(mask)


@ti.data_oriented
class Flood:
    """Floods on a grid. ``tiles`` has so many ``words`` for each environment, ``guesses`` for each block what
    it counts as a hiding place, once that was asked; ``news`` tells in which tiles something is new.
    """

    def __init__(self, grid: Grid) -> None:
        """Flood this grid."""
        self.grid, self.across = grid, grid.side // NODES
        self.number = self.across**2
        self.words = WORDS * self.number

    @ti.func
    def bit(self, node):
        """The bit of the block that a node is in."""
        x, y = self.grid.across(node) >> 1, self.grid.down(node) >> 1
        return ti.u64(1) << ti.cast(y % SIDE * SIDE + x % SIDE, ti.u64)

    @ti.func
    def node(self, tile, k):
        """The first node of a tile's k-th block."""
        x = tile % ti.static(self.across) * SIDE + k % SIDE
        y = tile // ti.static(self.across) * SIDE + k // SIDE
        return self.grid.at(2 * x, 2 * y)

    @ti.func
    def at(self, first, word: ti.template(), tile):
        """Where one of a tile's words is: words of a kind lie together."""
        return first + ti.static(word * self.number) + tile

    @ti.func
    def guess(self, base, tile):
        """Where the guesses of a tile's blocks begin."""
        return (base >> 2) + tile * SIDE * SIDE

    @ti.func
    def begin(self, tiles: ti.template(), news: ti.template(), guesses: ti.template(), base, first):
        """Let all run dry, in the words that begin at ``first``, and forget what was found of tiles in which
        there are news, or beside them.
        """
        for tile in range(ti.static(self.number)):
            tiles[self.at(first, WET, tile)] = ti.u64(0)
            if news[(base >> 2 * TILE) + tile]:
                news[(base >> 2 * TILE) + tile] = ti.cast(0, ti.u8)
                for k in range(9):
                    near = self.beside(tile, k % 3 - 1, k // 3 - 1)
                    if tiles[self.at(first, KNOWN, near)] != 0:
                        tiles[self.at(first, KNOWN, near)] = ti.u64(0)
                        for i in range(SIDE * SIDE):
                            guesses[self.guess(base, near) + i] = ti.cast(UNASKED, ti.u8)

    @ti.func
    def beside(self, tile, east, south):
        """The tile that lies so many to the east and to the south."""
        last = ti.static(self.across - 1)
        x, y = tile % ti.static(self.across), tile // ti.static(self.across)
        return ((y + south) & last) * ti.static(self.across) + ((x + east) & last)

    @ti.func
    def pour(self, tiles: ti.template(), agenda: ti.template(), first, to, tile, bits, tail):
        """Let the flood come to blocks of a tile, which joins the list that begins at ``to``; its new end."""
        if bits != 0:
            if tiles[self.at(first, COMING, tile)] == 0:
                agenda[to + tail] = ti.cast(tile, ti.u16)
                tail += 1
            tiles[self.at(first, COMING, tile)] = tiles[self.at(first, COMING, tile)] | bits
        return tail

    @ti.func
    def source(
        self, cells: ti.template(), tiles: ti.template(), agenda: ti.template(), base, first, to, px, py
    ):
        """Let the flood begin at the body: on the nodes within half a cell and those beside them, as far as
        they are open. The list's end, and one of the body's nodes.
        """
        tail, here = 0, self.grid.at(px >> 1, py >> 1)
        for k in range(4):
            x, y = (px + (k & 1)) >> 1, (py + (k >> 1)) >> 1
            if not self.grid.solid(cells, base, x, y):
                here = self.grid.at(x, y)
            for h in range(5):
                i = x + ti.select(h == 1, 1, 0) - ti.select(h == 2, 1, 0)
                j = y + ti.select(h == 3, 1, 0) - ti.select(h == 4, 1, 0)
                node = self.grid.at(i, j)
                if h == 0 or self.grid.open(cells, base, node):
                    tile, bit = self.grid.tile(node), self.bit(node)
                    tail = self.pour(tiles, agenda, first, to, tile, bit, tail)
        return tail, here

    @ti.func
    def settle(self, tiles: ti.template(), first, tile):
        """The blocks of a tile that the flood has just come to for the first time."""
        rising = tiles[self.at(first, COMING, tile)] & ~tiles[self.at(first, WET, tile)]
        tiles[self.at(first, COMING, tile)] = ti.u64(0)
        tiles[self.at(first, RISING, tile)] = rising
        tiles[self.at(first, WET, tile)] = tiles[self.at(first, WET, tile)] | rising
        return rising

    @ti.func
    def upright(self, tiles: ti.template(), agenda: ti.template(), first, to, tile, bits, tail):
        """Let blocks of a tile, and those north and south of them, come to the list; its new end."""
        north, south = self.beside(tile, 0, -1), self.beside(tile, 0, 1)
        joined, above = tiles[self.at(first, SOUTH, tile)], tiles[self.at(first, SOUTH, north)]
        down = bits & joined
        near = bits | (masked(down, ALL ^ LAST_ROW) << SIDE) | ((bits >> SIDE) & joined)
        tail = self.pour(tiles, agenda, first, to, tile, near, tail)
        over = masked(down, LAST_ROW) >> ti.static(SIDE * (SIDE - 1))
        tail = self.pour(tiles, agenda, first, to, south, over, tail)
        under = (masked(bits, FIRST_ROW) << ti.static(SIDE * (SIDE - 1))) & above
        return self.pour(tiles, agenda, first, to, north, under, tail)

    @ti.func
    def rise(
        self, cells: ti.template(), tiles: ti.template(), agenda: ti.template(), base, first, to, tile, tail
    ):
        """Let the flood go on from the blocks of a tile that it came to last, to those beside them."""
        west, east = self.beside(tile, -1, 0), self.beside(tile, 1, 0)
        for k in range(6):
            self.know(cells, tiles, base, first, self.beside(tile, k % 3 - 1, k // 3 - 1))
        bits, joined = tiles[self.at(first, RISING, tile)], tiles[self.at(first, EAST, tile)]
        ahead = bits & joined
        near = (
            bits | (masked(ahead, ALL ^ LAST_COLUMN) << 1) | ((bits >> 1) & masked(joined, ALL ^ LAST_COLUMN))
        )
        tail = self.upright(tiles, agenda, first, to, tile, near, tail)
        over = masked(ahead, LAST_COLUMN) >> ti.static(SIDE - 1)
        if over != 0:
            tail = self.upright(tiles, agenda, first, to, east, over, tail)
        under = (masked(bits, FIRST_COLUMN) << ti.static(SIDE - 1)) & tiles[self.at(first, EAST, west)]
        if under != 0:
            tail = self.upright(tiles, agenda, first, to, west, under, tail)
        return tail

    @ti.func
    def know(self, cells: ti.template(), tiles: ti.template(), base, first, tile):
        """Find which blocks of a tile are one with the next ones, if that is not known yet. Of a block whose
        open nodes touch at a corner alone, none counts.
        """
        if tiles[self.at(first, KNOWN, tile)] == 0:
            tiles[self.at(first, KNOWN, tile)] = ti.u64(1)
            x, y = (tile % ti.static(self.across)) * NODES, (tile // ti.static(self.across)) * NODES
            east, south, open_ = ti.u64(0), ti.u64(0), ti.u64(0)
            c_, d_ = ti.u32(0), ti.u32(0)
            for j in range(SIDE + 1):
                a, b = self.row(cells, base, x, y + 2 * j)
                c, d = self.row(cells, base, x, y + 2 * j + 1)
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
            tiles[self.at(first, EAST, tile)], tiles[self.at(first, SOUTH, tile)] = east, south
            tiles[self.at(first, OPEN, tile)] = open_

    @ti.func
    def row(self, cells: ti.template(), base, x, y):
        """Which nodes are open in a row of a tile's blocks and the next one's, on even bits: the first one of
        each block, and the second.
        """
        bits = ti.u32(0)
        for k in range(NODES + 2):
            bits |= ti.cast(self.grid.open(cells, base, self.grid.at(x + k, y)), ti.u32) << ti.cast(k, ti.u32)
        even = ti.u32(0x15555)
        return bits & even, (bits >> 1) & even

    @ti.func
    def packed(self, bits):
        """The even ones of 16 bits, as 8 of 64."""
        bits &= ti.u32(0x5555)
        bits = (bits | (bits >> 1)) & ti.u32(0x3333)
        bits = (bits | (bits >> 2)) & ti.u32(0x0F0F)
        return ti.cast((bits | (bits >> 4)) & ti.u32(0xFF), ti.u64)
