"""``vitruvius bench fuzz``: every reader of foreign files, with random changes of their contents.

A reader returns a value or raises an error of Vitruvius in one line, within bounds of time and memory. The
study keeps a content with any other result. Coverage guides the changes if atheris is installed (``pip
install atheris``); otherwise the changes are blind.
"""

import json
import os
import random
import shutil
import subprocess
import sys
import time
import traceback
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass
from hashlib import sha256
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from benchmarks.reliability.figures import AnswerFigures
from benchmarks.reliability.random_changes import MOST_BYTES, changed
from benchmarks.reliability.readers import READERS, answer, begin, scratch

SECONDS = 10
"""Longest time for an answer, in seconds. Most answers take milliseconds, but the machine may be busy."""

MEMORY_MIB = 2048
"""Largest memory of the process that answers, in MiB."""

MOST_FAILURES = 40
"""Largest number of kinds of failures that the study keeps for a reader."""

PACKAGES = ["vitruvius", "yaml", "tomllib", "zipfile"]
"""Packages whose branches guide atheris."""

EVERY_S = 2.0
"""Seconds between two saves of the figures."""


class FuzzTrial:
    """A reader in this process, and the figures of its answers."""

    def __init__(self, name: str, out: Path, folder: Path) -> None:
        """Use the empty ``folder`` for files, and keep failures in ``out``."""
        self.name, self.reader, self.out, self.folder = name, READERS[name], out, folder
        self.figures, self.begun, self._noted = AnswerFigures(), time.monotonic(), 0.0

    def __call__(self, content: bytes) -> None:
        """Read a content."""
        begun = time.process_time()
        try:
            found = answer(self.reader, content, self.folder)
        except Exception as error:
            found = "failed"
            self._keep(content, error)
        self.figures.count(found, time.process_time() - begun)
        if time.monotonic() > self._noted + EVERY_S:
            self.note()

    def note(self) -> None:
        """Save the figures: the process may end at any time."""
        self._noted = time.monotonic()
        self.figures.measure(self.begun)
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
    """Return the class of an error, and the last two lines of Vitruvius in its traceback."""
    frames = [
        each for each in traceback.extract_tb(error.__traceback__) if "site-packages" not in each.filename
    ]
    places = [f"{Path(each.filename).name}:{each.lineno}" for each in frames[-2:]]
    return f"{type(error).__name__} at {' '.join(places)}"


def main() -> None:
    """Fuzz a reader in this process. Arguments: its name, a folder for failures, seconds and a seed."""
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
    """Fuzz with atheris, which ends the process."""
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
    """Give every reader random files, each of which the reader must read, or refuse in one line."""

    seconds: float = 3600.0
    """Seconds for all readers together."""

    readers: tuple[str, ...] = ()
    """Names of readers; without a name, all readers."""

    seed: int = 0
    """Seed of the changes."""

    out: Path = Path("runs/fuzz")
    """Folder for the contents that fail."""

    replace: bool = False
    """Write into the folder even if it holds other files."""

    def run(self) -> int:
        """Print the figures of each reader, and return 1 if a content fails."""
        from vitruvius.logic.errors import RequestError
        from vitruvius.logic.spelling import unknown

        for name in self.readers:
            if name not in READERS:
                raise RequestError(unknown("reader", name, READERS))
        names = self.readers or tuple(READERS)
        return max([self._fuzzed(name, self.seconds / len(names)).report(name) for name in names])

    def _fuzzed(self, name: str, seconds: float) -> AnswerFigures:
        """Fuzz a reader in processes; after a content that ends a process, the next process continues."""
        total, end, number = AnswerFigures(), time.monotonic() + seconds, self.seed
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


def _noted(out: Path) -> AnswerFigures:
    path = out / "figures.json"
    if not path.exists():
        return AnswerFigures()
    noted: dict[str, Any] = json.loads(path.read_bytes())
    path.unlink()
    noted["answers"] = Counter(noted["answers"])
    return AnswerFigures(**noted)


def _ended(out: Path, name: str) -> dict[str, str] | None:
    """Return the contents that ended a process, by the names of libFuzzer; None if there is no content.

    Rules that a solver process answers do not count.
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
    """Return True for rules that ``lint`` answers in a solver process."""
    from vitruvius.logic import lint
    from vitruvius.logic.errors import GrammarError, LimitReached
    from vitruvius.logic.grammar import SHIPPED

    if name not in ("answer-sets", "prolog"):
        return False
    with scratch() as folder:
        shutil.copytree(SHIPPED / "family", folder / "mine")
        shutil.copy(path, folder / "mine" / READERS[name].file)
        with suppress(GrammarError, LimitReached):
            lint(folder / "mine", seconds=SECONDS)
        return True
