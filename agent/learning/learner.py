"""What all learners share: how a network plays, how far a run is, reports, a state to save and to restore."""

from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import torch
from torch import Tensor

from agent.banks import bank_hash
from agent.learning import ranks
from agent.learning.config import TrainConfig, differences, linear
from agent.learning.environments import layer_of
from agent.learning.stopwatch import Stopwatch
from agent.policies.policies import Explorer, QPolicy
from logic import House
from logic.errors import RequestError, VitruviusError
from sim import HouseVectorEnv

EPISODE = 1500
"""Steps to which counts of targets refer: the paper's 15 s."""

DIVERGED = 1e4
"""A larger loss means that learning has failed: the largest return there can be is 100 or so."""


class Diverged(VitruviusError):
    """The network's values are not numbers any more, or grow without bound."""

    exit_code = 1


@dataclass(frozen=True)
class Progress:
    """How far a run is, and how well it does."""

    steps: int
    """Environment steps so far, without those after an episode's end, whose action is ignored."""

    seconds: float
    """Wall-clock time so far."""

    fraction: float
    """How much of the run is done, 0 to 1; the schedules follow it."""

    targets: float
    """Targets picked up per 1500 steps, exploring, over the last 1500 steps or so of every environment."""

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

    held_out: float | None = None
    """Mean targets in an episode in held-out houses; None if no evaluation was due at this report."""


@dataclass
class Clock:
    """What a run has spent, in seconds."""

    all: float = 0.0
    simulating: float = 0.0
    mapping: float = 0.0


@dataclass
class Tally:
    """What this rank counted since the last report."""

    targets: float = 0.0
    """Targets picked up."""

    steps: float = 0.0
    """Environment steps, without those whose action was ignored."""

    overruled: float = 0.0
    """Actions that the avoidance layer changed."""

    def add(self, r: Tensor, valid: Tensor, overruled: Tensor) -> None:
        """Count a step of all environments, (E,) each: rewards, and bool."""
        self.targets += float(r.sum())
        self.steps += int(valid.sum())
        self.overruled += int(overruled.sum())


class Learner(ABC):
    """An algorithm: its network, the policy that plays by it, and a training run. ``train`` goes on with it.

    Logging, checkpoints and evaluation are the caller's: between two reports nothing moves, ``state`` has all
    that the next steps depend on, and whoever stops asking stops the run.
    """

    @staticmethod
    @abstractmethod
    def network_of(config: Any) -> Any:
        """A new network as the config has it, for what its simulator shows; its weights are a function of the
        seed, and torch's own generator is left as it was.
        """

    @staticmethod
    def policy_of(network: Any, config: Any, envs: HouseVectorEnv, seed: int = 0) -> QPolicy | Explorer:
        """A trained network's policy, as it is measured and filmed: its own layer, a few random actions."""
        generator = torch.Generator().manual_seed(seed)
        return QPolicy(network, layer_of(config, envs, generator), generator)

    optimizer: torch.optim.Optimizer

    def __init__(self, config: TrainConfig, envs: HouseVectorEnv, report: int) -> None:
        """Begin a run; ``envs`` has this rank's share of the environments, and NEXT_STEP autoreset.

        ``report`` is how many steps of every environment lie between two reports.
        """
        if envs.num_envs * ranks.size() != config.num_envs:
            raise RequestError(f"num_envs must be {ranks.size()} x {envs.num_envs}, not {config.num_envs}")
        self.config, self.envs = config, envs
        # Every rank has environments and random numbers of its own; weights are the same.
        self.seed = config.seed + ranks.rank() * envs.num_envs
        self.generator = torch.Generator(config.device).manual_seed(self.seed)
        self.network: Any = self.network_of(config).to(config.device)
        self.avoidance = layer_of(config, envs, self.generator)
        self.steps, self.clock, self.simulating = 0, Clock(), Stopwatch(config.device)
        self.recent: deque[tuple[float, float]] = deque(maxlen=max(1, round(EPISODE / report)))

    @property
    def houses(self) -> Sequence[House]:
        """All that it learns in."""
        return self.envs.rotation.houses if self.envs.rotation else self.envs.houses

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
            now = self.iterate()
            if not abs(now.loss) <= DIVERGED:  # nor if it is not a number
                raise Diverged(f"the loss is {now.loss:g} after {now.steps:,} steps")
            yield now

    def reset_envs(self) -> Tensor:
        """Begin episodes in all environments; the observations (E, R, C)."""
        self.s = torch.as_tensor(self.envs.reset(seed=self.seed)[0], device=self.config.device)
        self.blocked = self.ended = torch.zeros(
            self.envs.num_envs, dtype=torch.bool, device=self.config.device
        )
        return self.s

    def step_envs(self, actions: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Step all environments: the rewards, and whether the episodes ended in a terminal state or by time,
        (E,) each. ``s`` (E, R, C), ``blocked`` and ``ended`` (E,) bool are what it led to.
        """
        with self.simulating.running():
            observation, r, terminated, truncated, info = self.envs.step_torch(actions)
        # Cloned: the simulator writes over its tensors at the next step.
        self.s, self.blocked = observation.clone(), info["blocked"].clone()
        self.ended = terminated | truncated
        return r, terminated, truncated

    def set_learning_rate(self, rate: float) -> None:
        """From now on."""
        for group in self.optimizer.param_groups:
            group["lr"] = rate

    def anneal(self, final: float) -> None:
        """Set the learning rate, which falls on a line to the fraction ``final`` of it."""
        self.set_learning_rate(self.config.learning_rate * linear(1.0, final, self.fraction))

    def descend(self, loss: Tensor, max_grad_norm: float | None = None) -> Tensor:
        """A step of the optimiser down the gradient, which is clipped to a norm; the loss without it."""
        self.optimizer.zero_grad()
        loss.backward()
        ranks.all_reduce_gradients(self.network)
        if max_grad_norm is not None:
            torch.nn.utils.clip_grad_norm_(self.network.parameters(), max_grad_norm)
        self.optimizer.step()
        return loss.detach()

    @abstractmethod
    def iterate(self) -> Progress:
        """Act and learn up to the next report."""

    def report(self, tally: Tally, *, loss: float, epsilon: float) -> Progress:
        """The report after what was counted, which is added up over all ranks."""
        targets, steps, overruled = ranks.total((tally.targets, tally.steps, tally.overruled))
        self.clock.all = ranks.first(self.clock.all)
        self.clock.simulating += self.simulating.take()
        self.steps += int(steps)
        self.recent.append((targets, steps))
        recent_targets, recent_steps = (sum(column) for column in zip(*self.recent, strict=True))
        clock = self.clock
        return Progress(
            steps=self.steps,
            seconds=clock.all,
            fraction=self.fraction,
            targets=EPISODE * recent_targets / max(1, recent_steps),
            loss=loss,
            epsilon=epsilon,
            overruled=overruled / max(1, steps),
            simulator=self.steps / clock.simulating,
            learner=self.steps / (clock.all - clock.simulating - clock.mapping),
            map=self.steps / clock.mapping if clock.mapping else None,
        )

    def state(self) -> dict[str, Any]:
        """All that the run's next steps depend on: tensors and plain values, for ``torch.save``.

        Between two reports; with it a run goes on bit for bit on the CPU. The tensors are the run's own:
        write them before it goes on.
        """
        return {
            "algorithm": self.config.algorithm,
            "config": asdict(self.config),
            "houses": bank_hash(self.houses),
            "network": self.network.state_dict(),
            "generator": self.generator.get_state(),
            "envs": {name: torch.from_numpy(array) for name, array in self.envs.state.items()},
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
        if state["houses"] != bank_hash(self.houses):
            raise RequestError("a run in other houses cannot go on here")
        self.network.load_state_dict(state["network"])
        self.generator.set_state(state["generator"])
        self.envs.state = {name: tensor.numpy() for name, tensor in state["envs"].items()}
        self.steps = int(state["steps"])
        self.clock = Clock(**{name: float(seconds) for name, seconds in state["clock"].items()})
        self.recent.clear()
        self.recent.extend((float(targets), float(steps)) for targets, steps in state["recent"])
        self.restore_own(state)

    @abstractmethod
    def own_state(self) -> dict[str, Any]:
        """What this learner has besides."""

    @abstractmethod
    def restore_own(self, state: dict[str, Any]) -> None:
        """Take up what ``own_state`` gave."""
