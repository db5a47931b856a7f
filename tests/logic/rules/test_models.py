"""Tests of rules in clingo's language: small programs of one rule file, and their consequences.

A file ``NAME.lpt`` begins with ``%#``, rule files and the parts of them to ground. Each case then has

- ``%? title``, and the facts that are given, which may stand for choices;
- ``%| parts`` and ``%c constants``, in the place of the file's;
- ``%= facts``: of each predicate named here, these atoms follow and no others; ``%0 p/2`` for no atom;
- ``%+ facts``: with these added there is a stable model;
- ``%! facts``: with these added there is none;
- ``%n N``: the number of stable models, ``*`` for any; without it, there is one.

A difference ``&diff { a - b } <= c`` is read as the atom ``diff(a,b,c)``.
"""

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator
from pathlib import Path

import clingo
import pytest

from vitruvius.logic.grammar import RULES
from vitruvius.logic.layout.ground import Instances

FILES = sorted(Path(__file__).parent.glob("*.lpt"))
DIFFERENCE = re.compile(r"&diff \{ (.+?) - (\S+) \} <= (.+?)(?=\s*:-|\.\s)")
MOST_RULES = 20_000
"""Largest number of ground rules of a small program, as a rule without a literal may never end."""

MARK = re.compile(r"(?m)^%([#|c=0+!n]) ?(.*)$")


def ground(text: str, parts: str = "", constants: str = "") -> clingo.Control:
    """Return the ground program of some parts of a text."""
    arguments = ["0", *(f"-c{constant}" for constant in constants.split())]
    control = clingo.Control(arguments, logger=lambda code, message: None)
    control.register_observer(Instances(MOST_RULES))
    control.add("base", [], text)
    terms = [clingo.parse_term(part) for part in f"base {parts}".split()]
    control.ground([(term.name, term.arguments) for term in terms])
    return control


def models(rules: str, given: str, parts: str, constants: str) -> Iterator[clingo.Model]:
    """Yield all stable models of some parts of rules, with the given facts."""
    control = ground(f"{given}\n#program base.\n{rules}", parts, constants)
    with control.solve(yield_=True) as found:
        yield from found


def atoms(text: str) -> frozenset[clingo.Symbol]:
    """Return the facts of a text, in which ranges and pools stand for several facts."""
    control = ground(text)
    return frozenset(atom.symbol for atom in control.symbolic_atoms if atom.is_fact)


def signature(atom: clingo.Symbol) -> tuple[str, int]:
    return atom.name, len(atom.arguments)


def rules_of(names: Iterable[str]) -> str:
    """Return the text of rule files without the files that they include."""
    text = "\n#program base.\n".join((RULES / name).read_text() for name in names)
    return DIFFERENCE.sub(r"diff(\1,\2,\3)", text.replace("#include", "%"))


def case_of(text: str) -> tuple[str, dict[str, list[str]]]:
    """Return the given facts of a case, and its marks."""
    marks = defaultdict[str, list[str]](list)
    for kind, words in MARK.findall(text):
        marks[kind].append(words)
    return MARK.sub("", text), marks


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_what_follows_from_small_programs(file: Path) -> None:
    head, *cases = re.split(r"(?m)^%\? ", file.read_text())
    _, of_file = case_of(head)
    names = [word for text in of_file["#"] for word in text.split() if word.endswith(".lp")]
    rules = rules_of(names)
    for case in cases:
        title, _, body = case.partition("\n")
        given, marks = case_of(body)
        parts, constants = (" ".join(marks[kind] or of_file[kind]) for kind in "|c")
        expected, known = atoms("\n".join(marks["="])), atoms(given)
        none = {(name, int(arity)) for text in marks["0"] for name, arity in re.findall(r"(\S+)/(\d)", text)}
        compared, found = {*map(signature, expected)} | none, 0
        (number,) = marks["n"] or "1"
        for model in models(rules, given, parts, constants) if number != "*" else ():
            found += 1
            if compared:
                derived = {atom for atom in model.symbols(atoms=True) if signature(atom) in compared}
                assert sorted(map(str, derived - known)) == sorted(map(str, expected - known)), title
        assert number in ("*", str(found)), title
        for kind, possible in (("+", True), ("!", False)):
            for facts in marks[kind]:
                some = any(models(rules, f"{given}\n{facts}", parts, constants))
                assert some == possible, f"{title}: {facts}"


def test_there_are_files() -> None:
    assert len(FILES) >= 3
