"""``vitruvius bench shards``: a set of houses made under many kills, compared with one made without."""

import hashlib
import json
import random
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from benchmarks.generator.killing import Plain, victims
from vitruvius.logic.dataset.sets import files_of_shards, read_manifest
from vitruvius.logic.errors import RequestError, VitruviusError
from vitruvius.logic.files.writing import write_whole
from vitruvius.logic.terminal import say


class NotMade(VitruviusError):
    """The command that makes a set ended in an error."""

    exit_code = 1


@dataclass(frozen=True)
class Shards:
    """Make a set of houses under random kills, and all or a part of it without, and compare every file."""

    grammar: str = "home"
    """Name of a shipped grammar, or a directory of rules."""

    rooms: int = 6
    """Number of rooms of each house."""

    houses: int = 100_000
    """Number of houses."""

    shards: int = 400
    """Number of files."""

    workers: int = 2
    """Number of solver processes; with --engine, of nodes of one processor each."""

    kills: int = 20
    """Number of kills: in turn of the command and of one of its solver processes; with --engine also of a
    node's raylet."""

    engine: Literal["ray"] | None = None
    """Make the killed set by Ray, on a cluster of this machine."""

    undisturbed: float = 1.0
    """Fraction of the shards that plain workers also make without kills: 1 for the whole set, or less for
    random shards."""

    seed: int = 0
    """Seed of the moments, of the kinds of kills, and of the shards that are made without kills."""

    out: Path = Path("runs/shards")
    """Folder for both sets, shards.md and shards.json."""

    replace: bool = False
    """Write into the folder even if it holds other files."""

    def run(self) -> int:
        """Write the figures, and return 1 if a file differs."""
        if not 0 <= self.kills < self.shards:
            raise RequestError("--kills must be fewer than --shards")
        if not 0 < self.undisturbed <= 1:
            raise RequestError("--undisturbed must be more than 0 and at most 1")
        killed, beside = self.out / "killed", self.out / "undisturbed"
        with victims(self.engine, self.workers) as found:
            began = time.monotonic()
            kills, last = self._killed(killed, found)
            took = time.monotonic() - began
        manifest = read_manifest(killed)
        assert manifest
        shards, alone = self._undisturbed(beside)
        rows = sum(manifest.shards[shard].rows for shard in shards)
        one, other = content(killed), content(beside)
        same = one == other if len(shards) == self.shards else other.items() <= one.items()
        figures = {
            "grammar": self.grammar,
            "rooms": self.rooms,
            "houses": manifest.houses,
            "limits": manifest.limits,
            "shards": self.shards,
            "workers": self.workers,
            "engine": self.engine or "none",
            "kills": kills,
            "seconds_under_kills": round(took, 1),
            "seconds_after_the_last_kill": round(last, 1),
            "undisturbed_shards": len(shards),
            "undisturbed_houses": rows,
            "undisturbed_seconds": round(alone, 1),
            "bytes_a_house": round(sum(each.bytes for each in manifest.shards) / self.houses),
            "same_bytes": same,
        }
        table = "\n".join(f"| {name.replace('_', ' ')} | {value} |" for name, value in figures.items())
        write_whole(self.out / "shards.json", json.dumps(figures, indent=2).encode() + b"\n")
        write_whole(self.out / "shards.md", f"# A set under kills\n\n| | |\n|---|---|\n{table}\n".encode())
        print(self.out / "shards.md")
        return 0 if same else 1

    def _killed(self, folder: Path, found: Plain) -> tuple[dict[str, int], float]:
        """Make a set under kills. Return the number of kills of each kind, and the seconds after the last.

        Each kill happens after some number of shards, and a random fraction of a shard's time later.
        """
        moments, kills = random.Random(self.seed), dict.fromkeys(found.kinds, 0)
        last = time.monotonic()
        process = start(self, folder, *found.words)
        try:
            for number, made in enumerate(sorted(moments.sample(range(self.shards), self.kills))):
                kind = found.kinds[number % len(found.kinds)]
                while process.poll() is None and _made(folder) < made:
                    time.sleep(0.05)
                time.sleep(moments.uniform(0, _last_took(folder)))
                while process.poll() is None and not found.kill(kind, process.pid, moments):
                    time.sleep(0.05)
                if process.poll() in (None, -signal.SIGKILL):
                    kills[kind], last = kills[kind] + 1, time.monotonic()
                    say(f"{folder}: {_made(folder)} shards of {self.shards}, {kind} killed")
                if kind == "driver":
                    process.wait()
                    process = start(self, folder, *found.words)
            if code := process.wait():
                raise NotMade(f"{folder}: the command that makes it ended with exit code {code}")
        finally:
            process.kill()
        return kills, time.monotonic() - last

    def _undisturbed(self, folder: Path) -> tuple[list[int], float]:
        """Make the set, or some of its shards, without kills.

        Return the numbers of the shards, and the seconds.
        """
        if self.undisturbed == 1:
            return [*range(self.shards)], finished(self, folder)
        number = max(1, round(self.undisturbed * self.shards))
        shards = sorted(random.Random(self.seed).sample(range(self.shards), number))
        return shards, sum(finished(self, folder, shard=shard) for shard in shards)


def start(
    study: Any, folder: Path, *words: str, shard: int | Literal["all"] = "all"
) -> "subprocess.Popen[bytes]":
    """Start the command that makes a set, or a shard of it, with the options of a study."""
    asked = f"generate --rooms {study.rooms} --count {study.houses} --shard {shard}/{study.shards}"
    asked = [*asked.split(), "--workers", str(study.workers), "--grammar", study.grammar, *words]
    command = [sys.executable, "-m", "vitruvius.cli", *asked, "--out", str(folder)]
    return subprocess.Popen(command, stderr=subprocess.DEVNULL)


def finished(study: Any, folder: Path, *words: str, shard: int | Literal["all"] = "all") -> float:
    """Make the missing parts of a set, or of a shard. Return the seconds."""
    began = time.monotonic()
    if code := start(study, folder, *words, shard=shard).wait():
        raise NotMade(f"{folder}: the command that makes it ended with exit code {code}")
    return time.monotonic() - began


def content(folder: Path) -> dict[str, str]:
    """Return the hash of each file in a folder."""
    files = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def _made(folder: Path) -> int:
    """Return the number of shards in a set's folder."""
    return sum(1 for _ in files_of_shards(folder))


def _last_took(folder: Path) -> float:
    """Return the seconds between the last two shards."""
    times = sorted(path.stat().st_mtime for path in files_of_shards(folder))
    return times[-1] - times[-2] if times[1:] else 0
