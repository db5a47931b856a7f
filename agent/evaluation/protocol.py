"""Evaluation protocol: agents and baselines play one episode in each house of a bank, in each target mode.

All policies meet the same starts and the same targets in the same order: those of house i have the seed seed
+ i.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import islice

import numpy as np
import torch

from vitruvius.agent.algorithms.build import policy_of
from vitruvius.agent.baselines.coverage import Coverage
from vitruvius.agent.baselines.table import PRIVILEGED, TRUE_PATH, baselines_of
from vitruvius.agent.evaluation.episodes import EpisodeScores, play, reset
from vitruvius.agent.evaluation.result import Result, joined
from vitruvius.agent.learning.config import TARGET_MODES
from vitruvius.agent.learning.environments import make_envs, playable
from vitruvius.agent.learning.simulator import sensor, undisturbed, with_sensor
from vitruvius.agent.policies.policies import Policy
from vitruvius.agent.progress import Report
from vitruvius.agent.runs.checkpoint import Checkpoint
from vitruvius.logic import House, RequestError
from vitruvius.logic.cluster import Cluster
from vitruvius.logic.looks.looks import looks_of
from vitruvius.logic.spelling import keywords
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.allowed import allow, allowed
from vitruvius.sim.config import PRESETS, Config
from vitruvius.sim.oracle.oracle import Oracle
from vitruvius.sim.runtime import start
from vitruvius.sim.tasks.tasks import task
from vitruvius.sim.tasks.terms import counted
from vitruvius.sim.tasks.words import in_words

PART_HOUSES = 256
"""Number of houses that are played together: all of a frozen bank; a larger bank is played in parts."""


@dataclass(frozen=True)
class EvaluationPart:
    """Episodes that all policies play in a mode in some houses of a bank, in one process: see ``measure``."""

    agents: Mapping[str, Sequence[Checkpoint]]
    houses: Sequence[House]
    mode: str
    words: str
    """Mode in words."""
    seed: int
    """Seed of the first episode."""
    backend: str
    baselines: Sequence[str]
    world: str
    episodes: int
    allow: tuple[str, ...] = field(default_factory=allowed)
    """Classes that text may name in the process that plays the episodes, which may be another process."""


@keywords(targets="modes", preset="agents")
def measure(
    agents: Mapping[str, Sequence[Checkpoint]],
    houses: Sequence[House],
    modes: Sequence[str] = TARGET_MODES,
    seed: int = 0,
    report: Report = lambda done, words: None,
    *,
    backend: str = "continuous",
    baselines: Sequence[str] | None = None,
    world: str = "default",
    episodes: int = 1,
    cluster: Cluster | None = None,
) -> Iterator[Result]:
    """Yield the result of each mode: the scores of agents and baselines in the houses of a bank.

    ``agents`` has the training runs of each agent, by name. ``baselines`` names some of ``BASELINES``, by
    default all; the oracle must be among them, because figures are shares of the oracle's. In the backend
    ``free``, ``baselines`` names some of ``DRIVING_BASELINES``, and figures are shares of the true path's.
    ``world`` names the simulator's preset for all policies. Each policy keeps its own sensor; the policies
    that know their pose (searcher, oracle, true path) play without noise and slips. ``episodes`` is the
    number of episodes in each house in which the task can be played (``environments.playable``). A
    ``cluster`` plays parts of ``PART_HOUSES`` as its tasks, with the same figures. ``report`` receives the
    progress.

    Raises ``HouseFileError`` if a mode cannot be played in one of the houses, or if a house has too many
    corners for the true path. Raises ``RequestError`` for an agent whose kind of motion or whose drive limits
    differ from the baselines'. Raises the errors of ``Cluster.each``.
    """
    names = tuple(baselines_of(backend) if baselines is None else baselines)
    require_motion(agents, backend)
    if backend == "free":
        require_drive(agents, with_sensor(PRESETS[world]), world)
    parts, numbers = list[EvaluationPart](), list[int]()
    for mode in modes:
        suited = playable(houses, mode, backend=backend)
        words = in_words(mode, looks_of(suited[0]).name)
        firsts = range(0, len(suited), PART_HOUSES)
        for first in firsts:
            some, begins = suited[first : first + PART_HOUSES], seed + first * episodes
            parts.append(EvaluationPart(agents, some, mode, words, begins, backend, names, world, episodes))
        numbers.append(len(firsts))
    found = _on_cluster(parts, report, cluster) if cluster else _here(parts, report)
    for number in numbers:
        yield joined(list(islice(found, number)))
    report(1.0, f"{len(houses)} houses")


def _here(parts: Sequence[EvaluationPart], report: Report) -> Iterator[Result]:
    for number, part in enumerate(parts):
        yield played(part, lambda done, words, number=number: report((number + done) / len(parts), words))


def _on_cluster(parts: Sequence[EvaluationPart], report: Report, cluster: Cluster) -> Iterator[Result]:
    found = dict[int, Result]()
    for place, result in cluster.each(_as_task, parts):
        found[place] = result
        report(len(found) / len(parts), parts[place].words)
    yield from (found[place] for place in range(len(parts)))


def _as_task(part: EvaluationPart) -> Result:
    """Play a part as a task of a cluster, on one processor."""
    start(threads=1)
    torch.set_num_threads(1)
    return played(part)


def played(part: EvaluationPart, report: Report = lambda done, words: None) -> Result:
    """Return the result of all policies in a part of a bank."""
    allow(*part.allow)
    agents, houses, mode, seed, world = part.agents, part.houses, part.mode, part.seed, part.world
    drives = part.backend == "free"
    known = baselines_of(part.backend)
    baseline = with_sensor(PRESETS[world])
    exact = undisturbed(baseline)
    numbers = np.arange(len(houses) * part.episodes) % len(houses)
    sensors = {baseline, exact, *(sensor(run.config, world) for runs in agents.values() for run in runs)}
    settings = {each: Setting(houses, mode, each, part.backend, len(numbers)) for each in sensors}
    policies: list[tuple[str, Setting, Callable[[HouseVectorEnv, int], Policy]]] = [
        (name, settings[sensor(run.config, world)], partial(policy_of, run.network, run.config))
        for name, runs in agents.items()
        for run in runs
    ]
    policies += [
        (name, settings[exact if name in PRIVILEGED else baseline], known[name]) for name in part.baselines
    ]
    players = ((name, setting, make(setting.envs, seed)) for name, setting, make in policies)
    if drives:  # find a house with too many corners before anything plays
        players = iter(list(players))
    scores: dict[str, tuple[EpisodeScores, ...]] = {}
    for place, (name, setting, policy) in enumerate(players):
        report(place / len(policies), f"{part.words}: {name}")
        played = play(setting.envs, policy, seed, numbers, setting.coverage)
        scores[name] = (*scores.get(name, ()), played)
    rooms = np.array([len(house.secondary) for house in houses])[numbers]
    shortest = scores[TRUE_PATH][0].first if drives else shortest_ways(settings[exact].envs, seed, numbers)
    ends = task(mode).ends_on_pick_up
    return Result(mode, rooms, shortest, scores, part.episodes, baseline.steps, ends, part.words)


def require_motion(agents: Mapping[str, Sequence[Checkpoint]], backend: str) -> None:
    """Raise ``RequestError`` for an agent that drives in a backend of steps, and for the opposite case."""
    for name, runs in agents.items():
        drives = runs[0].config.backend == "free"
        if drives and backend != "free":
            raise RequestError(f"{name} drives: add --backend free")
        if backend == "free" and not drives:
            raise RequestError(f"{name} moves on a lattice and cannot run with --backend free")


def require_drive(agents: Mapping[str, Sequence[Checkpoint]], baseline: Config, world: str) -> None:
    """Raise ``RequestError`` for an agent whose drive limits differ from the baselines'.

    The true path would not be the shortest path of such an agent.
    """
    for name, runs in agents.items():
        for run in runs:
            if replace(sensor(run.config, world).drive, commands=()) != baseline.drive:
                what = "its speed limits differ from the baselines': only the commands may differ"
                raise RequestError(f"{name}: drive: {what}")


def shortest_ways(envs: HouseVectorEnv, seed: int, houses: np.ndarray | None = None) -> np.ndarray:
    """Return the fewest steps (E,) from each start to the first target; infinite without a path."""
    reset(envs, seed, houses)
    return np.array([np.inf if way is None else len(way) for way in Oracle(envs).paths()])


class Setting:
    """Environments of one sensor, one for each episode, and their coverage.

    Both are made on first use: most evaluations need one sensor alone.
    """

    def __init__(
        self, houses: Sequence[House], mode: str, sensor: Config, backend: str, count: int | None = None
    ) -> None:
        """Set up ``count`` environments over these houses, or one for each, with targets of this mode."""
        wanted = counted(task(mode))  # a score counts pick-ups, whatever a task rewards
        self._make = partial(make_envs, houses, count or len(houses), wanted, preset=sensor, backend=backend)

    @cached_property
    def envs(self) -> HouseVectorEnv:
        """Environments of the setting."""
        return self._make()

    @cached_property
    def coverage(self) -> Coverage:
        """Coverage of each house by its body."""
        return Coverage(self.envs)


def tasks_of(agents: Mapping[str, Sequence[Checkpoint]]) -> tuple[str, ...]:
    """Return the tasks that these agents are evaluated on by default.

    Agents that read maps know only the task they were trained on: those tasks are returned if there are any.
    Otherwise the result is all target modes.
    """
    runs = [run.config for each in agents.values() for run in each]
    learnt = {config.targets: None for config in runs if config.reads_maps}
    return tuple(learnt) or TARGET_MODES
