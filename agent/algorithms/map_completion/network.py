"""Network of map completion: a U-Net (Ronneberger et al. 2015, arXiv:1505.04597) over a map's window."""

from itertools import pairwise
from typing import NamedTuple

import torch
import torch.nn.functional as F
from torch import Tensor, nn

FINDS, PIECES = range(2)
"""Planes of marks: see ``Marks``."""

WINDOW = 96
"""Blocks along each side of a window: 27.5 m at the default body, which is in the middle."""

PLANES = 4
"""Number of inputs of each block: the fraction of its cells that are occupied, and that were seen; its
nearness to the episode's start; and the number of targets picked up in it."""

EMBEDDING = 6
"""Size of the learned embedding of each kind of furniture that rays can meet."""

FIELDS = 3
"""Number of predictions of each block: floor, sight, and the target."""

OWN = 4 * FIELDS
"""Channels of the last layer that belong to single blocks: each field of the four blocks of a place, south by
east. The other channels are kinds."""

FADE_BLOCKS = 9.0
"""Distance, in blocks, over which nearness to the start falls by a factor of e."""

MAX_FINDS = 4.0
"""Number of pick-ups in a block above which more do not count."""


class Prediction(NamedTuple):
    """Predictions for n windows."""

    floor: Tensor
    """(n, W, W) logits of a body being able to stand in a block, so that a target may lie there in some
    task."""

    sight: Tensor
    """(n, W, W) logits of a ray from seen ground passing an unseen block that it reaches, as neither a wall
    nor furniture stands there. The product of these probabilities is that of a ray getting so far."""

    target: Tensor
    """(n, W, W): log-probability that the next target lies in a block, if all places of the task were still
    to be looked at. The rest of the probability is outside the window."""

    kinds: Tensor
    """(n, K, W / 2, W / 2) logits of the kind of ground of two by two blocks."""


class CompletionNetwork(nn.Module):
    """U-Net of ``channels`` on half the blocks' resolution: about 150,000 weights.

    The network consists of convolutions alone, so a house's place in the window does not matter.
    """

    def __init__(self, kinds: int, pieces: int = 0, channels: tuple[int, ...] = (16, 32, 64, 96)) -> None:
        """Draw first weights from torch's generator.

        ``kinds`` is the number of kinds of ground to predict, ``pieces`` the number of kinds of furniture
        that rays distinguish.
        """
        super().__init__()
        self.kinds, self.channels = kinds, channels
        self.pieces = nn.Embedding(1 + pieces, EMBEDDING, padding_idx=0) if pieces else None
        planes = PLANES + EMBEDDING * bool(pieces)
        self.first = nn.Sequential(nn.Conv2d(planes, channels[0], 4, 2, 1), nn.ReLU(inplace=True))
        self.down = nn.ModuleList(_block(i, o) for i, o in pairwise(channels))
        # Features from below are narrowed before they are enlarged: this saves three quarters of the work.
        self.narrow = nn.ModuleList(nn.Conv2d(o, i, 1) for i, o in pairwise(channels))
        self.up = nn.ModuleList(_block(i, i) for i in channels[:-1])
        self.out = nn.Conv2d(channels[0], OWN + kinds, 1)
        self.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue]

    def forward(self, windows: Tensor, marks: Tensor, starts: Tensor) -> Prediction:
        """Predict from windows (n, W, W) uint8, as ``Windows.read`` returns them, or parts of them.

        Parts are a multiple of 16 blocks a side. ``marks`` (n, 2, W, W) uint8 are as ``Marks.read`` returns
        them. ``starts`` (n, 2) float32 are where the episodes began, blocks south and east of the first
        block.
        """
        occupied, seen = (windows & 7).float() / 4, (windows >> 3 & 7).float() / 4
        sides = (torch.arange(size, device=windows.device) for size in windows.shape[1:])
        south, east = ((side - starts[:, k, None]).square() for k, side in enumerate(sides))
        near = torch.exp(-(south[:, :, None] + east[:, None]).sqrt() / FADE_BLOCKS)
        found = (marks[:, FINDS].float() / MAX_FINDS).clamp(max=1.0)
        # Joining planes first and then turning them so that channels lie last is twice as fast.
        x = torch.stack([occupied, seen, near, found], 1)
        if self.pieces is not None:
            x = torch.cat([x, self.pieces(marks[:, PIECES].int()).permute(0, 3, 1, 2)], 1)
        x = self.first(x.contiguous(memory_format=torch.channels_last))
        passed = []
        for down in self.down:
            passed.append(x)
            x = down(F.max_pool2d(x, 2))
        for narrow, up in zip(reversed(self.narrow), reversed(self.up), strict=True):
            x = up(F.interpolate(pointwise(narrow, x), scale_factor=2.0) + passed.pop())
        # Each part of the last layer has its own product: joining the gradients of parts of one product is
        # slow.
        own, kinds = (pointwise(self.out, x, part) for part in (slice(OWN), slice(OWN, None)))
        count, _, high, wide = own.shape
        blocks = own.permute(0, 2, 3, 1).reshape(count, high, wide, FIELDS, 2, 2)
        blocks = blocks.permute(3, 0, 1, 4, 2, 5).reshape(FIELDS, count, 2 * high, 2 * wide)
        floor, sight, target = blocks
        outside = target.new_zeros(count, 1)
        target = torch.cat([target.flatten(1), outside], 1).log_softmax(1)[:, :-1].view_as(target)
        return Prediction(floor, sight, target, kinds)


def pointwise(layer: nn.Conv2d, x: Tensor, part: slice = slice(None)) -> Tensor:
    """Return a 1 by 1 convolution of ``x`` (n, C, H, W), or a part of its channels, as a matrix product.

    torch has no fast one for channels that lie last.
    """
    bias = layer.bias if layer.bias is None else layer.bias[part]
    return F.linear(x.permute(0, 2, 3, 1), layer.weight.flatten(1)[part], bias).permute(0, 3, 1, 2)


def _block(inputs: int, outputs: int) -> nn.Sequential:
    """Return a 3 by 3 convolution with a ReLU."""
    return nn.Sequential(nn.Conv2d(inputs, outputs, 3, padding=1), nn.ReLU(inplace=True))
