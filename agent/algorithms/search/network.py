"""Network that searches: a U-Net (Ronneberger et al. 2015, arXiv:1505.04597) over a window of a map."""

import json
from itertools import pairwise
from pathlib import Path

import safetensors
import torch
import torch.nn.functional as F
from torch import Tensor, nn

from vitruvius.agent.algorithms.map_completion.network import FINDS, CompletionNetwork, pointwise
from vitruvius.agent.algorithms.map_completion.network import OWN as COMPLETED
from vitruvius.agent.algorithms.search.crop import box, cropped
from vitruvius.agent.algorithms.search.windows import (
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
"""Number of inputs of each block, and of further inputs of each place."""

FLOOR, PASSES, TARGETS, ODDS = range(FORESEEN)
"""Predictions of a block: floor; sight passing; density of targets where the planner has not looked since the
last pick-up; and logarithm of this density."""

WHOLE, PART = 255.0, 63.0
"""Values in 8 bits of a probability of 1 and of a density of 1."""

MIN_SHOWN = 1e-3
"""Constant added to what a view shows before its logarithm is taken."""

FORESIGHT = Path(__file__).parents[2] / "runs" / "released" / "map-completion.safetensors"
"""Released network of map completion, whose predictions can be inputs."""

FADE_PLACES = 4.0
"""Distance, in places, over which nearness to the start falls by a factor of e."""

NODE_STEPS = 2.0
"""Steps from one node to the next: a cell is half a body wide."""

CHOICE_STEPS = 4.0
"""Steps added to a path's length: the cost of a choice of a view besides the way there."""

FIRST_LOG_SHARE = -3.0
"""First estimate of the logarithm of what a view shows, relative to all places where the target may be."""

MIN_SEEN_CELLS = 3
"""Least number of seen cells for a block to count as seen."""

TARGET_BLOCKS = 300.0
"""Approximate number of blocks in which a target may lie: the probability of one block times this is about
1."""


class ViewNetwork(nn.Module):
    """U-Net of ``channels`` on the places: about 146,000 weights.

    The network predicts the logarithm of what each view is expected to show. With ``looks`` the output is a
    correction of what rays over the map show, times the probability that the body can stand there. The
    correction is zero before training. A view's value is this prediction divided by the view's cost: the
    steps of the known path and the turns.
    """

    turns: Tensor
    shares: Tensor

    def __init__(
        self, channels: tuple[int, ...] = (16, 32, 64, 96), foresight: bool = False, looks: bool = False
    ) -> None:
        """Draw first weights from torch's generator.

        ``foresight``: the predictions of map completion are an input. ``looks``: what each view would show is
        an input.
        """
        super().__init__()
        self.channels, first, last = channels, channels[0], channels[-1]
        self.looks, own = looks, OWN + HEADINGS * looks
        self.completion = foreseeing() if foresight else None
        self.first = nn.Conv2d(PLANES + FORESEEN * foresight, first, 4, 2, 1)
        self.fuse = nn.Conv2d(first + own, first, 3, padding=1)
        self.down = nn.ModuleList(nn.Conv2d(i, o, 3, padding=1) for i, o in pairwise(channels))
        self.whole = nn.Linear(3 + HEADINGS, last)
        # Features from below are narrowed before they are enlarged: this saves three quarters of the work.
        self.narrow = nn.ModuleList(nn.Conv2d(o, i, 1) for i, o in pairwise(channels))
        self.up = nn.ModuleList(nn.Conv2d(i, i, 3, padding=1) for i in channels[:-1])
        self.hidden = nn.Conv2d(first + own + HEADINGS, 2 * first, 1)
        self.out = nn.Conv2d(2 * first, HEADINGS, 1)
        with torch.no_grad():
            self.out.weight.zero_()
            self.out.bias.fill_(0.0 if looks else FIRST_LOG_SHARE) if self.out.bias is not None else None
        self.register_buffer("turns", _turns(), persistent=False)
        self.register_buffer("shares", _shares(), persistent=False)
        self.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue]

    @torch.no_grad()
    def foresee(self, maps: ViewMaps) -> ViewMaps:
        """Return the same maps with the predictions for them, which are 0 far from all seen ground."""
        part = box(maps)
        near = cropped(maps, part)
        planes = unforeseen(near) if self.completion is None else foreseen(self.completion, near)
        return maps._replace(foreseen=part.whole(planes, 0))

    def forward(self, maps: ViewMaps) -> Tensor:
        """Return the logarithms (n, 8, G, G) of the views' values, targets per ``SCALE`` steps.

        They are minus infinity for places without a known path, and for the view that the body has.
        """
        part = box(maps)
        return part.whole(self.near(cropped(maps, part), part.cut(self.turns[maps.heading])), -torch.inf)

    def near(self, maps: ViewMaps, turns: Tensor) -> Tensor:
        """Return the same for parts of windows; ``turns`` (n, 8, high, wide) are those to each view."""
        there, way = (maps.ways != FAR).float(), maps.ways.float().clamp(min=0)
        planes = [F.embedding(maps.blocks.int(), self.shares), maps.ages[..., None].float() / 128]
        if self.completion is not None:
            planes.append(maps.foreseen.permute(0, 2, 3, 1) / SIZES)
        south, east = ((torch.arange(way.shape[1 + k]) - maps.start[:, k, None]).square() for k in range(2))
        near = torch.exp(-(south[:, :, None] + east[:, None]).sqrt() / FADE_PLACES)
        taken = gone_to(maps).float()
        log_way = ((way + CHOICE_STEPS).log() - 3) * there
        own = torch.stack([there, there * way / 50, log_way, near, maps.finds.float() / 2], 1)
        shown = [(maps.shown.float() + MIN_SHOWN).log() / 3 + 1] if self.looks else []
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
        # The heading is the same at all places, so its contribution is added, not joined.
        weight, x = self.hidden.weight.flatten(1), torch.cat([x, own], 1)
        hidden = F.linear(x.permute(0, 2, 3, 1), weight[:, :-HEADINGS])
        hidden = hidden + F.linear(head, weight[:, -HEADINGS:], self.hidden.bias)[:, None, None]
        values = pointwise(self.out, F.relu(hidden).permute(0, 3, 1, 2)).contiguous()  # as what is added
        gain = SCALE / cost(maps.ways, turns)
        if self.looks:
            gain = gain * (in_view(maps.shown.float()) * stands(maps)[:, None] + MIN_SHOWN)
        return (values + gain.log()).masked_fill(~views(maps), -torch.inf)


def cost(ways: Tensor, turns: Tensor) -> Tensor:
    """Return the cost of views (n, 8, G, G), in steps.

    It is the steps of paths of ``ways`` (n, G, G) nodes, the ``turns``, and some steps for a choice.
    """
    return NODE_STEPS * ways[:, None].float().clamp(min=0) + CHOICE_STEPS + turns


def stands(maps: ViewMaps) -> Tensor:
    """Return the probability that a body can stand at each place, (n, G, G) float32.

    Paths lead some way over unseen ground, for which the probability is that of floor by the predictions.
    """
    floor = (maps.foreseen[:, FLOOR] / WHOLE).masked_fill(
        maps.blocks // LEVELS % LEVELS >= MIN_SEEN_CELLS, 1.0
    )
    return F.avg_pool2d(floor[:, None], 2)[:, 0]


def foreseeing() -> CompletionNetwork:
    """Return the released network of map completion, with frozen weights."""
    with safetensors.safe_open(FORESIGHT, framework="pt") as file:
        channels = json.loads(file.metadata()["config"])["channels"]
        network = CompletionNetwork(
            file.get_slice("out.weight").get_shape()[0] - COMPLETED, channels=channels
        )
        network.load_state_dict({name: file.get_tensor(name) for name in network.state_dict()})
    return network.requires_grad_(False)


SIZES = torch.tensor([WHOLE, WHOLE, PART, PART])
"""Value of 1 in each plane of the predictions."""


@torch.no_grad()
def foreseen(completion: CompletionNetwork, maps: ViewMaps, marks: Tensor | None = None) -> Tensor:
    """Return the predictions for blocks (n, ``FORESEEN``, 2G, 2G) uint8, times ``SIZES``.

    ``marks`` (n, 2, 2G, 2G) are the marks on the map; by default the finds.
    """
    occupied, seen = (maps.blocks // k % LEVELS for k in (1, LEVELS))
    if marks is None:
        marks = maps.blocks.new_zeros(len(maps.blocks), 2, *maps.blocks.shape[1:])
        marks[:, FINDS, ::2, ::2] = maps.finds
    floor, sight, target, _ = completion(occupied | seen << 3, marks, 2 * maps.start)
    dense = (TARGET_BLOCKS * target.exp() * hides(maps)).clamp(max=4)
    odds = ((target + 10) / 3).clamp(min=0, max=4)
    planes = torch.stack([floor.sigmoid(), sight.sigmoid(), dense, odds], 1)
    return (planes * SIZES[:, None, None]).round().to(torch.uint8)


def unforeseen(maps: ViewMaps) -> Tensor:
    """Return the same for no prediction: targets are uniform, and sight passes unseen ground.

    Targets lie with equal probability on all ground that is not known to be occupied.
    """
    occupied = maps.blocks % LEVELS
    planes = torch.ones(len(occupied), FORESEEN, *occupied.shape[1:])
    planes[:, TARGETS] = ((occupied == 0) & hides(maps)).float()
    return (planes * SIZES[:, None, None]).round().to(torch.uint8)


def hides(maps: ViewMaps) -> Tensor:
    """Return a mask (n, 2G, 2G) bool of blocks where a target's middle may lie unseen.

    Unseen means not seen since the last pick-up. A target is two blocks wide, so seeing a neighbouring block
    shows it, too.
    """
    since = F.pad(maps.blocks // LEVELS**2, (1, 1, 1, 1))
    # Maximum over three by three, one axis after the other: a fifth of the time of torch's own.
    for axis in (1, 2):
        inner = since.shape[axis] - 2
        since = torch.stack([since.narrow(axis, k, inner) for k in range(3)]).amax(0)
    return since < MIN_SEEN_CELLS


def expected(maps: ViewMaps) -> tuple[Tensor, Tensor]:
    """Return the density of targets in blocks not looked at, and the probability that sight passes a block.

    The probability is that of a block that was never seen. Both are predictions, (n, 2G, 2G) float32.
    """
    return maps.foreseen[:, TARGETS] / PART, maps.foreseen[:, PASSES] / WHOLE


def in_view(octants: Tensor) -> Tensor:
    """Return the sums of the three octants (n, 8, G, G) that each view has."""
    return octants + octants.roll(1, 1) + octants.roll(-1, 1)


def _shares() -> Tensor:
    """Return the fractions (125, 3) float32 for each number of a block.

    They are the fractions of its cells that are occupied, that were seen, and that were seen since the last
    pick-up.
    """
    number = torch.arange(LEVELS**3)
    return torch.stack([number // k % LEVELS for k in (1, LEVELS, LEVELS**2)], 1) / (LEVELS - 1)


def _turns() -> Tensor:
    """Return the 45-degree turns before and after a straight way, (8, 8, G, G) float32.

    The first axis is the body's heading, the second the heading to look at from each place.
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
