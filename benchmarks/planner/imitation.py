"""Rays and recurrence alone, taught by the explorer, then by reward: ``vitruvius bench imitation``.

A recurrent network sees rays, its last action and whether that was blocked, and has no map. First it learns
to do as the explorer does, in episodes that this leads. Then it plays itself, and goes on by proximal policy
optimisation (PPO, Schulman et al. 2017, arXiv:1707.06347), at first its critic alone: the recipe of PIRLNav
(Ramrakhya et al. 2023, arXiv:2301.07302). Gradients flow through whole windows of steps; it plays under the
avoidance layer.

Axes: T steps of a window, E environments, S signals, A actions, W numbers of the recurrent layer.
"""

from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from time import process_time
from typing import Any, NamedTuple, cast

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor, nn

from agent.avoidance import Layer, subsume
from agent.learning.environments import make_envs, shield
from agent.policies.network import seeded
from agent.policies.policies import Explorer
from benchmarks.common.houses import ROOMS, by_rooms, kept_houses
from benchmarks.common.pages import write_tables
from benchmarks.common.processes import say
from benchmarks.planner.contenders import EXPLORER, Contender, contender
from benchmarks.planner.explorers import ORACLE
from benchmarks.planner.learning import Learning, scores_table, share
from logic import House
from logic.errors import RequestError
from logic.house.files import write_whole
from sim import HouseVectorEnv
from sim.actions import ACTIONS
from sim.config import DEFAULT

RESTARTS = 0.04
"""Share of the environments that begin another episode before each window, beside those near their end."""

IMITATING, REINFORCING, LEAST = 1e-3, 2e-4, 2e-5
"""Learning rates: of imitation and of the critic; of the rest by reward, at first, and in the end."""

WARM = 0.1
"""Share of learning by reward in which the critic alone learns."""

GAMMA, LAMBDA = 0.997, 0.95
"""Discount of a step; how far returns follow the path before they trust the critic."""

CLIP, ENTROPY = 0.2, 0.005
"""PPO's bound on the change of a probability; what the entropy counts in the loss."""

SPREAD = 0.05
"""Added to the deviation that advantages are divided by: where nothing was found there is noise alone."""

SHARES = 4
"""Updates of imitation in a window."""

PASSES, PARTS = 2, 2
"""Of PPO over a window, and updates in each."""

CODE = 128
"""Numbers that encode an observation."""

KEPT, SAID = 60.0, 40
"""Seconds of processor time from one checkpoint to the next, and windows between lines of the log."""


@dataclass(frozen=True)
class Imitation:
    """Teach a recurrent network that has no map by the explorer, then by reward, and let it play."""

    houses: int = 100
    """Houses of each number of rooms, 2 to 6, to learn in."""

    imitate: float = 300.0
    """Processor time of imitation, seconds."""

    reinforce: float = 3000.0
    """Processor time of learning by reward after it, seconds."""

    window: int = 128
    """Steps through which gradients flow."""

    width: int = 256
    """Numbers of the recurrent layer."""

    envs: int = 64
    """Environments that it learns in."""

    bank: str = "star"
    """Houses in which it plays: see ``bench learning``."""

    play: int = 16
    """Of these for each number of rooms, if they are made."""

    episodes: int = 4
    """In each house."""

    seed: int = 0
    """Of the first weights and of all else that is drawn."""

    out: Path = Path("runs/imitation")
    """Folder for houses, the network, scores and imitation.md. With more time it learns on."""

    replace: bool = False
    """Write into the folder whatever else it holds."""

    def run(self) -> None:
        """Learn what was not learnt yet; play, and print the table."""
        least = self.houses, self.window, self.width, self.play, self.episodes, self.envs // SHARES
        if min(least) < 1 or min(self.imitate, self.reinforce) < 0:
            raise RequestError(f"imitation's options must be greater than 0, --envs {SHARES} or more")
        torch.set_num_threads(1)
        network, key = RaysNetwork(self.width), repr(self)
        network.load_state_dict(self.learnt()["network"])
        study = Learning(bank=self.bank, houses=self.play, episodes=self.episodes, out=self.out)
        most, baseline = (study.scores(each, contender(each)) for each in (ORACLE, EXPLORER))
        scores = {EXPLORER: share(baseline[None], most)}
        for name, drawn in (("its likeliest action", False), ("an action that is drawn", True)):
            policy = Contender(
                lambda envs, drawn=drawn: RaysPolicy(network, shield(envs), drawn), f"{name} {key}"
            )
            scores[name] = share(study.scores(name, policy)[None], most)
        write_tables([scores_table(study.title, scores)], self.out / "imitation.md")

    def learnt(self) -> dict[str, Any]:
        """What was learnt for so long, going on from what is kept."""
        name = f"{self.houses}-{self.window}-{self.width}-{self.envs}-{self.seed}"
        path, time = self.out / f"network-{name}.pt", self.imitate + self.reinforce
        kept = torch.load(BytesIO(path.read_bytes()), weights_only=True) if path.exists() else {}
        if kept.get("seconds", -1.0) >= time:
            return kept
        houses = self.out / f"learn-{self.houses}.jsonl"
        pupil = Pupil(kept_houses(houses, lambda: by_rooms(ROOMS, self.houses, 100)), self, kept)
        while pupil.seconds < time:
            pupil.learn(min(pupil.seconds + KEPT, time))
            buffer = BytesIO()
            torch.save(pupil.state, buffer)
            write_whole(path, buffer.getvalue())
        return pupil.state


class RaysNetwork(nn.Module):
    """A recurrent layer (GRU) over codes of what the body senses; an actor and a critic that read it."""

    def __init__(self, width: int, rays: int = 2 * DEFAULT.rays) -> None:
        """Draw first weights from torch's generator."""
        super().__init__()
        self.code = nn.Sequential(
            nn.Linear(rays + ACTIONS + 1, CODE), nn.ReLU(), nn.Linear(CODE, CODE), nn.ReLU()
        )
        self.memory = nn.GRU(CODE, width)
        self.actor, self.critic = (
            nn.Sequential(nn.Linear(width + CODE, CODE), nn.ReLU(), nn.Linear(CODE, outputs))
            for outputs in (ACTIONS, 1)
        )

    def forward(self, signals: Tensor, memory: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Logits (T, E, A) of actions and values (T, E) by signals (T, E, S) and a memory (1, E, W); the
        memory after them. No gradient of the values reaches the memory.
        """
        codes = self.code(signals)
        kept, memory = self.memory(codes, memory)
        read = torch.cat([codes, kept], 2)
        return self.actor(read), self.critic(read.detach())[..., 0], memory


def sensed(observation: Tensor, blocked: Tensor, actions: Tensor) -> Tensor:
    """What the network reads (E, S): rays (E, R, C), the last actions (E,), and whether they were blocked."""
    return torch.cat([observation.flatten(1), F.one_hot(actions, ACTIONS), blocked[:, None]], 1)


class RaysPolicy:
    """The policy of a network that has no map."""

    def __init__(self, network: RaysNetwork, avoidance: Layer, drawn: bool, seed: int = 0) -> None:
        """Act by the likeliest action, or by one that is ``drawn``."""
        self.network, self.avoidance, self.drawn, self.interventions = network, avoidance, drawn, 0
        self.generator = torch.Generator().manual_seed(seed)

    def begin(self, environments: int) -> None:
        """See ``Policy``."""
        self.memory = torch.zeros(1, environments, self.network.memory.hidden_size)
        self.actions, self.interventions = torch.zeros(environments, dtype=torch.int64), 0

    @torch.no_grad()
    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """See ``Policy``."""
        signals = sensed(observation, blocked, self.actions)[None]
        logits, _, self.memory = self.network(signals, self.memory)
        preference, self.allowed = logits[0], self.avoidance(observation, blocked)
        if self.drawn:
            noise = torch.empty_like(preference).exponential_(generator=self.generator)
            preference = preference - noise.log()
        self.actions = subsume(preference, self.allowed)
        self.interventions += int((self.actions != preference.argmax(1)).sum())
        return self.actions


class StepsTaken(NamedTuple):
    """Steps to learn from."""

    signals: Tensor
    """(T + 1, E, S): what the network reads at each step, and after the last."""

    allowed: Tensor
    """(T, E, A) bool: what avoidance leaves."""

    actions: Tensor
    """(T, E) int64: what was done."""

    rewards: Tensor
    """(T, E) float32."""

    memory: Tensor
    """(1, E, W): before the first step."""

    def of(self, environments: Tensor) -> "StepsTaken":
        """That of some environments (n,) int64."""
        return StepsTaken(*(field[:, environments] for field in self))

    def log_odds(self, logits: Tensor) -> tuple[Tensor, Tensor]:
        """By logits (T, E, A): logarithms of the probabilities (T, E) of what was done, and the entropy."""
        every = logits.masked_fill(~self.allowed, -1e9).log_softmax(2)
        return every.gather(2, self.actions[..., None])[..., 0], -(every.exp() * every).sum(2).mean()


class Lesson:
    """Bodies that a network or the explorer leads."""

    def __init__(self, houses: list[House], number: int, network: RaysNetwork, seed: int) -> None:
        self.envs = cast(HouseVectorEnv, make_envs(houses, number, "secondary"))
        self.pupil = RaysPolicy(network, shield(self.envs), drawn=True, seed=seed)
        self.explorer = Explorer(shield(self.envs), self.envs.config)
        self.random, self.age = np.random.default_rng(seed), np.zeros(number, int)
        self.observation = torch.as_tensor(self.envs.reset(seed=seed)[0])
        self.blocked = torch.zeros(number, dtype=torch.bool)
        for policy in (self.pupil, self.explorer):
            policy.begin(number)

    def window(self, steps: int, led: bool) -> StepsTaken:
        """Some steps of the network, or of the explorer where it is ``led``: then the memory is not kept."""
        self.restart((self.random.random(len(self.age)) < RESTARTS) | (self.age + steps >= DEFAULT.steps))
        memory, rows = self.pupil.memory.clone(), []
        for _ in range(steps):
            signals = sensed(self.observation, self.blocked, self.pupil.actions)
            if led:
                self.pupil.actions = self.explorer(self.observation, self.blocked).clone()
                allowed = self.explorer.choice.allowed.clone()
            else:
                self.pupil(self.observation, self.blocked)
                allowed = self.pupil.allowed.clone()
            observation, reward, _, _, info = self.envs.step_torch(self.pupil.actions)
            self.observation, self.blocked = observation, info["blocked"].clone()
            rows.append((signals, allowed, self.pupil.actions, reward.clone()))
        self.age += steps
        signals, *others = (torch.stack(column) for column in zip(*rows, strict=True))
        last = sensed(self.observation, self.blocked, self.pupil.actions)[None]
        return StepsTaken(torch.cat([signals, last]), *others, memory)

    def restart(self, begun: np.ndarray) -> None:
        """Begin other episodes where (E,) bool."""
        if begun.any():
            observation, _ = self.envs.reset(options={"reset_mask": begun})
            fresh = torch.from_numpy(begun)
            self.observation, self.blocked = torch.as_tensor(observation), self.blocked & ~fresh
            self.age[begun], self.pupil.memory[:, fresh], self.pupil.actions[fresh] = 0, 0.0, 0
            self.explorer.tracker.fresh |= fresh


def advantages(rewards: Tensor, values: Tensor) -> Tensor:
    """How much more each step (T, E) brought than the critic thought, by rewards (T, E) and values
    (T + 1, E): generalised advantage estimation (Schulman et al. 2016, arXiv:1506.02438). No episode ends
    within a window.
    """
    gain = rewards + GAMMA * values[1:] - values[:-1]
    for t in range(len(gain) - 2, -1, -1):
        gain[t] += GAMMA * LAMBDA * gain[t + 1]
    return gain


class Pupil:
    """A network while it learns."""

    def __init__(self, houses: list[House], study: Imitation, kept: dict[str, Any]) -> None:
        with seeded(study.seed):
            self.network = RaysNetwork(study.width)
        critic = list(self.network.critic.parameters())
        others = [each for name, each in self.network.named_parameters() if not name.startswith("critic")]
        self.optimizer = torch.optim.Adam([{"params": others}, {"params": critic}], lr=IMITATING, eps=1e-5)
        self.study, self.seconds, self.windows = study, 0.0, 0
        if kept:
            self.network.load_state_dict(kept["network"])
            self.optimizer.load_state_dict(kept["optimizer"])
            self.seconds, self.windows = kept["seconds"], kept["windows"]
        self.lesson = Lesson(houses, study.envs, self.network, study.seed + self.windows)
        self.generator = torch.Generator().manual_seed(study.seed + self.windows)

    @property
    def state(self) -> dict[str, Any]:
        """All that it goes on from."""
        return {
            "network": self.network.state_dict(),
            "optimizer": self.optimizer.state_dict(),
            "seconds": self.seconds,
            "windows": self.windows,
        }

    def learn(self, until: float) -> None:
        """Learn until so many seconds of processor time were spent in all."""
        study, begun, said = self.study, process_time() - self.seconds, []
        while self.seconds < until:
            done = (self.seconds - study.imitate) / max(study.reinforce, 1e-9)
            if done >= 0:
                rate = REINFORCING + done * (LEAST - REINFORCING)
                self.optimizer.param_groups[0]["lr"] = rate if done >= WARM else 0.0
            said.append(self.imitated() if done < 0 else self.reinforced())
            self.windows, self.seconds = self.windows + 1, process_time() - begun
            if self.windows % SAID == 0:
                means = {name: np.mean([row[name] for row in said if name in row]) for name in said[-1]}
                numbers = ", ".join(f"{name} {mean:.3f}" for name, mean in means.items())
                say(f"{self.seconds:.0f} s, {self.windows * study.window * study.envs:,} steps: {numbers}")
                said = []

    def imitated(self) -> dict[str, float]:
        """Learn from a window by what the explorer did."""
        window, losses = self.lesson.window(self.study.window, led=True), []
        for some in self.parts(SHARES):
            part = window.of(some)
            logits, _, memory = self.network(part.signals[:-1], part.memory)
            losses.append(self.descend(-part.log_odds(logits)[0].mean()))
            self.lesson.pupil.memory[:, some] = memory.detach()
        return {"loss": float(np.mean(losses))} | found(window)

    def reinforced(self) -> dict[str, float]:
        """Learn from a window by PPO."""
        window = self.lesson.window(self.study.window, led=False)
        with torch.no_grad():
            logits, values, _ = self.network(window.signals, window.memory)
            before, entropy = window.log_odds(logits[:-1])
        gain = advantages(window.rewards, values)
        returns, gain = gain + values[:-1], (gain - gain.mean()) / (gain.std() + SPREAD)
        for _ in range(PASSES):
            for some in self.parts(PARTS):
                part, better = window.of(some), gain[:, some]
                logits, values, _ = self.network(part.signals[:-1], part.memory)
                log_odds, spread = part.log_odds(logits)
                ratio = (log_odds - before[:, some]).exp()
                better = torch.minimum(ratio * better, ratio.clamp(1 - CLIP, 1 + CLIP) * better).mean()
                error = (values - returns[:, some]).square().mean()
                self.descend(error / 2 - better - ENTROPY * spread)
        return {"entropy": float(entropy)} | found(window)

    def parts(self, number: int) -> tuple[Tensor, ...]:
        """The environments in so many parts, by chance."""
        return torch.randperm(self.study.envs, generator=self.generator).chunk(number)

    def descend(self, loss: Tensor) -> float:
        """One update; the loss."""
        self.optimizer.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(self.network.parameters(), 0.5)
        self.optimizer.step()
        return float(loss.detach())


def found(window: StepsTaken) -> dict[str, float]:
    """Targets in an episode, were all of it as in a window."""
    return {"found": float(window.rewards.sum(0).mean()) * DEFAULT.steps / len(window.rewards)}
