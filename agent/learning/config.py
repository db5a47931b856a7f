"""Configuration of a training run: the fields of all algorithms, and those of Q-learning.

The names of the fields are those of CleanRL and Stable-Baselines3; their docstrings are the command's help.
"""

from collections.abc import Iterator
from dataclasses import dataclass, fields
from math import inf
from typing import Annotated, ClassVar, Literal, get_args

import tyro

from vitruvius.logic.errors import RequestError
from vitruvius.logic.request.counts import whole

MAX_SEED = 2**62 - 1
"""Largest seed: environments and houses count up from it, and their seeds have 64 bits."""

TargetMode = Literal["main", "secondary", "mixed"]
"""Location of the targets: in the main room, in secondary rooms, or in both."""

MAX_HALF_LIVES = 64
"""Largest number of half-lives of a memory; the presets have four."""

TARGET_MODES: tuple[TargetMode, ...] = get_args(TargetMode)


@dataclass(frozen=True)
class TrainConfig:
    """Fields that the runs of all algorithms have in common.

    Raises ``RequestError``, a ``ValueError``, that names the field with an invalid value.
    """

    groups: ClassVar = {
        "targets": "Learning objective",
        "num_envs": "Size of the run",
        "learning_rate": "Learning",
    }

    targets: str = "main"
    """Location of the targets: main, secondary, mixed or habit; or another task: module:Class, or as JSON,
    such as '{"task": "reach", "room": "kitchen"}'."""

    world: Literal["default", "drive", "paper"] = "default"
    """Preset of the simulator. drive: actions are speed commands, in the backend free, without an
    avoidance layer."""

    sim: Annotated[tuple[str, ...], tyro.conf.UseAppendAction, tyro.conf.arg(metavar="FIELD=VALUE")] = ()
    """Field of the simulator's configuration that replaces the preset's (sim/config.py lists them), as in
    noise=0.05, rays=20 or body=[0.3,0.3]."""

    avoidance: Literal["shield", "paper", "none"] = "shield"
    """Avoidance layer, which overrules the network. shield: forbids a step forward if the rays show that the
    body's path is not free; paper: the paper's rule, a turn whenever an obstacle is near."""

    num_envs: int = 256
    """Number of environments, over all processes together."""

    steps: int = 3_000_000
    """Environment steps of the whole run; the schedules below are fractions of it."""

    seconds: float | None = None
    """Wall-clock limit. The schedules then follow steps or seconds, whichever is nearer to its end. Without a
    limit, a run on the CPU is a function of config, houses and seed alone."""

    seed: int = 0
    """Seed of the environments, the network's first weights, the exploration and the order of minibatches."""

    device: Literal["cpu", "cuda"] = "cpu"
    """Device of the environments and the network."""

    threads: int = 1
    """Number of cores that torch may use. More cores help little with such small batches, and the rounding
    of sums depends on the number of cores."""

    precision: Literal["highest", "high", "medium"] = "highest"
    """Precision of products of float32 matrices, as in torch: medium may use bfloat16 internally, which is
    faster on processors with AMX."""

    learning_rate: float = 1e-3
    """Step size of the optimiser at the start."""

    epsilon: float = 0.4
    """Fraction of random actions at the start."""

    final_epsilon: float = 0.02
    """Least fraction of random actions."""

    forward: float = 0.93
    """Fraction of forward among random actions, as in the paper's own exploration."""

    algorithm: ClassVar[str]
    """Name of the algorithm."""

    learnt_in: ClassVar[str | None] = None
    """Default training houses: a name of ``sim.environment.arguments``."""

    reads_maps: ClassVar[bool] = False
    """True if the agent is trained on maps of one body: then it plays only its own task, with that body."""

    drives: ClassVar[bool] = False
    """True if the algorithm can learn to drive."""

    parallel: ClassVar[bool] = False
    """True if several processes can train together."""

    positive: ClassVar[tuple[str, ...]] = ("num_envs", "steps", "seconds", "threads", "learning_rate")
    fractions: ClassVar[tuple[str, ...]] = ("epsilon", "final_epsilon", "forward")
    """Fields that must be above 0 (``positive``), and between 0 and 1 (``fractions``)."""

    @property
    def knows(self) -> tuple[str, ...]:
        """Signals that its agents use, in the terms of ``vitruvius.sim.Config.observe``."""
        return "rays", "bump", "last_action"

    @property
    def backend(self) -> str:
        """Backend of training and of play."""
        return "free" if self.world == "drive" else "continuous"

    @classmethod
    def presets(cls) -> "dict[str, TrainConfig]":
        """Return the configs that run by name."""
        return {}

    def __post_init__(self) -> None:
        """Raise ``RequestError`` for values that no run can have, before anything is made."""
        if self.world == "drive":
            if not self.drives:
                raise RequestError(f"world drive: {self.algorithm} moves in grid steps: use pqn-free")
            if self.avoidance != "none":
                raise RequestError(
                    f"world drive: the action mask {self.avoidance} needs grid steps: add --avoidance none"
                )
        for name in self.positive:
            if getattr(self, name) is not None and not getattr(self, name) > 0:
                raise RequestError(f"{name} must be above 0, not {getattr(self, name)}")
        for name in self.fractions:
            if not 0 <= getattr(self, name) <= 1:
                raise RequestError(f"{name} must lie between 0 and 1, not {getattr(self, name)}")
        whole("seed", self.seed, 0, MAX_SEED)


@dataclass(frozen=True)
class QLearningConfig(TrainConfig):
    """Fields that PQN and DQN have in common: a discount, linear schedules, and a Q-network with a memory."""

    groups: ClassVar = {"half_lives": "Q-learning"}
    drives: ClassVar[bool] = True

    half_lives: tuple[float, ...] = (1, 4, 16, 64)
    """Half-lives, in steps, of the memory's exponential moving averages of past actions, collisions and
    sightings."""

    module: str = ""
    """Your own torch.nn.Module, module:Class, instead of the built-in network. Vitruvius creates it with the
    numbers of rays, channels, remembered signals and actions, and calls it with observations and memories."""

    gamma: float = 0.99
    """Discount per step."""

    final_lr_fraction: float = 0.05
    """Final learning rate as a fraction of the first; the rate falls linearly."""

    max_grad_norm: float | None = 10.0
    """Norm to which longer gradients are clipped; None: never."""

    exploration_fraction: float = 0.2
    """Fraction of the run over which epsilon falls linearly to ``final_epsilon``."""

    positive: ClassVar[tuple[str, ...]] = (*TrainConfig.positive, "max_grad_norm")
    fractions: ClassVar[tuple[str, ...]] = (
        *(*TrainConfig.fractions, "gamma", "final_lr_fraction", "exploration_fraction"),
    )

    def epsilon_at(self, fraction: float) -> float:
        """Return the fraction of random actions when ``fraction`` of the run is done."""
        return linear(self.epsilon, self.final_epsilon, fraction / max(self.exploration_fraction, 1e-9))

    @property
    def remembers(self) -> bool:
        """True if the network reads what it did before."""
        return bool(self.half_lives)

    @property
    def knows(self) -> tuple[str, ...]:
        """Signals that the agent uses. Without a memory, only its avoidance layer knows of collisions."""
        return super().knows if self.remembers else ("rays", "bump")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.module and ":" not in self.module:
            raise RequestError(f"module: give module:Class, not {self.module!r}")
        if len(self.half_lives) > MAX_HALF_LIVES:
            raise RequestError(f"half_lives has at most {MAX_HALF_LIVES} values, not {len(self.half_lives)}")
        if not all(0 < half_life < inf for half_life in self.half_lives):
            raise RequestError(f"half_lives must be above 0 and finite, not {self.half_lives}")


def linear(start: float, end: float, progress: float) -> float:
    """Return the value on the line from start, at progress 0, to end, at progress 1 and beyond."""
    return start + (end - start) * min(max(progress, 0.0), 1.0)


def differences(one: TrainConfig, other: TrainConfig) -> Iterator[str]:
    """Yield the names of the fields that differ, or ``algorithm`` if the configs have different classes."""
    if type(one) is not type(other):
        yield "algorithm"
        return
    for field in fields(one):
        if getattr(one, field.name) != getattr(other, field.name):
            yield field.name
