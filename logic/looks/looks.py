"""Looks of types on a plan: ``looks.json``, for all grammars, and a file of this name in a grammar's folder.

The file is no rule file. A new colour changes neither houses nor the hash that names their rules.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cache
from itertools import islice, pairwise
from pathlib import Path
from typing import Any, TypeGuard

from vitruvius.logic.encoding import illegible
from vitruvius.logic.errors import GrammarError
from vitruvius.logic.grammar import SHIPPED, folder, shipped
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import ORIGINAL
from vitruvius.logic.opener import content_of, from_json
from vitruvius.logic.spelling import closest, listed

FILE_NAME = "looks.json"
"""Name of the file, here and in a grammar's folder."""

MOST_BYTES = 1 << 20
"""Largest size of a file of looks, in bytes."""

Form = tuple[str, tuple[float, ...]]
"""Line of a symbol, in its piece's own frame: across from 0 to 1, and from the back (0) to the front (1).

``box`` and ``oval``: two opposite corners; ``line``: points; ``curve``: a point, then three for each cubic
Bézier curve; ``ring``: a circle by its centre and its radius, in lengths of the piece's shorter side.
"""

FORMS = {
    "box": "4 numbers",
    "oval": "4 numbers",
    "ring": "3 numbers",
    "line": "2 points or more",
    "curve": "1 + 3 n points",
}

Where = tuple[str | int, ...]
"""Keys and indices that lead to a value in JSON."""


@dataclass(frozen=True)
class Looks:
    """Looks of types. A type without looks is drawn with its name, in a colour of ``palettes.json``."""

    rooms: dict[str, str] = field(default_factory=dict)
    """Colours of floors, ``#rrggbb``."""
    pieces: dict[str, str] = field(default_factory=dict)
    """Names of symbols, by piece type."""
    heights: dict[str, float] = field(default_factory=dict)
    """Heights of pieces, metres, for files of solids. Plans do not show them."""
    symbols: dict[str, tuple[Form, ...]] = field(default_factory=dict)
    names: dict[str, str] = field(default_factory=dict)
    """Names in plain words of types whose names in files differ."""

    def symbol(self, kind: str) -> tuple[Form, ...] | None:
        """Return the symbol of a piece type, or None."""
        return self.symbols[self.pieces[kind]] if kind in self.pieces else None

    def name(self, kind: str) -> str:
        """Return the name of a type in plain words: ``coffee table`` for ``coffeeTable``."""
        return self.names.get(kind) or spaced(kind)

    def __or__(self, other: Looks) -> Looks:
        """Return these looks, overridden by others."""
        parts = ((getattr(self, key), getattr(other, key)) for key in Looks.__dataclass_fields__)
        return Looks(*(mine | its for mine, its in parts))


def spaced(name: str) -> str:
    """Return a name as words."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])|_", " ", name).lower()


def looks_of(house: House, grammar: str | Path | None = None) -> Looks:
    """Return the looks of a house's types, from its grammar's folder if the grammar is shipped.

    The house's provenance names the grammar. Houses in the original's files have the looks of the paper's
    grammar. Raises ``GrammarError`` for a wrong file of looks, with file, line and column.
    """
    if grammar is not None:
        folder(grammar)  # raises for a folder that is no grammar
        return folder_looks(SHIPPED / grammar if str(grammar) in shipped() else Path(grammar))
    named = house.provenance.grammar if house.provenance else ""
    named = "paper" if house.topology == ORIGINAL else named
    return _shipped_looks(named) if named in shipped() else DEFAULT


def folder_looks(directory: Path) -> Looks:
    """Return the looks of a grammar's folder over those of all grammars. Raises as ``looks_of`` does."""
    file = directory / FILE_NAME
    if not directory.is_dir():
        raise GrammarError("there is no such directory of a grammar", directory)
    if not file.exists():
        return DEFAULT
    looks, errors = read_looks(file, DEFAULT)
    if errors:
        raise errors[0]
    return DEFAULT | looks


@cache
def _shipped_looks(name: str) -> Looks:
    return folder_looks(SHIPPED / name)


def read_looks(file: Path, under: Looks) -> tuple[Looks, list[GrammarError]]:
    """Return a file's looks and all its mistakes, by line and column.

    Symbols may also be those of ``under``.
    """
    try:
        text = _text(file)
        data = from_json(text.encode(), pairs=_Pairs)
        faults = list(islice(_faults(data, under), MAX_FAULTS))
    except GrammarError as error:
        return Looks(), [error]
    except json.JSONDecodeError as error:
        return Looks(), [GrammarError(f"not JSON: {error.msg}", file, error.lineno, error.colno)]
    except ValueError as error:
        return Looks(), [GrammarError(str(error), file)]
    if faults:
        at = _places(text)
        return Looks(), [GrammarError(why, file, *at.get(where, (1, 1))) for where, why in faults]
    plain = {key: dict(pairs) for key, pairs in data}
    symbols = {
        name: tuple((form, tuple(map(float, numbers))) for form, numbers in forms)
        for name, forms in plain.pop("symbols", {}).items()
    }
    return Looks(**plain, symbols=symbols), []


def _text(file: Path) -> str:
    """Return the text of a file of looks. Raises ``GrammarError`` if the file cannot or must not be read."""
    try:
        content = content_of(file, MOST_BYTES, unpack=False)
    except OSError as error:
        raise GrammarError(f"cannot be read: {error.strerror}", file) from None
    if wrong := illegible(content):
        line, column, why = wrong
        raise GrammarError(why, file, line, column)
    return content.decode("utf-8-sig")


def unused(file: Path, rooms: Iterable[str], pieces: Iterable[str]) -> Iterator[GrammarError]:
    """Yield errors, by line and column, for types in a file of looks that the grammar does not have."""
    looks, _ = read_looks(file, DEFAULT)
    at = _places(file.read_text("utf-8-sig")) if looks != Looks() else {}
    rooms, pieces = set(rooms), set(pieces)
    for key, known in (("rooms", rooms), ("pieces", pieces), ("heights", pieces), ("names", rooms | pieces)):
        for name in getattr(looks, key):
            if name not in known:
                close = closest(name, known)
                hint = f": did you mean {close}?" if close else ""
                yield GrammarError(
                    f"the grammar has no {key[:-1]} {name}{hint}", file, *at.get((key, name), (1, 1))
                )


class _Pairs(list[tuple[str, Any]]):
    """Keys and values of an object, in order."""


MAX_FAULTS = 20
"""Largest number of faults that are reported for a file. Each may compare a name with many names."""

Fault = tuple[Where, str]


def _faults(data: Any, under: Looks) -> Iterator[Fault]:
    """Yield the faults of a file, by their place in it."""
    keys = [*Looks.__dataclass_fields__]
    if not isinstance(data, _Pairs):
        yield (), f"expected an object with {', '.join(keys)}"
        return
    yield from _twice((), data)
    symbols = set(under.symbols) | {
        name for key, pairs in data if key == "symbols" and isinstance(pairs, _Pairs) for name, _ in pairs
    }
    for key, pairs in data:
        if key not in keys:
            yield (key,), f"there is no {key}{_meant(key, keys)}"
        elif not isinstance(pairs, _Pairs):
            yield (key,), f"{key}: expected an object with a value for each name"
        else:
            yield from _twice((key,), pairs)
            for name, value in pairs:
                yield from (
                    ((key, *where), f"{name}: {why}") for where, why in _wrong(key, name, value, symbols)
                )


def _twice(where: Where, pairs: _Pairs) -> Iterator[Fault]:
    for key in {
        one for (one, _), (other, _) in pairwise(sorted(pairs, key=lambda pair: pair[0])) if one == other
    }:
        yield (*where, key), f"{key} appears twice: keep one of them"


def _wrong(key: str, name: str, value: Any, symbols: set[str]) -> Iterator[Fault]:
    """Yield the faults of the value of a name."""
    shown, why = json.dumps(value), ""
    if key == "rooms":
        why = _wrong_colour(value)
    elif key == "pieces" and not (isinstance(value, str) and value in symbols):
        why = f"there is no symbol {shown}{_meant(str(value), symbols)}"
    elif key == "names" and not (isinstance(value, str) and re.fullmatch(r"\S[^\n]{0,39}", value)):
        why = f"{shown} is not a name: give words with at most 40 letters"
    elif key == "heights" and not (_is_number(value) and 0 < value <= 10):
        why = f"{shown} is not a height: give metres, more than 0 and at most 10"
    elif key == "symbols" and isinstance(value, list):
        wrong = ((index, _wrong_form(form)) for index, form in enumerate(value))
        yield from (((name, index), words) for index, words in wrong if words)
    elif key == "symbols":
        why = 'expected a list of forms, as [["line", [0, 0.5, 1, 0.5]]]'
    if why:
        yield (name,), why


def _wrong_colour(value: Any) -> str:
    if not (isinstance(value, str) and re.fullmatch("#[0-9a-fA-F]{6}", value)):
        shown = json.dumps(value)
        return f'{shown} is not a colour: write it as "#dbe6f4", two digits each of red, green and blue'
    if (found := contrast(value, INK)) < MIN_CONTRAST:
        return f"text is not readable on {value}: the contrast is {found:.1f}, less than {MIN_CONTRAST}"
    return ""


def _wrong_form(form: Any) -> str:
    if not (
        isinstance(form, list) and len(form) == 2 and isinstance(form[0], str) and isinstance(form[1], list)
    ):
        return 'a form is its name and its numbers, as ["line", [0, 0.5, 1, 0.5]]'
    name, numbers = form
    if name not in FORMS:
        return f"there is no form {name}{_meant(name, FORMS)}"
    count = len(numbers)
    fits = {"ring": count == 3, "line": count >= 4 and count % 2 == 0, "curve": count >= 8 and count % 6 == 2}
    if not fits.get(name, count == 4):
        return f"a {name} has {FORMS[name]}, not {count} numbers"
    if not all(_is_number(number) and -0.5 <= number <= 1.5 for number in numbers):
        return "its numbers are shares of the piece's sides, from 0 to 1"
    return ""


def _is_number(value: Any) -> TypeGuard[float]:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _meant(name: str, names: Iterable[str]) -> str:
    names = sorted(names)
    close = closest(name, names)
    return f": did you mean {close}?" if close else f": there are {listed(names)}"


def _places(text: str) -> dict[Where, tuple[int, int]]:
    """Return line and column of each value's key in a JSON text, or of the value in a list.

    If a key is there twice, the result has its second place.
    """
    found: dict[Where, tuple[int, int]] = {(): (1, 1)}
    stack: list[list[Any]] = []  # the container's bracket, and its current key or index
    previous, line, start = "", 1, 0
    for token in re.finditer(r'"(?:\\.|[^"\\])*+"?|[{}\[\]:,\n]|[^\s{}\[\]:,"]+', text):
        mark, place = token[0], (line, token.start() - start + 1)
        if mark == "\n":
            line, start = line + 1, token.end()
            continue
        if mark in "]}":
            stack.pop()
        elif mark == "," and stack[-1][0] == "[":
            stack[-1][1] += 1
        elif mark not in ":,":
            in_list = bool(stack) and stack[-1][0] == "["
            if stack and not in_list and previous != ":":
                stack[-1][1] = json.loads(mark)
            if in_list or previous != ":":
                found[tuple(key for _, key in stack)] = place
            if mark in "[{":
                stack.append([mark, 0 if mark == "[" else ""])
        previous = mark
    return found


def contrast(one: str, other: str) -> float:
    """Return the contrast ratio of two colours by WCAG 2.2, 1 to 21."""
    low, high = sorted((_luminance(one), _luminance(other)))
    return (high + 0.05) / (low + 0.05)


def _luminance(colour: str) -> float:
    """Return the relative luminance of a colour by WCAG 2.2, 0 to 1."""
    red, green, blue = (int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5))
    linear = (
        value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4
        for value in (red, green, blue)
    )
    return sum(weight * value for weight, value in zip((0.2126, 0.7152, 0.0722), linear, strict=True))


INK = "#3d4450"
"""Colour of words on a plan."""

MIN_CONTRAST = 4.5
"""Least contrast of words with their background: WCAG 2.2, level AA."""

DEFAULT, _ERRORS = read_looks(Path(__file__).with_name(FILE_NAME), Looks())
if _ERRORS:
    raise _ERRORS[0]
