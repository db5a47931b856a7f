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
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from agent.learning.environments import shield
from agent.policies.network import seeded
from benchmarks.common.houses import ROOMS, by_rooms, kept_houses
from benchmarks.common.pages import write_tables
from benchmarks.common.processes import say
from benchmarks.imitation.lesson import Lesson, StepsTaken
from benchmarks.imitation.network import RaysNetwork, RaysPolicy
from benchmarks.planner.contenders import EXPLORER, Contender, contender
from benchmarks.planner.explorers import ORACLE
from benchmarks.planner.learning import Learning, scores_table, share
from logic import House
from logic.errors import RequestError
from logic.house.files import write_whole
from sim.config import DEFAULT

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
