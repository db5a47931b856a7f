"""What all learners share: how a run stands, what it says of itself, how it is kept and taken up again."""

from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

import torch
from torch import Tensor

from agent import ranks
from agent.banks import bank_hash
from agent.build import layer_of, network_of
from agent.config import Config, differences
from agent.curriculum import CURRICULA
from logic.errors import RequestError, VitruviusError
from sim import HouseVectorEnv

EPISODE = 1500
"""Steps to which counts of targets refer: the paper's 15 s."""

DIVERGED = 1e4
"""A loss beyond this is no learning any more: the largest return there can be is 100 or so."""


class Diverged(VitruviusError):
    """What is learnt is not a number any more, or grows without bound."""

    exit_code = 1


@dataclass(frozen=True)
class Progress:
    """How a run stands after some updates."""

    steps: int
    """Environment steps so far, without those that the world ignored (after an episode's end)."""

    seconds: float
    """Wall-clock time so far."""

    fraction: float
    """How much of the run is done, 0 to 1; the schedules follow it."""

    targets: float
    """Targets picked up per 1500 steps, exploring, over the last 1500 steps or so of every world."""

    loss: float
    """Mean loss of the latest updates."""

    epsilon: float
    """Share of random actions lately."""

    overruled: float
    """Share of actions lately that the avoidance layer changed."""

    simulator: float
    """Steps a second of the simulator alone, over the whole run."""

    learner: float
    """Steps a second of all else, over the whole run: acting, avoidance, returns and updates."""

    map: float | None = None
    """Steps a second of the maps alone, over the whole run."""


@dataclass
class Clock:
    """What a run has spent, in seconds."""

    all: float = 0.0
    simulating: float = 0.0
    mapping: float = 0.0


class Learner(ABC):
    """A run of learning: its network, its worlds, and where they stand. ``train`` goes on with it.

    Logging, checkpoints and evaluation are the caller's: between two reports nothing moves, ``state`` has all
    that the next steps depend on, and whoever stops asking stops the run.
    """

    def __init__(self, config: Config, envs: HouseVectorEnv, report: int) -> None:
        """Begin a run; ``envs`` has this rank's share of the environments, and NEXT_STEP autoreset.

        ``report`` is how many steps of all worlds lie between two reports.
        """
        if envs.num_envs * ranks.size() != config.environments:
            raise RequestError(
                f"environments must be {ranks.size()} x {envs.num_envs}, not {config.environments}"
            )
        self.config, self.envs, self.bank = config, envs, envs.houses
        self.curriculum = CURRICULA[config.targets] if config.curriculum else None
        self.lesson = 0
        # Every rank has worlds, and chance, of its own; weights are the same.
        self.seed = config.seed + ranks.rank() * envs.num_envs
        self.generator = torch.Generator(config.device).manual_seed(self.seed)
        self.network: Any = network_of(config).to(config.device)
        self.avoidance = layer_of(config, envs, self.generator)
        self.steps, self.clock = 0, Clock()
        self.recent: deque[tuple[float, float]] = deque(maxlen=max(1, round(EPISODE / report)))
        self.teach(0)

    @property
    def fraction(self) -> float:
        """How much of the run is done, 0 to 1."""
        limit = self.config.seconds
        return min(1.0, max(self.steps / self.config.steps, self.clock.all / limit if limit else 0.0))

    def train(self) -> Iterator[Progress]:
        """Learn to the end of the run, and report now and then.

        Raises ``Diverged`` in place of a report that could not be true.
        """
        while self.fraction < 1:
            self.follow()
            now = self.advance()
            if not abs(now.loss) <= DIVERGED:  # nor if it is not a number
                raise Diverged(f"the loss is {now.loss:g} after {now.steps:,} steps")
            yield now

    def follow(self) -> None:
        """Go over to the next lesson of the curriculum when it is time: all episodes begin anew."""
        if self.curriculum and self.curriculum.at(self.fraction) != self.lesson:
            self.teach(self.curriculum.at(self.fraction))
            self.begin()

    def teach(self, lesson: int) -> None:
        """Let the worlds be those of a lesson of the curriculum, if there is one."""
        self.lesson = lesson
        if self.curriculum:
            houses = self.curriculum.banks(self.bank, "the house file")[lesson]
            self.envs.set_houses(houses, self.curriculum.lessons[lesson].targets)

    def first_look(self) -> Tensor:
        """Begin episodes in all worlds; what is seen (E, R, C). Seed and lesson alone say what is drawn: a
        run that goes on in the midst of a lesson begins the next one like a run that was never stopped.
        """
        seed = self.seed + (self.lesson << 32)
        return torch.as_tensor(self.envs.reset(seed=seed)[0], device=self.config.device)

    @abstractmethod
    def begin(self) -> None:
        """Begin episodes in all worlds."""

    @abstractmethod
    def advance(self) -> Progress:
        """Learn as far as the next report."""

    def report(self, *, found: float, counted: float, overruled: float, **told: float) -> Progress:
        """The report after ``counted`` steps of this rank with so many targets found and acts overruled."""
        found, counted, overruled = ranks.total((found, counted, overruled))
        self.clock.all = ranks.first(self.clock.all)
        self.steps += int(counted)
        self.recent.append((found, counted))
        all_found, all_counted = (sum(column) for column in zip(*self.recent, strict=True))
        clock = self.clock
        return Progress(
            steps=self.steps,
            seconds=clock.all,
            fraction=self.fraction,
            targets=EPISODE * all_found / max(1, all_counted),
            overruled=overruled / max(1, counted),
            simulator=self.steps / clock.simulating,
            learner=self.steps / (clock.all - clock.simulating - clock.mapping),
            map=self.steps / clock.mapping if clock.mapping else None,
            **told,
        )

    def state(self) -> dict[str, Any]:
        """All that the run's next steps depend on: tensors and plain values, for ``torch.save``.

        Between two reports; with it a run goes on bit for bit on the CPU. The tensors are the run's own:
        write them before it goes on.
        """
        return {
            "algorithm": self.config.algorithm,
            "config": asdict(self.config),
            "houses": bank_hash(self.bank),
            "lesson": self.lesson,
            "network": self.network.state_dict(),
            "generator": self.generator.get_state(),
            "worlds": {name: torch.from_numpy(array) for name, array in self.envs.state.items()},
            "steps": self.steps,
            "clock": asdict(self.clock),
            "recent": list(self.recent),
        } | self.own_state()

    def restore(self, state: dict[str, Any]) -> None:
        """Go on from a state, but for the limits ``steps`` and ``seconds``, which are this run's.

        Raises ``RequestError`` where it is another config's or other houses'.
        """
        if state["algorithm"] != self.config.algorithm:
            raise RequestError(f"a run of {state['algorithm']} cannot go on as {self.config.algorithm}")
        other = set(differences(self.config, type(self.config)(**state["config"]))) - {"steps", "seconds"}
        if other:
            raise RequestError(f"a run of another config cannot go on here: {', '.join(sorted(other))}")
        if state["houses"] != bank_hash(self.bank):
            raise RequestError("a run in other houses cannot go on here")
        if state["lesson"] != self.lesson:
            self.teach(state["lesson"])
            self.begin()
        self.network.load_state_dict(state["network"])
        self.generator.set_state(state["generator"])
        self.envs.state = {name: tensor.numpy() for name, tensor in state["worlds"].items()}
        self.steps, self.clock = state["steps"], Clock(**state["clock"])
        self.recent.clear()
        self.recent.extend(state["recent"])
        self.restore_own(state)

    @abstractmethod
    def own_state(self) -> dict[str, Any]:
        """What this learner has besides."""

    @abstractmethod
    def restore_own(self, state: dict[str, Any]) -> None:
        """Take up what ``own_state`` gave."""
