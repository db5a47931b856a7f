"""Room of a body and obstacles in its way, for terms that read them.

Kernels read rooms and pieces of furniture from one table:

    surroundings  H x (first room, rooms, rooms with a mark, first piece, pieces) | rooms (west, north, east,
                  south, mark, 1 if no other room overlaps the room) and pieces (west, north, east, south, the
                  code of the piece in observations, 0); floats as bits
    rooms         the last room of each environment, where the search for the current room begins
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from vitruvius.logic import House
from vitruvius.sim.backends.backend import WALL, Bank
from vitruvius.sim.backends.piece_kinds import codes
from vitruvius.sim.config import Config
from vitruvius.sim.runtime import Array, ti
from vitruvius.sim.tasks.terms import Terms

HEADER = 5
"""Number of integers of a house in the table's header."""

ROW = 6
"""Number of integers of a room, and of a piece."""


def surroundings(houses: Sequence[House], bank: Bank, config: Config, terms: Terms) -> Array:
    """Return the table of a bank's rooms and pieces.

    Raises ``ValueError`` if the terms refuse a house, or do not return one mark for each room.
    """
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
    """Return a mask (n,) bool of the boxes (n, 4) that overlap no other box; boxes may touch."""
    low, high = boxes[:, :2], boxes[:, 2:]
    return ((low[:, None] < high) & (low < high[:, None])).all(axis=2).sum(axis=1) == 1


@ti.data_oriented
class Surroundings:
    """Functions of kernels that look up a body's room, and the obstacle in its way."""

    def __init__(self, body: Any) -> None:
        """Take the body of a backend."""
        self.body = body

    @ti.func
    def box(self, table: ti.template(), at):
        """Return the box of a row (west, north, east, south)."""
        return ti.Vector([ti.bit_cast(table[at + k], ti.f32) for k in range(4)])

    @ti.func
    def room(self, table: ti.template(), rooms: ti.template(), e, house, place):
        """Return the first room that contains a place (-1: none), its mark, and the count of marked rooms."""
        header = house * HEADER
        at, count, last = table[header], table[header + 1], ti.max(0, rooms[e])
        room, mark, k = -1, 0, 0
        if last < count:
            # A place inside a room without overlaps is in no other room.
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
        """Return the distance from a place in a box to the nearest side, metres; negative outside the box."""
        return ti.min(place[0] - box[0], box[2] - place[0], place[1] - box[1], box[3] - place[1])

    @ti.func
    def bumped(self, table: ti.template(), house, origin, cell, new_origin, new, width):
        """Return the code of the obstacle between two cells."""
        header, found = house * HEADER, ti.static(WALL)
        at = table[header + 3]
        for k in range(table[header + 4]):
            if found == ti.static(WALL):  # noqa: SIM102 - ``and`` computes both sides
                if self.body.meets(self.box(table, at + ROW * k), origin, cell, new_origin, new, width):
                    found = table[at + ROW * k + 4]
        return found
