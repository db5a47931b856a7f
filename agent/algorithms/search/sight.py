"""What can be seen from each place towards each side, as layers of a network: learnt rays."""

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from agent.algorithms.map_completion.network import pointwise

SIDES = 4

FAN = ((0, 1, 0), (0.25, 0.5, 0.25), (0.9, 0.1, 0), (0, 0.1, 0.9), (0.5, 0.5, 0), (0, 0.5, 0.5))
"""Where rays of each channel go at first, from one row to the next: left, straight on, right."""

OPEN = 1.5
"""The logit of what a ray passes at first."""


class Sight(nn.Module):
    """Gathers what lies in sight of each place, a recurrence over rows as in spatial networks (Pan et al.
    2018, arXiv:1712.06080): what is seen from a place is what the row ahead shows and lets through.

    A convolution reaches some places around; a ray that ends at a wall reaches as far as there is none.
    """

    def __init__(self, inputs: int, channels: int) -> None:
        """Of so many ``inputs`` it gathers ``channels`` towards each side."""
        super().__init__()
        self.channels = channels
        self.given = nn.Conv2d(inputs, 2 * channels, 1)
        self.fan = nn.Parameter(torch.tensor([FAN[k % len(FAN)] for k in range(channels)]).float())
        with torch.no_grad():
            if self.given.bias is not None:
                self.given.bias[channels:].fill_(OPEN)

    def forward(self, x: Tensor) -> Tensor:
        """What is in sight (n, 4 C, G, G) of features (n, inputs, G, G)."""
        given = pointwise(self.given, x)
        # Turned so that rays come down the rows.
        turned = torch.stack([torch.rot90(given, side, (2, 3)) for side in range(SIDES)], 1)
        shown, passed = turned.permute(3, 0, 1, 2, 4).contiguous().split(self.channels, 3)
        left, ahead, right = (self.fan[:, k, None] for k in range(3))
        seen, rows = torch.zeros_like(shown[0]), []
        for own, open_ in zip(shown.relu().unbind(), passed.sigmoid().unbind(), strict=True):
            rows.append(seen)
            beside = F.pad(own + open_ * seen, (1, 1))
            seen = left * beside[..., :-2] + ahead * beside[..., 1:-1] + right * beside[..., 2:]
        sides = torch.stack(rows, 3).unbind(1)
        return torch.cat([torch.rot90(each, -side, (2, 3)) for side, each in enumerate(sides)], 1)
