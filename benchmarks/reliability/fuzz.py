"""``vitruvius bench fuzz``: every reader of files of others, with contents that are changed at random.

A reader has a value or an error of ours, in one line, within seconds and memory. All else is a failure, whose
content is kept. Contents are led by coverage where atheris is installed (``pip install atheris``), else they
are changed blindly.
"""

import json
import os
import random
import resource
import shutil
import subprocess
import sys
import time
import traceback
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass, field
from hashlib import sha256
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from benchmarks.reliability.random_changes import MOST_BYTES, changed
from benchmarks.reliability.readers import READERS, answer, begin, scratch

SECONDS = 10
"""For an answer: it takes some thousandths, but the machine may be busy."""

MEMORY_MIB = 2048
"""Of the process that answers."""

MOST_FAILURES = 40
"""Kinds of failures of a reader that are kept."""

PACKAGES = ["agent", "logic", "sim", "vitruvius", "yaml", "tomllib", "zipfile"]
"""Their branches lead atheris."""

EVERY_S = 2.0
"""Seconds between notes of how far a process is."""


@dataclass
class FuzzFigures:
    """The answers to the contents of a reader."""

    runs: int = 0
    seconds: float = 0.0
    answers: Counter[str] = field(default_factory=Counter)
    slowest: float = 0.0
    """Seconds of processor time of the slowest answer."""
    memory: int = 0
    """MiB, of the process that answers."""
    failures: dict[str, str] = field(default_factory=dict)
    """By kind of error and place: the file that keeps the content."""

    def __str__(self) -> str:
        """In a line."""
        answers = ", ".join(f"{number:,} {name}" for name, number in sorted(self.answers.items()))
        most = f"slowest {self.slowest:.2f} s, {self.memory} MiB"
        return f"{self.runs:,} in {self.seconds:.0f} s: {answers}; {most}; {len(self.failures)} failures"

    def add(self, other: "FuzzFigures") -> None:
        """Add the figures of another process."""
        self.runs, self.seconds = self.runs + other.runs, self.seconds + other.seconds
        self.answers += other.answers
        self.slowest, self.memory = max(self.slowest, other.slowest), max(self.memory, other.memory)
        self.failures |= other.failures


class FuzzTrial:
    """A reader in this process, the contents that it has answered, and what came of them."""

    def __init__(self, name: str, out: Path, folder: Path) -> None:
        """Failures are kept in ``out``; ``folder`` is empty."""
        self.name, self.reader, self.out, self.folder = name, READERS[name], out, folder
        self.figures, self.begun, self._noted = FuzzFigures(), time.monotonic(), 0.0

    def __call__(self, content: bytes) -> None:
        """Read a content."""
        begun, figures = time.process_time(), self.figures
        try:
            found = answer(self.reader, content, self.folder)
        except Exception as error:
            found = "failed"
            self._keep(content, error)
        figures.runs += 1
        figures.answers[found] += 1
        figures.slowest = max(figures.slowest, time.process_time() - begun)
        if time.monotonic() > self._noted + EVERY_S:
            self.note()

    def note(self) -> None:
        """Write the figures: the process may end at any time."""
        self._noted = time.monotonic()
        self.figures.seconds = self._noted - self.begun
        self.figures.memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss >> 10
        (self.out / "figures.json").write_text(json.dumps(vars(self.figures)))

    def _keep(self, content: bytes, error: Exception) -> None:
        """Keep the smallest content of each kind of failure."""
        kind = place_of(error)
        kept = self.out / f"{type(error).__name__}-{sha256(kind.encode()).hexdigest()[:8]}"
        there = self.figures.failures
        if (kind in there and len(content) >= kept.stat().st_size) or len(there) >= MOST_FAILURES:
            return
        kept.write_bytes(content)
        kept.with_suffix(".txt").write_text("".join(traceback.format_exception(error))[-4000:])
        there[kind] = str(kept)


def place_of(error: Exception) -> str:
    """Return the kind of an error, and the last lines of ours that it came through."""
    frames = [
        each for each in traceback.extract_tb(error.__traceback__) if "site-packages" not in each.filename
    ]
    places = [f"{Path(each.filename).name}:{each.lineno}" for each in frames[-2:]]
    return f"{type(error).__name__} at {' '.join(places)}"


def main() -> None:
    """Fuzz a reader in this process: its name, a folder for failures, seconds, and a seed."""
    name, out, seconds, seed = sys.argv[1], Path(sys.argv[2]), float(sys.argv[3]), int(sys.argv[4])
    os.nice(10)
    with scratch() as folder:
        trial = FuzzTrial(name, out, folder)
        (_led if find_spec("atheris") else _blind)(trial, seconds, seed)
        trial.note()


def _blind(trial: FuzzTrial, seconds: float, seed: int) -> None:
    rng, contents = random.Random(f"{trial.name} {seed}"), begin(trial.name)
    for content in contents:
        trial(content)
    trial.figures.slowest = 0.0  # the first answers import what they need
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        trial(changed(rng.choice(contents), rng, trial.reader.is_json, contents))


def _led(trial: FuzzTrial, seconds: float, seed: int) -> None:
    """Fuzz by atheris, which ends the process."""
    atheris: Any = import_module("atheris")
    contents = begin(trial.name)
    with atheris.instrument_imports(include=PACKAGES, enable_loader_override=False):
        for content in contents:
            trial(content)
    trial.figures.slowest = 0.0  # the first answers import what they need
    found = trial.out / "found"
    found.mkdir(exist_ok=True)
    for number, content in enumerate(contents):
        (found / f"begin-{number}").write_bytes(content)

    def mutated(content: bytes, most: int, number: int) -> bytes:
        rng = random.Random(number)
        if rng.random() < 0.5:
            return changed(content, rng, trial.reader.is_json, contents)[:most]
        return atheris.Mutate(content, most)

    def again(content: bytes) -> None:
        trial(content)

    trial.note()
    flags = [
        *(f"-max_total_time={int(seconds)}", f"-timeout={SECONDS}", f"-rss_limit_mb={MEMORY_MIB}"),
        *(f"-seed={seed + 1}", f"-max_len={MOST_BYTES}", f"-artifact_prefix={trial.out}/", "-verbosity=0"),
    ]
    atheris.Setup([sys.argv[0], *flags, str(found)], again, custom_mutator=mutated)
    atheris.Fuzz()


@dataclass(frozen=True)
class Fuzz:
    """Read files of others with random changes by every reader: each must be read, or refused in a line."""

    seconds: float = 3600.0
    """How long, for all readers together."""

    readers: tuple[str, ...] = ()
    """Names of readers; all, if none is named."""

    seed: int = 0
    """Of the changes."""

    out: Path = Path("runs/fuzz")
    """Folder for the contents that fail."""

    replace: bool = False
    """Write into the folder whatever else it holds."""

    def run(self) -> int:
        """Print the figures of each reader; 1 if a content fails."""
        from logic.errors import RequestError
        from logic.spelling import unknown

        for name in self.readers:
            if name not in READERS:
                raise RequestError(unknown("reader", name, READERS))
        failed = False
        names = self.readers or tuple(READERS)
        for name in names:
            figures = self._fuzzed(name, self.seconds / len(names))
            failed |= bool(figures.failures)
            print(f"{name}: {figures}", flush=True)
            for kind, kept in figures.failures.items():
                print(f"  {kind}: {kept}", flush=True)
        return int(failed)

    def _fuzzed(self, name: str, seconds: float) -> FuzzFigures:
        """Fuzz a reader in processes: a content that ends one is a failure, and the next process goes on."""
        total, end, number = FuzzFigures(), time.monotonic() + seconds, self.seed
        out = self.out / name
        shutil.rmtree(out, ignore_errors=True)
        out.mkdir(parents=True)
        while (left := end - time.monotonic()) > 1:
            start = f"from {__name__} import main; main()"
            command = [sys.executable, "-P", "-c", start, name, str(out), str(left), str(number)]
            with (out / "log.txt").open("w") as log:
                done = subprocess.run(command, stdout=log, stderr=log, check=False)
            figures = _noted(out)
            total.add(figures)
            if done.returncode == 0:
                break
            if (ended := _ended(out, name)) is None:
                total.failures[f"the process ended with {done.returncode}"] = str(out / "log.txt")
                break
            total.failures |= ended
            number += 1
        return total


def _noted(out: Path) -> FuzzFigures:
    path = out / "figures.json"
    if not path.exists():
        return FuzzFigures()
    noted: dict[str, Any] = json.loads(path.read_bytes())
    path.unlink()
    noted["answers"] = Counter(noted["answers"])
    return FuzzFigures(**noted)


def _ended(out: Path, name: str) -> dict[str, str] | None:
    """Return the contents that ended a process, by libFuzzer's names; but for those of rules that a solver
    process answers. None if there is no content.
    """
    found = None
    for kind in ("timeout", "oom", "crash", "slow-unit"):
        for path in out.glob(f"{kind}-*"):
            found = found or {}
            kept = path.rename(out / f"{kind}.{len(list(out.iterdir()))}")
            if not _by_a_solver(name, kept):
                found[f"{kind} {kept.suffix}"] = str(kept)
    return found


def _by_a_solver(name: str, path: Path) -> bool:
    """Return True if the content is of rules that ``lint`` answers by a solver process."""
    from logic import lint
    from logic.errors import GrammarError, LimitReached
    from logic.grammar import SHIPPED

    if name not in ("answer-sets", "prolog"):
        return False
    with scratch() as folder:
        shutil.copytree(SHIPPED / "family", folder / "mine")
        shutil.copy(path, folder / "mine" / READERS[name].file)
        with suppress(GrammarError, LimitReached):
            lint(folder / "mine", seconds=SECONDS)
        return True
