"""``vitruvius bench phases``: where the steps of an episode go.

For agents, the explorer and the searcher: the share of their steps of each phase (see ``account.py``), in all
houses and by size, with what a target costs in steps of each; and where targets come into sight. What is
played is kept, policy by policy, so that a run that was stopped goes on.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import torch
import tyro

from agent.algorithms.build import policy_of
from agent.banks import NAME, bank_hash, named
from agent.evaluation.baselines import BASELINES
from agent.evaluation.tables import Table
from agent.learning.config import TargetMode
from agent.learning.environments import make_envs
from agent.policies.policies import Policy
from agent.runs import checkpoint
from benchmarks.agents.account import PHASES, StepAccount, follow
from benchmarks.agents.kept import code, fingerprint
from benchmarks.common.pages import write_arrays, write_tables

BESIDE = ("explorer", "searcher", "oracle")
"""Baselines in the tables."""


@dataclass(frozen=True)
class Phases:
    """Account for the steps of agents and baselines, one episode in each house."""

    agents: tyro.conf.Positional[tuple[Path, ...]] = ()
    """Checkpoints, or names of agents that come with the project, of the default world. None: explorer,
    searcher and oracle alone."""

    houses: Path = Path(NAME)
    """House file, or a frozen bank, such as test-v1 or home-test-v1."""

    targets: TargetMode = "secondary"
    """Where targets lie."""

    seed: int = 0
    """Seeds starts and targets."""

    out: Path = Path("runs/phases")
    """Folder for what was played, and phases.md."""

    replace: bool = False
    """Write into the folder whatever else it holds."""

    def run(self) -> None:
        """Play and print."""
        torch.set_num_threads(1)
        houses = named(self.houses)
        envs = make_envs(houses, len(houses), self.targets)
        makers: dict[str, tuple[str, Callable[[], Policy]]] = {}
        for path in self.agents:
            found = checkpoint.load(path)
            make = partial(policy_of, found.network, found.config, envs, self.seed)
            makers[found.name] = fingerprint(found), make
        for name in BESIDE:
            makers[name] = name, partial(BASELINES[name], envs, self.seed)
        accounts = {}
        setting = f"{self.targets}-{self.seed}-{bank_hash(houses)[:8]}-{code()}"
        for name, (key, make) in makers.items():
            path = self.out / f"{key[:8]}-{setting}.npz"
            if not path.exists():
                write_arrays(path, **vars(follow(envs, make(), self.seed)))
            accounts[name] = StepAccount(**np.load(path))
        rooms = np.array([len(house.secondary) for house in houses])
        write_tables(sheets(accounts, rooms), self.out / "phases.md")


def sheets(accounts: dict[str, StepAccount], rooms: np.ndarray) -> Iterator[Table]:
    """The tables, for houses with these numbers of ``rooms`` (H,)."""
    where = f"{len(rooms)} houses"
    yield Table(
        f"Share of steps by phase, {where}",
        ("agent or baseline", *PHASES, "turns", "blocked"),
        [(name, *percents(each)) for name, each in accounts.items()],
    )
    yield Table(
        f"Steps of each phase for a target picked up, {where}",
        ("agent or baseline", *PHASES, "all"),
        [(name, *costs(each)) for name, each in accounts.items()],
    )
    yield Table(
        f"Targets picked up, by the phase in which a ray first met them, {where}",
        ("agent or baseline", "at once", *PHASES[1:], "targets an episode"),
        [
            (name, *shares(each.sighted.sum(axis=0)), f"{each.sighted.sum() / len(rooms):.2f}")
            for name, each in accounts.items()
        ],
    )
    for number in np.unique(rooms):
        yield Table(
            f"Share of steps by phase, {number} rooms, {(rooms == number).sum()} houses",
            ("agent or baseline", *PHASES, "turns", "blocked"),
            [(name, *percents(each.of(rooms == number))) for name, each in accounts.items()],
        )


def percents(account: StepAccount) -> tuple[str, ...]:
    """The share of steps of each phase, of turns and of blocked moves."""
    beside = [each.sum() / account.steps.sum() for each in (account.turning, account.blocked)]
    return *shares(account.steps.sum(axis=0)), *(f"{share:.1%}" for share in beside)


def costs(account: StepAccount) -> tuple[str, ...]:
    """How many steps of each phase, and of all, were made for a target."""
    steps = account.steps.sum(axis=0)
    return tuple(f"{count / max(account.sighted.sum(), 1):.1f}" for count in (*steps, steps.sum()))


def shares(counts: np.ndarray) -> tuple[str, ...]:
    """Each count's share in all, in per cent."""
    return tuple(f"{count / max(counts.sum(), 1):.1%}" for count in counts)
