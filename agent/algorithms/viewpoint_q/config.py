"""What a run of Q-learning over viewpoints is."""

from dataclasses import dataclass
from typing import ClassVar

from agent.learning.config import TrainConfig
from logic.errors import RequestError


@dataclass(frozen=True)
class ViewpointQConfig(TrainConfig):
    """Q-learning over the viewpoints that a planner offers: options, of some 25 steps each.

    Preset ``viewpoints`` begins as the explorer, and learns which of the views is worth more than the
    planner takes it to be. See ``agent.algorithms.viewpoint_q``.
    """

    groups: ClassVar = {"gamma": "Q-learning over viewpoints"}

    gamma: float = 0.998
    """Discount per step."""

    q_lambda: float = 0.8
    """Lambda of Q(lambda), over options: 0 one option, 1 all that follow."""

    privileged: bool = True
    """Whether the reward in training is how likely each step found the target, by the true house, and not
    whether it did: as much in all, with less noise. An agent that plays reads no house."""

    update_epochs: int = 4
    """Passes over the choices of the episodes played last."""

    batch_size: int = 512
    """Choices that an update learns from."""

    max_grad_norm: float = 1.0
    """Longer gradients are clipped to this norm."""

    algorithm: ClassVar[str] = "viewpoint-q"
    positive: ClassVar[tuple[str, ...]] = (
        *(*TrainConfig.positive, "update_epochs", "batch_size", "max_grad_norm"),
    )
    fractions: ClassVar[tuple[str, ...]] = (*TrainConfig.fractions, "gamma", "q_lambda")

    def __post_init__(self) -> None:
        """Refuse what no run can have, before anything is made."""
        super().__post_init__()
        if self.device != "cpu":
            raise RequestError("viewpoints needs device cpu: that is where maps are kept")
