"""The network of map completion: a U-Net (Ronneberger et al. 2015, arXiv:1505.04597) over a map's window."""

from itertools import pairwise
from typing import NamedTuple

import torch
import torch.nn.functional as F
from torch import Tensor, nn

FINDS, PIECES = range(2)
"""What the planes of marks are of, see ``Marks``."""

WINDOW = 96
"""Blocks along each side of a window: 27.5 m at the default body, the body in its middle."""

PLANES = 4
"""What it reads of each block: the share of its cells that are occupied, and that were seen; how near it is
to where the episode began; and how many targets were picked up in it."""

EMBEDDING = 6
"""Numbers that it learns for each kind of piece that rays can meet."""

FIELDS = 3
"""What is predicted of each block: floor, sight, and the target."""

OWN = 4 * FIELDS
"""Channels of its last layer that are of single blocks: each field of the four blocks of a place, south by
east. The others are kinds."""

FADE = 9.0
"""Blocks over which nearness to the start falls by a factor of e."""

MOST_FINDS = 4.0
"""Pick-ups in a block that count."""


class Prediction(NamedTuple):
    """What is predicted of n windows."""

    floor: Tensor
    """(n, W, W) logits: whether a body can stand in a block, so that a target may lie there in some task."""

    sight: Tensor
    """(n, W, W) logits: whether a ray from seen ground that reaches an unseen block passes it, as neither a
    wall nor furniture stands there. The product of these probabilities is that of a ray getting so far."""

    target: Tensor
    """(n, W, W): the logarithm of the probability that the next target lies in a block, were all places of
    the task still to be looked at. What is left to 1 is outside the window."""

    kinds: Tensor
    """(n, K, W / 2, W / 2) logits: which kind of ground two by two blocks are."""


class CompletionNetwork(nn.Module):
    """A U-Net of ``channels`` on half the blocks' resolution: about 150,000 weights.

    Convolutions alone, so a house's place in the window does not matter.
    """

    def __init__(self, kinds: int, pieces: int = 0, channels: tuple[int, ...] = (16, 32, 64, 96)) -> None:
        """Draw first weights from torch's generator, for so many ``kinds`` of ground to predict, and so many
        kinds of ``pieces`` that rays tell apart.
        """
        super().__init__()
        self.kinds, self.channels = kinds, channels
        self.pieces = nn.Embedding(1 + pieces, EMBEDDING, padding_idx=0) if pieces else None
        planes = PLANES + EMBEDDING * bool(pieces)
        self.first = nn.Sequential(nn.Conv2d(planes, channels[0], 4, 2, 1), nn.ReLU(inplace=True))
        self.down = nn.ModuleList(_block(i, o) for i, o in pairwise(channels))
        # What comes from below is narrowed before it is enlarged: three quarters of the work are saved.
        self.narrow = nn.ModuleList(nn.Conv2d(o, i, 1) for i, o in pairwise(channels))
        self.up = nn.ModuleList(_block(i, i) for i in channels[:-1])
        self.out = nn.Conv2d(channels[0], OWN + kinds, 1)
        self.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue]

    def forward(self, windows: Tensor, marks: Tensor, starts: Tensor) -> Prediction:
        """Predict from windows (n, W, W) uint8, as ``Windows.read`` gives them, or parts of them, a multiple
        of 16 blocks a side; their marks (n, 2, W, W) uint8, as ``Marks.read`` does; and where the episodes
        began in them, ``starts`` (n, 2) float32, blocks south and east of the first.
        """
        occupied, seen = (windows & 7).float() / 4, (windows >> 3 & 7).float() / 4
        sides = (torch.arange(size, device=windows.device) for size in windows.shape[1:])
        south, east = ((side - starts[:, k, None]).square() for k, side in enumerate(sides))
        near = torch.exp(-(south[:, :, None] + east[:, None]).sqrt() / FADE)
        found = (marks[:, FINDS].float() / MOST_FINDS).clamp(max=1.0)
        # Planes are joined one after the other, and then turned so that channels lie last: twice as fast.
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
        # A product for each part of the last layer: the gradients of parts of one product are slow to join.
        own, kinds = (pointwise(self.out, x, part) for part in (slice(OWN), slice(OWN, None)))
        count, _, high, wide = own.shape
        blocks = own.permute(0, 2, 3, 1).reshape(count, high, wide, FIELDS, 2, 2)
        blocks = blocks.permute(3, 0, 1, 4, 2, 5).reshape(FIELDS, count, 2 * high, 2 * wide)
        floor, sight, target = blocks
        outside = target.new_zeros(count, 1)
        target = torch.cat([target.flatten(1), outside], 1).log_softmax(1)[:, :-1].view_as(target)
        return Prediction(floor, sight, target, kinds)


def pointwise(layer: nn.Conv2d, x: Tensor, part: slice = slice(None)) -> Tensor:
    """A convolution over 1 by 1 of ``x`` (n, C, H, W), or a part of its channels, as a product of matrices:
    torch has no fast one for channels that lie last.
    """
    bias = layer.bias if layer.bias is None else layer.bias[part]
    return F.linear(x.permute(0, 2, 3, 1), layer.weight.flatten(1)[part], bias).permute(0, 3, 1, 2)


def _block(inputs: int, outputs: int) -> nn.Sequential:
    """A convolution over 3 by 3."""
    return nn.Sequential(nn.Conv2d(inputs, outputs, 3, padding=1), nn.ReLU(inplace=True))
