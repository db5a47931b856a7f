"""Each kind of mistake in a rule file is found, at its place, with a hint, within two seconds."""

import importlib
import pkgutil
import re
import shutil
import time
import warnings
from concurrent.futures import Future, ProcessPoolExecutor
from pathlib import Path

import clingo
import pytest
from clingo import Function, Number

from tests.logic.language import mistakes
from tests.logic.language.mistakes import Mistake
from tests.programs import PATIENCE
from vitruvius.logic import Finding, GrammarError, GrammarWarning, generate
from vitruvius.logic.grammar import RULES, SHIPPED, find, shipped
from vitruvius.logic.layout.differences import Differences
from vitruvius.logic.layout.program import CORE
from vitruvius.logic.placement import prolog

SECONDS = 2.0
"""CPU time in which a mistake must be found, seconds."""

TABLES = [
    importlib.import_module(f"{mistakes.__name__}.{each.name}")
    for each in pkgutil.iter_modules(mistakes.__path__)
]
MISTAKES = {each.title: each for table in TABLES for each in table.MISTAKES if isinstance(each, Mistake)}


def linted(folder: Path) -> tuple[list[Finding], float]:
    """Return lint's findings about a grammar outside of this package, and its CPU time in seconds."""
    from vitruvius.logic.language.linter import findings

    prolog.load(RULES / "core.pl")
    begin = time.process_time()
    found = findings(find(folder))
    seconds = time.process_time() - begin
    return found, seconds


def line_of(file: Path, words: str) -> str:
    """Return the number of the line of a file that begins with words."""
    lines = file.read_text().splitlines()
    return str(next(number for number, line in enumerate(lines, start=1) if line.startswith(words)))


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
    findings, seconds = result.result(timeout=PATIENCE)
    says = re.sub(
        r"line \[(\w+\.pl): (.+?)\]",
        lambda named: f"line {line_of(folder / named[1], named[2])}",
        mistake.says,
    )
    found = [finding for finding in findings if says in finding.text]
    assert found, findings
    lines = (before + mistake.new[: mistake.new.index(mistake.at)]).split("\n")
    place = (str(folder / mistake.file), len(lines), len(lines[-1]) + 1)
    assert (found[0].severity, found[0].file, found[0].line, found[0].column) == (mistake.severity, *place)
    assert seconds <= SECONDS


def of_the_core(grammar: str) -> set[tuple[str, int]]:
    """Return each predicate of the core with an atom in any of its programs, grounded with a grammar.

    The grammar's own predicates are excluded.
    """
    types = [Function("bedroom" if grammar != "clinic" else "ward"), Function("bed")]
    terms = {"t": types[0], "f": types[1], "s": Function("north"), "i": Number(0), "b": Number(9)}
    text = "".join(
        file.read_text() for part in (".", "language", "room") for file in (RULES / part).glob("*.lp")
    )
    parts = [
        (name, [terms.get(each, Number(1)) for each in arguments.split(",") if each])
        for name, arguments in re.findall(r"#program (\w+)\(?([\w,]*)\)?\.", text)
    ]
    signatures = list[tuple[str, int, bool]]()
    for stage in ("house", "room"):  # neither reads all rules
        control = clingo.Control(["-crooms=3", f"-cthis_room={types[0]}"], logger=lambda *_: None)
        Differences(control, (CORE, *find(grammar).asp), [(stage, [])], lambda _: None).load()
        control.ground([("base", []), *parts])
        signatures += control.symbolic_atoms.signatures
    named = set(re.findall(r"[a-z]\w*(?=\()", re.sub(r"%\*.*?\*%|%.*", "", text)))
    return {(name, arity) for name, arity, _ in signatures if name in named}


@pytest.mark.parametrize(
    ("grammar", "file"),
    [(name, file.name) for name in shipped() for file in sorted((SHIPPED / name).glob("*.lp"))],
)
def test_a_fact_of_each_predicate_of_the_core_is_refused_or_an_input(
    grammar: str, file: str, solver: ProcessPoolExecutor, tmp_path: Path
) -> None:
    """A grammar may state the predicates that the core names by ``#defined``, in each of its programs."""
    text = "".join(rules.read_text() for rules in RULES.rglob("*.lp") if rules.name != "own.lp")
    inputs = {(name, int(arity)) for name, arity in re.findall(r"#defined (\w+)/(\d)", text)}
    # The topology is read before the rules. Only a star derives the side of a fixed room.
    apart = {("topology", 1)} | ({("side", 2)} if find(grammar).shares_walls else set())
    core = sorted(of_the_core(grammar) - apart)
    assert len(core) > 50
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / grammar, folder)
    begin = len((folder / file).read_text().split("\n"))
    with (folder / file).open("a") as rules:
        rules.writelines(f"{name}({','.join('1' * arity)}).\n" for name, arity in core)
    findings, _ = solver.submit(linted, folder).result(timeout=PATIENCE)
    refused = {
        core[finding.line - begin]
        for finding in findings
        if finding.file == str(folder / file) and finding.severity == "error" and "the core" in finding.text
    }
    assert refused == set(core) - inputs


def test_a_grammar_with_an_error_makes_no_house(tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "family", folder)
    with (folder / "rooms.lp").open("a") as rules:
        rules.write("room(0,bathroom).\n")
    with pytest.raises(GrammarError, match=r"rooms\.lp:13:1: the core alone derives room/2"):
        next(generate(rooms=4, grammar=folder))


def test_generate_warns_once_of_a_rule_without_effect(tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "family", folder)
    with (folder / "rooms.lp").open("a") as rules:
        rules.write(":- room(R,T), R > 999.\n")
    with pytest.warns(
        GrammarWarning, match=r"rooms\.lp:13:1: warning: this rule never binds: :- room\(R,T\)"
    ):
        next(generate(rooms=1, grammar=folder))
    with warnings.catch_warnings(action="error"):
        next(generate(rooms=1, grammar=folder, cell=0.3))  # by another process
