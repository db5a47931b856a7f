"""Each kind of mistake in a rule file is found, at its place, with a hint, within two seconds."""

import importlib
import pkgutil
import shutil
import time
from collections.abc import Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import pytest

from logic.errors import Finding
from logic.grammar import SHIPPED, find
from tests.logic import mistakes
from tests.logic.mistakes import Mistake

SECONDS = 2.0
"""CPU time in which a mistake is found."""

TABLES = [
    importlib.import_module(f"{mistakes.__name__}.{each.name}")
    for each in pkgutil.iter_modules(mistakes.__path__)
]
MISTAKES = {each.title: each for table in TABLES for each in table.MISTAKES if isinstance(each, Mistake)}


def linted(folder: Path) -> tuple[list[Finding], float]:
    """What lint says of a grammar outside of this package, and the CPU seconds that it took."""
    from pyswip import Prolog

    from logic.linter import findings

    begin = time.process_time()
    found = findings(find(folder))
    seconds = time.process_time() - begin
    list(Prolog.query(f"forall((source_file(F), sub_atom(F,0,_,_,'{folder}')), unload_file(F))"))
    return found, seconds


@pytest.fixture(scope="module")
def solver() -> Iterator[ProcessPoolExecutor]:
    """One process for all cases: SWI-Prolog is one engine a process, and takes a while to load the core."""
    with ProcessPoolExecutor(1, get_context("spawn")) as pool:
        pool.submit(linted, SHIPPED / "family").result()
        yield pool


@pytest.mark.parametrize("title", MISTAKES)
def test_a_mistake_is_found_at_its_place(title: str, solver: ProcessPoolExecutor, tmp_path: Path) -> None:
    mistake = MISTAKES[title]
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / mistake.grammar, folder)
    text = (folder / mistake.file).read_text()
    old = mistake.old or text[len(text) :]
    if mistake.old:
        assert text.count(old) == 1
        before, after = text.split(old)
    else:
        before, after = text, "\n"
    (folder / mistake.file).write_text(before + mistake.new + after)
    result: Future = solver.submit(linted, folder)
    findings, seconds = result.result(timeout=60)
    found = [finding for finding in findings if mistake.says in finding.text]
    assert found, findings
    lines = (before + mistake.new[: mistake.new.index(mistake.at)]).split("\n")
    place = (str(folder / mistake.file), len(lines), len(lines[-1]) + 1)
    assert (found[0].severity, found[0].file, found[0].line, found[0].column) == (mistake.severity, *place)
    assert seconds <= SECONDS
