"""The network of map completion: a U-Net (Ronneberger et al. 2015, arXiv:1505.04597) over a map's window."""

from itertools import pairwise
from typing import NamedTuple

import torch
import torch.nn.functional as F
from torch import Tensor, nn

WINDOW = 96
"""Blocks along each side of a window: 27.5 m at the default body, the body in its middle."""

PLANES = 3
"""What it reads of each block: the share of its cells that are occupied, and that were seen; and how near it
is to where the episode began."""

FADE = 9.0
"""Blocks over which nearness to the start falls by a factor of e."""


class Prediction(NamedTuple):
    """Logits of each block of n windows."""

    floor: Tensor
    """(n, W, W): whether a body can stand there, so that a target may lie there in some task."""

    target: Tensor
    """(n, W, W): if so, whether the task's targets lie there."""

    rooms: Tensor
    """(n, K, W, W): if so, which of K types its room is of."""


class CompletionNetwork(nn.Module):
    """A U-Net of ``channels`` on half the blocks' resolution: about 200,000 weights.

    Convolutions alone, so a house's place in the window does not matter.
    """

    def __init__(self, types: int, channels: tuple[int, ...] = (16, 32, 64, 96)) -> None:
        """Draw first weights from torch's generator, for houses with so many ``types`` of rooms."""
        super().__init__()
        self.types, self.channels = types, channels
        self.first = nn.Sequential(nn.Conv2d(PLANES, channels[0], 4, 2, 1), nn.ReLU(inplace=True))
        self.down = nn.ModuleList(_block(i, o) for i, o in pairwise(channels))
        self.up = nn.ModuleList(_block(i + o, i) for i, o in pairwise(channels))
        self.out = nn.Conv2d(channels[0], 4 * (2 + types), 1)
        self.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue]

    def forward(self, windows: Tensor, starts: Tensor) -> Prediction:
        """Predict from windows (n, W, W) uint8, as ``Windows.read`` gives them, and where the episodes began
        in them, ``starts`` (n, 2) float32, blocks south and east of the first.
        """
        occupied, seen = (windows & 7).float() / 4, (windows >> 3).float() / 4
        axis = torch.arange(windows.shape[-1], device=windows.device)
        south, east = ((axis - starts[:, k, None]).square() for k in range(2))
        near = torch.exp(-(south[:, :, None] + east[:, None]).sqrt() / FADE)
        x = self.first(torch.stack([occupied, seen, near], -1).permute(0, 3, 1, 2))
        passed = []
        for down in self.down:
            passed.append(x)
            x = down(F.max_pool2d(x, 2))
        for up, kept in zip(reversed(self.up), reversed(passed), strict=True):
            x = up(torch.cat([F.interpolate(x, scale_factor=2.0), kept], 1))
        logits = F.pixel_shuffle(self.out(x), 2)
        return Prediction(logits[:, 0], logits[:, 1], logits[:, 2:])


def _block(inputs: int, outputs: int) -> nn.Sequential:
    """A convolution over 3 by 3."""
    return nn.Sequential(nn.Conv2d(inputs, outputs, 3, padding=1), nn.ReLU(inplace=True))
