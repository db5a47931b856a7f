"""Packing of houses for the continuous backend: boxes, lines and rooms as rows of numbers.

``layout.py`` explains the rows.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vitruvius.logic import House
from vitruvius.sim.backends.backend import WALL, Bank
from vitruvius.sim.backends.blocks import CELL, HEADER
from vitruvius.sim.backends.continuous.lists import listed_arrays
from vitruvius.sim.backends.piece_kinds import codes
from vitruvius.sim.backends.rays import overlap
from vitruvius.sim.config import Config
from vitruvius.sim.geometry import Geometry, geometry

ANYWHERE = np.array([0, 0, 1e6, 1e6])
"""A rectangle that contains every house."""


def pack(houses: Sequence[House], config: Config) -> Bank:
    """Copy houses to the device: boxes, lines and lists."""
    shapes = [geometry(house) for house in houses]
    for index, house in enumerate(houses):
        if config.collision == "original" and house.main_room is None:
            raise ValueError(
                f"house {index} of {len(houses)}: collision 'original' needs rooms with one door, to a main "
                f"room, and does not support the topology {house.topology!r}: use the preset 'default'"
            )
    parts = [
        _Part.of(shape, house.main_room is not None, codes(house, shape, config.kinds))
        for shape, house in zip(shapes, houses, strict=True)
    ]
    count = len(parts)
    numbers, at = [np.array([part.corner for part in parts], np.float32).ravel()], 2 * count
    header = np.zeros((count, HEADER), np.int32)
    cell = header.size
    for k, part in enumerate(parts):
        boxes, lines = len(part.boxes), len(part.lines)
        floor = at + 4 * (boxes + lines)
        counts = at, boxes, at + 4 * part.walls, floor, len(part.rooms) - 1
        header[k] = (*counts, cell, *part.size, at + 4 * boxes)
        rows = np.concatenate([part.boxes, part.lines, part.rooms.reshape(-1, 4)], dtype=np.float32).ravel()
        numbers.append(rows)
        at += len(rows)
        cell += part.size[0] * part.size[1]
    lines = np.array([(len(part.lines), part.across_x) for part in parts])
    return Bank(shapes, *listed_arrays(np.concatenate(numbers), header, lines, config))


@dataclass(frozen=True)
class _Part:
    """Part of a bank that belongs to one house: rows for ``numbers``."""

    corner: tuple[float, float]
    size: tuple[int, int]
    boxes: np.ndarray
    walls: int
    lines: np.ndarray
    across_x: int
    rooms: np.ndarray

    @classmethod
    def of(cls, shape: Geometry, one_door: bool, kinds: list[int]) -> "_Part":
        solids = shape.solids
        boxes = np.hstack([solids[:, :2] - solids[:, 2:], solids[:, :2] + solids[:, 2:]])
        walls = len(shape.verticals) + len(shape.horizontals)
        pieces = boxes[walls : len(boxes) - len(shape.filled)]
        west, north, east, south = shape.bounds
        across = [_lines(boxes[: len(shape.verticals)], pieces, kinds, axis=0)]
        across += [_lines(boxes[len(shape.verticals) : walls], pieces, kinds, axis=1)]
        astride = shape.floor if shape.overlapping else ANYWHERE
        # Only the original program's rule reads doors, and it needs rooms with one door.
        doors = np.vstack([astride, shape.doors if one_door else shape.rooms])
        rooms = np.stack([np.vstack([shape.floor, shape.rooms]), doors], axis=1)
        columns, rows = int((east - west) / CELL) + 1, int((south - north) / CELL) + 1
        return cls((west, north), (columns, rows), boxes, walls, np.vstack(across), len(across[0]), rooms)


def _lines(walls: np.ndarray, pieces: np.ndarray, kinds: list[int], axis: int) -> np.ndarray:
    """Return the lines across an axis, (n, 4) float32: position, middle, half length, kind.

    The kind is negative for a side of furniture that faces west or north.
    """
    other = 1 - axis
    rows = [
        np.column_stack([walls[:, axis], walls[:, other], walls[:, other + 2], np.full(len(walls), WALL)])
    ]
    for side, sign in ((axis, -1), (axis + 2, 1)):
        kind = sign * np.array(kinds)
        rows.append(np.column_stack([pieces[:, side], pieces[:, other], pieces[:, other + 2], kind]))
    at, low, high, kind = np.vstack(rows).astype(np.float32).T
    half, more = np.float32(0.5), overlap(np.column_stack([at, low, high])).astype(np.float32)
    return np.column_stack([at, half * (low + high), half * (high - low) + more, kind])
