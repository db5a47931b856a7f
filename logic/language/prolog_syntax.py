"""Explanations of syntax errors, about which SWI-Prolog only says that it cannot read on."""

import re
from collections.abc import Iterator

_BRACKETS = {"(": ")", "{": "}", "[": "]"}
_RELATION = re.compile(r"(=<|>=|=:=|<|>|=)")
_UNREAD = re.compile(r"%[^\n]*|/\*.*?\*/|'[^'\n]*'|\"[^\"\n]*\"|(/\*.*)", re.DOTALL)
"""Comments and quoted text. The group is an unclosed comment, up to the end of the text."""
_OTHER_LANGUAGES = {
    "!=": "a size has one range: state its bounds",
    "&&": "write a comma",
    "||": "a size has one range: state its bounds",
    "if": "write :-",
    "in": "a range is two bounds, as in { W >= 2.4, W =< 3.7 }",
    "{": "write :- before the braces",
}


def explained(text: str, line: int, column: int, what: str) -> tuple[int, int, str]:
    """Return line, column and message for a syntax error at a place of a file's text.

    ``what`` is SWI-Prolog's name of the error.
    """
    offset = sum(len(each) + 1 for each in text.split("\n")[: line - 1]) + column - 1
    place, hint = next(_meant(_without_comments(text), offset, what), (offset, ""))
    before = text[:place].split("\n")
    return len(before), len(before[-1]) + 1, f"syntax error: {what}{hint and ': ' + hint}"


def _without_comments(text: str) -> str:
    """Return the text with blanks instead of comments and quoted text, in the same length."""
    return _UNREAD.sub(lambda found: found[1] or re.sub(r"[^\n]", " ", found[0]), text)


def _meant(code: str, offset: int, what: str) -> Iterator[tuple[int, str]]:
    """Yield possible places of the mistake with a remedy, the likeliest first; nothing if unknown."""
    begin = max((found.end() for found in re.finditer(r"\.\s+", code[:offset])), default=0)
    read, rest = code[begin:offset].rstrip(), code[offset:]
    end = begin + len(read)
    opened = _unclosed(code, begin, end)

    if what == "float_overflow":
        yield offset, "no length is so large"
    if "block_comment" in what and "/*" in code:
        yield code.index("/*"), "a comment begins here and does not end: */ ends it"
    if "quoted" in what and (quote := re.search("['\"`]", code[begin:])):
        yield begin + quote.start(), "a quote begins here and does not end"
    if what == "end_of_file" and opened:
        yield opened[-1], f"{code[opened[-1]]} is not closed"
    if what == "end_of_file":
        yield end, "a full stop is missing"
    if found := re.match(r"\s*(#[a-z]\w*)", code[begin:]):
        yield begin + found.start(1), f"{found[1]} belongs in a .lp file"
    if found := re.search(r"\d(\.\d+)?\.\.", code[begin : offset + 2]):
        yield begin + found.start(), "a range is two bounds, as in { W >= 2.4, W =< 3.7 }"
    if found := re.match(r"\s*(#|//)", code[begin:]):
        yield begin + found.start(1), "a comment begins with %"
    if found := re.search(r"([<>])\s+=$", read):
        relation = {"<": "=<", ">": ">="}[found[1]]
        yield begin + found.start(), f"write {relation} for {found[0]}"
    if what == "operator_clash" and (chain := _chain(code, offset)):
        yield chain
    if (number := re.search(r"(?<!\d)\d++(\.\d++)?$", code[begin:offset])) and (
        word := re.match(r"[A-Za-z]+", rest)
    ):
        unit = "write *" if word[0][0].isupper() else "a number has no unit, and lengths are metres"
        yield begin + number.start(), f"{number[0]}{word[0]}: {unit}"
    if re.search(r"(^|[^\w.])\.$", read) and rest[:1].isdigit():
        yield end - 1, "a number begins with a digit: write 0 before the point"
    if found := re.search(r"(?<!\d)\d++\.$", read + "." if re.match(r"\.\s*[,})]", rest) else read):
        yield begin + found.start(), f"a number ends with a digit: write {found[0]}0"
    if opened and re.match(r"\.(\s|$)", rest):
        yield opened[-1], f"{code[opened[-1]]} is not closed"
    if read.endswith(","):
        yield end - 1, "nothing follows the comma"
    if rest[:1] == ",":
        yield offset, "nothing stands before the comma"
    if rest[:1] in {")", "}", "]"}:
        closes = f"and {code[opened[-1]]} is open" if opened else "and no bracket is open"
        yield offset, f"{rest[0]} stands here, {closes}"
    if rest[:1] == "(" and (name := re.search(r"\b[A-Z]\w*$", read)):
        yield begin + name.start(), f"a predicate begins in lower case: {name[0].lower()}"
    for word, hint in _OTHER_LANGUAGES.items():
        is_there = rest.startswith(word) and not re.match(r"\w", rest[len(word) :])
        if is_there and not (word == "{" and opened):
            yield offset, hint
    if opened and re.search(r"[\w)}]$", read) and re.match(r"[\w({]", rest):
        yield offset, "a comma or an operator is missing before it"
    if not opened and re.search(r"[)}]$", read) and re.match(r"\w", rest):
        yield end, "a full stop is missing"


def _chain(code: str, offset: int) -> tuple[int, str] | None:
    """Return the place of two bounds in one, as in ``3 =< W =< 4``, and a remedy."""
    begin = max(code.rfind(each, 0, offset) for each in ",{(") + 1
    parts = _RELATION.split(re.split(r"[,})]", code[begin:])[0])
    if len(parts) != 5:
        return None
    low, first, size, second, high = map(str.strip, parts)
    begin += len(parts[0]) - len(parts[0].lstrip())
    return begin, f"one bound each: write {low} {first} {size}, {size} {second} {high}"


def _unclosed(code: str, begin: int, end: int) -> list[int]:
    """Return the places of the brackets that are open at the end."""
    opened: list[int] = []
    for place in range(begin, end):
        if code[place] in _BRACKETS:
            opened.append(place)
        elif opened and code[place] == _BRACKETS[code[opened[-1]]]:
            opened.pop()
    return opened
