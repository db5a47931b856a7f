"""Part of a window that a network must read: the seen ground and a margin about it."""

from types import EllipsisType
from typing import NamedTuple

import torch
from torch import Tensor

from vitruvius.agent.algorithms.search.windows import LEVELS, PLACES, ViewMaps

MARGIN_PLACES = 4
"""Margin about seen ground that is read, too, in places: 2.3 m at the default body."""

UNIT_PLACES = 8
"""Unit of a part's height and width, in places: a network halves them three times."""


class Box(NamedTuple):
    """Part of each of n windows, all of one size."""

    south: list[int]
    """Places from each window's north edge to its part."""

    east: list[int]
    """Places from each window's west edge to its part."""

    high: int
    wide: int

    def slices(self, scale: int) -> list[tuple[EllipsisType, slice, slice]]:
        """Return the index of each window's part, with ``scale`` rows and columns for each place."""
        return [
            (..., slice(scale * i, scale * (i + self.high)), slice(scale * j, scale * (j + self.wide)))
            for i, j in zip(self.south, self.east, strict=True)
        ]

    def cut(self, field: Tensor) -> Tensor:
        """Return the parts (n, ..., high, wide) of a field (n, ..., G, G); of 2G, parts of twice the size."""
        scale = field.shape[-1] // PLACES
        made = field.new_empty((*field.shape[:-2], scale * self.high, scale * self.wide))
        for n, part in enumerate(self.slices(scale)):
            made[n] = field[n][part]
        return made

    def whole(self, field: Tensor, nothing: float) -> Tensor:
        """Return windows (n, ..., G, G) from their parts (n, ..., high, wide), with ``nothing`` around.

        Parts of twice the size become windows of 2G.
        """
        scale = field.shape[-2] // self.high
        made = field.new_full((*field.shape[:-2], scale * PLACES, scale * PLACES), nothing)
        for n, part in enumerate(self.slices(scale)):
            made[n][part] = field[n]
        return made


def spans(maps: ViewMaps) -> Tensor:
    """Return the places (n, 2, 2) int64 that parts must include, south and east: first, and last plus one."""
    seen, found = maps.blocks >= LEVELS, []
    for axis in (2, 1):
        some = seen.any(axis).view(len(seen), PLACES, 2).any(2).byte()
        first, last = some.argmax(1), PLACES - some.flip(1).argmax(1)
        found.append(
            torch.stack([(first - MARGIN_PLACES).clamp(min=0), (last + MARGIN_PLACES).clamp(max=PLACES)], 1)
        )
    return torch.stack(found, 1)


def box(maps: ViewMaps) -> Box:
    """Return the smallest part of the windows with all seen ground and ``MARGIN_PLACES`` around it."""
    first, last = spans(maps).unbind(2)
    high, wide = (UNIT_PLACES * -(-int(size) // UNIT_PLACES) for size in (last - first).amax(0))
    south, east = torch.minimum(first, torch.tensor([PLACES - high, PLACES - wide])).T.tolist()
    return Box(south, east, high, wide)


def by_size(maps: ViewMaps) -> Tensor:
    """Return an order (n,) int64 in which windows with large parts are together."""
    first, last = spans(maps).unbind(2)
    return (last - first).prod(1).argsort(stable=True)


def cropped(maps: ViewMaps, part: Box) -> ViewMaps:
    """Return the parts of maps as maps, without the worth of their views."""
    fields = {
        name: part.cut(field)
        for name, field in maps._asdict().items()
        if field.dim() >= 3 and field.shape[-1] >= PLACES and name != "worth"
    }
    start = maps.start - torch.tensor([part.south, part.east]).T
    return maps._replace(start=start, **fields)
