"""Windows of maps about bodies, as the network that searches reads them."""

from typing import NamedTuple

import torch
import torch.nn.functional as F
from torch import Tensor

PLACES = 48
"""Places along each side of a window, G: 27.5 m at the default body, which is at the one in the middle."""

HEADINGS = 8

FAR = -1
"""Distance of a place to which no path is known."""

LEVELS = 5
"""Number of values of a count of a block's cells, 0 to 4."""

FORESEEN = 4
"""Number of predictions of a block: see ``ViewNetwork.foresee``."""

SCALE = 100.0
"""Number of steps per which values count targets."""


class ViewMaps(NamedTuple):
    """Windows of n maps, G places and 2 G blocks a side, with scalar inputs and labels."""

    blocks: Tensor
    """(n, 2G, 2G) uint8: number of a block's four cells that are occupied, plus ``LEVELS`` times the number
    of those seen, plus ``LEVELS`` squared times the number of those seen since the last pick-up."""

    ages: Tensor
    """(n, 2G, 2G) uint8: 0 for never seen, else 1 + 16 log2(1 + steps since)."""

    ways: Tensor
    """(n, G, G) int16: nodes of the path to each place, ``FAR`` if none is known."""

    finds: Tensor
    """(n, G, G) uint8: number of targets picked up at each place."""

    taken: Tensor
    """(n, G, G) uint8, one bit for each heading: goals since the last pick-up."""

    start: Tensor
    """(n, 2) float32: start of the episode, places south and east of the first place."""

    scalars: Tensor
    """(n, 3) float32: fraction of the episode that is over; time since the last pick-up; number of
    pick-ups."""

    heading: Tensor
    """(n,) int64: heading of the body."""

    worth: Tensor
    """(n, 8, G, G) float16: worth of each view in the true house, targets per ``SCALE`` steps; or empty."""

    foreseen: Tensor
    """(n, ``FORESEEN``, 2G, 2G) uint8: see ``ViewNetwork.foresee``; or empty."""

    shown: Tensor
    """(n, 8, G, G) float16: fraction of the targets expected in the window that each octant of a place would
    show (``ViewLooks``); or empty."""


def empty(number: int) -> ViewMaps:
    """Return memory for ``number`` maps with labels."""
    blocks, places = (number, 2 * PLACES, 2 * PLACES), (number, PLACES, PLACES)
    return ViewMaps(
        blocks=torch.zeros(blocks, dtype=torch.uint8),
        ages=torch.zeros(blocks, dtype=torch.uint8),
        ways=torch.zeros(places, dtype=torch.int16),
        finds=torch.zeros(places, dtype=torch.uint8),
        taken=torch.zeros(places, dtype=torch.uint8),
        start=torch.zeros(number, 2),
        scalars=torch.zeros(number, 3),
        heading=torch.zeros(number, dtype=torch.int64),
        worth=torch.zeros(number, HEADINGS, PLACES, PLACES, dtype=torch.float16),
        foreseen=torch.zeros(number, FORESEEN, 2 * PLACES, 2 * PLACES, dtype=torch.uint8),
        shown=torch.zeros(number, HEADINGS, PLACES, PLACES, dtype=torch.float16),
    )


def views(maps: ViewMaps) -> Tensor:
    """Return a mask (n, 8, G, G) bool of views to which there is a path, except the body's present view."""
    here = (maps.ways == 0)[:, None] & F.one_hot(maps.heading, HEADINGS).bool()[:, :, None, None]
    return (maps.ways != FAR)[:, None] & ~here


def gone_to(maps: ViewMaps) -> Tensor:
    """Return a mask (n, 8, G, G) bool of views that were goals since the last pick-up."""
    return (maps.taken[:, None].int() >> torch.arange(HEADINGS)[:, None, None] & 1).bool()


def turned(maps: ViewMaps, quarters: int, mirrored: bool) -> ViewMaps:
    """Return the same maps, turned by quarters counter-clockwise about the body, then mirrored.

    Mirroring swaps east and west. Places that no part of the map covers become unknown.
    """
    order = (torch.arange(HEADINGS) - 2 * quarters) & 7  # old heading of each new one
    if mirrored:
        order = order[(4 - torch.arange(HEADINGS)) & 7]

    def turn(field: Tensor, nothing: int = 0) -> Tensor:
        for _ in range(quarters):
            field = _flipped(field.transpose(-2, -1), -2, nothing)
        return _flipped(field, -1, nothing) if mirrored else field.contiguous()

    heading = (maps.heading + 2 * quarters) & 7
    south, east = maps.start.unbind(1)
    for _ in range(quarters):
        south, east = PLACES - east, south
    if mirrored:
        heading, east = (4 - heading) & 7, PLACES - east
    bits, was = torch.arange(HEADINGS)[:, None, None], gone_to(maps)[:, order].int()
    return ViewMaps(
        turn(maps.blocks),
        turn(maps.ages),
        turn(maps.ways, FAR),
        turn(maps.finds),
        turn((was << bits).sum(1).to(torch.uint8)),
        torch.stack([south, east], 1),
        maps.scalars,
        heading,
        *(
            turn(field)[:, order]
            if field.dim() == 4 and field.shape[1] == HEADINGS
            else turn(field)
            if field.dim() == 4
            else field
            for field in (maps.worth, maps.foreseen, maps.shown)
        ),
    )


def _flipped(field: Tensor, axis: int, nothing: int) -> Tensor:
    """Return a field (..., G, G) or (..., 2G, 2G) flipped about the place in the middle, G / 2."""
    place = field.shape[axis] // PLACES
    field = field.flip(axis).roll(place, axis)
    field.narrow(axis, 0, place).fill_(nothing)
    return field
