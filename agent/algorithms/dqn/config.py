"""Configuration and presets of deep Q-learning from a replay buffer."""

from dataclasses import dataclass
from typing import ClassVar

from vitruvius.agent.learning.config import QLearningConfig, TrainConfig
from vitruvius.logic.errors import RequestError


@dataclass(frozen=True)
class DQNConfig(QLearningConfig):
    """Deep Q-learning from a replay buffer, with double Q-learning and n-step returns.

    Source: Mnih et al. 2015, doi:10.1038/nature14236.
    """

    groups: ClassVar = {"buffer_size": "Deep Q-learning from a replay buffer (DQN)"}

    buffer_size: int = 200_000
    """Capacity of the replay buffer in steps, of all environments together."""

    learning_starts: int = 20_000
    """Steps in the buffer before the first update."""

    train_frequency: int = 4
    """Steps of every environment between two updates."""

    batch_size: int = 1024
    """Number of steps that an update learns from."""

    n_step: int = 5
    """Number of rewards (n) that a return adds up before it uses the network's value."""

    target_network_frequency: int = 200
    """Updates between two copies of the network to the target network."""

    algorithm: ClassVar[str] = "dqn"
    positive: ClassVar[tuple[str, ...]] = (
        *(*QLearningConfig.positive, "buffer_size", "learning_starts", "train_frequency"),
        *("batch_size", "n_step", "target_network_frequency"),
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.buffer_size < self.num_envs * (self.n_step + 1):
            raise RequestError(
                f"buffer_size must hold n_step + 1 steps of each environment, not {self.buffer_size}"
            )
        if self.device != "cpu":
            raise RequestError("deep Q-learning from a replay buffer runs only on device cpu")

    @classmethod
    def presets(cls) -> "dict[str, TrainConfig]":
        """Return the configs that run by name."""
        return {
            "dqn": cls(
                num_envs=64, learning_rate=5e-4, final_lr_fraction=0.1, epsilon=1.0, exploration_fraction=0.1
            )
        }
