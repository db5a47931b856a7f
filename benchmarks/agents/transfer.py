"""``vitruvius bench transfer``: scores of agents in houses of other kinds than those they learnt in.

Agents learn nothing during the study. Results are kept for each bank, so that a stopped study can continue.
"""

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
import tyro

from benchmarks.agents.kept import code, fingerprint
from benchmarks.common.houses import in_turns, kept_houses
from benchmarks.common.pages import ROOT, write_tables
from vitruvius.agent.banks import bank_hash
from vitruvius.agent.evaluation import scores
from vitruvius.agent.evaluation.protocol import measure
from vitruvius.agent.evaluation.statistics import Estimate
from vitruvius.agent.evaluation.tables import Table
from vitruvius.agent.learning.config import TargetMode
from vitruvius.agent.planner import TUNED, Planner
from vitruvius.agent.runs import checkpoint
from vitruvius.agent.runs.checkpoint import Checkpoint
from vitruvius.logic import House, load
from vitruvius.logic.dataset.splits import VALIDATION
from vitruvius.logic.files.writing import write_whole
from vitruvius.sim.config import DEFAULT

ORIGINAL = ROOT / "tests/fixtures/example1.json"
"""House of the original program; the study leaves it out if the file is missing."""

BESIDE = ("explorer", "searcher")
"""Baselines in the table."""


@dataclass(frozen=True)
class HouseKind:
    """Kind of houses: its title, its request, and the backend that simulates it."""

    title: str
    rooms: tuple[int, ...] = (2, 3, 4, 5, 6)
    count: int = 64
    grammar: str = "family"
    cell: float = 0.0
    backend: str = "continuous"

    def houses(self) -> list[House]:
        """Return houses, as many with each number of rooms, in turns.

        Their seed is reserved for validation.
        """
        return in_turns(self.rooms, self.count, grammar=self.grammar, cell=self.cell, seed=VALIDATION.start)


BANKS = {
    "family": HouseKind("`family`, 2 to 6 rooms, as learnt"),
    "paper": HouseKind("`paper`, 2 to 6 rooms", grammar="paper"),
    "on-a-grid": HouseKind("`family`, edges on a grid of 0.3 m", cell=0.3),
    "by-cells": HouseKind("the same, moved and seen cell by cell", cell=0.3, backend="grid"),
    "twelve": HouseKind("`family`, 12 rooms", rooms=(12,), count=32),
}


@dataclass(frozen=True)
class Transfer:
    """Evaluate agents on banks that they did not learn in; explorer and searcher are the baselines."""

    agents: tyro.conf.Positional[tuple[Path, ...]] = ()
    """Checkpoints, or names of released agents. By default only the explorer and the searcher play."""

    targets: tyro.conf.UseAppendAction[tuple[TargetMode, ...]] = ()
    """Place of the targets; by default secondary rooms. Repeat for several."""

    banks: tuple[str, ...] = (*BANKS, "original")
    """Banks to evaluate on."""

    out: Path = Path("runs/transfer")
    """Folder for houses, figures and transfer.md."""

    replace: bool = False
    """Write into the folder even if it holds other files."""

    def run(self) -> None:
        """Run the evaluations that are missing, and print the tables."""
        torch.set_num_threads(1)
        agents: dict[str, list[Checkpoint]] = {}
        for path in self.agents:
            found = checkpoint.load(path)
            agents.setdefault(found.name, []).append(found)
        modes = self.targets or ("secondary",)
        write_tables([self.sheet(agents, mode) for mode in modes], self.out / "transfer.md")

    def sheet(self, agents: dict[str, list[Checkpoint]], mode: TargetMode) -> Table:
        """Return the table of a target mode."""
        rows = []
        for name in self.banks:
            if (houses := self.bank(name)) is None:
                continue
            policies = self.measured(agents, name, houses, mode).policies
            ratios = [Estimate(**policies[policy].figures["ratio"]) for policy in (*agents, *BESIDE)]
            title = BANKS[name].title if name in BANKS else f"the original's house, {len(houses)} episodes"
            rows.append(
                (
                    title,
                    f"{len({id(house) for house in houses})}",
                    f"{wider(houses):.0%}",
                    f"{policies['oracle'].figures['targets']['value']:.1f}",
                    *(ratio.text() for ratio in ratios),
                )
            )
            print(f"{mode}, {title}: done", flush=True)
        headings = ("houses", "number", f"wider than {map_width():.1f} m", "oracle", *agents, *BESIDE)
        return Table(f"Ratio to the oracle, {mode}", headings, rows)

    def bank(self, name: str) -> list[House] | None:
        """Return the houses of a bank, made once; None if the original program's house is missing."""
        if name == "original":  # starts and targets differ from episode to episode
            return list(load(ORIGINAL)) * 64 if ORIGINAL.exists() else None
        kind = BANKS[name]
        path = self.out / f"{kind.grammar}-{kind.rooms[0]}-{kind.rooms[-1]}-{kind.cell}.jsonl"
        return kept_houses(path, kind.houses)

    def measured(
        self, agents: dict[str, list[Checkpoint]], name: str, houses: list[House], mode: TargetMode
    ) -> scores.ModeScores:
        """Return the figures of all policies in a bank, from the file of an earlier run if it exists."""
        key = json.dumps([code(), *(fingerprint(each) for runs in agents.values() for each in runs)])
        path = self.out / f"{name}-{mode}-{hashlib.sha256(key.encode()).hexdigest()[:8]}.json"
        if not path.exists():
            backend = BANKS[name].backend if name in BANKS else "continuous"
            result = next(measure(agents, houses, (mode,), backend=backend))
            bank = scores.ScoredBank(bank_hash(houses))
            write_whole(path, scores.ScoreFile(bank, 0, scores.modes_of([result]), backend).json())
        return scores.load(path).targets[mode]


def wider(houses: list[House]) -> float:
    """Return the fraction of the houses that are wider than an agent's map.

    The map is a torus, so the far ends of such a house overlap.
    """
    boxes = [np.array([room.box for room in house.rooms]) for house in houses]
    across = [(box[:, 2:].max(axis=0) - box[:, :2].min(axis=0)).max() for box in boxes]
    return float((np.array(across) > map_width()).mean())


def map_width() -> float:
    """Return the circumference of an agent's map, in metres."""
    return Planner(DEFAULT, 1).cell * 2**TUNED.map_bits
