"""What a training run is: what all runs have in common, and a frozen dataclass for each Q-learning algorithm.

The names of the fields are those of CleanRL and Stable-Baselines3; their docstrings are the command's help.
"""

from collections.abc import Iterator
from dataclasses import dataclass, fields
from math import inf
from typing import Annotated, ClassVar, Literal, get_args

import tyro

from logic.errors import RequestError
from logic.request.request import whole

MOST_SEED = 2**62 - 1
"""So that each environment and house has one of its own after it: they have 64 bits."""

TargetMode = Literal["main", "secondary", "mixed"]
"""Where targets lie: in the main room, in secondary rooms, or in both."""

MOST_HALF_LIVES = 64
"""Half-lives of a memory: those of the presets are four."""

TARGET_MODES: tuple[TargetMode, ...] = get_args(TargetMode)


@dataclass(frozen=True)
class TrainConfig:
    """What runs of all algorithms have in common.

    Raises ``RequestError``, a ``ValueError``, that names the field for a value that no run can have.
    """

    groups: ClassVar = {
        "targets": "What is learnt",
        "num_envs": "The run's size",
        "learning_rate": "Learning",
    }

    targets: str = "main"
    """Where targets lie: main, secondary, mixed or habit; or another task: module:Class, or as JSON, such as
    '{"task": "reach", "room": "kitchen"}'."""

    world: Literal["default", "paper"] = "default"
    """Preset of the simulator."""

    sim: Annotated[tuple[str, ...], tyro.conf.UseAppendAction, tyro.conf.arg(metavar="FIELD=VALUE")] = ()
    """Field of the simulator's configuration in place of the preset's (sim/config.py lists them), as in
    noise=0.05, rays=20 or body=[0.3,0.3]."""

    avoidance: Literal["shield", "paper", "none"] = "shield"
    """The layer that overrules. shield: forbids a step forward where the rays say that the body's path is not
    free; paper: the paper's rule, a turn wherever anything but the target is near."""

    num_envs: int = 256
    """Environments stepped at once, by all processes together."""

    steps: int = 3_000_000
    """Environment steps of the whole run; the schedules below are fractions of it."""

    seconds: float | None = None
    """Wall-clock limit: the schedules then follow whichever of steps and seconds is further on. With none,
    a run on the CPU is a function of config, houses and seed alone."""

    seed: int = 0
    """Seeds the environments, the network's first weights, the exploration and the order of minibatches."""

    device: Literal["cpu", "cuda"] = "cpu"
    """Where environments and network live."""

    threads: int = 1
    """Cores that torch may use. More help little with batches this small, and sums depend on their number."""

    precision: Literal["highest", "high", "medium"] = "highest"
    """Of products of float32 matrices, as torch names it: medium may take bfloat16 inside, faster where a
    processor has AMX."""

    learning_rate: float = 1e-3
    """Step size of the optimiser at the start."""

    epsilon: float = 0.4
    """Share of random actions at the start."""

    final_epsilon: float = 0.02
    """Least share of random actions."""

    forward: float = 0.93
    """Share of forward among random actions, as the paper's own exploration has it."""

    algorithm: ClassVar[str]
    """What learns."""

    positive: ClassVar[tuple[str, ...]] = ("num_envs", "steps", "seconds", "threads", "learning_rate")
    fractions: ClassVar[tuple[str, ...]] = ("epsilon", "final_epsilon", "forward")
    """Fields that must be above 0, and between 0 and 1."""

    def __post_init__(self) -> None:
        """Refuse what no run can have, before anything is made."""
        for name in self.positive:
            if getattr(self, name) is not None and not getattr(self, name) > 0:
                raise RequestError(f"{name} must be above 0, not {getattr(self, name)}")
        for name in self.fractions:
            if not 0 <= getattr(self, name) <= 1:
                raise RequestError(f"{name} must lie between 0 and 1, not {getattr(self, name)}")
        whole("seed", self.seed, 0, MOST_SEED)


@dataclass(frozen=True)
class QLearningConfig(TrainConfig):
    """What PQN and DQN have in common: a discount, linear schedules, and a Q-network that remembers."""

    groups: ClassVar = {"half_lives": "Q-learning"}

    half_lives: tuple[float, ...] = (1, 4, 16, 64)
    """Of the memory's exponential moving averages of past actions, bumps and sightings, in steps."""

    gamma: float = 0.99
    """Discount per step."""

    final_lr_fraction: float = 0.05
    """The learning rate falls on a line to this fraction of it."""

    max_grad_norm: float | None = 10.0
    """Longer gradients are clipped to this norm; None: never."""

    exploration_fraction: float = 0.2
    """Fraction of the run over which epsilon falls on a line to ``final_epsilon``."""

    positive: ClassVar[tuple[str, ...]] = (*TrainConfig.positive, "max_grad_norm")
    fractions: ClassVar[tuple[str, ...]] = (
        *(*TrainConfig.fractions, "gamma", "final_lr_fraction", "exploration_fraction"),
    )

    def __post_init__(self) -> None:
        """Refuse what no run can have, before anything is made."""
        super().__post_init__()
        if len(self.half_lives) > MOST_HALF_LIVES:
            raise RequestError(f"half_lives are at most {MOST_HALF_LIVES}, not {len(self.half_lives)}")
        if not all(0 < half_life < inf for half_life in self.half_lives):
            raise RequestError(f"half_lives must be above 0 and finite, not {self.half_lives}")


@dataclass(frozen=True)
class PQNConfig(QLearningConfig):
    """Parallel Q-learning, "PQN" (Gallici et al. 2024, arXiv:2407.04811).

    Preset ``pqn`` reaches the oracle's neighbourhood in the main room after about a minute on a core.
    """

    groups: ClassVar = {"network": "Parallel Q-learning (PQN)"}

    network: Literal["feedforward", "recurrent"] = "feedforward"
    """feedforward: remembers by exponential moving averages of the past; recurrent: by a layer (GRU) that
    learns what to remember."""

    num_steps: int = 32
    """Steps of every environment in a rollout; the network learns after each."""

    q_lambda: float = 0.75
    """Lambda of Q(lambda), how far returns follow the path taken before they trust the network: 0 one step,
    1 all of them."""

    update_epochs: int = 2
    """Passes over each rollout."""

    num_minibatches: int = 4
    """Updates in an epoch; each learns from its share of the rollout."""

    algorithm: ClassVar[str] = "pqn"
    positive: ClassVar[tuple[str, ...]] = (
        *(*QLearningConfig.positive, "num_steps", "update_epochs", "num_minibatches"),
    )
    fractions: ClassVar[tuple[str, ...]] = (*(*QLearningConfig.fractions, "q_lambda"),)

    def __post_init__(self) -> None:
        """Refuse what no run can have, before anything is made."""
        super().__post_init__()
        if self.network == "recurrent" and self.num_minibatches > self.num_envs:
            raise RequestError(f"num_minibatches must not exceed num_envs, not {self.num_minibatches}")
        if self.num_minibatches > self.num_envs * self.num_steps:
            raise RequestError(
                f"num_minibatches must not exceed num_envs x num_steps, not {self.num_minibatches}"
            )


@dataclass(frozen=True)
class DQNConfig(QLearningConfig):
    """Deep Q-learning from a replay buffer (Mnih et al. 2015, doi:10.1038/nature14236), with double
    Q-learning and n-step returns.
    """

    groups: ClassVar = {"buffer_size": "Deep Q-learning from a replay buffer (DQN)"}

    buffer_size: int = 200_000
    """Steps that the replay buffer holds, of all environments together."""

    learning_starts: int = 20_000
    """Steps in the buffer before the first update."""

    train_frequency: int = 4
    """Steps of every environment between two updates."""

    batch_size: int = 1024
    """Steps that an update learns from."""

    n_step: int = 5
    """Rewards that a return adds up before it trusts the network (n)."""

    target_network_frequency: int = 200
    """Updates between two copies of the network to the target network."""

    algorithm: ClassVar[str] = "dqn"
    positive: ClassVar[tuple[str, ...]] = (
        *(*QLearningConfig.positive, "buffer_size", "learning_starts", "train_frequency"),
        *("batch_size", "n_step", "target_network_frequency"),
    )

    def __post_init__(self) -> None:
        """Refuse what no run can have, before anything is made."""
        super().__post_init__()
        if self.buffer_size < self.num_envs * (self.n_step + 1):
            raise RequestError(
                f"buffer_size must hold n_step + 1 steps of each environment, not {self.buffer_size}"
            )
        if self.device != "cpu":
            raise RequestError("deep Q-learning from a replay buffer runs on device cpu alone")


@dataclass(frozen=True)
class PaperConfig(TrainConfig):
    """The original agent; preset ``paper`` is it, in the original's simulator. See ``algorithms.paper``."""

    groups: ClassVar = {"episodes": "The paper's agent"}

    episodes: int | None = 817
    """Episodes of the whole run, if it has not ended by its steps before; None: as many as come."""

    initialisation: Literal["glorot", "torch"] = "glorot"
    """First weights: Glorot's uniform ones and no biases, as Keras has them, or torch's own."""

    lr_decay: float = 1e-2
    """The learning rate is divided by 1 + this x the updates so far."""

    adam_epsilon: float = 1e-7
    """What Adam adds to the root of the mean squared gradient: Keras's."""

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
    positive: ClassVar[tuple[str, ...]] = (
        *(*TrainConfig.positive, "episodes", "adam_epsilon", "buffer_size", "learning_starts"),
        *("batch_size", "num_minibatches"),
    )
    fractions: ClassVar[tuple[str, ...]] = (*TrainConfig.fractions, "epsilon_decay")

    def __post_init__(self) -> None:
        """Refuse what no run can have, before anything is made."""
        super().__post_init__()
        if self.lr_decay < 0:
            raise RequestError(f"lr_decay must be 0 or more, not {self.lr_decay}")
        if self.buffer_size < 2 * self.num_envs:
            raise RequestError(f"buffer_size must hold 2 steps of each environment, not {self.buffer_size}")
        if self.num_minibatches > self.batch_size:
            raise RequestError(f"num_minibatches must not exceed batch_size, not {self.num_minibatches}")
        if self.device != "cpu":
            raise RequestError("deep Q-learning from a replay buffer runs on device cpu alone")


def differences(one: TrainConfig, other: TrainConfig) -> Iterator[str]:
    """Names of the fields that are not the same in both, or ``algorithm`` where no field can be compared."""
    if type(one) is not type(other):
        yield "algorithm"
        return
    for field in fields(one):
        if getattr(one, field.name) != getattr(other, field.name):
            yield field.name
