"""Common parts of learners: the policy of a network, the run's progress, reports, and saved states."""

from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import torch
from torch import Tensor

from vitruvius.agent.banks import bank_hash
from vitruvius.agent.learning import ranks
from vitruvius.agent.learning.config import TrainConfig, differences, linear
from vitruvius.agent.learning.environments import layer_of
from vitruvius.agent.learning.stopwatch import Stopwatch
from vitruvius.agent.policies.policies import Explorer, QPolicy
from vitruvius.logic import House
from vitruvius.logic.errors import RequestError, VitruviusError
from vitruvius.sim import HouseVectorEnv

EPISODE_STEPS = 1500
"""Number of steps to which counts of targets refer: the paper's 15 s."""

MAX_LOSS = 1e4
"""Loss above which training has failed: the largest possible return is about 100."""


class Diverged(VitruviusError):
    """Error for a network whose values are no longer numbers, or grow without bound."""

    exit_code = 1


@dataclass(frozen=True)
class Progress:
    """Progress of a run, and its current performance."""

    steps: int
    """Environment steps so far, without those after an episode's end, whose action is ignored."""

    seconds: float
    """Wall-clock time so far, in seconds."""

    fraction: float
    """Fraction of the run that is done, 0 to 1; the schedules follow it."""

    targets: float
    """Targets picked up per 1500 steps with exploration, over about the last 1500 steps of every
    environment."""

    loss: float
    """Mean loss of the latest updates."""

    epsilon: float
    """Fraction of random actions since the last report."""

    overruled: float
    """Fraction of actions since the last report that the avoidance layer changed."""

    simulator: float
    """Steps per second of the simulator alone, over the whole run."""

    learner: float
    """Steps per second of the rest, over the whole run: acting, avoidance, returns and updates."""

    map: float | None = None
    """Steps per second of the maps alone, over the whole run."""

    held_out: float | None = None
    """Mean targets in an episode in held-out houses; None if no evaluation was due at this report."""


@dataclass
class Clock:
    """Time that a run has spent, in seconds."""

    all: float = 0.0
    simulating: float = 0.0
    mapping: float = 0.0


@dataclass
class Tally:
    """Counts of this rank since the last report."""

    targets: float = 0.0
    """Targets picked up."""

    steps: float = 0.0
    """Environment steps, without those whose action was ignored."""

    overruled: float = 0.0
    """Number of actions that the avoidance layer changed."""

    def add(self, r: Tensor, valid: Tensor, overruled: Tensor) -> None:
        """Count a step of all environments, (E,) each: rewards, and two masks (bool)."""
        self.targets += float(r.sum())
        self.steps += int(valid.sum())
        self.overruled += int(overruled.sum())


class Learner(ABC):
    """Algorithm: its network, the policy that plays by it, and a training run, which ``train`` continues.

    The caller is responsible for logging, checkpoints and evaluation. Between two reports nothing moves, and
    ``state`` has all that the next steps depend on. A caller that stops iterating stops the run.
    """

    @staticmethod
    @abstractmethod
    def network_of(config: Any) -> Any:
        """Return a new network for a config and its simulator.

        The weights are a function of the seed, and torch's own generator keeps its state.
        """

    @staticmethod
    def policy_of(network: Any, config: Any, envs: HouseVectorEnv, seed: int = 0) -> QPolicy | Explorer:
        """Return a trained network's policy for evaluation and films: its own layer, a few random actions."""
        generator = torch.Generator().manual_seed(seed)
        return QPolicy(network, layer_of(config, envs, generator), generator)

    optimizer: torch.optim.Optimizer

    def __init__(self, config: TrainConfig, envs: HouseVectorEnv, report: int) -> None:
        """Begin a run; ``envs`` has this rank's share of the environments, and NEXT_STEP autoreset.

        ``report`` is the number of steps of every environment between two reports.
        """
        if envs.num_envs * ranks.size() != config.num_envs:
            raise RequestError(f"num_envs must be {ranks.size()} x {envs.num_envs}, not {config.num_envs}")
        self.config, self.envs = config, envs
        # Every rank has its own environments and random numbers; weights are the same.
        self.seed = config.seed + ranks.rank() * envs.num_envs
        self.generator = torch.Generator(config.device).manual_seed(self.seed)
        self.network: Any = self.network_of(config).to(config.device)
        self.avoidance = layer_of(config, envs, self.generator)
        self.steps, self.clock, self.simulating = 0, Clock(), Stopwatch(config.device)
        self.recent: deque[tuple[float, float]] = deque(maxlen=max(1, round(EPISODE_STEPS / report)))

    @property
    def houses(self) -> Sequence[House]:
        """All training houses."""
        return self.envs.rotation.houses if self.envs.rotation else self.envs.houses

    @property
    def fraction(self) -> float:
        """Fraction of the run that is done, 0 to 1."""
        limit = self.config.seconds
        return min(1.0, max(self.steps / self.config.steps, self.clock.all / limit if limit else 0.0))

    def train(self) -> Iterator[Progress]:
        """Train to the end of the run, and yield reports.

        Raises ``Diverged`` if the loss is not a number or is too large.
        """
        while self.fraction < 1:
            now = self.iterate()
            if not abs(now.loss) <= MAX_LOSS:  # true for NaN, too
                raise Diverged(f"the loss is {now.loss:g} after {now.steps:,} steps")
            yield now

    def reset_envs(self) -> Tensor:
        """Begin episodes in all environments; return the observations (E, R, C)."""
        self.s = torch.as_tensor(self.envs.reset(seed=self.seed)[0], device=self.config.device)
        self.blocked = self.ended = torch.zeros(
            self.envs.num_envs, dtype=torch.bool, device=self.config.device
        )
        return self.s

    def step_envs(self, actions: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Step all environments; return rewards and the masks of terminated and truncated episodes.

        Each is (E,). The new observations are ``s`` (E, R, C); ``blocked`` and ``ended`` (E,) bool are set,
        too.
        """
        with self.simulating.running():
            observation, r, terminated, truncated, info = self.envs.step_torch(actions)
        # Cloned, because the simulator overwrites its tensors at the next step.
        self.s, self.blocked = observation.clone(), info["blocked"].clone()
        self.ended = terminated | truncated
        return r, terminated, truncated

    def set_learning_rate(self, rate: float) -> None:
        """Set the learning rate from now on."""
        for group in self.optimizer.param_groups:
            group["lr"] = rate

    def anneal(self, final: float) -> None:
        """Set the learning rate, which falls linearly to the fraction ``final`` of the first."""
        self.set_learning_rate(self.config.learning_rate * linear(1.0, final, self.fraction))

    def descend(self, loss: Tensor, max_grad_norm: float | None = None) -> Tensor:
        """Take an optimiser step along the gradient, clipped to a norm; return the detached loss."""
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
        """Return the report after what was counted, summed over all ranks."""
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
            targets=EPISODE_STEPS * recent_targets / max(1, recent_steps),
            loss=loss,
            epsilon=epsilon,
            overruled=overruled / max(1, steps),
            simulator=self.steps / clock.simulating,
            learner=self.steps / (clock.all - clock.simulating - clock.mapping),
            map=self.steps / clock.mapping if clock.mapping else None,
        )

    def state(self) -> dict[str, Any]:
        """Return all that the run's next steps depend on: tensors and plain values, for ``torch.save``.

        Call it between two reports; on the CPU, a restored run continues bit for bit. The tensors are the
        run's own: write them before the run goes on.
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
        """Continue from a state, except for the limits ``steps`` and ``seconds``, which are this run's.

        Raises ``RequestError`` for a state of another config or other houses.
        """
        if state["algorithm"] != self.config.algorithm:
            raise RequestError(f"a run of {state['algorithm']} cannot be resumed as {self.config.algorithm}")
        other = set(differences(self.config, type(self.config)(**state["config"]))) - {"steps", "seconds"}
        if other:
            raise RequestError(
                f"a run with another config cannot be resumed here: {', '.join(sorted(other))}"
            )
        if state["houses"] != bank_hash(self.houses):
            raise RequestError("a run in other houses cannot be resumed here")
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
        """Return the rest of this learner's state."""

    @abstractmethod
    def restore_own(self, state: dict[str, Any]) -> None:
        """Restore what ``own_state`` returned."""
