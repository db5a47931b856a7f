"""``vitruvius bench fuzz``: house files and grammars with random changes, each with a definite answer.

A house file is read, or refused by ``HouseFileError``. ``lint`` has findings, each at a line of a file, or
ends at a limit. What else happens is a failure: its input is kept.
"""

import gzip
import json
import os
import random
import re
import resource
import shutil
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures import TimeoutError as Late
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from agent.banks import benchmark_path
from logic.errors import GrammarError, HouseFileError, LimitReached, MissingProgram

SECONDS = 10.0
"""For one input, by the clock: they take some hundredths."""

VALUES = (None, True, -1, 0, 1e300, 5e-324, 10**30, "", "\x1b[2J", "<b>", "\ud800", [], {}, [[[]]], "NaN")
TOKENS = re.compile(rb"\w+|\s+|[^\w\s]+")
ODD = (
    b"(",
    b")",
    b"{",
    b"}",
    b",",
    b".",
    b":-",
    b"%*",
    b"*%",
    b"'",
    b'"',
    b"#",
    b"_",
    b"0",
    b"-1",
    b"9e99",
    b"..",
)


# - inputs ----------------------------------------------------------------------------------------------
def changed_bytes(text: bytes, rng: random.Random) -> bytes:
    """Some bytes changed, left out, put in or repeated; or the end cut off."""
    for _ in range(rng.randint(1, 4)):
        at, length = rng.randrange(len(text) + 1), rng.randint(1, 9)
        kind = rng.randrange(5)
        if kind == 0:
            text = text[:at] + rng.randbytes(length) + text[at + length :]
        elif kind == 1:
            text = text[:at] + text[at + length :]
        elif kind == 2:
            text = text[:at] + rng.randbytes(length) + text[at:]
        elif kind == 3:
            text = text[:at] + text[at : at + 40] * length + text[at:]
        elif rng.random() < 0.2:
            text = text[:at]
    return text


def changed_tokens(text: bytes, pool: list[bytes], rng: random.Random) -> bytes:
    """Some tokens left out, repeated, exchanged, or others in their place."""
    tokens = TOKENS.findall(text)
    for _ in range(rng.randint(1, 4)):
        at, other = rng.randrange(len(tokens)), rng.randrange(len(tokens))
        kind = rng.randrange(4)
        if kind == 0:
            tokens[at] = b""
        elif kind == 1:
            tokens[at] *= 2
        elif kind == 2:
            tokens[at], tokens[other] = tokens[other], tokens[at]
        else:
            tokens[at] = rng.choice(ODD if rng.random() < 0.3 else pool)
    return b"".join(tokens)


def changed_record(record: Any, rng: random.Random) -> None:
    """Some values of a house's record changed, left out or given to another key, in place."""
    for _ in range(rng.randint(1, 3)):
        node: Any = record
        while True:
            keys = list(node) if isinstance(node, dict) else list(range(len(node)))
            if not keys:
                break
            key = rng.choice(keys)
            if isinstance(node[key], dict | list) and rng.random() < 0.8:
                node = node[key]
                continue
            kind = rng.randrange(4)
            if kind == 0:
                node[key] = rng.choice(VALUES)
            elif kind == 1 and isinstance(node[key], int | float):
                node[key] = node[key] * rng.choice((-1, 0, 1e-9, 0.5, 2, 100, 1e6)) + rng.choice(
                    (0, 1e-7, 1, 9)
                )
            elif kind == 2:
                del node[key]
            elif isinstance(node, dict):
                node[str(rng.choice([*keys, "R0", "x", "floor", "unit"]))] = node[key]
            break


@cache
def _houses() -> list[bytes]:
    return gzip.decompress(benchmark_path().read_bytes()).splitlines()


@cache
def _rules() -> tuple[dict[str, list[Path]], list[Path], list[bytes]]:
    """The files of each grammar, the recipes, and the tokens of all."""
    from logic.grammar import RULES, SHIPPED, shipped
    from logic.language.reference import RECIPES

    grammars = {name: sorted((SHIPPED / name).glob("*.[lp][lp]")) for name in shipped()}
    recipes = sorted(RECIPES.glob("*.[lp][lp]"))
    every = [*recipes, *RULES.rglob("*.[lp][lp]"), *(file for files in grammars.values() for file in files)]
    return grammars, recipes, sorted({token for file in every for token in TOKENS.findall(file.read_bytes())})


def house_file(folder: Path, rng: random.Random) -> Path:
    """A house file with changes."""
    lines = rng.choices(_houses(), k=rng.randint(1, 2))
    if rng.random() < 0.7:
        records = [json.loads(line) for line in lines]
        changed_record(records[-1], rng)
        lines = [json.dumps(record).encode() for record in records]
    content = b"\n".join(lines)
    if rng.random() < 0.4:
        content = changed_bytes(content, rng)
    path = folder / "houses.jsonl"
    path.write_bytes(content)
    return path


def grammar(folder: Path, rng: random.Random) -> Path:
    """A grammar with changes in one of its files, or with a changed recipe."""
    grammars, recipes, pool = _rules()
    path = folder / "mine"
    name = rng.choice(sorted(grammars))
    shutil.copytree(grammars[name][0].parent, path)
    file = rng.choice(grammars[name])
    content = file.read_bytes()
    if rng.random() < 0.3:
        recipe = rng.choice([each for each in recipes if each.suffix == file.suffix])
        content += b"\n" + recipe.read_bytes()
    if rng.random() < 0.7:
        content = changed_tokens(content, pool, rng)
    if rng.random() < 0.4:
        content = changed_bytes(content, rng)
    (path / file.name).write_bytes(content)
    return path


# - answers ---------------------------------------------------------------------------------------------
def read(path: Path) -> str:
    """What is said of a house file; what is read is checked, drawn and written, and reads back the same."""
    from xml.etree import ElementTree

    from logic import House, check, load
    from logic.drawing.draw import plan_svg

    try:
        houses = load(path)
    except HouseFileError:
        return "refused"
    for house in houses:
        check(house)
        ElementTree.fromstring(plan_svg(house))
        assert House.from_dict(house.to_dict()) == house
    return "read"


def linted(path: Path) -> str:
    """What ``lint`` finds in a grammar, in this process."""
    from logic.grammar import find
    from logic.language.linter import findings

    try:
        found = findings(find(path))
    except GrammarError:
        return "refused"
    for each in found:
        file = Path(each.file)
        assert each.text.strip(), each
        assert file == path or each.line <= len(file.read_bytes().splitlines()) + 1, each
    kinds = {each.severity for each in found}
    return "errors" if "error" in kinds else "warnings" if kinds else "nothing found"


def by_a_worker(path: Path) -> str:
    """What ``lint`` answers where the rules end the process that reads them, or take long."""
    from logic import lint

    try:
        return "by a worker: errors" if lint(path, seconds=SECONDS) else "by a worker: nothing found"
    except GrammarError:
        return "by a worker: refused"
    except LimitReached:
        return "by a worker: limited"


@dataclass(frozen=True)
class FuzzTarget:
    """What makes inputs, and what answers them."""

    make: Callable[[Path, random.Random], Path]
    answer: Callable[[Path], str]
    again: Callable[[Path], str] | None = None


TARGETS = {"houses": FuzzTarget(house_file, read), "lint": FuzzTarget(grammar, linted, by_a_worker)}


def _tried(name: str, folder: Path, seed: str) -> tuple[str, float, int]:
    """An input's answer, its seconds of processor time, and the most memory of this process, bytes."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    path = TARGETS[name].make(folder, random.Random(seed))
    begin = time.process_time()
    try:
        answer = TARGETS[name].answer(path)
    except MissingProgram:
        raise
    except Exception:
        answer = f"FAILURE {traceback.format_exc()}"
    return answer, time.process_time() - begin, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss << 10


@dataclass
class Figures:
    """What became of the inputs of a target."""

    inputs: int = 0
    outcomes: Counter[str] = field(default_factory=Counter)
    slowest: float = 0.0
    """Seconds of processor time."""
    memory: int = 0
    """Bytes, of the process that reads them all."""
    failures: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        """In a line."""
        outcomes = ", ".join(f"{number:,} {name}" for name, number in sorted(self.outcomes.items()))
        most = f"slowest {self.slowest:.2f} s, at most {self.memory >> 20} MiB"
        return f"{self.inputs:,} inputs: {outcomes}; {most}; {len(self.failures)} failures"


@dataclass(frozen=True)
class Fuzz:
    """Read house files and grammars with random changes: each must have a definite answer."""

    seconds: float = 900.0
    """How long, for house files and grammars together."""

    seed: int = 0
    """Of the changes: input i is a function of the seed and i."""

    first: int = 0
    """The number of the first input: go on where another run ended."""

    out: Path = Path("runs/fuzz")
    """Folder for the inputs that fail."""

    replace: bool = False
    """Write into the folder whatever else it holds."""

    def run(self) -> int:
        """Print the figures of each; 1 if an input fails."""
        figures = {name: self._figures(name) for name in TARGETS}
        for name, found in figures.items():
            print(f"{name}: {found}")
        return 1 if any(found.failures for found in figures.values()) else 0

    def _figures(self, name: str) -> Figures:
        figures, end, pool = Figures(), time.monotonic() + self.seconds / len(TARGETS), None
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch) / "input"
            while time.monotonic() < end:
                number = self.first + figures.inputs
                pool = pool or ProcessPoolExecutor(1, get_context("spawn"), _nice)
                try:
                    answer, seconds, memory = pool.submit(
                        _tried, name, folder, f"{self.seed} {number}"
                    ).result(60 if not figures.inputs else SECONDS)
                except (BrokenProcessPool, Late) as error:
                    for process in list(pool._processes.values()):
                        process.kill()
                    pool.shutdown()
                    answer, seconds, memory, pool = self._again(name, folder, error), 0.0, 0, None
                figures.inputs += 1
                figures.slowest, figures.memory = max(figures.slowest, seconds), max(figures.memory, memory)
                figures.outcomes[answer.split(" ", 1)[0] if answer.startswith("FAILURE") else answer] += 1
                if answer.startswith("FAILURE"):
                    figures.failures.append(self._kept(name, folder, number, answer))
        if pool:
            pool.shutdown()
        return figures

    def _again(self, name: str, folder: Path, error: Exception) -> str:
        """The answer of a solver process to what ended ours."""
        again, why = TARGETS[name].again, "late" if isinstance(error, Late) else "ended the process"
        if not again:
            return f"FAILURE {why}"
        path = next(folder.iterdir())
        try:
            return again(path)
        except Exception:
            return f"FAILURE {why}, and {traceback.format_exc()}"

    def _kept(self, name: str, folder: Path, number: int, answer: str) -> str:
        kept = self.out / f"{name}-{self.seed}-{number}"
        with suppress(FileNotFoundError):
            shutil.rmtree(kept)
        shutil.copytree(folder, kept)
        (kept / "answer.txt").write_text(answer)
        print(f"{kept}: {answer.splitlines()[-1]}", flush=True)
        return str(kept)


def _nice() -> None:
    """Leave the processor to others."""
    os.nice(10)
