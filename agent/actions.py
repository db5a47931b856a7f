"""The three actions, and the same with left and right exchanged."""

import torch
from torch import Tensor

LEFT, RIGHT, FORWARD = range(3)
"""Turn left by 45 degrees, turn right, one step forward."""

ACTIONS = 3
"""How many there are."""


def flipped_actions(actions: Tensor) -> Tensor:
    """The same actions (B,) with left and right exchanged; rays are exchanged by ``flip(1)``.

    Houses are as likely as their mirror images and the rays lie symmetrically about the heading, so a flipped
    transition is as good as the one that was seen.
    """
    return torch.where(actions == FORWARD, actions, RIGHT - actions)
