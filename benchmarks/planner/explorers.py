"""Effect of the planner's numbers: ``vitruvius bench explorers --set replan_interval=48``.

The explorer (``policies.Explorer``) plays four episodes in each of 320 houses of validation seeds, with the
tuned configuration and with others. Each ``--set`` is a variant, of one field of ``PlannerConfig`` or of
several (``--set near=4,gain_most=300``). Tables show each variant's fraction of the oracle's targets, and the
difference to the tuned explorer, house by house. Houses and scores are kept, so that a stopped run can
continue; scores are kept by the sources that made them.
"""

import hashlib
import importlib
import inspect
import pkgutil
from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from difflib import get_close_matches
from functools import cached_property
from pathlib import Path
from time import process_time
from types import ModuleType
from typing import Literal

import numpy as np
import torch
import tyro
from torch import Tensor

from benchmarks.common.houses import ROOMS, by_rooms, kept_houses
from benchmarks.common.pages import write_arrays, write_tables
from benchmarks.common.processes import say
from benchmarks.planner import prior
from vitruvius.agent import avoidance, planner
from vitruvius.agent.banks import bank_hash
from vitruvius.agent.baselines import searcher
from vitruvius.agent.baselines.table import BASELINES
from vitruvius.agent.evaluation.episodes import reset
from vitruvius.agent.evaluation.statistics import interquartile_mean
from vitruvius.agent.evaluation.tables import Table
from vitruvius.agent.learning.config import TargetMode
from vitruvius.agent.learning.environments import make_envs, shield
from vitruvius.agent.planner import TUNED, Planner, PlannerConfig
from vitruvius.agent.policies import policies
from vitruvius.agent.policies.episodes import moments
from vitruvius.agent.policies.policies import Explorer, Policy, Tracker
from vitruvius.logic import House
from vitruvius.logic.dataset.splits import VALIDATION
from vitruvius.logic.errors import RequestError
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.config import DEFAULT
from vitruvius.sim.oracle import oracle

SEED = VALIDATION[len(VALIDATION) // 2]
"""Seed of the houses: those with r rooms have ``SEED + r``. Other studies take theirs from the range's
begin."""

THIRDS = ("first third", "second", "last")
AS_IS, ORACLE, SEARCHER = "as it is", "oracle", "searcher"

SOURCES = {ORACLE: [oracle], SEARCHER: [searcher]}
"""Modules that a baseline's score depends on besides the environments, which tests keep constant."""

PRIORS = {f"prior {what}": what for what in prior.PRIORS}
"""Explorers with a prior, by name."""


@dataclass(frozen=True)
class Explorers:
    """Evaluate the explorer, and variants of it, in houses of validation seeds."""

    targets: tuple[TargetMode, ...] = ("secondary",)
    """Place of the targets: two tables for each."""

    set: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """A variant: FIELD=NUMBER, or several separated by commas. Repeat for other variants."""

    searcher: bool = False
    """Also play the searcher, which knows the house, and where in it a target may still be."""

    prior: tyro.conf.UseAppendAction[tuple[Literal["floor", "rooms", "walls"], ...]] = ()
    """An explorer that knows from the start which unseen ground is floor; also in which rooms targets lie;
    also where walls and furniture stand. Repeat for several."""

    houses: int = 64
    """Number of houses of each number of rooms, 2 to 6."""

    episodes: int = 4
    """Number of episodes in each house, each with other targets: with one, differences below 0.01 are
    noise."""

    steps: int = DEFAULT.steps
    """Number of steps of an episode that are played."""

    world: Literal["default", "noisy"] = "default"
    """Simulator settings for explorers. Baselines, which know their pose, play in the default."""

    out: Path = Path("runs/explorers")
    """Folder for houses, scores and explorers.md."""

    replace: bool = False
    """Write into the folder even if it holds other files."""

    def run(self) -> None:
        """Play the episodes that are missing, and print the tables."""
        if min(self.houses, self.episodes) < 1 or not len(THIRDS) <= self.steps <= DEFAULT.steps:
            lengths = f"--steps {len(THIRDS)} to {DEFAULT.steps}"
            raise RequestError(f"--houses and --episodes must be 1 or more, {lengths}")
        for text in self.set:
            variant(text)
        priors = [name for name, what in PRIORS.items() if what in self.prior]
        agents = list(dict.fromkeys((AS_IS, *self.set, *priors, *[SEARCHER] * self.searcher)))
        for agent in (ORACLE, *agents):
            self.play(agent)
        rooms, page = np.array([len(house.secondary) for house in self.bank]), []
        for mode in self.targets:
            kept = {agent: np.load(self.path(mode, agent)) for agent in (ORACLE, *agents)}
            # If the oracle finds none, the score is as if it found one in all of the episodes.
            most = np.maximum(kept.pop(ORACLE)["targets"].sum(axis=0), 1 / self.episodes)
            page += sheets(mode, kept, most, rooms)
        write_tables(page, self.out / "explorers.md")

    @cached_property
    def bank(self) -> list[House]:
        """Houses, made once."""
        path = self.out / f"houses-{self.houses}.jsonl"
        return kept_houses(path, lambda: by_rooms(ROOMS, self.houses, SEED))

    def path(self, mode: str, agent: str) -> Path:
        """Return the file of an agent's results.

        It has the mean targets (3, H) of each third of an episode in each house, and the planner's
        microseconds for a step of one environment.
        """
        known, name = [bank_hash(self.bank), self.episodes, self.steps], agent
        sources = SOURCES.get(agent, [*_modules(planner), policies, avoidance])
        if agent in PRIORS:
            name, sources = agent.replace(" ", "-"), [*sources, prior]
        elif agent not in SOURCES:
            known, name = [*known, config_of(agent), agent == AS_IS, self.world], "explorer"
        key = hashlib.sha256(repr([*known, *map(inspect.getsource, sources)]).encode()).hexdigest()
        return self.out / f"{mode}-{name}-{key[:12]}.npz"

    def play(self, agent: str) -> None:
        """Play in the modes that are missing."""
        torch.set_num_threads(1)
        for mode in self.targets:
            path = self.path(mode, agent)
            if not path.exists():
                world = "default" if agent in SOURCES else self.world
                envs = make_envs(self.bank, self.episodes * len(self.bank), mode, preset=world)
                what = PRIORS.get(agent)
                tracker = prior.Informed(envs, what) if what else TimedTracker(envs.config, config_of(agent))
                policy = BASELINES[agent](envs, 0) if agent in SOURCES else explorer(envs, tracker)
                if isinstance(tracker, prior.Informed) and what == prior.WALLS:
                    episode(envs, policy, self.steps, len(self.bank))
                    tracker.remember()
                targets = episode(envs, policy, self.steps, len(self.bank))
                targets = targets.reshape(len(THIRDS), self.episodes, -1).mean(axis=1)
                write_arrays(path, targets=targets, microseconds=tracker.microseconds)
                say(f"{mode}, {agent}: {targets.sum() / len(self.bank):.2f} targets an episode")


class TimedTracker(Tracker):
    """Tracker that also records its planners' processor time, in seconds."""

    seconds: tuple[float, ...] = ()

    def look(self, observation: Tensor, blocked: Tensor) -> Planner:
        """Return the planners after the last actions."""
        began = process_time()
        found = super().look(observation, blocked)
        self.seconds += (process_time() - began,)
        return found

    @property
    def microseconds(self) -> float:
        """Time of a planner's step, without the first, which compiles; NaN without a step."""
        return 1e6 * float(np.mean(self.seconds[1:])) / len(self.actions) if self.seconds else np.nan


def variant(text: str) -> PlannerConfig:
    """Return the configuration of ``replan_interval=48,gain_most=300``; a whole number stays whole.

    Raises ``RequestError`` for an unknown field, and for a value that is no number or that no planner can
    have.
    """
    known = {field.name: field.default for field in fields(PlannerConfig) if field.type in (int, float)}
    changes = {}
    for each in text.split(","):
        name, _, value = each.strip().partition("=")
        if name not in known:
            near = get_close_matches(name, known, 1)
            raise RequestError(
                f"--set {text}: {name or 'nothing'} is not a number of PlannerConfig"
                + (f". Did you mean {near[0]}?" if near else "")
            )
        try:
            changes[name] = type(known[name])(value)
        except ValueError:
            raise RequestError(
                f"--set {text}: {name} needs a number like its default, {known[name]}, not {value!r}"
            ) from None
    try:
        return replace(TUNED, **changes)
    except ValueError as error:
        raise RequestError(f"--set {text}: {error}") from None


def config_of(agent: str) -> PlannerConfig:
    """Return the configuration of an agent's planner."""
    return TUNED if agent in (AS_IS, *SOURCES, *PRIORS) else variant(agent)


def _modules(package: ModuleType) -> list[ModuleType]:
    """Return a package and its modules."""
    names = [each.name for each in pkgutil.walk_packages(package.__path__, f"{package.__name__}.")]
    return [package, *map(importlib.import_module, names)]


def explorer(envs: HouseVectorEnv, tracker: Tracker) -> Policy:
    """Return an explorer for these environments, with the tracker that keeps its planners."""
    policy = Explorer(shield(envs), envs.config)
    policy.tracker = tracker
    return policy


def episode(envs: HouseVectorEnv, policy: Policy, steps: int, houses: int) -> np.ndarray:
    """Return the targets (3, E) that a policy picks up in each third of the steps.

    Environment i is in house i modulo ``houses``.
    """
    observation = reset(envs, 0, np.arange(envs.num_envs) % houses)
    targets = np.zeros((len(THIRDS), envs.num_envs))
    for now in moments(envs, policy, observation, steps):
        targets[len(THIRDS) * max(now.step - 1, 0) // steps] += now.reward.numpy()
    return targets


def sheets(mode: str, kept: dict, most: np.ndarray, rooms: np.ndarray) -> Iterator[Table]:
    """Yield a mode's tables of the agents' results.

    The houses have ``rooms`` (H,) rooms, and the oracle picks up ``most`` (H,) targets in them.
    """
    shares = {agent: cuts(each["targets"] / most, rooms) for agent, each in kept.items()}
    names = shares[AS_IS]
    yield Table(
        f"Share of the oracle's targets, {mode}, {len(rooms)} houses",
        ("agent", "iqm", *names, "µs of the planner"),
        [
            (
                agent,
                f"{interquartile_mean(each['mean']).value:.3f}",
                *(f"{share.mean():.3f}" for share in each.values()),
                f"{float(kept[agent]['microseconds']):.1f}".replace("nan", "-"),
            )
            for agent, each in shares.items()
        ],
    )
    if len(shares) == 1:
        return
    yield Table(
        f"The same less that of the explorer as it is, {mode}, and the difference's standard error",
        ("agent", *names),
        [
            (agent, *(difference(each[name] - names[name]) for name in names))
            for agent, each in shares.items()
            if agent != AS_IS
        ],
    )


def cuts(shares: np.ndarray, rooms: np.ndarray) -> dict[str, np.ndarray]:
    """Return the ``shares`` (3, H) of all houses, by number of ``rooms`` (H,), and in each third."""
    by_rooms = {f"{number} rooms": shares.sum(axis=0)[rooms == number] for number in np.unique(rooms)}
    return {"mean": shares.sum(axis=0)} | by_rooms | dict(zip(THIRDS, len(THIRDS) * shares, strict=True))


def difference(pairs: np.ndarray) -> str:
    """Return a mean difference over houses (H,), with its standard error."""
    return f"{pairs.mean():+.3f} ± {pairs.std() / max(len(pairs) - 1, 1) ** 0.5:.3f}"
