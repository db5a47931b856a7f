"""Value of knowing where a task puts its targets: ``vitruvius bench tasks``.

Three searchers and the explorer play the same episodes in houses of validation seeds. All searchers know the
house. ``searcher, floor`` expects a target anywhere on its free floor. ``searcher, task`` knows where the
task puts targets, and how often. ``searcher, finds`` knows a habit's shares, and learns from its finds which
region has which share. The paired difference to the first, house by house, is the value of that knowledge
before any training. Houses and scores are kept, so that a stopped run can continue.
"""

import hashlib
import inspect
import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import torch
import tyro

from benchmarks.common.houses import in_turns, kept_houses
from benchmarks.common.pages import write_arrays, write_tables
from benchmarks.common.processes import say
from benchmarks.planner.explorers import difference
from vitruvius.agent.banks import bank_hash
from vitruvius.agent.baselines import posterior, priors, searcher, view_planner
from vitruvius.agent.baselines.priors import PriorName
from vitruvius.agent.baselines.privileged import Privileged
from vitruvius.agent.baselines.searcher import Searcher
from vitruvius.agent.baselines.table import explorer, oracle
from vitruvius.agent.evaluation.episodes import EpisodeScores, play
from vitruvius.agent.evaluation.protocol import shortest_ways
from vitruvius.agent.evaluation.tables import Table
from vitruvius.agent.learning.environments import make_envs, playable
from vitruvius.agent.policies.policies import Policy
from vitruvius.logic import House
from vitruvius.logic.dataset.splits import VALIDATION
from vitruvius.logic.errors import RequestError
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.tasks import furniture as furniture_tasks
from vitruvius.sim.tasks.tasks import task

SEED = VALIDATION[len(VALIDATION) // 2] + 100
"""Seed of the houses; other studies of the planner use smaller ones."""

SIZES = {"family": range(2, 7), "home": range(4, 11)}
"""Numbers of rooms of a grammar's houses, as in its frozen bank; other grammars have those of ``family``."""

SOURCES = [searcher, posterior, priors, view_planner, furniture_tasks]
"""Modules that the scores of searchers depend on."""

FLOOR, TASK, FINDS = "searcher, floor", "searcher, task", "searcher, finds"


def searching(prior: PriorName) -> Callable[[HouseVectorEnv, int], Policy]:
    """Return a function that makes a searcher with a prior."""

    def make(envs: HouseVectorEnv, seed: int) -> Policy:
        found = Searcher(envs, prior)
        return Privileged(found.act, found.begin)

    return make


PLAYERS = {
    "oracle": oracle, FLOOR: searching("floor"), TASK: searching("task"), FINDS: searching("finds"),
    "explorer": explorer,
}  # fmt: skip


@dataclass(frozen=True)
class Tasks:
    """Evaluate searchers with and without a task's prior, and the explorer."""

    tasks: tyro.conf.UseAppendAction[tuple[str, ...]] = (
        '{"task": "object", "piece": "bed"}', "habit", "secondary",
    )  # fmt: skip
    """Tasks, by name or as JSON. Repeat for several."""

    grammars: tuple[str, ...] = ("family", "home")
    """Grammars of the houses: family with 2 to 6 rooms, home with 4 to 10."""

    houses: int = 84
    """Number of houses of a grammar, of all sizes in turn; object goal is played in those that have the
    piece."""

    episodes: int = 4
    """Number of episodes in each house."""

    out: Path = Path("runs/tasks")
    """Folder for houses, scores and tasks.md."""

    replace: bool = False
    """Write into the folder even if it holds other files."""

    def run(self) -> None:
        """Play the episodes that are missing, and print the tables."""
        if min(self.houses, self.episodes) < 1:
            raise RequestError("--houses and --episodes must be 1 or more")
        torch.set_num_threads(1)
        page = [self.sheet(name, grammar) for name in self.tasks for grammar in self.grammars]
        write_tables(page, self.out / "tasks.md")

    def bank(self, grammar: str) -> list[House]:
        """Return the houses of a grammar, made once."""
        path = self.out / f"{grammar}-{self.houses}.jsonl"
        sizes = SIZES.get(grammar, SIZES["family"])
        return kept_houses(path, lambda: in_turns(sizes, self.houses, grammar=grammar, seed=SEED))

    def sheet(self, name: str, grammar: str) -> Table:
        """Return the table of a task in a grammar's houses."""
        try:
            ends, weighted = task(name).ends_on_pick_up, hasattr(task(name), "regions")
        except ValueError as error:
            raise RequestError(str(error)) from None
        houses = playable(self.bank(grammar), name)

        @cache
        def envs() -> HouseVectorEnv:
            return make_envs(houses, len(houses) * self.episodes, name)

        numbers = np.arange(len(houses) * self.episodes) % len(houses)
        shown = [player for player in PLAYERS if player != FINDS or weighted]
        played = {player: self.play(player, name, houses, numbers, envs) for player in shown}
        most = played["oracle"][2 if ends else 0]
        rows, base = [], None
        for player, (targets, first, _) in played.items():
            found = np.where(np.isfinite(first), most / np.maximum(first, most), 0.0)
            score = (found if ends else targets).reshape(self.episodes, -1).sum(axis=0)
            score = score / (self.episodes if ends else np.maximum(most.reshape(self.episodes, -1).sum(0), 1))
            base = score if player == FLOOR else base
            steps = first[np.isfinite(first)]
            rows.append((
                player, f"{targets.mean():.2f}", f"{np.median(steps):.0f}", f"{score.mean():.3f}",
                "" if base is None or player == FLOOR else difference(score - base),
            ))  # fmt: skip
        headings = "player", "targets", "first find", "SPL" if ends else "ratio", f"less {FLOOR}"
        return Table(
            f"{name}, {grammar}, {len(houses)} houses, {self.episodes} episodes each", headings, rows
        )

    def play(
        self, player: str, name: str, houses: list[House], numbers: np.ndarray,
        envs: Callable[[], HouseVectorEnv],
    ) -> np.ndarray:  # fmt: skip
        """Return targets, steps to the first one, and the fewest steps to it, of each episode (3, E).

        Results are kept in a file.
        """
        known = [bank_hash(houses), json.dumps(name), player, len(numbers)]
        key = hashlib.sha256(repr([*known, *map(inspect.getsource, SOURCES)]).encode()).hexdigest()
        path = self.out / f"{key[:16]}.npz"
        if not path.exists():
            scores: EpisodeScores = play(envs(), PLAYERS[player](envs(), 0), 0, numbers)
            shortest = shortest_ways(envs(), 0, numbers) if player == "oracle" else scores.first
            write_arrays(path, scores=np.stack([scores.targets, scores.first, shortest]))
            say(f"{name}, {player}: {scores.targets.mean():.2f} targets an episode")
        return np.load(path)["scores"]
