"""The tests that belong to each file, run against mutants of the file in a copy of the checkout."""

import ast
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from fnmatch import fnmatch
from hashlib import sha256
from pathlib import Path
from typing import Any

import msgspec

from benchmarks.common.pages import ROOT
from benchmarks.common.processes import ONE_THREAD, StudyFailed, say
from benchmarks.reliability.changes import Mutant
from vitruvius.logic.files.writing import write_whole

BELONGING: dict[str, tuple[str, ...]] = {
    "logic/checking/*": ("logic/checking",),
    "logic/generation/*": (
        "logic/generation/test_makers.py",
        "logic/generation",
        "logic/language/test_own_topology.py",
        "logic/proofs/test_plan_proofs.py",
        "logic/request/test_fixed_rooms.py",
        "logic/request/test_given_plan.py",
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
    "sim/oracle/oracle.py": ("agent/baselines/test_oracle.py",),
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
    "agent/planner/core/frame.py": ("agent/planner/test_frame.py",),
    "agent/policies/*": ("agent/policies", "agent/test_avoidance.py", "agent/evaluation/test_episodes.py"),
}
"""Tests of each file: by pattern of files, paths below ``tests``. The first pattern that matches a file
counts."""

LEFT_OUT = (".git", ".venv", ".local", ".cache", "runs", "__pycache__", "dist", "node_modules")
"""Files and folders that the copy of the checkout omits."""


class MutantRow(msgspec.Struct, kw_only=True):
    """The trial of a mutant."""

    kind: str
    mutant: Mutant
    by: str = ""
    """Test that noticed the mutant, ``LATE`` or ``ENDED``; empty for a survivor."""
    tests: int = 0
    """Number of tests in the trial."""
    left_out: int = 0
    """Number of tests that belong to the file and took too long for the trial."""


@contextmanager
def scratch() -> Iterator[Path]:
    """Yield a temporary copy of the checkout."""
    with tempfile.TemporaryDirectory(prefix="vitruvius-mutants-") as folder:
        copy = Path(folder, "checkout")
        shutil.copytree(ROOT, copy, ignore=shutil.ignore_patterns(*LEFT_OUT), symlinks=True)
        yield copy


class MutantTests:
    """The tests that belong to some files, and the process that runs the tests in the copy."""

    def __init__(self, copy: Path, out: Path, files: Iterable[str], seconds: float) -> None:
        """Start the process, which collects the tests."""
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

    def tried(self, kind: str, mutant: Mutant, seconds: float) -> MutantRow:
        """Change the file, run the tests that belong to the file, and restore the file."""
        first = first_line(self.copy, mutant)
        measured = self.measured(belonging(mutant.file))
        place = self.copy / mutant.file
        content = place.read_bytes()
        place.write_bytes(mutant.applied(content))
        try:
            row = self.noticing(kind, mutant, first, measured, seconds)
            if first and not row.by:
                # Tests that compute values at their import have used the unchanged function.
                row = self.noticing(kind, mutant, 0, measured, seconds)
        finally:
            place.write_bytes(content)
        if row.by:
            self.noticed[mutant.file, row.by] += 1
        return row

    def noticing(
        self, kind: str, mutant: Mutant, first: int, measured: dict[str, Any], seconds: float
    ) -> MutantRow:
        """Run the tests with the function at line ``first`` replaced, or for 0 with new imports."""
        file = mutant.file if mutant.file.endswith(".py") else ""
        while True:
            order, left_out = self.order(mutant, first, measured, seconds)
            limit = 20 + 3 * sum(measured["seconds"][name] for name in order)
            failed = self.ask(order, limit, file=file, line=first)["failed"][:1]
            # A test that fails at random, as by a limit of seconds, seldom fails twice.
            again = [name for name in failed if name in order]
            if not again or self.ask(again, limit, file=file, line=first)["failed"]:
                return MutantRow(
                    kind=kind, mutant=mutant, by="".join(failed), tests=len(order), left_out=left_out
                )
            measured["failed"] += failed

    def order(
        self, mutant: Mutant, first: int, measured: dict[str, Any], seconds: float
    ) -> tuple[list[str], int]:
        """Return the tests to run, and the number of tests left out.

        Tests with the name of the file come first, then tests that noticed mutants of the file, then the
        fastest. Tests that do not enter the changed function are left out, if others enter it.
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
        """Return the seconds of each test and the functions that the test enters, measured once."""
        found: dict[str, Any] = {"failed": [], "seconds": {}, "entered": {}, "others": 0}
        for path in paths:
            content = sha256()
            place = self.copy / path
            for file in sorted((place if place.is_dir() else place.parent).rglob("*")):
                content.update(file.read_bytes() if file.is_file() else b"")
            key = f"{path} {content.hexdigest()[:12]}"
            if key not in self.known:
                say(f"measuring {path}")
                measured = self.ask([path], 3600, measure=self.seconds)
                if not measured.get("seconds"):
                    raise StudyFailed(f"{path}: no test could be measured: {measured['failed']}")
                self.known[key] = measured
                write_whole(self.file, json.dumps(self.known).encode())
                say(f"{len(self.known[key]['seconds'])} tests; failing already: {self.known[key]['failed']}")
            found["failed"] += self.known[key]["failed"]
            found["others"] += self.known[key]["others"]
            for name in ("seconds", "entered"):
                found[name] |= self.known[key][name]
        return found

    def ask(
        self, order: Sequence[str], seconds: float, measure: float = 0, file: str = "", line: int = 0
    ) -> dict[str, Any]:
        """Run tests in this order until one fails, or measure all for ``measure`` seconds."""
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
    """Return the first line of the Python function that a mutant changes, or 0 outside any function."""
    if not mutant.file.endswith(".py"):
        return 0
    functions = [
        min([node.lineno, *(each.lineno for each in node.decorator_list)])
        for node in ast.walk(ast.parse((root / mutant.file).read_bytes()))
        if isinstance(node, ast.FunctionDef) and node.body[0].lineno <= mutant.line <= (node.end_lineno or 0)
    ]
    return min(functions, default=0)
