"""What a run of the paper's agent is, and the presets."""

from dataclasses import dataclass
from typing import ClassVar, Literal

from agent.banks import PAPER_HOUSE
from agent.learning.config import TrainConfig
from logic.errors import RequestError


@dataclass(frozen=True)
class PaperConfig(TrainConfig):
    """The original agent; preset ``paper`` is it, in the original's simulator. See ``paper.learner``."""

    groups: ClassVar = {"episodes": "The paper's agent"}

    episodes: int | None = 817
    """Episodes of the whole run, if it has not ended by its steps before; None: as many as come."""

    initialisation: Literal["glorot", "torch"] = "glorot"
    """First weights: Glorot's uniform ones and no biases, as Keras has them, or torch's own."""

    lr_decay: float = 1e-2
    """The learning rate is divided by 1 + this x the updates so far."""

    adam_epsilon: float = 1e-7
    """What Adam adds to the root of the mean squared gradient: Keras's."""

    @property
    def knows(self) -> tuple[str, ...]:
        """Its rays have directions of the compass, so it knows its heading; and no more."""
        return "rays", "heading"

    homing: bool = True
    """Whether a random action goes forward where a middle ray sees the target."""

    epsilon_decay: float = 0.996
    """Epsilon is multiplied by this after each episode."""

    buffer_size: int = 100_000
    """Steps that the replay buffer holds, of all environments together."""

    learning_starts: int = 1
    """Steps in the buffer before the first update."""

    batch_size: int = 500
    """Steps that are replayed when an episode ends; some repeatedly while the buffer has fewer."""

    num_minibatches: int = 500
    """Updates that these steps are shared out among."""

    angles: Literal["own", "next"] = "next"
    """Whose angle the network reads at a ray: its own, or the next ray's, as the original's did by a slip."""

    plays_as_original: bool = True
    """Whether the trained agent is measured as the original was: a share ``final_epsilon`` of random actions,
    forward where a middle ray sees the target. Otherwise it is measured as all other agents are."""

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
            raise RequestError("deep Q-learning from a replay buffer runs on device cpu alone")

    @classmethod
    def presets(cls) -> "dict[str, TrainConfig]":
        """Configs that run by name."""
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
