"""``vitruvius bench playing``: how many steps per second agents play, with simulator, planner and network.

Some processes at once, a core and environments of its own each, play an episode in houses of ``family``; the
steps per second of all are added up. Their clocks start together, when all have compiled and made their first
steps.
"""

import os
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from statistics import median
from threading import Barrier
from time import perf_counter

import torch

from agent.evaluation.episodes import reset
from agent.learning.config import TargetMode
from agent.learning.environments import make_envs
from agent.policies.episodes import moments
from benchmarks.common.houses import ROOMS, in_turns, kept_houses
from benchmarks.common.pages import machine, table_rows, write
from benchmarks.common.processes import say
from benchmarks.planner.contenders import contender
from benchmarks.planner.explorers import SEED
from logic import load
from logic.errors import RequestError
from sim.config import DEFAULT

HOUSES = 160

WARM_UP = 9
"""Steps of an episode before the clock runs."""

PATIENCE = 600.0
"""Seconds that a process waits for the others before the clock runs."""

HEAD = """\
| agent | processes | environments each | steps per second |
|---|---|---|---|"""


@dataclass(frozen=True)
class Playing:
    """Steps per second of agents that play: simulator, planner and network."""

    agent: tuple[str, ...] = ("explorer", "map-completion")
    """A baseline, a released agent or a checkpoint, each."""

    targets: TargetMode = "secondary"
    """Where targets lie."""

    processes: int = 2
    """That play at once."""

    envs: int = 480
    """Environments of each process."""

    steps: int = DEFAULT.steps
    """Of an episode that are played."""

    rounds: int = 3
    """Of all agents, in turns; the table has their median and range."""

    out: Path = Path("runs/playing")
    """Folder for houses and playing.md."""

    replace: bool = False
    """Write into the folder whatever else it holds."""

    def run(self) -> None:
        """Measure, and print the table."""
        if min(self.processes, self.envs, self.rounds) < 1 or not WARM_UP < self.steps <= DEFAULT.steps:
            steps = f"--steps {WARM_UP + 1} to {DEFAULT.steps}"
            raise RequestError(f"--processes, --envs and --rounds must be 1 or more, {steps}")
        if self.processes > (found := len(os.sched_getaffinity(0))):
            raise RequestError(f"--processes {self.processes}: there are {found} cores, and each needs one")
        for name in self.agent:
            contender(name)
        houses = self.out / "houses.jsonl"
        kept_houses(houses, lambda: in_turns(ROOMS, HOUSES, seed=SEED))
        rates: dict[str, list[float]] = {name: [] for name in self.agent}
        for _ in range(self.rounds):
            for name in self.agent:
                rates[name].append(self.rate(name, houses))
                say(f"{name}: {rates[name][-1]:,.0f} steps per second")
        rows = (
            [
                name,
                str(self.processes),
                str(self.envs),
                f"{median(all_):,.0f} ({min(all_):,.0f} to {max(all_):,.0f})",
            ]
            for name, all_ in rates.items()
        )
        page = f"{machine()}.\n\n{HEAD}\n{table_rows(rows)}\n"
        write({"playing.md": page.encode()}, self.out)
        print(page)

    def rate(self, name: str, houses: Path) -> float:
        """Steps per second of all processes together."""
        cores = sorted(os.sched_getaffinity(0))[: self.processes]
        context = get_context("spawn")
        with context.Manager() as manager, context.Pool(self.processes) as pool:
            job = (name, houses, self.targets, self.envs, self.steps, manager.Barrier(self.processes))
            return sum(pool.starmap(rate, [(*job, core) for core in cores], chunksize=1))


def rate(
    name: str, houses: Path, targets: TargetMode, count: int, steps: int, together: Barrier, core: int
) -> float:
    """Steps per second of an agent on one core, in ``count`` environments, once all are ``together``."""
    os.sched_setaffinity(0, [core])
    torch.set_num_threads(1)
    some = load(houses)
    envs = make_envs([some[k % len(some)] for k in range(count)], count, targets)
    policy = contender(name).make(envs)
    began = 0.0
    for now in moments(envs, policy, reset(envs, 0), steps):
        if now.step == WARM_UP:
            together.wait(PATIENCE)
            began = perf_counter()
    return count * (steps - WARM_UP) / (perf_counter() - began)
