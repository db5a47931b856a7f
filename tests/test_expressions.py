"""Regular expressions end soon, whatever text a file has: each is found in the code and timed."""

import ast
import re
from collections import deque
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from re import _parser  # pyright: ignore[reportAttributeAccessIssue]
from time import process_time
from typing import Any, NamedTuple

import pytest

ROOT = Path(__file__).parents[1]

FOLDERS = ("logic", "sim", "agent", "vitruvius")

OURS = {"logic/language/reference.py", "logic/browser/playground/npm.py"}
"""Modules that read only files that come with the project."""

CALLS = {"match", "fullmatch", "search", "findall", "finditer", "sub", "split"}

LENGTHS = ((1_000, 0.2), (20_000, 0.3), (200_000, 1.0))
"""Numbers of characters, and limits of processor time in seconds: a superlinear time shows at the shorter
ones."""


class Expression(NamedTuple):
    """Regular expression, with its call, its flags and its place in the code."""

    pattern: Any
    call: str
    flags: int
    place: str


def expressions() -> Iterator[Expression]:
    """Yield every expression in the code; a compiled one with each call of its name."""
    for file, tree in trees().items():
        named = {
            id(node.value): node.targets[0].id
            for node in ast.walk(tree)
            if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)
        }
        for node in ast.walk(tree):
            if not isinstance(node, ast.Call):
                continue
            place, what = f"{file}:{node.lineno}", node.func
            for word in node.keywords:
                if word.arg == "pattern" and isinstance(word.value, ast.Constant):  # msgspec's ``Meta``
                    yield Expression(word.value.value, "search", 0, place)
            if not (isinstance(what, ast.Attribute) and ast.unparse(what.value) == "re"):
                continue
            if what.attr in CALLS:
                yield Expression(text_of(node.args[0]), what.attr, flags_of(node), place)
            elif what.attr == "compile":
                for call in sorted(applied().get(named.get(id(node), ""), {"finditer"})):
                    yield Expression(text_of(node.args[0]), call, flags_of(node), place)


@cache
def trees() -> dict[str, ast.Module]:
    files = (path for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*.py")))
    texts = {str(path.relative_to(ROOT)): path.read_text() for path in files}
    return {
        file: ast.parse(text)
        for file, text in texts.items()
        if file not in OURS and ("import re\n" in text or "Meta" in text)
    }


@cache
def applied() -> dict[str, set[str]]:
    """Return the calls of each compiled expression, by its name."""
    found: dict[str, set[str]] = {}
    for node in (each for tree in trees().values() for each in ast.walk(tree)):
        if isinstance(node, ast.Attribute) and node.attr in CALLS and isinstance(node.value, ast.Name):
            found.setdefault(node.value.id, set()).add(node.attr)
    return found


def text_of(node: ast.expr) -> Any:
    """Return the text of an expression, with a letter for each inserted value; None if not a literal."""
    if isinstance(node, ast.JoinedStr):
        return "".join(each.value if isinstance(each, ast.Constant) else "x" for each in node.values)  # pyright: ignore
    return node.value if isinstance(node, ast.Constant) else None


def flags_of(call: ast.Call) -> int:
    names = {each.attr for each in ast.walk(call) if isinstance(each, ast.Attribute)}
    return sum(int(getattr(re, name)) for name in names & {"DOTALL", "S", "MULTILINE", "M", "IGNORECASE"})


def hostile(parsed: Any, before: str = "") -> Iterator[tuple[str, str]]:
    """Yield texts that lead to each part of an expression, and the text that is repeated there.

    They are the part, and everything up to it.
    """
    for item in parsed:
        kind, value = str(item[0]), item[1]
        inner = {"SUBPATTERN": lambda v: [v[3]], "ATOMIC_GROUP": lambda v: [v], "BRANCH": lambda v: v[1]}
        parts = [value[2]] if kind.endswith("REPEAT") else inner.get(kind, lambda _: [])(value)
        if kind.endswith("REPEAT"):
            yield before, sample(value[2])
        for part in parts:
            yield from hostile(part, before)
        before += sample([item])
        yield "", before


def sample(parsed: Any) -> str:
    """Return a short text that an expression matches."""
    return "".join(_sample(str(kind), value) for kind, value in parsed)


def _sample(kind: str, value: Any) -> str:
    makes = {
        "LITERAL": lambda: chr(value),
        "NOT_LITERAL": lambda: "a" if value != ord("a") else "b",
        "ANY": lambda: "a",
        "IN": lambda: _letter(value),
        "SUBPATTERN": lambda: sample(value[3]),
        "BRANCH": lambda: sample(value[1][0]),
        "ATOMIC_GROUP": lambda: sample(value),
    }
    if kind.endswith("REPEAT"):
        return sample(value[2]) * value[0]
    return makes.get(kind, str)()


def _letter(choices: Any) -> str:
    """Return a letter of a set, if possible one that other expressions have, too."""
    tests = {
        "LITERAL": lambda letter, value: ord(letter) == value,
        "RANGE": lambda letter, value: value[0] <= ord(letter) <= value[1],
        "CATEGORY": lambda letter, value: bool(re.match(CATEGORIES[str(value)], letter)),
    }
    own = [chr(value) for kind, value in choices if str(kind) == "LITERAL"]
    negated = str(choices[0][0]) == "NEGATE"
    for letter in [*" 0aA", *own, *map(chr, range(1, 256))]:
        if any(tests[str(kind)](letter, value) for kind, value in choices if value is not None) != negated:
            return letter
    raise AssertionError(f"no letter of {choices}")


CATEGORIES = {
    f"CATEGORY_{no}{name}": rf"\{letter.upper() if no else letter}"
    for name, letter in (("DIGIT", "d"), ("SPACE", "s"), ("WORD", "w"))
    for no in ("", "NOT_")
}


@pytest.mark.parametrize("expression", list(expressions()), ids=lambda each: f"{each.place} {each.call}")
def test_an_expression_takes_a_time_that_grows_as_its_text(expression: Expression) -> None:
    """The texts have up to 200,000 characters that lead the expression on and then end differently."""
    pattern, call, flags, place = expression
    assert pattern is not None, f"{place}: write the expression where it is compiled, for this test"
    compiled: Any = re.compile(pattern, flags)
    texts = {(start, unit) for start, unit in hostile(_parser.parse(pattern, flags)) if unit}
    # The texts are in lines, too: a part that may cross line ends begins again in each.
    lines = {("", unit + "\n") for _, unit in texts}
    for start, unit in texts | lines:
        for length, most in LENGTHS if start else LENGTHS[:-1]:
            text: Any = start + unit * (length // len(unit)) + "\0"
            text = text.encode("latin-1", "replace") if isinstance(pattern, bytes) else text
            began = process_time()
            found = getattr(compiled, call)(*[text[:0]] * (call == "sub"), text)
            if call == "finditer":
                deque(found, maxlen=0)  # a list of them would be scanned as garbage
            took = process_time() - began
            assert took < most, f"{place}: {took:.2g} s, {length:,} characters: {start[:20]!r}, {unit[:20]!r}"
