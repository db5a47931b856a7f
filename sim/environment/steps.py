"""The actions of a step, read and checked before anything is changed."""

from typing import Any

import numpy as np
from gymnasium.error import ResetNeeded

from sim.actions import ACTIONS
from sim.world.kernels import TERMINATED, TRUNCATED


def read_actions(actions: Any) -> np.ndarray:
    """Actions as an array. Raises ``ValueError`` for what is not of integers."""
    actions = np.asarray(actions)
    if actions.dtype.kind not in "iu":
        raise ValueError(f"actions must be integers 0, 1 or 2, not {actions.dtype}")
    return actions


def read_tensor(actions: Any, device: str) -> Any:
    """Actions (E,) int64 on a device; ``ValueError`` for others. On the CPU by NumPy: torch's threads would
    stay awake, and in the way of those that step.
    """
    import torch

    tensor = isinstance(actions, torch.Tensor)
    if not tensor or actions.dtype != torch.int64 or actions.device.type != device:
        raise ValueError(f"actions must be an int64 tensor on the device {device!r}")
    return actions.numpy() if device == "cpu" else actions


def require_actions(actions: Any, count: int) -> None:
    """Raise ``ValueError`` where an array or a tensor is not an action for each of ``count`` environments."""
    if actions.shape != (count,):
        raise ValueError(f"actions have shape {tuple(actions.shape)}: one for each of {count} environments")
    least, greatest = _range(actions)
    if least < 0 or greatest >= ACTIONS:
        raise ValueError(f"actions go from 0 to 2, found {least} to {greatest}")


def require_going_on(flags: np.ndarray) -> None:
    """Raise ``ResetNeeded`` where an episode has ended, by the outputs' flags (F, E) bool."""
    over = flags[TERMINATED] | flags[TRUNCATED]
    if over.any():
        raise ResetNeeded(
            f"the episode of environment {int(over.argmax())} has ended: reset it by "
            'reset(options={"reset_mask": ...})'
        )


def _range(actions: Any) -> tuple[int, int]:
    """The least and the greatest of an array or a tensor, from a GPU in one answer."""
    if isinstance(actions, np.ndarray):
        if actions.size == 1:  # sooner than to reduce it twice
            return (one := actions.item()), one
        return int(actions.min()), int(actions.max())
    import torch

    least, greatest = torch.stack(actions.aminmax()).tolist()
    return least, greatest
