"""What a training run is: a frozen dataclass for each algorithm, and the presets that run by name."""

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from typing import ClassVar, Literal, get_args

from logic.errors import RequestError

TargetMode = Literal["main", "secondary", "mixed"]
"""Where targets lie: in the main room, in secondary rooms, or in both."""

TARGET_MODES: tuple[TargetMode, ...] = get_args(TargetMode)


@dataclass(frozen=True)
class Config:
    """What runs of all algorithms have in common. The field docstrings are the help.

    Raises ``RequestError``, a ``ValueError``, that names the field for a value that no run can have.
    """

    targets: TargetMode = "main"
    """Where targets lie."""

    world: Literal["default", "paper"] = "default"
    """Preset of the simulator."""

    avoidance: Literal["shield", "paper", "none"] = "shield"
    """The layer that overrules. shield: forbids a step forward where the rays say that the body's path is not
    free; paper: the paper's rule, a turn wherever anything but the target is near."""

    environments: int = 256
    """Worlds stepped at once, by all processes together."""

    steps: int = 3_000_000
    """Environment steps of the whole run; the schedules below are fractions of it."""

    seconds: float | None = None
    """Wall-clock limit: the schedules then follow whichever of steps and seconds is further on. With none,
    a run on the CPU is a function of config, houses and seed alone."""

    seed: int = 0
    """Seeds the worlds, the network's first weights, the exploration and what is learnt from."""

    device: Literal["cpu", "cuda"] = "cpu"
    """Where worlds and network live."""

    threads: int = 1
    """Cores that torch may use. More help little with batches this small, and sums depend on their number."""

    half_lives: tuple[float, ...] = (1, 4, 16, 64)
    """Of the memory's traces, in steps: running averages of what was done and where the target was seen."""

    precision: Literal["highest", "high", "medium"] = "highest"
    """Of products of float32 matrices, as torch names it: medium may take bfloat16 inside, faster where a
    processor has it."""

    mirror: bool = True
    """Whether half of all updates see what they learn from with left and right exchanged."""

    curriculum: bool = False
    """Whether easier worlds come first: main rooms, few rooms, no furniture. See ``agent.curriculum``."""

    discount: float = 0.99
    """Worth of a reward one step later (gamma)."""

    learning_rate: float = 1e-3
    """The rate at the start; it falls on a line to ``final_rate`` of it."""

    final_rate: float = 0.05
    """The learning rate at the end, as a fraction of the one at the start."""

    clip: float | None = 10.0
    """Largest norm of a gradient; None: any."""

    epsilon: float = 0.4
    """Share of random actions at the start."""

    final_epsilon: float = 0.02
    """Share of random actions after ``exploration`` of the run, and from then on."""

    exploration: float = 0.2
    """Fraction of the run over which epsilon falls on a line."""

    forward: float = 0.93
    """Share of forward among random actions, as the paper's own exploration has it."""

    algorithm: ClassVar[str]
    """What learns."""

    positive: ClassVar[tuple[str, ...]] = (
        *("environments", "steps", "seconds", "threads", "learning_rate", "clip"),
    )
    shares: ClassVar[tuple[str, ...]] = (
        *("discount", "final_rate", "epsilon", "final_epsilon", "exploration", "forward"),
    )
    """Fields that must be above 0, and between 0 and 1."""

    def __post_init__(self) -> None:
        """Refuse what no run can have, before anything is made."""
        for name in self.positive:
            if getattr(self, name) is not None and not getattr(self, name) > 0:
                raise RequestError(f"{name} must be above 0, not {getattr(self, name)}")
        for name in self.shares:
            if not 0 <= getattr(self, name) <= 1:
                raise RequestError(f"{name} must lie between 0 and 1, not {getattr(self, name)}")
        if not all(half_life > 0 for half_life in self.half_lives):
            raise RequestError(f"half_lives must be above 0, not {self.half_lives}")
        if self.mirror and self.world == "paper":
            raise RequestError("mirror needs world default: the paper's rays are not the same on both sides")


@dataclass(frozen=True)
class PQNConfig(Config):
    """Parallel Q-learning, "PQN" (Gallici et al. 2024, arXiv:2407.04811).

    Preset ``pqn`` reaches the oracle's neighbourhood in the main room after about a minute on a core.
    """

    network: Literal["traces", "recurrent"] = "traces"
    """What it remembers by: fading traces of the past, or a recurrent layer (GRU) that is learnt."""

    rollout: int = 32
    """Steps of every world between two updates of the network."""

    map: bool = False
    """Whether the network reads a map of the house, made of the agent's own rays and actions."""

    novelty: float = 0.0
    """Reward for a step nearer to its map's goal, the target or a place to look at, and for seeing 40 new
    cells; it fades to 0 by ``fading`` of the run."""

    fading: float = 0.7
    """Fraction of the run over which ``novelty`` fades."""

    guided: float = 0.0
    """Share of the random actions that are the map's advice instead."""

    levels: bool = False
    """Whether episodes take place in the houses with most to learn (prioritised level replay). See
    ``agent.levels``."""

    trace: float = 0.75
    """How far returns run along the path taken before they trust the network (lambda): 0 one step, 1 all."""

    epochs: int = 2
    """Passes over each rollout."""

    minibatches: int = 4
    """Updates in an epoch; each learns from its share of the rollout."""

    algorithm: ClassVar[str] = "pqn"
    positive: ClassVar[tuple[str, ...]] = (*Config.positive, "rollout", "epochs", "minibatches")
    shares: ClassVar[tuple[str, ...]] = (*Config.shares, "trace", "novelty", "fading", "guided")

    def __post_init__(self) -> None:
        """Refuse what no run can have, before anything is made."""
        super().__post_init__()
        if not self.map and (self.novelty or self.guided):
            raise RequestError("novelty and guided need map: there is no map that they could come from")
        if (self.map or self.levels) and self.device != "cpu":
            raise RequestError("map and levels need device cpu: that is where they are kept")
        if self.network == "recurrent":
            if self.mirror or self.map:
                raise RequestError(
                    "network recurrent needs no-mirror and no-map: what it keeps has no mirror"
                )
            if self.minibatches > self.environments:
                raise RequestError(f"minibatches must not exceed environments, not {self.minibatches}")
        if self.minibatches > self.environments * self.rollout:
            raise RequestError(f"minibatches must not exceed environments x rollout, not {self.minibatches}")


@dataclass(frozen=True)
class DQNConfig(Config):
    """Deep Q-learning from a replay memory (Mnih et al. 2015, doi:10.1038/nature14236)."""

    network: Literal["traces", "paper"] = "traces"
    """Rays and fading traces of the past (``agent.network``), or the original's layers."""

    memory: int = 200_000
    """Steps that the replay memory holds, of all worlds together."""

    warm_up: int = 20_000
    """Steps in the memory before the first update."""

    every: int = 4
    """Steps of all worlds between two updates, or 0: updates come when an episode ends."""

    batch: int = 1024
    """Steps replayed each time."""

    minibatches: int = 1
    """Updates that these are shared out among."""

    rewarded: bool = False
    """Whether, when an episode ends, all its rewarded steps are in the batch."""

    horizon: int = 5
    """Rewards that a return adds up before it trusts the network (n)."""

    timeouts_end: bool = False
    """Whether a time-out counts as a terminal state, as if the world stopped there."""

    masked: bool = True
    """Whether a state is worth its best *allowed* action, as the avoidance layer will act there too."""

    double: bool = True
    """Whether the network chooses the action that the target network judges."""

    target_every: int = 200
    """Updates from one copy of the network to the target network to the next; 0: there is none."""

    loss: Literal["huber", "squared"] = "huber"
    """Huber's loss is squared up to an error of 1 and grows linearly from there."""

    rate_decay: float = 0.0
    """The rate is also divided by 1 + this x the updates so far."""

    epsilon_decay: float = 1.0
    """Below 1, epsilon falls by this factor with each episode, and not on a line."""

    homing: bool = False
    """Whether a random action is forward for certain where one of the rays 18 to 20 sees the target."""

    algorithm: ClassVar[str] = "dqn"
    positive: ClassVar[tuple[str, ...]] = (
        *(*Config.positive, "memory", "warm_up", "batch", "minibatches", "horizon"),
    )
    shares: ClassVar[tuple[str, ...]] = (*Config.shares, "epsilon_decay")

    def __post_init__(self) -> None:
        """Refuse what no run can have, before anything is made."""
        super().__post_init__()
        for name in ("every", "target_every", "rate_decay"):
            if getattr(self, name) < 0:
                raise RequestError(f"{name} must be 0 or more, not {getattr(self, name)}")
        if self.memory < self.environments * (self.horizon + 1):
            raise RequestError(f"memory must hold horizon + 1 steps of each world, not {self.memory}")
        if self.minibatches > self.batch:
            raise RequestError(f"minibatches must not exceed batch, not {self.minibatches}")
        if self.device != "cpu":
            raise RequestError("deep Q-learning from a replay memory runs on device cpu alone")


PAPER = DQNConfig(
    world="paper",
    network="paper",
    avoidance="paper",
    environments=8,
    steps=1_500_000,
    half_lives=(),
    memory=100_000,
    warm_up=500,
    every=0,
    batch=500,
    minibatches=500,
    rewarded=True,
    mirror=False,
    horizon=1,
    discount=1.0,
    timeouts_end=True,
    masked=False,
    double=False,
    target_every=0,
    loss="squared",
    learning_rate=1e-2,
    final_rate=1.0,
    rate_decay=1e-2,
    clip=None,
    epsilon=1.0,
    final_epsilon=0.025,
    epsilon_decay=0.996,
    forward=0.92,
    homing=True,
)
"""The original agent, in the original's world, to reproduce what it claims and what it fails at.

Known of it, by measurement: the layers, the loss, Adam and its rate, gamma, no target network, the replay
memory and what is in a batch, epsilon, the exploring actions, the avoidance rule, a time-out as terminal.
Not known, and chosen here: that an update is made for each sample and that there were 1000 episodes (the rate
is said to fall to 2e-6, which takes 500,000 updates: 500 samples x 1000 episodes); that the executed action
is stored and not the one that avoidance overruled; that a state's worth ignores avoidance; the first weights
(torch's own). Different: 8 worlds in many houses, where the original had one world in one house.
"""

PQN = PQNConfig(precision="medium", mirror=False)

PRESETS: dict[str, PQNConfig | DQNConfig] = {
    "pqn": PQN,
    "pqn-map": replace(
        PQN,
        mirror=True,
        targets="secondary",
        steps=2_000_000,
        map=True,
        novelty=0.02,
        guided=0.9,
        epsilon=1.0,
    ),
    "pqn-recurrent": replace(PQN, network="recurrent", half_lives=(), steps=4_500_000),
    "dqn": DQNConfig(environments=64, learning_rate=5e-4, final_rate=0.1, epsilon=1.0, exploration=0.1),
    "paper": PAPER,
}
"""Configs that run by name."""


def differences(one: Config, other: Config) -> Iterator[str]:
    """Names of the fields that are not the same in both, or ``algorithm`` where no field can be compared."""
    if type(one) is not type(other):
        yield "algorithm"
        return
    for field in fields(one):
        if getattr(one, field.name) != getattr(other, field.name):
            yield field.name
