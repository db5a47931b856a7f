"""What terms see of a house about a body: the room that it is in, and what it bumps into.

Kernels read them from one table:

    surroundings  H x (first room, rooms, rooms with a mark, first piece, pieces) | rooms (west, north, east,
                  south, mark, whether no other lies over it) and pieces (west, north, east, south, what a
                  ray says of it, 0); floats as bits
    rooms         for each environment the room that it was in last, where it is looked for first
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from logic import House
from sim.backends.backend import DOOR, WALL, Bank
from sim.backends.kinds import codes
from sim.config import Config
from sim.runtime import Array, ti
from sim.tasks.terms import Terms

HEADER = 5
"""Whole numbers of a house before all rows."""

ROW = 6
"""Whole numbers of a room, and of a piece."""


def surroundings(houses: Sequence[House], bank: Bank, config: Config, terms: Terms) -> Array:
    """A bank's rooms and pieces as kernels read them; where terms see none, an array that nothing reads.

    Raises ``ValueError`` where terms refuse a house, or mark other rooms than it has.
    """
    if not terms.surveys:
        return Array(ti.i32, 1)
    header, rows, at = np.zeros((len(houses), HEADER), np.int32), list[np.ndarray](), HEADER * len(houses)
    for k, (house, shape) in enumerate(zip(houses, bank.geometries, strict=True)):
        try:
            marks = [int(mark) for mark in terms.marks(house)]
            if len(marks) != len(house.rooms):
                raise ValueError(f"{len(marks)} marks for {len(house.rooms)} rooms")
        except ValueError as error:
            raise ValueError(f"house {k} of {len(houses)}: {error}") from None
        pieces = [piece.box for room in house.rooms for piece in room.pieces]
        header[k] = (
            at, len(marks), np.count_nonzero(marks), at + ROW * len(marks), len(pieces),
        )  # fmt: skip
        boxes = np.array([*(room.box for room in house.rooms), *pieces], np.float32).view(np.int32)
        said = [*marks, *codes(house, shape, config.kinds)[: len(pieces)]]
        alone = [*_alone(boxes[: len(marks)].view(np.float32)), *[0] * len(pieces)]
        rows.append(np.column_stack([boxes, np.array([said, alone], np.int32).T]).ravel())
        at += len(rows[-1])
    return Array.of(np.concatenate([header.ravel(), *rows]))


def _alone(boxes: np.ndarray) -> np.ndarray:
    """Which boxes (n, 4) no other one lies over, (n,) bool; touching is not lying over."""
    low, high = boxes[:, :2], boxes[:, 2:]
    return ((low[:, None] < high) & (low < high[:, None])).all(axis=2).sum(axis=1) == 1


@ti.data_oriented
class Surroundings:
    """Looks up what is about a body."""

    def __init__(self, body: Any) -> None:
        """For bodies of a backend."""
        self.body = body

    @ti.func
    def box(self, table: ti.template(), at):
        """The box of a row (west, north, east, south)."""
        return ti.Vector([ti.bit_cast(table[at + k], ti.f32) for k in range(4)])

    @ti.func
    def room(self, table: ti.template(), rooms: ti.template(), e, house, place):
        """The first room that a place is in, -1 for none; its mark, and how many rooms have one."""
        header = house * HEADER
        at, count, last = table[header], table[header + 1], ti.max(0, rooms[e])
        room, mark, k = -1, 0, 0
        if last < count:
            # Well inside a room that no other lies over, it is that one.
            row = at + ROW * last
            if table[row + 5] > 0 and self.depth(self.box(table, row), place) > 0:
                room = last
        while room < 0 and k < count:
            if self.depth(self.box(table, at + ROW * k), place) >= 0:
                room = k
            k += 1
        if room >= 0:
            mark = table[at + ROW * room + 4]
        rooms[e] = room
        return room, mark, table[header + 2]

    @ti.func
    def depth(self, box, place):
        """How far a place is inside a box, metres; negative outside."""
        return ti.min(place[0] - box[0], box[2] - place[0], place[1] - box[1], box[3] - place[1])

    @ti.func
    def bumped(self, table: ti.template(), house, origin, cell, new_origin, new, door, width):
        """What is in the way of a body from a cell to a new one; ``door``: a closed one, -1 for none."""
        header, found = house * HEADER, ti.static(WALL)
        at = table[header + 3]
        for k in range(table[header + 4]):
            if found == ti.static(WALL):  # noqa: SIM102 - ``and`` computes both sides
                if self.body.meets(self.box(table, at + ROW * k), origin, cell, new_origin, new, width):
                    found = table[at + ROW * k + 4]
        return ti.select(door >= 0, ti.static(DOOR), found)
