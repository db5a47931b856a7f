"""Deep Q-learning from a replay memory (Mnih et al. 2015), in one file to be read beside its papers.

| part | of |
|---|---|
| replay memory, target network | Mnih et al. 2015, doi:10.1038/nature14236 |
| double Q-learning | van Hasselt et al. 2016, arXiv:1509.06461 |
| n-step returns | Hessel et al. 2018 (Rainbow), arXiv:1710.02298: not corrected for exploring actions |

Many worlds are stepped at once, a row of the memory for each step of all. Axes: N rows, E worlds, n steps of
a return, B samples, R rays, C channels, M half-lives, A actions; ``s_tm1, a_tm1`` lead to ``s_t``.
"""

from copy import deepcopy
from time import perf_counter
from typing import Any, NamedTuple

import torch
from torch import Tensor, nn

from agent.actions import ACTIONS, FORWARD, LEFT, RIGHT, mirrored
from agent.avoidance import best_value, random_preference, subsume
from agent.config import DQNConfig
from agent.learner import Learner, Progress
from agent.memory import mirrored_memory
from agent.pqn import linear
from sim import HouseVectorEnv

REPORT = 128
"""Rows from one report of the run to the next."""

SURELY = 1e6
"""More than any preference by chance."""


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


class DQN(Learner):
    """A run of deep Q-learning: networks, replay memory, worlds, and where they stand."""

    config: DQNConfig

    def __init__(self, config: DQNConfig, envs: HouseVectorEnv) -> None:
        """Begin a run; ``envs`` has the environments and the world of ``config``, and NEXT_STEP autoreset."""
        super().__init__(config, envs, REPORT)
        self.target = deepcopy(self.network) if config.target_every else self.network
        self.optimizer = torch.optim.Adam(self.network.parameters(), lr=config.learning_rate, fused=True)
        self.updates, self.episodes = 0, 0
        self.found = self.counted = self.overruled = 0.0
        self.losses: list[Tensor] = []
        self.begin()

    def begin(self) -> None:
        """Begin episodes in all worlds, with a replay memory of nothing."""
        worlds = self.config.environments
        self.s, self.m = self.first_look(), self.network.memory.empty(worlds)
        self.blocked = torch.zeros(worlds, dtype=torch.bool)
        self.ended = self.blocked.clone()
        self.began = torch.zeros(worlds, dtype=torch.int64)
        self.replay = Replay(self.config.memory // worlds, self.s, self.m)

    @property
    def epsilon(self) -> float:
        """Share of random actions now."""
        c = self.config
        if c.epsilon_decay < 1:
            return max(c.final_epsilon, c.epsilon * c.epsilon_decay**self.episodes)
        return linear(c.epsilon, c.final_epsilon, self.fraction / max(c.exploration, 1e-9))

    def advance(self) -> Progress:
        """So many steps of all worlds, with the updates that they are time for."""
        start = perf_counter()
        self.found = self.counted = self.overruled = 0.0
        self.losses = []
        for _ in range(REPORT):
            self.step()
        self.clock.all += perf_counter() - start
        return self.report(
            found=self.found,
            counted=self.counted,
            overruled=self.overruled,
            loss=float(torch.stack(self.losses).mean()) if self.losses else 0.0,
            epsilon=self.epsilon,
        )

    def step(self) -> None:
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
        self.clock.simulating += perf_counter() - before
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
        self.counted += len(a) - int(self.ended.sum())
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
        if config.clip is not None:
            nn.utils.clip_grad_norm_(self.network.parameters(), config.clip)
        self.optimizer.step()
        self.losses.append(loss.detach())
        self.updates += 1
        if config.target_every and self.updates % config.target_every == 0:
            self.target.load_state_dict(self.network.state_dict())

    def own_state(self) -> dict[str, Any]:
        """The target network, the optimiser, the replay memory, and where the worlds stand."""
        return {
            "target": self.target.state_dict(),
            "optimizer": self.optimizer.state_dict(),
            "replay": self.replay.kept,
            "written": self.replay.written,
            "now": {name: getattr(self, name) for name in NOW},
        }

    def restore_own(self, state: dict[str, Any]) -> None:
        """Take up what ``own_state`` gave."""
        self.target.load_state_dict(state["target"])
        self.optimizer.load_state_dict(state["optimizer"])
        for name, kept in self.replay.kept.items():
            kept.copy_(state["replay"][name])
        self.replay.written = state["written"]
        for name, value in state["now"].items():
            setattr(self, name, value.clone() if isinstance(value, Tensor) else value)


NOW = ("s", "m", "blocked", "ended", "began", "updates", "episodes")
"""Where the worlds and the schedules stand."""
