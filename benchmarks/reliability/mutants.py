"""``vitruvius bench mutants``: small mistakes in code and rules, and the fraction that the tests notice.

A mutant is a file with one change. The tests that belong to the file run against the mutant in a copy of the
checkout until one fails. The study tries a random sample. A stopped study continues from its rows.
"""

import json
from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from pathlib import Path

from msgspec.structs import replace
from scipy.stats import binomtest

from benchmarks.common.pages import ROOT, table_rows, write
from benchmarks.common.processes import say
from benchmarks.common.rows import read_rows, write_rows
from benchmarks.reliability.changes import Mutant, mutants
from benchmarks.reliability.mutant_tests import MutantRow, MutantTests, scratch
from vitruvius.logic.errors import RequestError

EXPLAINED = Path(__file__).with_name("explained.json")
"""Reasons why no test can or should notice a survivor, by the name of the mutant."""

KINDS: dict[str, tuple[str, ...]] = {
    "checking": ("logic/checking/*.py",),
    "generation": ("logic/generation/*.py",),
    "sim": ("sim/**/*.py",),
    "agent": (
        "agent/avoidance.py",
        "agent/evaluation/statistics.py",
        "agent/planner/core/frame.py",
        "agent/policies/*.py",
    ),
    "lp": ("logic/rules/**/*.lp",),
    "pl": ("logic/rules/**/*.pl",),
}
"""Groups of files, each with its own sample of mutants."""

ENOUGH = 0.85
"""Smallest fraction of noticed or explained mutants of a group."""

HEAD = Path(__file__).with_name("head.md")
"""Text at the top of the page."""


@dataclass(frozen=True)
class Mutants:
    """Put one small mistake at a time into code and rules, and count the mistakes that tests notice."""

    kinds: tuple[str, ...] = tuple(KINDS)
    """Groups of files."""

    each: int = 50
    """Number of mutants in each group."""

    seconds: float = 20.0
    """Seconds of tests for a mutant: the fastest tests that belong to the file run."""

    measured: float = 600.0
    """Seconds for the measurement of each folder of tests; tests beyond these seconds do not run."""

    seed: int = 0
    """Seed of the sample."""

    again: bool = False
    """Try the survivors again with the current tests."""

    out: Path = Path("runs/mutants")
    """Folder for rows.jsonl, tests.json and mutants.md."""

    replace: bool = False
    """Write into the folder even if it holds other files."""

    publish: bool = False
    """Copy the page to docs/development/mutants.md."""

    def run(self) -> int:
        """Try mutants, print the page, and return 1 if too many survivors have no reason."""
        if unknown := [name for name in self.kinds if name not in KINDS]:
            raise RequestError(f"--kinds {unknown[0]}: unknown group: choose from {', '.join(KINDS)}")
        if self.each < 1 or self.seconds <= 0:
            raise RequestError("--each must be 1 or more, --seconds above 0")
        path = self.out / "rows.jsonl"
        rows = {row.mutant.key: row for row in _current(read_rows(path, MutantRow), self.seed)}
        with scratch() as copy:
            for kind in self.kinds:
                left = max(0, self.each - sum(row.kind == kind for row in rows.values()))
                todo = [each for each in sample(kind, self.seed) if each.key not in rows][:left]
                if self.again:
                    todo += [row.mutant for row in rows.values() if row.kind == kind and not row.by]
                if todo:
                    tests = MutantTests(copy, self.out, {each.file for each in todo}, self.measured)
                    for number, mutant in enumerate(todo):
                        rows[mutant.key] = row = tests.tried(kind, mutant, self.seconds)
                        write_rows(path, rows.values())
                        what = row.by or "SURVIVED"
                        place = f"{mutant.file}:{mutant.line} {mutant.operator}"
                        say(f"{kind} {number + 1}/{len(todo)}: {place}: {what}")
                    tests.close()
        explained = json.loads(EXPLAINED.read_bytes())
        page = report(list(rows.values()), explained)
        write({"mutants.md": page.encode()}, self.out, self.publish, "development")
        print(page)
        kinds = Counter(row.kind for row in rows.values())
        known = Counter(row.kind for row in rows.values() if row.by or row.mutant.name in explained)
        return int(any(known[kind] < ENOUGH * number for kind, number in kinds.items()))


def _current(rows: Sequence[MutantRow], seed: int) -> list[MutantRow]:
    """Return the rows of mutants that the files still have, at their current places."""
    places = {each.key: each for kind in {row.kind for row in rows} & {*KINDS} for each in sample(kind, seed)}
    return [replace(row, mutant=places[row.mutant.key]) for row in rows if row.mutant.key in places]


@cache
def sample(kind: str, seed: int) -> list[Mutant]:
    """Return all mutants of a group of files in a random order."""

    def rank(mutant: Mutant) -> bytes:
        return sha256(f"{seed} {mutant.key}".encode()).digest()

    files = sorted({file.relative_to(ROOT).as_posix() for glob in KINDS[kind] for file in ROOT.glob(glob)})
    return sorted((mutant for file in files for mutant in mutants(ROOT, file)), key=rank)


# - the page --------------------------------------------------------------------------------------------
def report(rows: Sequence[MutantRow], explained: Mapping[str, str]) -> str:
    """Return the page: a table of groups, a table of folders, and the survivors."""
    parts = [HEAD.read_text().strip()]
    for title, key in (
        ("files", lambda row: row.kind),
        ("folder", lambda row: str(Path(row.mutant.file).parent)),
    ):
        groups = defaultdict[str, list[MutantRow]](list)
        for row in rows:
            groups[key(row)].append(row)
        names = (
            title,
            "mutants",
            "noticed",
            "share, 95 % interval",
            "survivors explained",
            "other survivors",
        )
        lines = [figures(name, groups[name], explained) for name in sorted(groups)]
        parts.append(table_rows([names, ["---"] * len(names), *lines]))
    survivors = sorted((row.mutant for row in rows if not row.by), key=lambda each: (each.file, each.line))
    lines = [(each.name, explained.get(each.name, "")) for each in survivors]
    words = (f"- `{name}`{why and f': {why}'}" for name, why in lines)
    parts += ["## Survivors", "\n".join(words)]
    return "\n\n".join(parts) + "\n"


def figures(name: str, rows: Sequence[MutantRow], explained: Mapping[str, str]) -> list[str]:
    """Return a row of a table: the mutants of a group and those that tests notice."""
    noticed = sum(bool(row.by) for row in rows)
    told = sum(not row.by and row.mutant.name in explained for row in rows)
    low, high = binomtest(noticed, len(rows)).proportion_ci(method="wilson")
    share = f"{noticed / len(rows):.0%} ({low:.0%} to {high:.0%})"
    return [name, str(len(rows)), str(noticed), share, str(told), str(len(rows) - noticed - told)]
