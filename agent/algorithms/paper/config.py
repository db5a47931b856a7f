"""Configuration and presets of the paper's agent."""

from dataclasses import dataclass
from typing import ClassVar, Literal

from vitruvius.agent.banks import PAPER_HOUSE
from vitruvius.agent.learning.config import TrainConfig
from vitruvius.logic.errors import RequestError


@dataclass(frozen=True)
class PaperConfig(TrainConfig):
    """Original agent of the paper; preset ``paper`` trains it in the original's simulator.

    See ``paper.learner``.
    """

    groups: ClassVar = {"episodes": "The paper's agent"}

    episodes: int | None = 817
    """Largest number of episodes of the run, which may end earlier by its steps; None: no limit."""

    initialisation: Literal["glorot", "torch"] = "glorot"
    """First weights: Glorot's uniform weights without biases, as in Keras, or torch's defaults."""

    lr_decay: float = 1e-2
    """Decay of the learning rate, which is divided by 1 + lr_decay x the number of updates so far."""

    adam_epsilon: float = 1e-7
    """Constant that Adam adds to the root of the mean squared gradient, as in Keras."""

    @property
    def knows(self) -> tuple[str, ...]:
        """Signals that the agent knows: rays and heading, as its rays have compass directions."""
        return "rays", "heading"

    homing: bool = True
    """True if a random action goes forward when a middle ray sees the target."""

    epsilon_decay: float = 0.996
    """Factor on epsilon after each episode."""

    buffer_size: int = 100_000
    """Capacity of the replay buffer in steps, of all environments together."""

    learning_starts: int = 1
    """Steps in the buffer before the first update."""

    batch_size: int = 500
    """Number of steps that are replayed when an episode ends; some repeat while the buffer has fewer."""

    num_minibatches: int = 500
    """Number of updates among which these steps are divided."""

    angles: Literal["own", "next"] = "next"
    """Angle that the network reads at a ray: the ray's own, or the next ray's, as in the original by
    mistake."""

    plays_as_original: bool = True
    """True if the trained agent is evaluated as the original was: with a fraction ``final_epsilon`` of random
    actions, which go forward when a middle ray sees the target. Otherwise it is evaluated as all other agents
    are."""

    algorithm: ClassVar[str] = "paper"
    learnt_in: ClassVar[str | None] = PAPER_HOUSE
    positive: ClassVar[tuple[str, ...]] = (
        *(*TrainConfig.positive, "episodes", "adam_epsilon", "buffer_size", "learning_starts"),
        *("batch_size", "num_minibatches"),
    )
    fractions: ClassVar[tuple[str, ...]] = (*TrainConfig.fractions, "epsilon_decay")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.lr_decay < 0:
            raise RequestError(f"lr_decay must be 0 or more, not {self.lr_decay}")
        if self.buffer_size < 2 * self.num_envs:
            raise RequestError(f"buffer_size must hold 2 steps of each environment, not {self.buffer_size}")
        if self.num_minibatches > self.batch_size:
            raise RequestError(f"num_minibatches must not exceed batch_size, not {self.num_minibatches}")
        if self.device != "cpu":
            raise RequestError("deep Q-learning from a replay buffer runs only on device cpu")

    @classmethod
    def presets(cls) -> "dict[str, TrainConfig]":
        """Return the configs that run by name."""
        return {
            "paper": cls(
                targets="paper-main",
                world="paper",
                avoidance="paper",
                num_envs=1,
                steps=1_225_500,  # 817 episodes at most
                learning_rate=1e-2,
                epsilon=1.0,
                final_epsilon=0.025,
                forward=0.92,
            )
        }
