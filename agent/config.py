"""What a training run is: one frozen dataclass, and the presets that run by name."""

from dataclasses import dataclass
from typing import Literal

from logic.errors import RequestError


@dataclass(frozen=True)
class Config:
    """Parallel Q-learning, "PQN" (Gallici et al. 2024, arXiv:2407.04811). The field docstrings are the help.

    The defaults reach the oracle's neighbourhood in the main room after about two minutes on two cores.
    Raises ``RequestError``, a ``ValueError``, that names the field for a value that no run can have.
    """

    targets: Literal["main", "secondary", "mixed"] = "main"
    """Where targets lie."""

    environments: int = 256
    """Worlds stepped at once."""

    rollout: int = 32
    """Steps of every world between two updates of the network."""

    steps: int = 3_000_000
    """Environment steps of the whole run; the schedules below are fractions of it."""

    seconds: float | None = None
    """Wall-clock limit: the schedules then follow whichever of steps and seconds is further on. With none,
    a run on the CPU is a function of config, houses and seed alone."""

    seed: int = 0
    """Seeds the worlds, the network's first weights, the exploration and the minibatches."""

    threads: int = 1
    """Cores that torch may use. More help little with batches this small, and sums depend on their number."""

    half_lives: tuple[float, ...] = (1, 4, 16, 64)
    """Half-lives of the memory's traces, in steps."""

    map: bool = False
    """Whether the network reads a map of the house, made of the agent's own rays and actions."""

    novelty: float = 0.0
    """Reward for a step that brings the goal of its map nearer, and for seeing 40 new cells; it fades to 0 by
    ``fading`` of the run."""

    fading: float = 0.7
    """Fraction of the run over which ``novelty`` fades."""

    guided: float = 0.0
    """Share of the random actions that are the map's advice instead."""

    discount: float = 0.99
    """Worth of a reward one step later (gamma)."""

    trace: float = 0.75
    """How far returns run along the path taken before they trust the network (lambda): 0 one step, 1 all."""

    learning_rate: float = 1e-3
    """RAdam's rate at the start; it falls on a line to ``final_rate`` of it."""

    final_rate: float = 0.05
    """The learning rate at the end, as a fraction of the one at the start."""

    clip: float = 10.0
    """Largest norm of a gradient."""

    epochs: int = 2
    """Passes over each rollout; every second one is seen in the mirror (left and right exchanged)."""

    minibatches: int = 4
    """Updates in an epoch."""

    epsilon: float = 0.4
    """Share of random actions at the start."""

    final_epsilon: float = 0.02
    """Share of random actions after ``exploration`` of the run, and from then on."""

    exploration: float = 0.2
    """Fraction of the run over which epsilon falls."""

    forward: float = 0.93
    """Share of forward among random actions, as the paper's own exploration has it."""

    def __post_init__(self) -> None:
        """Refuse what no run can have, before anything is made."""
        for name in POSITIVE:
            if getattr(self, name) is not None and not getattr(self, name) > 0:
                raise RequestError(f"{name} must be above 0, not {getattr(self, name)}")
        for name in SHARES:
            if not 0 <= getattr(self, name) <= 1:
                raise RequestError(f"{name} must lie between 0 and 1, not {getattr(self, name)}")
        if not all(half_life > 0 for half_life in self.half_lives):
            raise RequestError(f"half_lives must be above 0, not {self.half_lives}")
        if not self.map and (self.novelty or self.guided):
            raise RequestError("novelty and guided need map: there is no map that they could come from")
        if self.minibatches > self.environments * self.rollout:
            raise RequestError(f"minibatches must not exceed environments x rollout, not {self.minibatches}")


POSITIVE = (
    *("environments", "rollout", "steps", "seconds", "learning_rate", "clip"),
    *("epochs", "minibatches", "threads"),
)
SHARES = (
    *("discount", "trace", "final_rate", "epsilon", "final_epsilon", "exploration", "forward"),
    *("novelty", "fading", "guided"),
)

PRESETS = {
    "pqn": Config(),
    "pqn-map": Config(targets="secondary", steps=4_500_000, map=True, novelty=0.02, guided=0.9, epsilon=1.0),
}
"""Configs that run by name."""
