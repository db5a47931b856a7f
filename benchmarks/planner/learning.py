"""Gain of learning over the explorer: ``vitruvius bench learning --agent runs/mine/agent.safetensors``.

Every agent plays the same episodes as the explorer, four in each house: the same starts, and the same targets
in the same order. Tables show each agent's fraction of the oracle's targets, or its SPL in a task that ends
with the first target, and the paired difference to the explorer by house and episode. With ``--decisions``
they show how many of its choices of a viewpoint differ from the explorer's, and if those are better
(``decisions.py``). With ``--shuffled`` they show how much of a gain remains if each environment gets the
prediction of another one. Scores are kept under keys of everything that they depend on, so that a stopped run
can continue.
"""

import hashlib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, cast

import numpy as np
import torch
import tyro

from benchmarks.common.houses import by_rooms, kept_houses
from benchmarks.common.pages import write_arrays, write_tables
from benchmarks.common.processes import say
from benchmarks.planner.contenders import EXPLORER, Contender, contender, with_shuffled_predictions
from benchmarks.planner.decisions import Decisions, Tracked, decisions
from benchmarks.planner.explorers import ORACLE, SEED
from vitruvius.agent.banks import bank_hash, named
from vitruvius.agent.evaluation.episodes import reset
from vitruvius.agent.evaluation.protocol import shortest_ways
from vitruvius.agent.evaluation.statistics import mean
from vitruvius.agent.evaluation.tables import Table
from vitruvius.agent.learning.environments import make_envs, playable
from vitruvius.agent.learning.simulator import sensor
from vitruvius.agent.policies.episodes import moments
from vitruvius.agent.policies.policies import Policy
from vitruvius.logic import House
from vitruvius.logic.errors import RequestError
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.config import DEFAULT
from vitruvius.sim.tasks.tasks import task

EARLY = 500
"""Number of first steps that have a column of their own."""

SHARE = "Share of the oracle's targets"
"""Name of the score, if it is not SPL."""

BANKS = {"star": ("family", range(2, 7)), "home": ("home", range(4, 11)), "large": ("family", range(12, 13))}
"""Houses of validation seeds: a grammar, and numbers of rooms."""

AT_ONCE = 64
"""Number of choices that are continued together."""


@dataclass(frozen=True)
class Learning:
    """Compare agents with the explorer, episode by episode, in houses of validation seeds."""

    agent: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """A released agent, a checkpoint, ``module:function`` that makes a policy of environments, a baseline,
    ``prior-floor`` and ``prior-rooms``, explorers that know a part of the house, or ``truth``, an explorer
    with perfect map completion. Several training runs of one agent: NAME=FILE,FILE,FILE. Repeat for other
    agents; by default ``prior-rooms``."""

    bank: str = "star"
    """``star``, ``home``, ``large`` (12 rooms); or a house file, or a bank's name."""

    targets: str = "secondary"
    """Place of the targets: a task's name, or JSON of a task."""

    houses: int = 64
    """Number of houses of each number of rooms, if houses are generated; an object is sought only in houses
    that have it."""

    episodes: int = 4
    """Number of episodes in each house, each with other targets."""

    steps: int = DEFAULT.steps
    """Number of steps of an episode that are played."""

    world: Literal["default", "noisy", "doors"] = "default"
    """Simulator settings for agents. The oracle plays in the default ones."""

    shuffled: bool = False
    """Also play each agent with the predictions of other environments: a gain by prediction must
    disappear."""

    decisions: float = 0.0
    """Fraction of an agent's choices of a viewpoint that are compared with the explorer's; 0 for none."""

    ahead: int = 200
    """Number of steps for which both choices are continued."""

    out: Path = Path("runs/learning")
    """Folder for houses, scores and learning.md."""

    replace: bool = False
    """Write into the folder even if it holds other files."""

    def run(self) -> None:
        """Play the episodes that are missing, and print the tables."""
        if min(self.houses, self.episodes) < 1 or not 1 <= self.steps <= DEFAULT.steps:
            raise RequestError(f"--houses and --episodes must be 1 or more, --steps 1 to {DEFAULT.steps}")
        if not 0 <= self.decisions <= 1 or not 0 < self.ahead < self.steps:
            raise RequestError("--decisions must be a share from 0 to 1, --ahead 1 or more and below --steps")
        agents = dict(map(runs_of, self.agent or ("prior-rooms",)))
        most, baseline = (self.scores(name, contender(name)) for name in (ORACLE, EXPLORER))
        compared = {EXPLORER: baseline[None]}
        for name, files in agents.items():
            compared[name] = np.stack([self.scores(name, contender(file)) for file in files])
            if self.shuffled:
                shuffled = [self.scores(name, contender(file), shuffled=True) for file in files]
                compared[f"{name}, shuffled"] = np.stack(shuffled)
        shares = {name: share(each, most) for name, each in compared.items()}
        page = [scores_table(f"{'SPL' if self.ends else SHARE}, {self.title}", shares)]
        if self.decisions:
            made = {
                name: [self.decided(name, contender(file)) for file in files]
                for name, files in agents.items()
            }
            page.append(decisions_table(self.title, made, len(self.bank_houses), self.ahead))
        write_tables(page, self.out / "learning.md")

    @property
    def title(self) -> str:
        """Bank, task and size, for the titles of tables."""
        world = "" if self.world == "default" else f", {self.world}"
        houses, episodes = len(self.bank_houses), self.episodes
        return f"{self.bank}, {self.targets}{world}, {houses} houses of {episodes} episodes"

    @property
    def ends(self) -> bool:
        """True if an episode ends with its first target."""
        try:
            return task(self.targets).ends_on_pick_up
        except ValueError as error:
            raise RequestError(str(error)) from None

    @cached_property
    def bank_houses(self) -> list[House]:
        """Houses in which the task can be played, made once."""
        return playable(self._houses(), self.targets)

    def _houses(self) -> list[House]:
        if self.bank not in BANKS:
            return named(self.bank)
        path = self.out / f"{self.bank}-{self.houses}.jsonl"
        grammar, rooms = BANKS[self.bank]
        return kept_houses(path, lambda: by_rooms(rooms, self.houses, SEED, grammar=grammar))

    def environments(self, number: int, world: str, agent: Contender) -> HouseVectorEnv:
        """Return ``number`` environments over the houses, with the agent's sensor."""
        preset = sensor(agent.config, world) if agent.config else world
        return make_envs(self.bank_houses, number, self.targets, preset=preset)

    def path(self, what: str, key: str, *more: Any) -> Path:
        """Return the file of the result for an agent with this key."""
        known = (bank_hash(self.bank_houses), self.targets, self.episodes, self.steps, key, *more)
        return self.out / f"{what}-{hashlib.sha256(repr(known).encode()).hexdigest()[:16]}.npz"

    def scores(self, name: str, agent: Contender, shuffled: bool = False) -> np.ndarray:
        """Return targets (2, episodes, H), or SPL, of the first ``EARLY`` steps and of all steps."""
        world = "default" if name == ORACLE else self.world
        path = self.path("scores", agent.key, world, shuffled)
        if not path.exists():
            torch.set_num_threads(1)
            envs = self.environments(self.episodes * len(self.bank_houses), world, agent)
            policy = agent.make(envs)
            if shuffled:
                policy = with_shuffled_predictions(policy, name)
            targets = episode(envs, policy, self.steps, len(self.bank_houses), self.ends)
            write_arrays(path, targets=targets.reshape(2, self.episodes, -1))
            what = "SPL" if self.ends else "targets an episode"
            say(f"{name}{', shuffled' * shuffled}: {targets[1].mean():.2f} {what}")
        return np.load(path)["targets"]

    def decided(self, name: str, agent: Contender) -> Decisions:
        """Return the choices of an agent, compared with the explorer's."""
        path = self.path("decisions", agent.key, self.world, self.decisions, self.ahead)
        if not path.exists():
            torch.set_num_threads(1)
            envs = self.environments(self.episodes * len(self.bank_houses), self.world, agent)
            again = self.environments(AT_ONCE, self.world, agent)
            policy = agent.make(envs)
            if not hasattr(policy, "tracker"):
                raise RequestError(
                    f"--decisions: {name} has no planner and chooses no viewpoints: leave --decisions out"
                )
            tracked = cast(Tracked, policy)
            made = decisions(
                envs, again, tracked, len(self.bank_houses), self.steps, self.ahead, self.decisions
            )
            write_arrays(path, **vars(made))
        return Decisions(**np.load(path))


def runs_of(text: str) -> tuple[str, tuple[str, ...]]:
    """Return an agent's name, and the names of its training runs.

    Raises ``RequestError`` if there are none.
    """
    name, given, files = text.partition("=")
    runs = tuple(filter(None, files.split(","))) if given else (text,)
    if not name or not runs:
        raise RequestError(f"--agent {text}: give NAME=FILE,FILE, or one agent")
    return name, runs


def episode(envs: HouseVectorEnv, policy: Policy, steps: int, houses: int, ends: bool = False) -> np.ndarray:
    """Return the targets (2, E) that a policy picks up in the first ``EARLY`` steps, and in all steps.

    If the first target ``ends`` an episode, return its SPL, which is 0 without a target. Environment i is in
    house i modulo ``houses``.
    """
    numbers = np.arange(envs.num_envs) % houses
    shortest = shortest_ways(envs, 0, numbers) if ends else None
    observation = reset(envs, 0, numbers)
    targets, first = np.zeros((2, envs.num_envs)), np.full(envs.num_envs, np.inf)
    for now in moments(envs, policy, observation, steps):
        targets[int(now.step > EARLY) :] += now.reward.numpy()
        first[(now.reward.numpy() > 0) & np.isinf(first)] = now.step
    if shortest is None:
        return targets
    return np.where([first <= EARLY, first <= steps], shortest / np.maximum(first, shortest), 0.0)


def share(targets: np.ndarray, most: np.ndarray) -> np.ndarray:
    """Return targets (S, 2, episodes, H) as fractions of the oracle's (2, episodes, H) in the same house.

    If the oracle finds none, the result is as if it found one in all of the episodes.
    """
    return targets / np.maximum(most.mean(axis=1, keepdims=True), 1 / most.shape[1])


def scores_table(title: str, shares: dict[str, np.ndarray]) -> Table:
    """Return a table of fractions (S, 2, episodes, H) of the oracle's score, by agent.

    It also has the differences to the explorer.
    """
    headings = (
        "agent",
        "runs",
        "score",
        "difference",
        "95 % interval",
        "spread of runs",
        f"first {EARLY}",
        "difference there",
    )
    rows = []
    for name, each in shares.items():
        # Of an episode, then of the house.
        early, late = np.moveaxis((each - shares[EXPLORER]).mean(axis=2), 1, 0)
        spread = f"{late.mean(axis=1).std(ddof=1):.3f}" if len(each) > 1 else "-"
        interval, own = mean(late), each.mean(axis=(0, 2, 3))
        compared = (
            ("", "", "")
            if name == EXPLORER
            else (difference(late), f"{interval.low:+.3f} to {interval.high:+.3f}", difference(early))
        )
        rows.append(
            (name, str(len(each)), f"{own[1]:.3f}", *compared[:2], spread, f"{own[0]:.3f}", compared[2])
        )
    return Table(title, headings, rows)


def difference(pairs: np.ndarray) -> str:
    """Return a mean difference (S, H), with its standard error over houses."""
    of_house = pairs.mean(axis=0)
    return f"{of_house.mean():+.3f} ± {of_house.std() / max(len(of_house) - 1, 1) ** 0.5:.3f}"


def decisions_table(title: str, made: dict[str, list[Decisions]], houses: int, ahead: int) -> Table:
    """Return a table of the choices that differ from the explorer's, and of the targets found after them."""
    rows = []
    for name, runs in made.items():
        different = np.concatenate([each.differs for each in runs])
        house = np.concatenate([each.environment for each in runs])[different] % houses
        after = np.concatenate([each.targets for each in runs])[different]
        gain = after[:, 0] - after[:, 1]
        better, worse = ((gain > 0).mean(), (gain < 0).mean()) if len(gain) else (np.nan, np.nan)
        rows.append((
            name, str(len(different)), f"{different.mean():.3f}" if len(different) else "-",
            f"{after[:, 0].mean() if len(gain) else np.nan:.3f}", clustered(gain, house),
            f"{better:.3f}", f"{worse:.3f}",
        ))  # fmt: skip
    headings = ("agent", "choices", "differ", f"targets in {ahead} steps", "difference", "better", "worse")
    return Table(f"Choices of a viewpoint that are not the explorer's, {title}", headings, rows)


def clustered(values: np.ndarray, group: np.ndarray) -> str:
    """Return a mean of ``values`` (n,), with its standard error if only ``group`` (n,) are independent."""
    if len(np.unique(group)) < 2:
        return "-"
    sums = np.bincount(group, values - values.mean())
    number = len(np.unique(group))
    error = np.sqrt(np.square(sums).sum() * number / (number - 1)) / len(values)
    return f"{values.mean():+.3f} ± {error:.3f}"
