"""What a run of map completion is."""

from dataclasses import dataclass
from typing import ClassVar

from agent.learning.config import TrainConfig
from logic.errors import RequestError

MOST_GROUND = 250
"""Types of rooms and kinds of pieces that map completion tells apart: they are kept in 8 bits."""


@dataclass(frozen=True)
class CompletionConfig(TrainConfig):
    """Map completion: a network learns what lies where a map shows nothing."""

    groups: ClassVar = {"kinds": "Map completion"}

    kinds: tuple[str, ...] = ()
    """Types of rooms and kinds of pieces that are told apart; by default those of the houses that it learns
    in."""

    channels: tuple[int, ...] = (16, 32, 64, 96)
    """Of the network's levels, each at half the resolution of the one before."""

    num_steps: int = 32
    """Steps of every explorer from one window of its map to the next."""

    restarts: float = 0.04
    """Share of the environments that begin another episode each time."""

    update_epochs: int = 2
    """Passes over these windows, each time turned and mirrored otherwise."""

    batch_size: int = 32
    """Windows that an update learns from."""

    final_lr_fraction: float = 0.02
    """The learning rate falls on a line to this fraction of it."""

    max_grad_norm: float = 5.0
    """Longer gradients are clipped to this norm."""

    algorithm: ClassVar[str] = "map-completion"
    reads_maps: ClassVar[bool] = True
    positive: ClassVar[tuple[str, ...]] = (
        *(*TrainConfig.positive, "num_steps", "update_epochs", "batch_size", "max_grad_norm"),
    )
    fractions: ClassVar[tuple[str, ...]] = (*TrainConfig.fractions, "restarts", "final_lr_fraction")

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 2 <= len(self.channels) <= 5 or min(self.channels) < 1:
            raise RequestError(f"channels are of 2 to 5 levels, 1 or more each, not {self.channels}")
        if len(self.kinds) > MOST_GROUND:
            raise RequestError(f"kinds are {MOST_GROUND} at most, not {len(self.kinds)}")
        if self.device != "cpu":
            raise RequestError("map completion runs on device cpu alone: that is where maps are kept")

    @classmethod
    def presets(cls) -> "dict[str, TrainConfig]":
        """Configs that run by name."""
        return {
            "map-completion": cls(
                targets="secondary", num_envs=512, steps=6_000_000, threads=2, learning_rate=3e-3
            )
        }
