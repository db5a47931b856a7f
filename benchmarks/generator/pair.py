"""``vitruvius bench pair``: the CPU time of a house by two checkouts, in turn on one machine."""

import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from logic.errors import RequestError

HERE = Path(__file__).parents[2]


@dataclass(frozen=True)
class Pair:
    """The CPU time of the same houses by two checkouts, house by house in turn; a machine's speed swings."""

    beside: Path | None = None
    """Another checkout, such as `git worktree add DIR REVISION` makes. By default this one: the noise."""

    grammar: str = "family"
    """A shipped grammar's name."""

    rooms: tuple[int, ...] = (1, 2, 3, 4, 8, 16)
    """Numbers of secondary rooms."""

    houses: int = 300
    """Houses of each number of rooms."""

    rounds: int = 3
    """How often each house is made: the least time counts, since other work on a machine only adds to it."""

    def run(self) -> None:
        """Measure, and print a table."""
        beside = (self.beside or HERE).resolve()
        if not (beside / "logic" / "builder.py").exists():
            raise RequestError(f"--beside {beside}: no checkout of Vitruvius is there")
        if self.houses < 2 or self.rounds < 1 or not self.rooms or min(self.rooms) < 1:
            raise RequestError("--houses needs 2 or more; --rounds and each of --rooms 1 or more")
        makers = [CheckoutProcess(beside, self.grammar), CheckoutProcess(HERE, self.grammar)]
        print("| rooms | mean, ms: beside | here | ratio | p95/median: beside | here |")
        print("|---|---|---|---|---|---|")
        for rooms in self.rooms:
            for maker in makers:
                for index in range(30):
                    maker.seconds(rooms, 1, index)
            times = np.full((2, self.houses), np.inf)
            for _ in range(self.rounds):
                for index in range(self.houses):
                    for which, maker in enumerate(makers):
                        times[which, index] = min(times[which, index], maker.seconds(rooms, 0, index))
            (before, after), tails = 1e3 * times.mean(axis=1), np.percentile(times, 95, axis=1)
            first, second = tails / np.median(times, axis=1)
            cells = f"{before:.2f} | {after:.2f} | {after / before:.2f} | {first:.2f} | {second:.2f}"
            print(f"| {rooms} | {cells} |", flush=True)
        for maker in makers:
            maker.end()


class CheckoutProcess:
    """A process that makes houses by one checkout."""

    def __init__(self, checkout: Path, grammar: str) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-P", str(Path(__file__).with_name("timed_houses.py")), grammar],
            env=os.environ | {"PYTHONPATH": str(checkout)},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def seconds(self, rooms: int, seed: int, index: int) -> float:
        """CPU time of one house."""
        assert self._process.stdin
        assert self._process.stdout
        self._process.stdin.write(json.dumps([rooms, seed, index]) + "\n")
        self._process.stdin.flush()
        return float(self._process.stdout.readline())

    def end(self) -> None:
        """Let it end."""
        self._process.communicate()
