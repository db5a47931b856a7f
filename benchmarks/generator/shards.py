"""``vitruvius bench shards``: a set of houses that is killed again and again, beside one that is not."""

import hashlib
import json
import random
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from logic.dataset.sets import read_manifest
from logic.errors import VitruviusError
from logic.house.files import write_whole
from logic.terminal import say


class NotMade(VitruviusError):
    """The command that makes a set ended in an error."""

    exit_code = 1


@dataclass(frozen=True)
class Shards:
    """Make a set of houses twice, once under kills at random moments, and compare every file."""

    grammar: str = "home"
    """A shipped grammar's name, or a directory of rules."""

    rooms: int = 6
    """Rooms of each house."""

    houses: int = 100_000
    """How many."""

    shards: int = 400
    """In how many files."""

    workers: int = 2
    """Solver processes."""

    kills: int = 20
    """How often it is killed."""

    seed: int = 0
    """Of the moments."""

    out: Path = Path("runs/shards")
    """Folder for both sets, shards.md and shards.json."""

    replace: bool = False
    """Write beside files that no study wrote."""

    def run(self) -> int:
        """Write the figures; 1 where a file differs."""
        undisturbed, killed = self.out / "undisturbed", self.out / "killed"
        took = finished(self, undisturbed)
        kills = self._killed(killed, took)
        resumed = finished(self, killed)
        same = content(undisturbed) == content(killed)
        manifest = read_manifest(undisturbed)
        assert manifest
        figures = {
            "grammar": self.grammar,
            "rooms": self.rooms,
            "houses": manifest.houses,
            "limits": manifest.limits,
            "shards": self.shards,
            "workers": self.workers,
            "kills": kills,
            "seconds": round(took, 1),
            "houses_a_second": round(self.houses / took, 1),
            "bytes_a_house": round(sum(each.bytes for each in manifest.shards) / self.houses),
            "seconds_after_the_last_kill": round(resumed, 1),
            "same_bytes": same,
        }
        table = "\n".join(f"| {name.replace('_', ' ')} | {value} |" for name, value in figures.items())
        write_whole(self.out / "shards.json", json.dumps(figures, indent=2).encode() + b"\n")
        write_whole(self.out / "shards.md", f"# A set under kills\n\n| | |\n|---|---|\n{table}\n".encode())
        print(self.out / "shards.md")
        return 0 if same else 1

    def _killed(self, folder: Path, took: float) -> int:
        """Kill what makes a set, each time after some of the seconds that it takes; how often."""
        moments, kills = random.Random(self.seed), 0
        while kills < self.kills and read_manifest(folder) is None:
            process = start(self, folder)
            time.sleep(2 + moments.uniform(0, 2 * took / self.kills))
            if process.poll() is None:
                kills += 1
                say(f"{folder}: kill {kills}")
            process.kill()
            process.wait()
        return kills


def start(study: Any, folder: Path, *words: str) -> "subprocess.Popen[bytes]":
    """The command that makes a set, as the options of a study say."""
    asked = f"generate --rooms {study.rooms} --count {study.houses} --shard all/{study.shards}"
    asked = [*asked.split(), "--workers", str(study.workers), "--grammar", study.grammar, *words]
    command = [sys.executable, "-m", "vitruvius.cli", *asked, "--out", str(folder)]
    return subprocess.Popen(command, stderr=subprocess.DEVNULL)


def finished(study: Any, folder: Path, *words: str) -> float:
    """Make what is missing of a set; the seconds."""
    began = time.monotonic()
    if code := start(study, folder, *words).wait():
        raise NotMade(f"{folder}: the command that makes it ended with exit code {code}")
    return time.monotonic() - began


def content(folder: Path) -> dict[str, str]:
    """The hash of each file in a folder."""
    files = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}
