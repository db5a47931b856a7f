"""``vitruvius bench mutants``: small mistakes put into code and rules, and whether the tests notice each.

A mutant is a file with one change. The tests that belong to the file run against it in a copy of the
checkout, until one fails. A sample by a seed is tried. Each trial is a row: a study that was ended goes on.
"""

import ast
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from fnmatch import fnmatch
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

import msgspec
from scipy.stats import binomtest

from benchmarks.common.pages import ROOT, table_rows, write
from benchmarks.common.processes import ONE_THREAD, StudyFailed, say
from benchmarks.reliability.changes import Mutant, mutants
from logic.errors import RequestError
from logic.house.files import write_whole

EXPLAINED = Path(__file__).with_name("explained.json")
"""Survivors that no test could notice, or none should: by file, the line's code and the change, why."""

KINDS: dict[str, tuple[str, ...]] = {
    "checking": ("logic/checking/*.py",),
    "generation": ("logic/generation/*.py",),
    "sim": ("sim/**/*.py",),
    "agent": (
        "agent/avoidance.py",
        "agent/evaluation/statistics.py",
        "agent/planner/frame.py",
        "agent/policies/*.py",
    ),
    "lp": ("logic/rules/**/*.lp",),
    "pl": ("logic/rules/**/*.pl",),
}
"""Files whose mutants are counted together."""

ENOUGH = 0.85
"""Least share of mutants that are noticed or explained."""

HEAD = Path(__file__).with_name("head.md")
"""How the page begins."""

BELONGING: dict[str, tuple[str, ...]] = {
    "logic/checking/*": ("logic/checking",),
    "logic/generation/*": (
        "logic/generation/test_frames.py",
        "logic/generation/test_star_nogoods.py",
        "logic/generation",
        "logic/request/test_fixed_rooms.py",
    ),
    "logic/rules/brief/*.pl": ("logic/generation/test_brief.py",),
    "logic/rules/*.lp": ("logic/rules/test_models.py",),
    "logic/rules/language/*.pl": ("logic/rules/test_prolog.py",),
    "logic/rules/agreement.pl": ("logic/rules/test_prolog.py",),
    "logic/rules/why/*.pl": ("logic/rules/test_prolog.py", "logic/why/test_why.py"),
    "logic/rules/shared_walls/*.pl": (
        "logic/rules/test_prolog.py",
        "logic/generation/test_shared_walls.py",
        "logic/generation/test_outdoor.py",
        "logic/language/test_lengths.py",
    ),
    "logic/rules/*.pl": ("logic/rules/test_prolog.py", "logic/generation/test_shared_walls.py"),
    "sim/backends/*/backend.py": ("sim/backends/test_fit.py",),
    "sim/baselines/oracle.py": ("sim/baselines/test_oracle.py",),
    "sim/environment/steps.py": ("sim/environment/test_steps.py",),
    "sim/environment/window.py": ("sim/environment/test_window.py",),
    "sim/world/world.py": ("sim/world/test_world.py",),
    "sim/*/*": ("{folder}",),
    "sim/cache.py": ("sim/test_cache.py",),
    "sim/config.py": ("sim/test_config.py",),
    "sim/drive.py": ("sim/test_config.py",),
    "sim/film.py": ("sim/test_film.py",),
    "sim/geometry.py": ("sim/test_geometry.py", "sim/test_plans.py", "sim/test_free_walls.py"),
    "sim/tracing.py": ("sim/test_tracing.py",),
    "sim/huge_pages.py": ("sim/test_huge_pages.py",),
    "sim/*": ("sim/environment",),
    "agent/avoidance.py": ("agent/test_avoidance.py",),
    "agent/evaluation/*": ("agent/evaluation/test_statistics.py",),
    "agent/planner/frame.py": ("agent/planner/test_frame.py",),
    "agent/policies/*": ("agent/policies", "agent/test_avoidance.py", "agent/evaluation/test_episodes.py"),
}
"""By pattern of files the tests, below ``tests``, that belong to them: the first that matches counts."""

LEFT_OUT = (".git", ".venv", ".local", ".cache", "runs", "__pycache__", "dist", "node_modules")
"""Not copied with the checkout."""


class Row(msgspec.Struct, kw_only=True):
    """A mutant that was tried."""

    kind: str
    mutant: Mutant
    by: str = ""
    """The test that noticed it, or that tests do not end."""
    tests: int = 0
    """Number of tests that could have run."""
    left_out: int = 0
    """Number of tests that belong to the file and were left out for their time."""


@dataclass(frozen=True)
class Mutants:
    """Change code and rules in one place each, and count the changes that the tests notice."""

    kinds: tuple[str, ...] = tuple(KINDS)
    """Which kinds of files."""

    each: int = 50
    """Number of mutants of each kind."""

    seconds: float = 20.0
    """Seconds of tests for a mutant: the fastest tests that belong to its file are taken."""

    measured: float = 600.0
    """Seconds for which the tests of each folder are measured: tests that are not reached are left out."""

    seed: int = 0
    """Seed of the sample."""

    again: bool = False
    """Try again the mutants that survived, against the tests as they are now."""

    out: Path = Path("runs/mutants")
    """Folder for rows.jsonl, tests.json and mutants.md."""

    replace: bool = False
    """Write into the folder whatever else it holds."""

    publish: bool = False
    """Put the table into docs/mutants.md."""

    def run(self) -> int:
        """Try what was not tried yet, and print the table; 1 where too many of a kind survive unexplained."""
        if unknown := [name for name in self.kinds if name not in KINDS]:
            raise RequestError(f"--kinds {unknown[0]}: there are {', '.join(KINDS)}")
        if self.each < 1 or self.seconds <= 0:
            raise RequestError("--each is 1 or more, --seconds above 0")
        rows = self._rows()
        with scratch() as copy:
            for kind in self.kinds:
                todo = [each for each in sample(kind, self.seed)[: self.each] if each not in rows]
                if self.again:
                    todo += [row.mutant for row in rows.values() if row.kind == kind and not row.by]
                if todo:
                    tests = Tests(copy, self.out, {each.file for each in todo}, self.measured)
                    for number, mutant in enumerate(todo):
                        rows[mutant] = row = tests.tried(kind, mutant, self.seconds)
                        self._keep(rows.values())
                        what = row.by or "SURVIVED"
                        place = f"{mutant.file}:{mutant.line} {mutant.operator}"
                        say(f"{kind} {number + 1}/{len(todo)}: {place}: {what}")
                    tests.close()
        explained = json.loads(EXPLAINED.read_bytes())
        page = report(list(rows.values()), explained)
        write({"mutants.md": page.encode()}, self.out, self.publish)
        print(page)
        kinds = Counter(row.kind for row in rows.values())
        known = Counter(row.kind for row in rows.values() if row.by or name_of(row.mutant) in explained)
        return int(any(known[kind] < ENOUGH * number for kind, number in kinds.items()))

    def _rows(self) -> dict[Mutant, Row]:
        """Rows of mutants of the files as they are now."""
        path = self.out / "rows.jsonl"
        lines = path.read_bytes().splitlines() if path.exists() else []
        rows = [msgspec.json.decode(line, type=Row) for line in lines]
        current = {kind: {*sample(kind, self.seed)} for kind in {row.kind for row in rows} & {*KINDS}}
        return {row.mutant: row for row in rows if row.mutant in current.get(row.kind, ())}

    def _keep(self, rows: Iterable[Row]) -> None:
        write_whole(self.out / "rows.jsonl", b"".join(msgspec.json.encode(row) + b"\n" for row in rows))


# - trials ----------------------------------------------------------------------------------------------
@contextmanager
def scratch() -> Iterator[Path]:
    """Copy the checkout to a folder of its own, for as long as the block runs."""
    with tempfile.TemporaryDirectory(prefix="vitruvius-mutants-") as folder:
        copy = Path(folder, "checkout")
        shutil.copytree(ROOT, copy, ignore=shutil.ignore_patterns(*LEFT_OUT), symlinks=True)
        yield copy


class Tests:
    """The tests of a kind of files, and the process that runs them in the copy."""

    def __init__(self, copy: Path, out: Path, files: Iterable[str], seconds: float) -> None:
        """Start the process, which collects the tests that belong to the files."""
        self.copy, self.file, self.log, self.seconds = (
            copy,
            out / "tests.json",
            copy.parent / "log.txt",
            seconds,
        )
        self.known: dict[str, Any] = json.loads(self.file.read_bytes()) if self.file.exists() else {}
        self.noticed: Counter[tuple[str, str]] = Counter()
        self.collected = copy.parent / "collected.txt"
        paths = sorted({path for file in files for path in belonging(file)})
        self.process = subprocess.Popen(
            [sys.executable, "-P", "-c", "from benchmarks.reliability.trial import main; main()", *paths],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self.collected.open("wb"),
            text=True,
            cwd=copy,
            env=os.environ | ONE_THREAD | {"PYTHONPATH": str(copy)},
        )

    def close(self) -> None:
        """End the process."""
        self.process.communicate()

    def tried(self, kind: str, mutant: Mutant, seconds: float) -> Row:
        """Change the file, run the tests that belong to it, and change it back."""
        first = first_line(self.copy, mutant)
        measured = self.measured(belonging(mutant.file))
        place = self.copy / mutant.file
        content = place.read_bytes()
        place.write_bytes(mutant.applied(content))
        try:
            row = self.noticing(kind, mutant, first, measured, seconds)
            if first and not row.by:
                # What tests make as they are imported, the function as it was has made.
                row = self.noticing(kind, mutant, 0, measured, seconds)
        finally:
            place.write_bytes(content)
        if row.by:
            self.noticed[mutant.file, row.by] += 1
        return row

    def noticing(
        self, kind: str, mutant: Mutant, first: int, measured: dict[str, Any], seconds: float
    ) -> Row:
        """Run the tests, where the function at line ``first`` has changed; or all is imported anew."""
        file = mutant.file if mutant.file.endswith(".py") else ""
        while True:
            order, left_out = self.order(mutant, first, measured, seconds)
            limit = 20 + 3 * sum(measured["seconds"][name] for name in order)
            failed = self.ask(order, limit, file=file, line=first)["failed"][:1]
            # What fails by chance, as by a limit of seconds, seldom fails again.
            again = [name for name in failed if name in order]
            if not again or self.ask(again, limit, file=file, line=first)["failed"]:
                return Row(kind=kind, mutant=mutant, by="".join(failed), tests=len(order), left_out=left_out)
            measured["failed"] += failed

    def order(
        self, mutant: Mutant, first: int, measured: dict[str, Any], seconds: float
    ) -> tuple[list[str], int]:
        """Return the tests to run, and the number of others: those first that are named as the file is, then
        those that have noticed mutants of the file, then the fastest. Where tests enter the changed function
        in this process, only these are run.
        """
        stem = Path(mutant.file).stem
        tests = [name for name in measured["seconds"] if name not in measured["failed"]]
        if first:
            tests = [name for name in tests if [mutant.file, first] in measured["entered"][name]] or tests
        tests.sort(
            key=lambda name: (
                not name.endswith(f"[{stem}]"),
                -self.noticed[mutant.file, name],
                measured["seconds"][name],
            )
        )
        taken, left = [], seconds
        for name in tests:
            left -= measured["seconds"][name]
            if left < 0 and taken:
                break
            taken.append(name)
        return taken, len(tests) - len(taken) + measured["others"]

    def measured(self, paths: Sequence[str]) -> dict[str, Any]:
        """Return the seconds of all tests, and the functions that each enters: measured once."""
        found: dict[str, Any] = {"failed": [], "seconds": {}, "entered": {}, "others": 0}
        for path in paths:
            content = sha256()
            place = self.copy / path
            for file in sorted((place if place.is_dir() else place.parent).rglob("*")):
                content.update(file.read_bytes() if file.is_file() else b"")
            key = f"{path} {content.hexdigest()[:12]}"
            if key not in self.known:
                say(f"measures {path}")
                measured = self.ask([path], 3600, measure=self.seconds)
                if not measured.get("seconds"):
                    raise StudyFailed(f"{path}: no test could be measured: {measured['failed']}")
                self.known[key] = measured
                write_whole(self.file, json.dumps(self.known).encode())
                say(f"{len(self.known[key]['seconds'])} tests; fail already: {self.known[key]['failed']}")
            found["failed"] += self.known[key]["failed"]
            found["others"] += self.known[key]["others"]
            for name in ("seconds", "entered"):
                found[name] |= self.known[key][name]
        return found

    def ask(
        self, order: Sequence[str], seconds: float, measure: float = 0, file: str = "", line: int = 0
    ) -> dict[str, Any]:
        """Run tests in this order until one fails, where a function has changed; or measure all."""
        assert self.process.stdin
        assert self.process.stdout
        question = {"order": order, "seconds": seconds, "measure": measure, "file": file, "line": line}
        print(json.dumps(question | {"log": str(self.log)}), file=self.process.stdin, flush=True)
        answer = self.process.stdout.readline()
        if not answer:
            raise StudyFailed(f"the tests were not collected: {self.collected.read_text()[-1000:]}")
        return json.loads(answer)


def belonging(file: str) -> list[str]:
    """Return the folders and files of tests that belong to a file."""
    paths = next(paths for pattern, paths in BELONGING.items() if fnmatch(file, pattern))
    folder = "/".join(file.split("/")[:2])
    return [f"tests/{path.format(folder=folder)}" for path in paths]


def first_line(root: Path, mutant: Mutant) -> int:
    """Return the first line of the function whose body a mutant of Python changes, 0 if there is none."""
    if not mutant.file.endswith(".py"):
        return 0
    functions = [
        min([node.lineno, *(each.lineno for each in node.decorator_list)])
        for node in ast.walk(ast.parse((root / mutant.file).read_bytes()))
        if isinstance(node, ast.FunctionDef) and node.body[0].lineno <= mutant.line <= (node.end_lineno or 0)
    ]
    return min(functions, default=0)


@cache
def sample(kind: str, seed: int) -> list[Mutant]:
    """Return all mutants of a kind of files in a random order: that of their hashes."""

    def rank(mutant: Mutant) -> bytes:
        return sha256(f"{seed} {mutant.start} {name_of(mutant)}".encode()).digest()

    files = sorted({file.relative_to(ROOT).as_posix() for glob in KINDS[kind] for file in ROOT.glob(glob)})
    return sorted((mutant for file in files for mutant in mutants(ROOT, file)), key=rank)


# - the page --------------------------------------------------------------------------------------------
def report(rows: Sequence[Row], explained: Mapping[str, str]) -> str:
    """Return the tables of groups and folders, with 95 % intervals, and the survivors."""
    parts = [HEAD.read_text().strip()]
    for title, key in (
        ("files", lambda row: row.kind),
        ("folder", lambda row: str(Path(row.mutant.file).parent)),
    ):
        groups = defaultdict[str, list[Row]](list)
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
    lines = [(name_of(each), explained.get(name_of(each), "")) for each in survivors]
    words = (f"- `{name}`{why and f': {why}'}" for name, why in lines)
    parts += ["## Survivors", "\n".join(words)]
    return "\n\n".join(parts) + "\n"


def figures(name: str, rows: Sequence[Row], explained: Mapping[str, str]) -> list[str]:
    """Return a line of a table: how many mutants the tests notice."""
    noticed = sum(bool(row.by) for row in rows)
    told = sum(not row.by and name_of(row.mutant) in explained for row in rows)
    low, high = binomtest(noticed, len(rows)).proportion_ci(method="wilson")
    share = f"{noticed / len(rows):.0%} ({low:.0%} to {high:.0%})"
    return [name, str(len(rows)), str(noticed), share, str(told), str(len(rows) - noticed - told)]


def name_of(mutant: Mutant) -> str:
    """Return the words for a mutant, which hold when lines above it change."""
    before, after = (" ".join(text.split()) for text in (mutant.before, mutant.after))
    return f"{mutant.file}: {mutant.code}: {before[:60]} -> {after[:60]}"
