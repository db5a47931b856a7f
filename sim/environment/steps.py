"""The actions of a step, read and checked before anything is changed."""

from typing import Any

import numpy as np
from gymnasium import spaces
from gymnasium.error import ResetNeeded

from sim.drive import Drive
from sim.world.kernels import TERMINATED, TRUNCATED


def orders(space: spaces.Space[Any], drive: Drive) -> "Choices | Commands":
    """How the actions of a space are read."""
    return Choices(space) if isinstance(space, spaces.Discrete) else Commands(drive)


class Choices:
    """Actions that are numbers."""

    def __init__(self, space: spaces.Discrete) -> None:
        """Of so many."""
        self.last = int(space.n) - 1
        self.words = (
            f"one integer, 0, 1 or {self.last}" if self.last == 2 else f"one integer, 0 to {self.last}"
        )

    def read(self, actions: Any) -> np.ndarray:
        """Actions as an array. Raises ``ValueError`` for what is not of integers."""
        actions = np.asarray(actions)
        if actions.dtype.kind not in "iu":
            few = "0, 1 or 2" if self.last == 2 else f"0 to {self.last}"
            raise ValueError(f"actions must be integers {few}, not {actions.dtype}")
        return actions

    def read_tensor(self, actions: Any, device: str) -> Any:
        """Actions (E,) int64 on a device; ``ValueError`` for others. On the CPU by NumPy: torch's threads
        would stay awake, and in the way of those that step.
        """
        import torch

        tensor = isinstance(actions, torch.Tensor)
        if not tensor or actions.dtype != torch.int64 or actions.device.type != device:
            raise ValueError(f"actions must be an int64 tensor on the device {device!r}")
        return actions.numpy() if device == "cpu" else actions

    def require(self, actions: Any, count: int) -> None:
        """Raise ``ValueError`` where this is not an action for each of ``count`` environments."""
        if actions.shape != (count,):
            raise ValueError(
                f"actions have shape {tuple(actions.shape)}: one for each of {count} environments"
            )
        least, greatest = _range(actions)
        if least < 0 or greatest > self.last:
            raise ValueError(f"actions go from 0 to {self.last}, found {least} to {greatest}")

    def packed(self, actions: Any) -> Any:
        """Actions as kernels read them: 64 bits each."""
        return actions


class Commands:
    """Actions that are a forward speed and a turn rate, (v, w)."""

    words = "two numbers, (v, w)"

    def __init__(self, drive: Drive) -> None:
        """Within its limits."""
        self.drive = drive
        self.low, self.high = (np.array(ends, np.float32) for ends in (drive.low, drive.high))

    def read(self, actions: Any) -> np.ndarray:
        """Actions as an array of float32. Raises ``ValueError`` for what are no numbers."""
        actions = np.asarray(actions)
        if actions.dtype.kind not in "iuf":
            raise ValueError(f"actions must be numbers, (v, w) for each environment, not {actions.dtype}")
        return np.ascontiguousarray(actions, np.float32)

    def read_tensor(self, actions: Any, device: str) -> Any:
        """Actions (E, 2) float32 on a device; ``ValueError`` for others."""
        import torch

        tensor = isinstance(actions, torch.Tensor)
        if not tensor or actions.dtype != torch.float32 or actions.device.type != device:
            raise ValueError(f"actions must be a float32 tensor on the device {device!r}")
        actions = actions.detach().contiguous()
        return actions.numpy() if device == "cpu" else actions

    def require(self, actions: Any, count: int) -> None:
        """Raise ``ValueError`` where this has not two numbers for each of ``count`` environments, or NaN, or,
        unless they are clipped, a number beyond its limit.
        """
        if actions.shape != (count, 2):
            raise ValueError(
                f"actions have shape {tuple(actions.shape)}: (v, w) for each of {count} environments"
            )
        array = actions if isinstance(actions, np.ndarray) else actions.cpu().numpy()
        strange = np.isnan(array) if self.drive.clips else ~((array >= self.low) & (array <= self.high))
        if strange.any():
            e = int(strange.any(axis=1).argmax())
            v, w = array[e].tolist()
            limits = (
                f"v from {self.low[0]:g} to {self.high[0]:g} m/s, w up to {self.high[1]:g} rad/s either way"
            )
            raise ValueError(f"action {e} is ({v:g}, {w:g}): {limits}")

    def packed(self, actions: Any) -> Any:
        """Actions as kernels read them: the bits of both numbers in 64. Kernels clip them."""
        if isinstance(actions, np.ndarray):
            return actions.view(np.int64)[:, 0]
        import torch

        return actions.view(torch.int64)[:, 0]


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
