"""Configuration and presets of parallel Q-learning."""

from dataclasses import dataclass
from typing import ClassVar, Literal

from vitruvius.agent.learning.config import QLearningConfig, TrainConfig
from vitruvius.logic.errors import RequestError


@dataclass(frozen=True)
class PQNConfig(QLearningConfig):
    """Parallel Q-learning, "PQN" (Gallici et al. 2024, arXiv:2407.04811).

    Preset ``pqn`` comes close to the oracle in the main room after about a minute on one core.
    """

    groups: ClassVar = {"network": "Parallel Q-learning (PQN)"}

    network: Literal["feedforward", "recurrent"] = "feedforward"
    """Memory of the network. feedforward: exponential moving averages of the past; recurrent: a layer (GRU)
    that learns what to remember."""

    num_steps: int = 32
    """Steps of every environment in a rollout; the network learns after each."""

    q_lambda: float = 0.75
    """Lambda of Q(lambda): how far returns follow the path taken before they use the network's values: 0 one
    step, 1 all steps."""

    update_epochs: int = 2
    """Passes over each rollout."""

    num_minibatches: int = 4
    """Number of updates in an epoch, each with an equal part of the rollout."""

    algorithm: ClassVar[str] = "pqn"
    parallel: ClassVar[bool] = True
    positive: ClassVar[tuple[str, ...]] = (
        *(*QLearningConfig.positive, "num_steps", "update_epochs", "num_minibatches"),
    )
    fractions: ClassVar[tuple[str, ...]] = (*(*QLearningConfig.fractions, "q_lambda"),)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.network == "recurrent" and self.module:
            raise RequestError("module: it replaces the feedforward network, not the recurrent one")
        if self.network == "recurrent" and self.num_minibatches > self.num_envs:
            raise RequestError(f"num_minibatches must not exceed num_envs, not {self.num_minibatches}")
        if self.num_minibatches > self.num_envs * self.num_steps:
            raise RequestError(
                f"num_minibatches must not exceed num_envs x num_steps, not {self.num_minibatches}"
            )

    @property
    def remembers(self) -> bool:
        """True if the network reads what it did before."""
        return super().remembers or self.network == "recurrent"

    @classmethod
    def presets(cls) -> "dict[str, TrainConfig]":
        """Return the configs that run by name."""
        return {
            # More environments, and one pass over each rollout: half the time per step.
            "pqn": cls(num_envs=512, num_steps=16, update_epochs=1, learning_rate=1.5e-3),
            # Same for a body that drives, with as many random actions of each kind. A command takes more
            # steps to have an effect.
            "pqn-free": cls(
                world="drive",
                avoidance="none",
                num_envs=512,
                num_steps=16,
                update_epochs=1,
                learning_rate=1.5e-3,
                q_lambda=0.9,
                forward=0.07,
                steps=6_000_000,
            ),
            "pqn-recurrent": cls(network="recurrent", half_lives=(), steps=4_500_000),
        }
