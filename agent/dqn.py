"""Deep Q-learning from a replay memory (Mnih et al. 2015), in one file to be read beside its papers.

| part | of |
|---|---|
| replay memory, target network | Mnih et al. 2015, doi:10.1038/nature14236 |
| double Q-learning | van Hasselt et al. 2016, arXiv:1509.06461 |
| n-step returns | Hessel et al. 2018 (Rainbow), arXiv:1710.02298: not corrected for exploring actions |

Many worlds are stepped at once, a row of the memory for each step of all. Axes: N rows, E worlds, n steps of
a return, B samples, R rays, C channels, M half-lives, A actions; ``s_tm1, a_tm1`` lead to ``s_t``.
"""

import io
from collections import deque
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import asdict, dataclass
from itertools import pairwise
from pathlib import Path
from time import perf_counter
from typing import Any, Literal, NamedTuple

import torch
from torch import Tensor, nn

from agent.actions import ACTIONS, FORWARD, LEFT, RIGHT, mirrored
from agent.avoidance import Layer, PaperRule, best_value, random_preference, subsume
from agent.banks import bank_hash
from agent.memory import Memory, mirrored_memory
from agent.network import seeded_network
from agent.pqn import linear
from agent.train import EPISODE, Progress
from agent.world import shield
from logic.errors import RequestError
from logic.files import write_whole
from sim import HouseVectorEnv

REPORT = 128
"""Rows from one report of the run to the next."""

SURELY = 1e6
"""More than any preference by chance."""


@dataclass(frozen=True)
class DQNConfig:
    """Deep Q-learning from a replay memory. The field docstrings are the help, the defaults preset ``dqn``.

    Raises ``RequestError``, a ``ValueError``, that names the field for a value that no run can have.
    """

    world: Literal["default", "paper"] = "default"
    """Preset of the simulator."""

    targets: Literal["main", "secondary", "mixed"] = "main"
    """Where targets lie."""

    network: Literal["traces", "paper"] = "traces"
    """Rays and fading traces of the past (``agent.network``), or the original's layers."""

    avoidance: Literal["shield", "paper"] = "shield"
    """The layer that overrules: where the rays say that the body's path is not free, or the paper's rule."""

    environments: int = 64
    """Worlds stepped at once."""

    steps: int = 3_000_000
    """Environment steps of the whole run; the schedules below are fractions of it."""

    seconds: float | None = None
    """Wall-clock limit: the schedules then follow whichever of steps and seconds is further on. With none,
    a run on the CPU is a function of config, houses and seed alone."""

    seed: int = 0
    """Seeds the worlds, the network's first weights, the exploration and what is replayed."""

    half_lives: tuple[float, ...] = (1, 4, 16, 64)
    """Half-lives of the traces, in steps."""

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

    mirror: bool = True
    """Whether every second update sees left and right exchanged."""

    horizon: int = 5
    """Rewards that a return adds up before it trusts the network (n)."""

    discount: float = 0.99
    """Worth of a reward one step later (gamma)."""

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

    learning_rate: float = 5e-4
    """Adam's rate at the start; it falls on a line to ``final_rate`` of it."""

    final_rate: float = 0.1
    """The learning rate at the end, as a fraction of the one at the start."""

    rate_decay: float = 0.0
    """The rate is also divided by 1 + this x the updates so far."""

    clip: float = 10.0
    """Largest norm of a gradient."""

    epsilon: float = 1.0
    """Share of random actions at the start."""

    final_epsilon: float = 0.02
    """Share of random actions at least, and from ``exploration`` of the run on."""

    exploration: float = 0.1
    """Fraction of the run over which epsilon falls on a line."""

    epsilon_decay: float = 1.0
    """Below 1, epsilon falls by this factor with each episode instead."""

    forward: float = 0.93
    """Share of forward among random actions."""

    homing: bool = False
    """Whether a random action is forward for certain where one of the rays 18 to 20 sees the target."""

    def __post_init__(self) -> None:
        """Refuse what no run can have, before anything is made."""
        for name in POSITIVE:
            if getattr(self, name) is not None and not getattr(self, name) > 0:
                raise RequestError(f"{name} must be above 0, not {getattr(self, name)}")
        for name in SHARES:
            if not 0 <= getattr(self, name) <= 1:
                raise RequestError(f"{name} must lie between 0 and 1, not {getattr(self, name)}")
        for name in ("every", "target_every", "rate_decay"):
            if getattr(self, name) < 0:
                raise RequestError(f"{name} must be 0 or more, not {getattr(self, name)}")
        if self.memory < self.environments * (self.horizon + 1):
            raise RequestError(f"memory must hold horizon + 1 steps of each world, not {self.memory}")
        if self.minibatches > self.batch:
            raise RequestError(f"minibatches must not exceed batch, not {self.minibatches}")
        if self.mirror and self.world == "paper":
            raise RequestError("mirror needs world default: the paper's rays are not the same on both sides")


POSITIVE = (
    *("environments", "steps", "seconds", "memory", "warm_up", "batch", "minibatches", "horizon"),
    *("learning_rate", "clip"),
)
SHARES = (*("discount", "final_rate", "epsilon", "final_epsilon", "exploration", "epsilon_decay", "forward"),)

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
    clip=float("inf"),
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

PRESETS = {"dqn": DQNConfig(), "paper": PAPER}
"""Configs that run by name."""


class PaperNetwork(nn.Module):
    """The original's layers: 25 for each ray, the same for all; then 50, 100, 50, 25, 3: 61,653 parameters.

    Its softmax cannot hold what it is asked to learn: sums of rewards, which are greater than 1, for three
    actions whose values need not add up to 1.
    """

    def __init__(self, rays: int = 40, channels: int = 3) -> None:
        """Draw first weights from torch's generator."""
        super().__init__()
        self.shape = (rays, channels, (), 0)
        self.memory = Memory(())  # of nothing, so that it is called as the other network is
        widths = (25 * rays, 50, 100, 50, 25)
        hidden = [(nn.Linear(a, b), nn.ReLU()) for a, b in pairwise(widths)]
        self.layers = nn.Sequential(
            *(nn.Linear(channels, 25), nn.ReLU(), nn.Flatten()),
            *(layer for pair in hidden for layer in pair),
            *(nn.Linear(widths[-1], ACTIONS), nn.Softmax(dim=1)),
        )

    def forward(self, observation: Tensor, memory: Tensor, features: Tensor | None = None) -> Tensor:
        """What stands for Q-values (B, A), from observations (B, R, C) alone."""
        return self.layers(observation)


def n_step_returns(
    r: Tensor, terminated: Tensor, truncated: Tensor, discount: float
) -> tuple[Tensor, Tensor, Tensor]:
    """What n steps gave, from the step each sample begins with: ``g, ahead, worth``, each (B,).

    ``r`` (n, B) are rewards, ``terminated`` and ``truncated`` (n, B) bool how a step ended. ``g`` adds up the
    discounted rewards as far as the first end; the state ``ahead`` steps on counts ``worth`` times its value:
    not at all if it is terminal, as any other if the time ran out there. What follows an end is left out.
    """
    alive = torch.ones_like(terminated[0])
    died, ahead, g = ~alive, torch.zeros(len(alive), dtype=torch.int64), torch.zeros_like(r[0])
    for k in range(len(r)):
        g = g + discount**k * r[k] * alive
        ahead = ahead + alive
        died = died | (alive & terminated[k])
        alive = alive & ~(terminated[k] | truncated[k])
    return g, ahead, discount**ahead * ~died


def q_targets(g: Tensor, worth: Tensor, judged: Tensor, chosen: Tensor | None, allowed: Tensor) -> Tensor:
    """What the taken actions' values (B,) should be: the return, and the worth of the state it leads to.

    ``judged`` (B, A) are the target network's values there, ``chosen`` (B, A) the network's own, whose best
    allowed action is the one that counts; None: the greatest of ``judged``, which errs on the high side.
    """
    if chosen is None:
        return g + worth * best_value(judged, allowed)
    return g + worth * judged.gather(1, subsume(chosen, allowed)[:, None]).squeeze(1)


class Batch(NamedTuple):
    """Steps to learn from. ``m`` is what was remembered (B, M, 6) beside an observation ``s`` (B, R, C)."""

    s_tm1: Tensor
    m_tm1: Tensor
    a_tm1: Tensor
    g: Tensor
    worth: Tensor
    s_t: Tensor
    m_t: Tensor
    allowed_t: Tensor
    valid: Tensor

    def seen_in_the_mirror(self) -> "Batch":
        """The same steps with left and right exchanged."""
        return self._replace(
            s_tm1=self.s_tm1.flip(1),
            m_tm1=mirrored_memory(self.m_tm1),
            a_tm1=mirrored(self.a_tm1),
            s_t=self.s_t.flip(1),
            m_t=mirrored_memory(self.m_t),
            allowed_t=self.allowed_t[:, [RIGHT, LEFT, FORWARD]],
        )


class Replay:
    """The last N rows of E worlds, kept in place; a row is a step of all worlds and the states before it.

    Each observation is kept once: the state that a step leads to is the next row's, at an end as well, as the
    world then shows the last state for one more step (NEXT_STEP autoreset), whose action it ignores.
    """

    def __init__(self, rows: int, observation: Tensor, memory: Tensor) -> None:
        """Make room for so many rows beside observations (E, R, C) and memories (E, M, 6)."""
        size = (rows, len(observation))
        # Half precision is 2 mm at the end of the range, takes no longer to read and half the room.
        self.kept = {
            "s": torch.zeros(*size, *observation.shape[1:], dtype=torch.float16),
            "m": torch.zeros(*size, *memory.shape[1:], dtype=torch.float16),
            "allowed": torch.zeros(*size, ACTIONS, dtype=torch.bool),
            "a": torch.zeros(size, dtype=torch.int64),
            "r": torch.zeros(size),
            "terminated": torch.zeros(size, dtype=torch.bool),
            "truncated": torch.zeros(size, dtype=torch.bool),
            "valid": torch.zeros(size, dtype=torch.bool),
        }
        self.size, self.written = size, 0

    @property
    def oldest(self) -> int:
        """The first row that is still there; rows are counted from the beginning of the run."""
        return max(0, self.written - self.size[0])

    def append(self, **row: Tensor) -> None:
        """Write a row, (E, ...) each, over the oldest one."""
        for name, kept in self.kept.items():
            kept[self.written % self.size[0]] = row[name]
        self.written += 1

    def draw(self, number: int, horizon: int, generator: torch.Generator) -> tuple[Tensor, Tensor]:
        """Rows and worlds, (B,) int64 each, of so many steps by chance, with ``horizon`` rows after them."""
        rows = torch.randint(self.oldest, self.written - horizon, (number,), generator=generator)
        return rows, torch.randint(self.size[1], (number,), generator=generator)

    def rewarded(self, world: int, begin: int, end: int) -> Tensor:
        """Those rows (B,) int64 from ``begin`` to before ``end`` that brought the world a reward."""
        rows = torch.arange(max(begin, self.oldest), end)
        return rows[self._at("r", rows, torch.full_like(rows, world)) > 0]

    def batch(self, rows: Tensor, worlds: Tensor, horizon: int, discount: float) -> Batch:
        """The steps at these rows (B,) of these worlds (B,), with their returns over ``horizon`` steps."""
        window, along = rows + torch.arange(horizon)[:, None], worlds.expand(horizon, -1)
        g, ahead, worth = n_step_returns(
            *(self._at(name, window, along) for name in ("r", "terminated", "truncated")), discount=discount
        )
        return Batch(
            s_tm1=self._at("s", rows, worlds).float(),
            m_tm1=self._at("m", rows, worlds).float(),
            a_tm1=self._at("a", rows, worlds),
            g=g,
            worth=worth,
            s_t=self._at("s", rows + ahead, worlds).float(),
            m_t=self._at("m", rows + ahead, worlds).float(),
            allowed_t=self._at("allowed", rows + ahead, worlds),
            valid=self._at("valid", rows, worlds),
        )

    def _at(self, name: str, rows: Tensor, worlds: Tensor) -> Tensor:
        return self.kept[name].flatten(0, 1)[rows % self.size[0] * self.size[1] + worlds]


class Learner:
    """A run of deep Q-learning: networks, replay memory, worlds, and where they stand."""

    def __init__(self, config: DQNConfig, envs: HouseVectorEnv) -> None:
        """Begin a run; ``envs`` has the environments and the world of ``config``, and NEXT_STEP autoreset."""
        self.config, self.envs = config, envs
        self.generator = torch.Generator().manual_seed(config.seed)
        self.avoidance: Layer = PaperRule(self.generator) if config.avoidance == "paper" else shield(envs)
        self.network = network_of(config, envs.config.rays, envs.config.channels)
        self.target = deepcopy(self.network) if config.target_every else self.network
        self.optimizer = torch.optim.Adam(self.network.parameters(), lr=config.learning_rate, fused=True)
        worlds = config.environments
        self.s = torch.as_tensor(envs.reset(seed=config.seed)[0])
        self.m = self.network.memory.empty(worlds)
        self.blocked = torch.zeros(worlds, dtype=torch.bool)
        self.ended = self.blocked.clone()
        self.began = torch.zeros(worlds, dtype=torch.int64)
        self.replay = Replay(config.memory // worlds, self.s, self.m)
        self.steps, self.updates, self.episodes, self.overruled = 0, 0, 0, 0
        self.seconds = self.simulating = self.found = 0.0
        self.recent: deque[tuple[float, int]] = deque(maxlen=round(EPISODE / REPORT))
        self.losses: list[Tensor] = []

    @property
    def fraction(self) -> float:
        """How much of the run is done, 0 to 1."""
        limit = self.config.seconds
        return min(1.0, max(self.steps / self.config.steps, self.seconds / limit if limit else 0.0))

    @property
    def epsilon(self) -> float:
        """Share of random actions now."""
        c = self.config
        if c.epsilon_decay < 1:
            return max(c.final_epsilon, c.epsilon * c.epsilon_decay**self.episodes)
        return linear(c.epsilon, c.final_epsilon, self.fraction / max(c.exploration, 1e-9))

    def advance(self) -> None:
        """A step of all worlds, and the updates that it is time for."""
        begun = self.ended
        self.act()
        if begun.any():
            self.learn_after(begun.nonzero().flatten().tolist())
        every = self.config.every
        if every and self.replay.written % every == 0 and self.warm:
            self.update(self.sample(*self.draw()))

    def draw(self) -> tuple[Tensor, Tensor]:
        """Rows and worlds, (B,) int64 each, of a batch by chance."""
        return self.replay.draw(self.config.batch, self.config.horizon, self.generator)

    def sample(self, rows: Tensor, worlds: Tensor) -> Batch:
        """What the memory holds of these steps."""
        return self.replay.batch(rows, worlds, self.config.horizon, self.config.discount)

    @property
    def warm(self) -> bool:
        """Whether there is enough to learn from."""
        least = max(self.config.warm_up // self.config.environments, self.config.horizon + 1)
        return self.replay.written >= min(least, self.replay.size[0])

    @torch.no_grad()
    def act(self) -> None:
        """Step the worlds once and remember the actions that were executed."""
        s, allowed = self.s, self.avoidance(self.s, self.blocked)
        preference = self.explore(self.network(s, self.m))
        a = subsume(preference, allowed)
        self.overruled += int((a != preference.argmax(-1)).sum())
        before = perf_counter()
        observation, r, terminated, truncated, info = self.envs.step_torch(a)
        self.simulating += perf_counter() - before
        self.replay.append(
            s=s,
            m=self.m,
            allowed=allowed if self.config.masked else torch.ones_like(allowed),
            a=a,
            r=r,
            terminated=terminated | truncated if self.config.timeouts_end else terminated,
            truncated=truncated,
            valid=~self.ended,
        )
        self.steps += len(a) - int(self.ended.sum())
        self.found += float(r.sum())
        # The step after an end begins the next episode: it is no memory of that one.
        self.m = self.network.memory(self.m, s, self.blocked, a, self.ended)
        # Cloned: the world writes over its tensors at the next step.
        self.s, self.blocked = observation.clone(), info["blocked"].clone()
        self.ended = terminated | truncated

    def explore(self, q: Tensor) -> Tensor:
        """Preferences (E, A): the Q-values, or a random action's in a share ``epsilon`` of the rows."""
        chosen = torch.rand(len(q), 1, generator=self.generator) < self.epsilon
        instead = random_preference(q, self.generator, self.config.forward)
        if self.config.homing:
            instead[:, FORWARD] += SURELY * self.s[:, 18:21, -1].amax(-1)
        return torch.where(chosen, instead, q)

    def learn_after(self, worlds: list[int]) -> None:
        """Episodes of these worlds have ended, and the states that they ended in are in the memory."""
        config, now = self.config, self.replay.written
        for world in worlds:
            self.episodes += 1
            begin, self.began[world] = int(self.began[world]), now
            if config.every or not self.warm:
                continue
            rows, of = self.draw()
            if config.rewarded:
                found = self.replay.rewarded(world, begin, now - config.horizon)[: config.batch]
                rows[: len(found)], of[: len(found)] = found, world
            mixed = torch.randperm(config.batch, generator=self.generator)
            batch = self.sample(rows[mixed], of[mixed])
            for part in zip(*(field.chunk(config.minibatches) for field in batch), strict=True):
                self.update(Batch(*part))

    def update(self, batch: Batch) -> None:
        """Learn from a batch."""
        config = self.config
        if config.mirror and self.updates % 2:
            batch = batch.seen_in_the_mirror()
        with torch.no_grad():
            judged = self.target(batch.s_t, batch.m_t)
            chosen = self.network(batch.s_t, batch.m_t) if config.double else None
            y = q_targets(batch.g, batch.worth, judged, chosen, batch.allowed_t)
        q = self.network(batch.s_tm1, batch.m_tm1).gather(1, batch.a_tm1[:, None]).squeeze(1)
        kind = nn.functional.huber_loss if config.loss == "huber" else nn.functional.mse_loss
        loss = (kind(q, y, reduction="none") * batch.valid).sum() / batch.valid.sum().clamp(min=1)
        for group in self.optimizer.param_groups:
            rate = config.learning_rate * linear(1.0, config.final_rate, self.fraction)
            group["lr"] = rate / (1 + config.rate_decay * self.updates)
        self.optimizer.zero_grad()
        loss.backward()
        if config.clip < float("inf"):
            nn.utils.clip_grad_norm_(self.network.parameters(), config.clip)
        self.optimizer.step()
        self.losses.append(loss.detach())
        self.updates += 1
        if config.target_every and self.updates % config.target_every == 0:
            self.target.load_state_dict(self.network.state_dict())

    def state(self) -> dict[str, Any]:
        """All that the run's next steps depend on: tensors and plain values, for ``torch.save``.

        Between two reports of ``train_dqn``; with it a run goes on bit for bit on the CPU. The tensors are
        the run's own: write them before it goes on.
        """
        return {
            "config": asdict(self.config),
            "houses": bank_hash(self.envs.houses),
            "network": self.network.state_dict(),
            "target": self.target.state_dict(),
            "optimizer": self.optimizer.state_dict(),
            "replay": self.replay.kept,
            "written": self.replay.written,
            "generator": self.generator.get_state(),
            "worlds": {name: torch.from_numpy(array) for name, array in self.envs.state.items()},
            "now": {name: getattr(self, name) for name in (*NOW, *COUNTS)},
            "recent": list(self.recent),
        }

    def restore(self, state: dict[str, Any]) -> None:
        """Go on from a state, but for the limits ``steps`` and ``seconds``, which are this run's.

        Raises ``RequestError`` where it is another config's or other houses'.
        """
        mine = asdict(self.config)
        other = [n for n in mine if n not in ("steps", "seconds") and mine[n] != state["config"].get(n)]
        if other:
            raise RequestError(f"a run of another config cannot go on here: {', '.join(other)}")
        if state["houses"] != bank_hash(self.envs.houses):
            raise RequestError("a run in other houses cannot go on here")
        self.network.load_state_dict(state["network"])
        self.target.load_state_dict(state["target"])
        self.optimizer.load_state_dict(state["optimizer"])
        for name, kept in self.replay.kept.items():
            kept.copy_(state["replay"][name])
        self.replay.written = state["written"]
        self.generator.set_state(state["generator"])
        self.envs.state = {name: tensor.numpy() for name, tensor in state["worlds"].items()}
        for name, value in state["now"].items():
            setattr(self, name, value.clone() if isinstance(value, Tensor) else value)
        self.recent.extend(state["recent"])

    def save(self, path: str | Path) -> None:
        """Write the state beside its place and rename it: a kill leaves the old file or the new one."""
        content = io.BytesIO()
        torch.save(self.state(), content)
        write_whole(path, content.getvalue())

    def load(self, path: str | Path) -> None:
        """Go on from a file that ``save`` wrote; only tensors and plain values are read, never code."""
        self.restore(torch.load(path, weights_only=True))


NOW = ("s", "m", "blocked", "ended", "began")
COUNTS = ("steps", "updates", "episodes", "overruled", "seconds", "simulating")


def train_dqn(learner: Learner) -> Iterator[Progress]:
    """Train to the end of the run, and report every 128 steps of all worlds.

    Logging, checkpoints and evaluation are the caller's: between two reports nothing moves, ``learner.save``
    keeps all of the run, and whoever stops asking stops it.
    """
    while learner.fraction < 1:
        start, steps, overruled = perf_counter(), learner.steps, learner.overruled
        learner.found, learner.losses = 0.0, []
        for _ in range(REPORT):
            learner.advance()
        learner.recent.append((learner.found, learner.steps - steps))
        learner.seconds += perf_counter() - start
        found, counted = (sum(column) for column in zip(*learner.recent, strict=True))
        yield Progress(
            steps=learner.steps,
            seconds=learner.seconds,
            fraction=learner.fraction,
            targets=EPISODE * found / max(1, counted),
            loss=float(torch.stack(learner.losses).mean()) if learner.losses else 0.0,
            epsilon=learner.epsilon,
            overruled=(learner.overruled - overruled) / (REPORT * learner.config.environments),
            simulator=learner.steps / learner.simulating,
            learner=learner.steps / (learner.seconds - learner.simulating),
        )


def network_of(config: DQNConfig, rays: int = 40, channels: int = 2) -> Any:
    """The network that the config names; its weights are a function of its seed."""
    if config.network == "traces":
        return seeded_network(config.seed, rays, channels, config.half_lives)
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(config.seed)
        return PaperNetwork(rays, channels)
