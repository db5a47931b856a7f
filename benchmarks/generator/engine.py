"""``vitruvius bench engine``: shards as tasks of Ray, beside plain workers on the same processors."""

import json
import shutil
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

from benchmarks.common.pages import machine
from benchmarks.generator.shards import content, finished
from logic.dataset.sets import DATA
from logic.errors import RequestError
from logic.house.files import write_whole
from logic.terminal import say

KINDS = {"plain": (), "ray": ("--engine", "ray")}
"""The commands, by what they add."""


@dataclass(frozen=True)
class Engine:
    """Make a set by plain workers and by Ray, in turn, and compare houses a second and every file."""

    grammar: str = "family"
    """A shipped grammar's name, or a directory of rules."""

    rooms: int = 4
    """Rooms of each house."""

    houses: int = 2000
    """How many."""

    shards: int = 40
    """In how many files, 20 or more."""

    workers: int = 2
    """Solver processes."""

    pairs: int = 5
    """How often each makes the set."""

    out: Path = Path("runs/engine")
    """Folder for both sets, engine.md and engine.json."""

    replace: bool = False
    """Write beside files that no study wrote."""

    def run(self) -> int:
        """Write the figures; 1 where a file differs."""
        if self.shards < 20 or self.pairs < 1:
            raise RequestError("--shards must be 20 or more, --pairs 1 or more")
        pairs = list[dict[str, Any]]()
        same = True
        for turn in range(self.pairs):
            order = [*KINDS] if turn % 2 == 0 else [*reversed(KINDS)]
            pair = {kind: self._measured(kind) for kind in order}
            same &= content(self.out / "plain") == content(self.out / "ray")
            pairs.append(pair)
            say(f"pair {turn + 1}: {json.dumps(pair)}")
        at_work, whole = (
            [pair["ray"][rate] / pair["plain"][rate] for pair in pairs]
            for rate in ("at_work", "houses_a_second")
        )
        figures = {
            "machine": machine(),
            "houses": f"{self.houses} of {self.grammar}, {self.rooms} rooms, in {self.shards} shards",
            "workers": self.workers,
            "pairs": pairs,
            "ray_of_plain_at_work": _spread(at_work),
            "ray_of_plain_whole_command": _spread(whole),
            "seconds_more_of_the_command": _spread(
                [pair["ray"]["beside"] - pair["plain"]["beside"] for pair in pairs]
            ),
            "same_bytes": same,
        }
        shown = {name: value for name, value in figures.items() if name not in {"pairs", "machine"}}
        table = "\n".join(f"| {name.replace('_', ' ')} | {value} |" for name, value in shown.items())
        write_whole(self.out / "engine.json", json.dumps(figures, indent=2).encode() + b"\n")
        write_whole(
            self.out / "engine.md", f"# Ray beside plain workers\n\n| | |\n|---|---|\n{table}\n".encode()
        )
        print(self.out / "engine.md")
        return 0 if same else 1

    def _measured(self, kind: str) -> dict[str, float]:
        """Houses a second of the whole command and while shards are made, and its seconds beside that.

        The latter rate is between the first and the last tenth of the shards, by the times of their files.
        """
        folder = self.out / kind
        shutil.rmtree(folder, ignore_errors=True)
        took = finished(self, folder, *KINDS[kind])
        written = sorted(path.stat().st_mtime for path in (folder / DATA).iterdir())
        few, size = self.shards // 10, self.houses / self.shards
        rate = (self.shards - 2 * few) * size / (written[-few - 1] - written[few - 1])
        found = {"houses_a_second": self.houses / took, "at_work": rate, "beside": took - self.houses / rate}
        return {name: round(value, 2) for name, value in found.items()}


def _spread(values: list[float]) -> str:
    """The median, with the least and the most."""
    return f"{median(values):.2f} ({min(values):.2f} to {max(values):.2f})"
