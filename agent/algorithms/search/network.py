"""The network that searches: a U-Net (Ronneberger et al. 2015, arXiv:1505.04597) over a window of a map."""

import json
from itertools import pairwise
from pathlib import Path

import safetensors
import torch
import torch.nn.functional as F
from torch import Tensor, nn

from agent.algorithms.map_completion.network import FINDS, CompletionNetwork, pointwise
from agent.algorithms.map_completion.network import OWN as COMPLETED
from agent.algorithms.search.crop import box, cropped
from agent.algorithms.search.windows import (
    FAR,
    FORESEEN,
    HEADINGS,
    LEVELS,
    PLACES,
    SCALE,
    ViewMaps,
    gone_to,
    views,
)

PLANES, OWN = 4, 5 + HEADINGS
"""What is read of each block, and of each place besides."""

FLOOR, PASSES, TARGETS, ODDS = range(FORESEEN)
"""What is foreseen of a block: floor, whether sight passes, how dense targets are where it was not looked
since the last pick-up, and the logarithm of how dense they are."""

WHOLE, PART = 255.0, 63.0
"""What a probability of 1, and what a density of 1, is in 8 bits."""

HARDLY = 1e-3
"""Added to what a view shows before its logarithm is taken."""

FORESIGHT = Path(__file__).parents[2] / "runs" / "released" / "map-completion.safetensors"
"""The released network of map completion, whose predictions can be inputs."""

FADE = 4.0
"""Places over which nearness to the start falls by a factor of e."""

NODE = 2.0
"""Steps from a node to the next one: a cell is half a body wide."""

CONSTANT = 4.0
"""Steps added to a path's length: what a choice of a view costs beside the way there."""

FIRST = -3.0
"""The logarithm of what a view is first thought to show of all places where the target may be."""

MOSTLY = 3
"""Cells of a block from which on it counts as seen."""

DENSE = 300.0
"""Blocks in which a target may lie, about: its probability in one, times these, is about 1."""


class ViewNetwork(nn.Module):
    """A U-Net of ``channels`` on the places: about 146,000 weights.

    It gives the logarithm of what each view is expected to show, with ``looks`` as a correction of what rays
    over the map show, as likely as the body can stand there; a view's value is that for its cost, the steps
    of the known path and the turns. The correction is none before it has learnt.
    """

    turns: Tensor
    shares: Tensor

    def __init__(
        self, channels: tuple[int, ...] = (16, 32, 64, 96), foresight: bool = False, looks: bool = False
    ) -> None:
        """Draw first weights from torch's generator. ``foresight``: what map completion predicts is an
        input; ``looks``: what each view would show is one.
        """
        super().__init__()
        self.channels, first, last = channels, channels[0], channels[-1]
        self.looks, own = looks, OWN + HEADINGS * looks
        self.completion = foreseeing() if foresight else None
        self.first = nn.Conv2d(PLANES + FORESEEN * foresight, first, 4, 2, 1)
        self.fuse = nn.Conv2d(first + own, first, 3, padding=1)
        self.down = nn.ModuleList(nn.Conv2d(i, o, 3, padding=1) for i, o in pairwise(channels))
        self.whole = nn.Linear(3 + HEADINGS, last)
        # What comes from below is narrowed before it is enlarged: three quarters of the work are saved.
        self.narrow = nn.ModuleList(nn.Conv2d(o, i, 1) for i, o in pairwise(channels))
        self.up = nn.ModuleList(nn.Conv2d(i, i, 3, padding=1) for i in channels[:-1])
        self.hidden = nn.Conv2d(first + own + HEADINGS, 2 * first, 1)
        self.out = nn.Conv2d(2 * first, HEADINGS, 1)
        with torch.no_grad():
            self.out.weight.zero_()
            self.out.bias.fill_(0.0 if looks else FIRST) if self.out.bias is not None else None
        self.register_buffer("turns", _turns(), persistent=False)
        self.register_buffer("shares", _shares(), persistent=False)
        self.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue]

    @torch.no_grad()
    def foresee(self, maps: ViewMaps) -> ViewMaps:
        """The same maps with what is foreseen of them, nothing far from all that was seen."""
        part = box(maps)
        near = cropped(maps, part)
        planes = unforeseen(near) if self.completion is None else foreseen(self.completion, near)
        return maps._replace(foreseen=part.whole(planes, 0))

    def forward(self, maps: ViewMaps) -> Tensor:
        """The logarithms (n, 8, G, G) of the views' values, targets per ``SCALE`` steps; minus infinity where
        no path is known, and for the view that the body has.
        """
        part = box(maps)
        return part.whole(self.near(cropped(maps, part), part.cut(self.turns[maps.heading])), -torch.inf)

    def near(self, maps: ViewMaps, turns: Tensor) -> Tensor:
        """The same of parts of windows; the ``turns`` to each view (n, 8, high, wide)."""
        there, way = (maps.ways != FAR).float(), maps.ways.float().clamp(min=0)
        planes = [F.embedding(maps.blocks.int(), self.shares), maps.ages[..., None].float() / 128]
        if self.completion is not None:
            planes.append(maps.foreseen.permute(0, 2, 3, 1) / SIZES)
        south, east = ((torch.arange(way.shape[1 + k]) - maps.start[:, k, None]).square() for k in range(2))
        near = torch.exp(-(south[:, :, None] + east[:, None]).sqrt() / FADE)
        taken = gone_to(maps).float()
        log_way = ((way + CONSTANT).log() - 3) * there
        own = torch.stack([there, there * way / 50, log_way, near, maps.finds.float() / 2], 1)
        shown = [(maps.shown.float() + HARDLY).log() / 3 + 1] if self.looks else []
        own = torch.cat([own, taken, *shown], 1).contiguous(memory_format=torch.channels_last)
        head = F.one_hot(maps.heading, HEADINGS).float()
        x = F.relu(self.first(torch.cat(planes, 3).permute(0, 3, 1, 2)))
        x = F.relu(self.fuse(torch.cat([x, own], 1)))
        passed = []
        for down in self.down:
            passed.append(x)
            x = F.relu(down(F.max_pool2d(x, 2)))
        x = x + self.whole(torch.cat([maps.scalars, head], 1))[:, :, None, None]
        for narrow, up in zip(reversed(self.narrow), reversed(self.up), strict=True):
            x = F.relu(up(F.interpolate(pointwise(narrow, x), scale_factor=2.0) + passed.pop()))
        # The heading is the same at all places, so what is made of it is added, not joined.
        weight, x = self.hidden.weight.flatten(1), torch.cat([x, own], 1)
        hidden = F.linear(x.permute(0, 2, 3, 1), weight[:, :-HEADINGS])
        hidden = hidden + F.linear(head, weight[:, -HEADINGS:], self.hidden.bias)[:, None, None]
        values = pointwise(self.out, F.relu(hidden).permute(0, 3, 1, 2)).contiguous()  # as what is added
        gain = SCALE / cost(maps.ways, turns)
        if self.looks:
            gain = gain * (in_view(maps.shown.float()) * stands(maps)[:, None] + HARDLY)
        return (values + gain.log()).masked_fill(~views(maps), -torch.inf)


def cost(ways: Tensor, turns: Tensor) -> Tensor:
    """What views (n, 8, G, G) cost: the steps of paths of ``ways`` (n, G, G) nodes, the ``turns``, and some
    steps for a choice.
    """
    return NODE * ways[:, None].float().clamp(min=0) + CONSTANT + turns


def stands(maps: ViewMaps) -> Tensor:
    """How likely a body can stand at each place (n, G, G) float32: paths lead some way over unseen ground,
    which is floor as far as is foreseen.
    """
    floor = (maps.foreseen[:, FLOOR] / WHOLE).masked_fill(maps.blocks // LEVELS % LEVELS >= MOSTLY, 1.0)
    return F.avg_pool2d(floor[:, None], 2)[:, 0]


def foreseeing() -> CompletionNetwork:
    """The released network of map completion; it learns nothing more."""
    with safetensors.safe_open(FORESIGHT, framework="pt") as file:
        channels = json.loads(file.metadata()["config"])["channels"]
        network = CompletionNetwork(
            file.get_slice("out.weight").get_shape()[0] - COMPLETED, channels=channels
        )
        network.load_state_dict({name: file.get_tensor(name) for name in network.state_dict()})
    return network.requires_grad_(False)


SIZES = torch.tensor([WHOLE, WHOLE, PART, PART])
"""What 1 is in the planes of what is foreseen."""


@torch.no_grad()
def foreseen(completion: CompletionNetwork, maps: ViewMaps, marks: Tensor | None = None) -> Tensor:
    """What is predicted of blocks (n, ``FORESEEN``, 2G, 2G) uint8, times ``SIZES``; by ``marks`` on the map
    (n, 2, 2G, 2G), if there are others than the finds.
    """
    occupied, seen = (maps.blocks // k % LEVELS for k in (1, LEVELS))
    if marks is None:
        marks = maps.blocks.new_zeros(len(maps.blocks), 2, *maps.blocks.shape[1:])
        marks[:, FINDS, ::2, ::2] = maps.finds
    floor, sight, target, _ = completion(occupied | seen << 3, marks, 2 * maps.start)
    dense = (DENSE * target.exp() * hides(maps)).clamp(max=4)
    odds = ((target + 10) / 3).clamp(min=0, max=4)
    planes = torch.stack([floor.sigmoid(), sight.sigmoid(), dense, odds], 1)
    return (planes * SIZES[:, None, None]).round().to(torch.uint8)


def unforeseen(maps: ViewMaps) -> Tensor:
    """The same of who foresees nothing: targets lie on all ground that is not known to be occupied, as
    likely, and sight passes what is unseen.
    """
    occupied = maps.blocks % LEVELS
    planes = torch.ones(len(occupied), FORESEEN, *occupied.shape[1:])
    planes[:, TARGETS] = ((occupied == 0) & hides(maps)).float()
    return (planes * SIZES[:, None, None]).round().to(torch.uint8)


def hides(maps: ViewMaps) -> Tensor:
    """Where (n, 2G, 2G) bool a target's middle may lie that was not seen since the last pick-up: a target is
    two blocks wide, so it would have been seen from beside a block too.
    """
    since = F.pad(maps.blocks // LEVELS**2, (1, 1, 1, 1))
    # The most of three by three, along one axis after the other: a fifth of the time of torch's own.
    for axis in (1, 2):
        inner = since.shape[axis] - 2
        since = torch.stack([since.narrow(axis, k, inner) for k in range(3)]).amax(0)
    return since < MOSTLY


def expected(maps: ViewMaps) -> tuple[Tensor, Tensor]:
    """How dense targets are in blocks that were not looked at, and the probability that sight passes a block
    that was never seen, (n, 2G, 2G) float32 each, by what is foreseen.
    """
    return maps.foreseen[:, TARGETS] / PART, maps.foreseen[:, PASSES] / WHOLE


def in_view(octants: Tensor) -> Tensor:
    """Sums of the three octants (n, 8, G, G) that each view has."""
    return octants + octants.roll(1, 1) + octants.roll(-1, 1)


def _shares() -> Tensor:
    """What numbers of blocks (125, 3) float32 say: the shares of cells that are occupied, that were seen, and
    that were seen since the last pick-up.
    """
    number = torch.arange(LEVELS**3)
    return torch.stack([number // k % LEVELS for k in (1, LEVELS, LEVELS**2)], 1) / (LEVELS - 1)


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
