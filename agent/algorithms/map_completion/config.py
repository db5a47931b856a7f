"""Configuration of a run of map completion."""

from dataclasses import dataclass
from typing import ClassVar

from vitruvius.agent.learning.config import TrainConfig
from vitruvius.logic.errors import RequestError

MAX_GROUND_TYPES = 250
"""Largest number of room types and furniture kinds that map completion distinguishes, as they are stored in 8
bits."""


@dataclass(frozen=True)
class CompletionConfig(TrainConfig):
    """Map completion: a network learns to predict the unseen part of a map."""

    groups: ClassVar = {"kinds": "Map completion"}

    kinds: tuple[str, ...] = ()
    """Types of rooms and kinds of furniture to distinguish; by default those of the training houses."""

    channels: tuple[int, ...] = (16, 32, 64, 96)
    """Channels of the network's levels, each at half the resolution of the level before."""

    num_steps: int = 32
    """Steps of every explorer from one window of its map to the next."""

    restarts: float = 0.04
    """Fraction of the environments that begin another episode after each window."""

    update_epochs: int = 2
    """Passes over these windows, each with another rotation and reflection."""

    batch_size: int = 32
    """Number of windows that an update learns from."""

    final_lr_fraction: float = 0.02
    """Final learning rate as a fraction of the first; the rate falls linearly."""

    max_grad_norm: float = 5.0
    """Norm to which longer gradients are clipped."""

    algorithm: ClassVar[str] = "map-completion"
    reads_maps: ClassVar[bool] = True
    positive: ClassVar[tuple[str, ...]] = (
        *(*TrainConfig.positive, "num_steps", "update_epochs", "batch_size", "max_grad_norm"),
    )
    fractions: ClassVar[tuple[str, ...]] = (*TrainConfig.fractions, "restarts", "final_lr_fraction")

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 2 <= len(self.channels) <= 5 or min(self.channels) < 1:
            raise RequestError(f"channels has 2 to 5 levels, each 1 or more, not {self.channels}")
        if len(self.kinds) > MAX_GROUND_TYPES:
            raise RequestError(f"kinds has at most {MAX_GROUND_TYPES} names, not {len(self.kinds)}")
        if self.device != "cpu":
            raise RequestError("map completion runs only on device cpu, which holds the maps")

    @classmethod
    def presets(cls) -> "dict[str, TrainConfig]":
        """Return the configs that run by name."""
        return {
            "map-completion": cls(
                targets="secondary", num_envs=512, steps=6_000_000, threads=2, learning_rate=3e-3
            )
        }
