"""Configuration of a run of a network that searches."""

from dataclasses import dataclass
from typing import ClassVar, Literal

from vitruvius.agent.learning.config import TrainConfig
from vitruvius.logic.errors import RequestError


@dataclass(frozen=True)
class SearchConfig(TrainConfig):
    """Search: a network learns the value of each view."""

    groups: ClassVar = {"channels": "Search"}

    channels: tuple[int, ...] = (16, 32, 64, 96)
    """Channels of the network's levels, each at half the resolution of the level before."""

    foresight: bool = True
    """True if the predictions of the released network of map completion are an input."""

    looks: bool = True
    """True if what each view would show is an input, by rays over the map and over the predictions."""

    num_steps: int = 32
    """Steps of every environment from one report to the next."""

    restarts: float = 0.015
    """Fraction of the environments that begin another episode after each report."""

    guided: float = 0.0
    """Fraction of the run over which the true best view replaces the network's, less and less often."""

    buffer_size: int = 2048
    """Number of choices that are stored to learn from."""

    passes: float = 4.0
    """Average number of updates that learn from a choice."""

    batch_size: int = 32
    """Number of choices that an update learns from."""

    loss: Literal["choice", "value"] = "choice"
    """Loss. choice: the relative worth of a view drawn by the network's values, compared with the best view;
    value: the values themselves, by Poisson regression."""

    heat: float = 0.2
    """First temperature at which the loss of choices draws a view."""

    final_heat: float = 0.05
    """Final temperature; in between its logarithm falls linearly."""

    final_lr_fraction: float = 0.02
    """Final learning rate as a fraction of the first; the rate falls linearly."""

    max_grad_norm: float = 1.0
    """Norm to which longer gradients are clipped."""

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
            raise RequestError(f"channels has 2 to 4 levels, each 1 or more, not {self.channels}")
        if self.device != "cpu":
            raise RequestError("search runs only on device cpu, which holds the maps")

    @classmethod
    def presets(cls) -> "dict[str, TrainConfig]":
        """Return the configs that run by name."""
        return {"search": cls(targets="secondary", num_envs=64, steps=6_000_000, learning_rate=1e-3)}
