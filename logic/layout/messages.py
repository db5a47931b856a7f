"""Messages of clingo as errors with file, line and column, and with the user's own text."""

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from vitruvius.logic.errors import GrammarError

_PLACED = re.compile(
    r"^(?P<file>.+?):(?P<line>\d+):(?P<column>\d+)(?:-(?:(?P<last>\d+):)?(?P<end>\d+))?:"
    r" (?P<kind>\w+): (?P<text>.*)$",
    re.S,
)
_UNSAFE = re.compile(r":(?P<line>\d{1,9}):(?P<column>\d{1,9})[-\d:]{0,40}: note: '(?P<name>\S+)' is unsafe")

_COMMENTS = re.compile(r'"(?:\\.|[^"\\\n])*+"?|%\*.*?(?:\*%|(?P<open>\Z))|%[^\n]*', re.DOTALL)
"""Strings and comments, and the start of one that does not end."""

REMARKS = {
    "operation undefined": "arithmetic takes whole numbers; where there is none, the rule is passed over",
    "tuple ignored": "a sum adds whole numbers: the first term of each tuple",
    "global variable in tuple": "outside the aggregate it has a value, so it counts once: rename it inside",
}
"""Clingo's remarks, and their consequences."""

SYNTAX = {
    re.compile(r"^\s*(//|/\*|#(\s|$))"): "a comment begins with %",
    re.compile(r"\\\+|(?<!\w)!(?!=)"): "not is a word, as in not side(R,north)",
    re.compile(
        r"->|\bthen\b|\)\s*=>"
    ): "write the consequence first, head :- body, or what must not be, :- body",
    re.compile(
        r"(?<!#)\b(count|sum|min|max)\s*\{"
    ): "a # stands before the name, as in #count{ R : room(R,hall) }",
    re.compile(r"\{[^{}:|]*\|"): "a condition follows a colon, as in #count{ R : room(R,hall) }",
    re.compile(r"=/=|=\\=|\\=|<>|~="): "unequal is !=, as in R != Q",
    re.compile(r"\b(no|Not|NOT|never|without)\s+[a-z]\w*\("): "not is a word, as in not side(R,north)",
    re.compile(r"\band\b|&"): "and is a comma",
    re.compile(r"\bor\b|\|"): "or is a pool, as in room(R,(hall;study)), or a rule for each",
    re.compile(r"\bif\b|<-|:=|: -"): "if is :-, as in near(R) :- adjacent(R,Q)",
    re.compile(r"=>"): "at least is >=",
    re.compile(r"=<"): "at most is <= in .lp files",
    re.compile(r"[(,]\s*(?!not\b)[a-z]\w* [a-z]\w*\s*[,)]"): "names have no spaces, as in livingRoom",
    re.compile(r"\d\.\d"): "numbers are whole in .lp files: lengths belong in .pl files",
    re.compile(r"(?<![\w#])[A-Z]\w*\("): "predicates begin in lower case, variables in upper case",
}
"""Patterns in lines with a syntax error, and the correct notation."""


def clingo_error(remarks: Iterable[str], otherwise: str) -> GrammarError:
    """Return the first error among clingo's remarks, or else an error with the text ``otherwise``."""
    for remark in remarks:
        found = _PLACED.match(remark.strip())
        if found and found["kind"] == "error":
            return placed_error(remark)
    return GrammarError(otherwise)


def placed_error(remark: str) -> GrammarError:
    """Return a remark of clingo as an error at its place."""
    found = _PLACED.match(remark.strip())
    if not found:
        return GrammarError(remark.strip())
    file, line, column = found["file"], int(found["line"]), int(found["column"])
    if found["text"].startswith("lexer error") and "<EOF>" in found["text"]:
        return _unclosed(file)
    last, end = int(found["last"] or line), int(found["end"] or column)
    text = " ".join(found["text"].split())
    if unsafe := _UNSAFE.search(found["text"]):
        name = re.sub("^#Anon.*", "_", unsafe["name"])
        rule = excerpt(file, (line, column), (last, end))
        why = f"no literal without not gives it values, as in room({name},_)"
        if rule.startswith("#") and "{" in rule and ":" not in rule:
            why = "its terms come first, as in #count{ R : room(R,hall) }"
        elif not rule.startswith("#") and ":-" not in rule:
            why = "a fact has no variables, and a name begins in lower case"
        text = f"{name} is unsafe: {why}: {rule}"
        return GrammarError(text, file, int(unsafe["line"]), int(unsafe["column"]))
    written = excerpt(file, (line, 1), (last, None))
    hints = [hint for start, hint in REMARKS.items() if text.startswith(start)]
    if text.startswith(("syntax error", "lexer error")):
        hints = [hint for pattern, hint in SYNTAX.items() if pattern.search(written)]
    if text.startswith("syntax error"):
        end = "EOF" in text and "the last statement has no period at its end"
        hints = hints or [
            end or "perhaps a comma is missing before it, or a period after the statement above"
        ]
    return GrammarError(": ".join([text, *hints[:1], written]), file, line, column)


def _unclosed(file: str) -> GrammarError:
    """Return an error at the start of a comment that goes on to the end of its file."""
    text = Path(file).read_text("utf-8")
    opened = next((each.start() for each in _COMMENTS.finditer(text) if each["open"] is not None), 0)
    before = text[:opened].split("\n")
    why = "a comment begins here and does not end: *% ends it"
    return GrammarError(why, file, len(before), len(before[-1]) + 1)


def excerpt(file: str, begin: tuple[int, int], end: tuple[int, int | None]) -> str:
    """Return the text between two places of a file, lines and columns, on one line."""
    lines = Path(file).read_text(encoding="utf-8").split("\n")
    # If a file ends within a statement, clingo names the line after its last.
    first = min(begin[0], len(lines)) - 1
    part = lines[first : max(first + 1, end[0])]
    part[-1] = part[-1][: end[1] and end[1] - 1]
    part[0] = part[0][begin[1] - 1 :]
    return " ".join(" ".join(text.split()) for text in part)


def written(node: Any) -> str:
    """Return the user's text for a node of clingo's syntax tree."""
    begin, end = node.location.begin, node.location.end
    return excerpt(begin.filename, (begin.line, begin.column), (end.line, end.column))
