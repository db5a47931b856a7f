"""Packing of houses for the free backend: solids and lines as rows of numbers; see ``layout.py``."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vitruvius.logic import House
from vitruvius.sim.backends.backend import WALL, Bank
from vitruvius.sim.backends.blocks import CELL, HEADER
from vitruvius.sim.backends.free.layout import ROW
from vitruvius.sim.backends.free.lists import listed_arrays
from vitruvius.sim.backends.piece_kinds import codes
from vitruvius.sim.backends.rays import overlap
from vitruvius.sim.config import Config
from vitruvius.sim.geometry import Geometry, geometry


def pack(houses: Sequence[House], config: Config) -> Bank:
    """Copy houses to the device: solids, lines and lists."""
    shapes = [geometry(house) for house in houses]
    parts = [
        _Share.of(shape, codes(house, shape, config.kinds), max(config.body))
        for shape, house in zip(shapes, houses, strict=True)
    ]
    count = len(parts)
    numbers, at = [np.array([part.corner for part in parts], np.float32).ravel()], 2 * count
    header = np.zeros((count, HEADER), np.int32)
    cell = header.size
    for k, part in enumerate(parts):
        solids, lines = len(part.solids), len(part.lines)
        across_x, across = part.across
        header[k] = (at, solids, at + ROW * solids, lines, across_x, cell, *part.used.shape, across)
        numbers += [part.solids.astype(np.float32).ravel(), part.lines.astype(np.float32).ravel()]
        at += ROW * (solids + lines)
        cell += part.used.size
    used = np.concatenate([part.used.T.ravel() for part in parts])  # by rows, the order of look-ups
    return Bank(shapes, *listed_arrays(np.concatenate(numbers), header, used, config))


@dataclass(frozen=True)
class _Share:
    """Part of a bank that belongs to one house: rows for ``numbers``, and the cells in use.

    ``used`` (columns, rows) is a mask of the cells that a body may be in.
    """

    corner: tuple[float, float]
    used: np.ndarray
    solids: np.ndarray
    lines: np.ndarray
    across: tuple[int, int]

    @classmethod
    def of(cls, shape: Geometry, kinds: list[int], body: float) -> "_Share":
        boxes, slanted, last = shape.solids, shape.slanted, len(shape.solids) - len(shape.filled)
        solids = np.vstack([_along_longer_side(boxes), slanted])
        lined = np.vstack(
            [_along_longer_side(boxes[:last]), slanted]
        )  # rays end at walls before what is filled
        kind = np.concatenate(
            [
                np.full(len(shape.verticals) + len(shape.horizontals), WALL),
                kinds,
                np.full(len(slanted), WALL),
            ]
        )
        lines = _sides(lined, kind)
        # Across x, across y, at an angle: a line along an axis has a unit vector that is exactly one.
        order = np.select([lines[:, 2] == 0, lines[:, 3] == 0], [0, 1], 2)
        lines = lines[np.argsort(order, kind="stable")]
        across = int((order == 0).sum()), int((order <= 1).sum())
        west, north, east, south = shape.bounds
        size = int((east - west) / CELL) + 1, int((south - north) / CELL) + 1
        middle = np.stack(np.meshgrid(*(np.arange(n) for n in size), indexing="ij"), axis=-1) + 0.5
        middle = np.array([west, north]) + CELL * middle
        rooms = np.vstack([shape.floor, shape.rooms, shape.doorways])
        near = np.abs(middle[:, :, None] - rooms[:, :2]) < rooms[:, 2:] + CELL / 2 + body
        return cls((west, north), np.all(near, axis=3).any(axis=2), solids, lines, across)


def _along_longer_side(boxes: np.ndarray) -> np.ndarray:
    """Return boxes (n, 4) as solids (n, 6)."""
    upright = boxes[:, 3] > boxes[:, 2]
    way = np.where(upright[:, None], [0.0, 1.0], [1.0, 0.0])
    half = np.where(upright[:, None], boxes[:, [3, 2]], boxes[:, 2:])
    return np.hstack([boxes[:, :2], way, half])


def _sides(solids: np.ndarray, kinds: np.ndarray) -> np.ndarray:
    """Return the sides of solids as lines (n, 6), each with its outside at (v, -u) of its direction (u, v).

    A segment has a single line, which is visible from both sides.
    """
    rows = []
    ends = [solids[:, :2] + sign * solids[:, 4:5] * solids[:, 2:4] for sign in (-1, 1)]
    more = overlap(np.hstack(ends).reshape(-1, 4)).tolist()
    for (x, y, u, v, half, thick), kind, beyond in zip(solids.tolist(), kinds.tolist(), more, strict=True):
        if thick == 0:
            rows.append((x, y, u, v, half + beyond, -kind))
            continue
        for a, b, far, long in (
            (u, v, thick, half),
            (-u, -v, thick, half),
            (-v, u, half, thick),
            (v, -u, half, thick),
        ):
            rows.append((x + far * b, y - far * a, a, b, long + beyond, kind))
    return np.array(rows, np.float64).reshape(-1, ROW)
