"""What a run of a network that searches is."""

from dataclasses import dataclass
from typing import ClassVar, Literal

from agent.learning.config import TrainConfig
from logic.errors import RequestError


@dataclass(frozen=True)
class SearchConfig(TrainConfig):
    """Search: a network learns what each view is worth."""

    groups: ClassVar = {"channels": "Search"}

    channels: tuple[int, ...] = (16, 32, 64, 96)
    """Of the network's levels, each at half the resolution of the one before."""

    foresight: bool = True
    """Whether what the released network of map completion predicts is an input."""

    looks: bool = True
    """Whether what each view would show, by rays over the map and over what is foreseen, is an input."""

    num_steps: int = 32
    """Steps of every environment from one report to the next."""

    restarts: float = 0.015
    """Share of the environments that begin another episode each time."""

    guided: float = 0.0
    """Share of the run over which the true best view is taken in place of the network's, less and less
    often."""

    buffer_size: int = 2048
    """Choices that are kept to learn from."""

    passes: float = 4.0
    """How often a choice is learnt from, on average."""

    batch_size: int = 32
    """Choices that an update learns from."""

    loss: Literal["choice", "value"] = "choice"
    """What is learnt: choices, by what a view is worth that is drawn by the values, of the best one's; or the
    values themselves, by Poisson regression."""

    heat: float = 0.2
    """Temperature at which the loss of choices draws a view, at first."""

    final_heat: float = 0.05
    """The same in the end; between both its logarithm falls on a line."""

    final_lr_fraction: float = 0.02
    """The learning rate falls on a line to this fraction of it."""

    max_grad_norm: float = 1.0
    """Longer gradients are clipped to this norm."""

    algorithm: ClassVar[str] = "search"
    reads_maps: ClassVar[bool] = True
    positive: ClassVar[tuple[str, ...]] = (
        *(*TrainConfig.positive, "num_steps", "buffer_size", "passes", "batch_size", "max_grad_norm"),
        *("heat", "final_heat"),
    )
    fractions: ClassVar[tuple[str, ...]] = (*TrainConfig.fractions, "restarts", "guided", "final_lr_fraction")

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 2 <= len(self.channels) <= 4 or min(self.channels) < 1:
            raise RequestError(f"channels are of 2 to 4 levels, 1 or more each, not {self.channels}")
        if self.device != "cpu":
            raise RequestError("search runs on device cpu alone: that is where maps are kept")

    @classmethod
    def presets(cls) -> "dict[str, TrainConfig]":
        """Configs that run by name."""
        return {"search": cls(targets="secondary", num_envs=64, steps=6_000_000, learning_rate=1e-3)}
