"""Actions of a step, read and checked before anything is changed."""

from typing import Any

import numpy as np
from gymnasium import spaces
from gymnasium.error import ResetNeeded

from vitruvius.sim.drive import Drive
from vitruvius.sim.world.phases import TERMINATED, TRUNCATED


def orders(space: spaces.Space[Any], drive: Drive) -> "Choices | Commands":
    """Return the reader for the actions of a space."""
    return Choices(space) if isinstance(space, spaces.Discrete) else Commands(drive)


class Choices:
    """Reader of actions that are numbers."""

    def __init__(self, space: spaces.Discrete) -> None:
        """Take the space, which has the number of actions."""
        self.last = int(space.n) - 1
        self.words = (
            f"one integer, 0, 1 or {self.last}" if self.last == 2 else f"one integer, 0 to {self.last}"
        )

    def read(self, actions: Any) -> np.ndarray:
        """Return actions as an array. Raises ``ValueError`` for anything but integers."""
        actions = np.asarray(actions)
        if actions.dtype.kind not in "iu":
            few = "0, 1 or 2" if self.last == 2 else f"0 to {self.last}"
            raise ValueError(f"actions must be integers {few}, not {actions.dtype}")
        return actions

    def read_tensor(self, actions: Any, device: str) -> Any:
        """Return actions (E,) int64 on a device. Raises ``ValueError`` for any other tensor.

        On the CPU the result is a NumPy array, because torch's threads would stay awake and disturb those
        that step.
        """
        import torch

        tensor = isinstance(actions, torch.Tensor)
        if not tensor or actions.dtype != torch.int64 or actions.device.type != device:
            raise ValueError(f"actions must be an int64 tensor on the device {device!r}")
        return actions.numpy() if device == "cpu" else actions

    def require(self, actions: Any, count: int) -> None:
        """Raise ``ValueError`` unless there is a valid action for each of ``count`` environments."""
        if actions.shape != (count,):
            raise ValueError(
                f"actions have shape {tuple(actions.shape)}: give one for each of {count} environments"
            )
        least, greatest = _range(actions)
        if least < 0 or greatest > self.last:
            raise ValueError(f"actions must be 0 to {self.last}, not {least} to {greatest}")

    def given(self, actions: Any) -> Any:
        """Return actions (E,) for kernels."""
        return actions


class Commands:
    """Reader of actions that are speeds, (v, w), or (vx, vy, w)."""

    def __init__(self, drive: Drive) -> None:
        """Take the limits of the speeds."""
        self.drive, self.size = drive, len(drive.low)
        self.words = f"{('two', 'three')[self.size - 2]} numbers, {drive.names}"
        self.low, self.high = (np.array(ends, np.float32) for ends in (drive.low, drive.high))
        self._tensors: Any = None  # limits as tensors, on the device of step_torch's actions

    def read(self, actions: Any) -> np.ndarray:
        """Return actions as a float32 array. Raises ``ValueError`` for anything but numbers."""
        actions = np.asarray(actions)
        if actions.dtype.kind not in "iuf":
            names = self.drive.names
            raise ValueError(f"actions must be numbers, {names} for each environment, not {actions.dtype}")
        return np.ascontiguousarray(actions, np.float32)

    def read_tensor(self, actions: Any, device: str) -> Any:
        """Return actions (E, n) float32 on a device. Raises ``ValueError`` for any other tensor."""
        import torch

        tensor = isinstance(actions, torch.Tensor)
        if not tensor or actions.dtype != torch.float32 or actions.device.type != device:
            raise ValueError(f"actions must be a float32 tensor on the device {device!r}")
        actions = actions.detach().contiguous()
        return actions.numpy() if device == "cpu" else actions

    def require(self, actions: Any, count: int) -> None:
        """Raise ``ValueError`` unless there are valid numbers for each of ``count`` environments.

        NaN is invalid, and so are numbers beyond their limits, unless actions are clipped.
        """
        if actions.shape != (count, self.size):
            found, names = tuple(actions.shape), self.drive.names
            raise ValueError(f"actions have shape {found}: give {names} for each of {count} environments")
        if self._strange(actions).any():
            array = actions if isinstance(actions, np.ndarray) else actions.cpu().numpy()
            e = int(self._strange(array).any(axis=1).argmax())
            given = ", ".join(f"{each:g}" for each in array[e].tolist())
            first, aside = "vx" if self.size > 2 else "v", ""
            if self.size > 2:
                aside = f", vy up to {self.high[1]:g} m/s"
            limits = f"{first} from {self.low[0]:g} to {self.high[0]:g} m/s{aside}"
            raise ValueError(
                f"action {e} is ({given}): {limits}, w up to {self.high[-1]:g} rad/s in either direction"
            )

    def _strange(self, actions: Any) -> Any:
        """Return a mask (E, n) of the invalid numbers, on the device of the actions."""
        if self.drive.clips:
            return ~(actions <= np.inf)  # NaN
        low, high = self._limits(actions)
        return ~((actions >= low) & (actions <= high))

    def _limits(self, actions: Any) -> Any:
        """Return the limits, on the device of the actions."""
        if isinstance(actions, np.ndarray):
            return self.low, self.high
        if self._tensors is None:
            self._tensors = [actions.new_tensor(ends.tolist()) for ends in (self.low, self.high)]
        return self._tensors

    def given(self, actions: Any) -> Any:
        """Return actions (E, n) float32 for kernels, which clip them.

        Three speeds are whole multiples of ``Drive.part``, as those of bodies that drive sideways.
        """
        if self.size == 2:
            return actions
        if isinstance(actions, np.ndarray):
            part = np.array(self.drive.part)
            parts = np.rint(np.clip(actions, self.low, self.high) / part) + 0.0  # no negative zero
            return parts.astype(np.float32) * part.astype(np.float32)
        import torch

        low, high, part = (
            torch.tensor(each, dtype=torch.float64, device=actions.device)
            for each in (self.drive.low, self.drive.high, self.drive.part)
        )
        return ((actions.clamp(low, high) / part).round() + 0.0).float() * part.float()


def require_going_on(flags: np.ndarray) -> None:
    """Raise ``ResetNeeded`` if an episode has ended, by the outputs' flags (F, E) bool."""
    over = flags[TERMINATED] | flags[TRUNCATED]
    if over.any():
        raise ResetNeeded(
            f'the episode of environment {int(over.argmax())} has ended: call reset(options={{"reset_mask": '
            f"...}})"
        )


def _range(actions: Any) -> tuple[int, int]:
    """Return the smallest and the largest value of an array or a tensor, with one transfer from a GPU."""
    if isinstance(actions, np.ndarray):
        if actions.size == 1:  # faster than two reductions
            return (one := actions.item()), one
        return int(actions.min()), int(actions.max())
    import torch

    least, greatest = torch.stack(actions.aminmax()).tolist()
    return least, greatest
