"""The network that searches: a U-Net (Ronneberger et al. 2015, arXiv:1505.04597) over a window of a map."""

import json
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import safetensors
import torch
import torch.nn.functional as F
from torch import Tensor, nn

from agent.algorithms.map_completion.network import FINDS, CompletionNetwork, pointwise
from agent.algorithms.map_completion.network import OWN as COMPLETED
from agent.algorithms.search.sight import SIDES, Sight

PLACES = 48
"""Places along each side of a window, G: 27.5 m at the default body, which is at the one in the middle."""

HEADINGS = 8

FAR = -1
"""Of a place to which no path is known."""

LEVELS = 5
"""A block has 0 to 4 cells that are so."""

PLANES, FORESEEN, OWN = 4, 4, 5 + HEADINGS
"""What is read of each block, what is foreseen of it, and what is read of each place besides."""

FORESIGHT = Path(__file__).parents[2] / "runs" / "released" / "map-completion.safetensors"
"""The released network of map completion, whose predictions can be inputs."""

FADE = 4.0
"""Places over which nearness to the start falls by a factor of e."""

CONSTANT = 4.0
"""Steps added to a path's length: what a choice of a view costs beside the way there."""

SCALE = 100.0
"""Values are in targets per so many steps."""

FIRST = -3.0
"""The logarithm of what a view is first thought to show of all places where the target may be."""


DENSE = 300.0
"""Blocks in which a target may lie, about: its probability in one, times these, is about 1."""


class ViewMaps(NamedTuple):
    """Windows of n maps, G places a side and 2 G blocks; what is known beside them; and the label."""

    blocks: Tensor
    """(n, 2G, 2G) uint8: how many of a block's four cells are occupied, ``LEVELS`` times how many were seen,
    and ``LEVELS`` squared times how many of these since the last pick-up."""

    ages: Tensor
    """(n, 2G, 2G) uint8: 0 for never seen, else 1 + 16 times the binary logarithm of the steps since, and
    1."""

    ways: Tensor
    """(n, G, G) int16: nodes of the path to each place, ``FAR`` where none is known."""

    finds: Tensor
    """(n, G, G) uint8: targets picked up at each place."""

    taken: Tensor
    """(n, G, G) uint8, a bit a heading: the goals since the last pick-up."""

    start: Tensor
    """(n, 2) float32: where the episode began, places south and east of the first."""

    scalars: Tensor
    """(n, 3) float32: the share of the episode that is over, how long ago the last pick-up was, and how
    many."""

    heading: Tensor
    """(n,) int64: the body's."""

    worth: Tensor
    """(n, 8, G, G) float16: what each view is worth in the true house, targets per ``SCALE`` steps; or
    empty."""


def empty(number: int) -> ViewMaps:
    """Room for so many maps with labels."""
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
    )


class ViewNetwork(nn.Module):
    """A U-Net of ``channels`` on the places, and rays over what it makes of them: about 145,000 weights.

    It gives the logarithm of what each view is expected to show; a view's value is that for its cost, the
    steps of the known path and the turns, to a power that is learnt.
    """

    turns: Tensor
    bearings: Tensor

    def __init__(
        self, channels: tuple[int, ...] = (16, 32, 64, 96), rays: int = 0, foresight: bool = False
    ) -> None:
        """Draw first weights from torch's generator. So many channels of ``rays`` towards each side, see
        ``Sight``; ``foresight``: what map completion predicts is an input.
        """
        super().__init__()
        self.channels, first, last = channels, channels[0], channels[-1]
        self.completion = foreseeing() if foresight else None
        self.first = nn.Conv2d(PLANES + FORESEEN * foresight, first, 4, 2, 1)
        self.fuse = nn.Conv2d(first + OWN, first, 3, padding=1)
        self.down = nn.ModuleList(nn.Conv2d(i, o, 3, padding=1) for i, o in pairwise(channels))
        self.whole = nn.Linear(3 + HEADINGS, last)
        # What comes from below is narrowed before it is enlarged: three quarters of the work are saved.
        self.narrow = nn.ModuleList(nn.Conv2d(o, i, 1) for i, o in pairwise(channels))
        self.up = nn.ModuleList(nn.Conv2d(i, i, 3, padding=1) for i in channels[:-1])
        self.sight = Sight(first, rays) if rays else None
        self.hidden = nn.Conv2d(first + SIDES * rays + OWN + HEADINGS, 2 * first, 1)
        self.out = nn.Conv2d(2 * first, HEADINGS, 1)
        self.price = nn.Parameter(torch.tensor(1.0))
        with torch.no_grad():
            self.out.weight.mul_(0.1)
            self.out.bias.fill_(FIRST) if self.out.bias is not None else None
        self.register_buffer("turns", _turns(), persistent=False)
        self.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue]

    def forward(self, maps: ViewMaps) -> Tensor:
        """The logarithms (n, 8, G, G) of the views' values, targets per ``SCALE`` steps; minus infinity where
        no path is known, and for the view that the body has.
        """
        counts = maps.blocks.int()
        planes = [counts % LEVELS, counts // LEVELS % LEVELS, counts // LEVELS**2]
        planes = torch.stack([*(each.float() / 4 for each in planes), maps.ages.float() / 128], 1)
        if self.completion is not None:
            planes = torch.cat([planes, foreseen(self.completion, maps)], 1)
        there = (maps.ways != FAR).float()
        way = maps.ways.float().clamp(min=0)
        axis = torch.arange(PLACES, device=way.device)
        south, east = ((axis - maps.start[:, k, None]).square() for k in range(2))
        near = torch.exp(-(south[:, :, None] + east[:, None]).sqrt() / FADE)
        bits = torch.arange(HEADINGS, device=way.device)[:, None, None]
        taken = (maps.taken[:, None].int() >> bits & 1).float()
        log_way = ((way + CONSTANT).log() - 3) * there
        own = torch.stack([there, there * way / 50, log_way, near, maps.finds.float() / 2], 1)
        own = torch.cat([own, taken], 1).contiguous(memory_format=torch.channels_last)
        head = F.one_hot(maps.heading, HEADINGS).float()
        x = F.relu(self.first(planes.contiguous(memory_format=torch.channels_last)))
        x = F.relu(self.fuse(torch.cat([x, own], 1)))
        passed = []
        for down in self.down:
            passed.append(x)
            x = F.relu(down(F.max_pool2d(x, 2)))
        x = x + self.whole(torch.cat([maps.scalars, head], 1))[:, :, None, None]
        for narrow, up in zip(reversed(self.narrow), reversed(self.up), strict=True):
            x = F.relu(up(F.interpolate(pointwise(narrow, x), scale_factor=2.0) + passed.pop()))
        heads = head[:, :, None, None].expand(-1, -1, PLACES, PLACES)
        sight = [] if self.sight is None else [self.sight(x)]
        shown = pointwise(self.out, F.relu(pointwise(self.hidden, torch.cat([x, *sight, own, heads], 1))))
        cost = (way[:, None] + CONSTANT + self.turns[maps.heading]).log()
        values = shown - self.price * cost + torch.log(torch.tensor(SCALE))
        return values.masked_fill(~views(maps), -torch.inf)


def foreseeing() -> CompletionNetwork:
    """The released network of map completion; it learns nothing more."""
    with safetensors.safe_open(FORESIGHT, framework="pt") as file:
        channels = json.loads(file.metadata()["config"])["channels"]
        network = CompletionNetwork(
            file.get_slice("out.weight").get_shape()[0] - COMPLETED, channels=channels
        )
        network.load_state_dict({name: file.get_tensor(name) for name in network.state_dict()})
    return network.requires_grad_(False)


@torch.no_grad()
def foreseen(completion: CompletionNetwork, maps: ViewMaps) -> Tensor:
    """What is predicted of blocks (n, ``FORESEEN``, 2G, 2G) float32: floor, whether sight passes, how dense
    targets are where it was not looked since the last pick-up, and the logarithm of how dense they are.
    """
    occupied, seen, since = (maps.blocks // k % LEVELS for k in (1, LEVELS, LEVELS**2))
    marks = maps.blocks.new_zeros(len(maps.blocks), 2, 2 * PLACES, 2 * PLACES)
    marks[:, FINDS, ::2, ::2] = maps.finds
    floor, sight, target, _ = completion(occupied | seen << 3, marks, 2 * maps.start)
    dense = (DENSE * target.exp() * (since < LEVELS - 2)).clamp(max=4)
    return torch.stack([floor.sigmoid(), sight.sigmoid(), dense, ((target + 10) / 3).clamp(min=0)], 1)


def views(maps: ViewMaps) -> Tensor:
    """Which views (n, 8, G, G) bool there is a path to, but for the one that the body has."""
    here = (maps.ways == 0)[:, None] & F.one_hot(maps.heading, HEADINGS).bool()[:, :, None, None]
    return (maps.ways != FAR)[:, None] & ~here


def _turns() -> Tensor:
    """Turns, of 45 degrees each, before and after a straight way (8, 8, G, G) float32: by the body's heading,
    and the heading to look at from each place.
    """
    axis = torch.arange(PLACES) - PLACES // 2
    bearing = torch.atan2(-axis[:, None].double(), axis[None].double()) / (torch.pi / 4)
    headings = torch.arange(HEADINGS)
    # The middle is the body's own place: any bearing on the shorter way round will do.
    bearing = bearing.round().long() & 7

    def between(one: Tensor, other: Tensor) -> Tensor:
        away = (one - other) & 7
        return torch.minimum(away, 8 - away)

    turns = between(headings[:, None, None, None], bearing) + between(bearing, headings[None, :, None, None])
    middle = PLACES // 2
    turns[:, :, middle, middle] = between(headings[:, None], headings[None])
    return turns.float()


def turned(maps: ViewMaps, quarters: int, mirrored: bool) -> ViewMaps:
    """The same maps, turned by quarters counter-clockwise about the body, and then mirrored from east to
    west. Where nothing of them comes to lie, nothing is known.
    """
    order = (torch.arange(HEADINGS) - 2 * quarters) & 7  # of a new heading, the one that it was
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
    bits = torch.arange(HEADINGS)[:, None, None]
    was = maps.taken[:, None].int() >> order[:, None, None] & 1
    return ViewMaps(
        turn(maps.blocks),
        turn(maps.ages),
        turn(maps.ways, FAR),
        turn(maps.finds),
        turn((was << bits).sum(1).to(torch.uint8)),
        torch.stack([south, east], 1),
        maps.scalars,
        heading,
        turn(maps.worth)[:, order] if maps.worth.dim() == 4 else maps.worth,
    )


def _flipped(field: Tensor, axis: int, nothing: int) -> Tensor:
    """A field (..., G, G) or (..., 2G, 2G) flipped about the place in the middle, G / 2."""
    place = field.shape[axis] // PLACES
    field = field.flip(axis).roll(place, axis)
    field.narrow(axis, 0, place).fill_(nothing)
    return field
