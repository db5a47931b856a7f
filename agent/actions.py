"""The three actions, and what they are in a mirror."""

import torch
from torch import Tensor

LEFT, RIGHT, FORWARD = range(3)
"""Turn left by 45 degrees, turn right, one step forward."""

ACTIONS = 3
"""How many there are."""


def mirrored(actions: Tensor) -> Tensor:
    """The same actions (B,) in a mirror: left for right; rays are mirrored by ``flip(1)``.

    Houses are as likely as their mirror images and the rays lie symmetrically about the heading, so a
    mirrored transition is as good as the one that was lived.
    """
    return torch.where(actions == FORWARD, actions, RIGHT - actions)
