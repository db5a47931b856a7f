"""Room types of the words that other programs and people use: the table ``types.json``.

The words are English, German, Dutch, Finnish, French and Spanish.
"""

import re
import unicodedata
from collections.abc import Collection, Iterable
from functools import cache
from pathlib import Path

import msgspec

from vitruvius.logic.readers.sketch import Space

OUTSIDE = "outside"
"""Type in the table for an area that is no room of the house, such as a balcony or a column."""

MAX_LETTERS, MAX_WORDS = 100, 4
"""Number of letters of a name that are read, and of words in one phrase, such as ``salle de bain``."""

MAX_ABBREVIATION_LETTERS, MIN_HEAD_LETTERS = 2, 4
"""Greatest length of an abbreviation, and least length of the last part of a compound word, in letters.

``Elternschlafzimmer`` is such a compound word.
"""

TOGETHER = re.compile(r"[/+&,;|]|-(?=\W|[A-ZÀ-Þ])")
"""Separator of the uses of a room with several uses."""

PART, HUMP = re.compile(r"[^\W\d_]+"), re.compile(r"(?<=[a-zà-ÿ])(?=[A-ZÀ-Þ])")

UMLAUTS = str.maketrans({"ä": "ae", "ö": "oe", "ü": "ue"})

Uses = tuple[str, ...]
"""Types that a word means: several for a room of several uses, an empty one for any type."""


class Least(msgspec.Struct, frozen=True):
    """Least floor, square metres, and least width, metres, of a use of a room."""

    floor: float
    width: float


class WordTable(msgspec.Struct):
    """Words for each type of room, or for several types, as in ``living+kitchen``.

    ``open`` has the types that may be uses of one room, with the least size of each; ``entered`` the types of
    rooms with an entrance, most likely first. ``whose`` has words for a room's owner, such as a child: they
    state the type only if no other word does. ``elements`` has words for parts of a house other than rooms.
    """

    types: dict[str, list[str]]
    open: dict[str, Least]
    entered: list[str]
    whose: list[str]
    elements: dict[str, list[str]]


def meant(words: Iterable[str], types: Collection[str] | None = None) -> tuple[str, bool]:
    """Return the type that the first known word means, and True if a word is known.

    The type is empty if the word permits any type, or if ``types``, a grammar's types, lack it. The type
    ``outside`` stands for an area that is no room of the house.
    """
    found = [uses for word in words if (uses := _uses(word))]
    kind = next((uses[0] for uses in found if uses[0]), "")
    return kind if types is None or kind in (*types, OUTSIDE) else "", bool(found)


def kind_of(space: Space, types: Collection[str] | None = None) -> tuple[str, bool]:
    """Return the type of a room and True if its words are known: see ``meant``."""
    return (space.type, True) if space.type or not space.words else meant(space.words, types)


def uses(words: Iterable[str]) -> Uses:
    """Return all types that the first known word means: several for ``Wohnen/Essen/Kochen``."""
    return next((types for word in words if (types := _uses(word)) and types[0]), ())


def least_sizes() -> dict[str, Least]:
    """Return the least size of each type that may be a use of a room, the most important type first."""
    return table().open


def _uses(word: str) -> Uses:
    """Return the types that a word means; none for an unknown word."""
    word = unicodedata.normalize("NFC", word[:MAX_LETTERS])
    if whole := _whole(word, word[:1].isupper()):
        return whole
    parts = (PART.findall(HUMP.sub(" ", part)) for part in TOGETHER.split(word))
    groups = [found for found in map(_of_parts, parts) if found]
    each = dict.fromkeys(kind for runs in groups for run in runs for kind in run if kind)
    if each and each.keys() <= table().open.keys():
        return tuple(each)
    if not groups:
        return ()
    # In ``bedroom with bath`` the first type counts; ``kitchen storage`` may be of either type.
    first = dict.fromkeys(kind for kind in groups[0][0] if kind)
    return tuple(first) if len(first) == 1 else ("",)


def _of_parts(parts: list[str]) -> list[list[str]]:
    """Return the types of the known words in a text; the types of adjacent words are one group.

    The longest known phrase is read first. A word for the room's owner counts only if no other word does.
    """
    runs, whose, at = [list[str]()], list[str](), 0
    while at < len(parts):
        ends = range(min(len(parts), at + MAX_WORDS), at, -1)
        end = next((end for end in ends if _of_words(parts[at:end])), at + 1)
        found = _of_words(parts[at:end])
        if _letters("".join(parts[at:end])) in table().whose:
            whose += found
        elif found:
            runs[-1] += found
        elif runs[-1]:
            runs.append([])
        at = end
    return [run for run in runs if run] or ([whose] if whose else [])


def _of_words(parts: list[str]) -> Uses:
    """Return the types of a phrase; for an unknown single word, the types of its last part."""
    if (found := _whole("".join(parts), parts[0].isupper())) or len(parts) > 1:
        return found
    letters = _letters(parts[0])
    heads = (letters[start:] for start in range(1, len(letters) - MIN_HEAD_LETTERS + 1))
    found = next((found for head in heads if (found := _words().get(head))), ())
    return () if {"", OUTSIDE} & {*found} else found


def _whole(word: str, is_capital: bool) -> Uses:
    """Return the types of a word in the table. Abbreviations such as ``OH`` are known only in capitals."""
    letters = _letters(word)
    if len(letters) <= MAX_ABBREVIATION_LETTERS and not is_capital and letters not in table().types:
        return ()
    return _words().get(letters, ())


def element(word: str) -> str:
    """Return the element that a word means: ``door``, ``entrance``, ``opening``, ``window`` or ``part``."""
    return _elements().get(_letters(word[:MAX_LETTERS]), "")


@cache
def table() -> WordTable:
    """Return the table of words."""
    return msgspec.json.decode(Path(__file__).with_name("types.json").read_bytes(), type=WordTable)


@cache
def _words() -> dict[str, Uses]:
    """Return the types for each word, with and without its accents, and with ``ae`` for an umlaut."""
    words = [(word, tuple(kind.split("+"))) for kind, some in table().types.items() for word in some]
    return {_letters(word.translate(UMLAUTS)): kinds for word, kinds in words} | {
        _letters(word): kinds for word, kinds in words
    }


@cache
def _elements() -> dict[str, str]:
    """Return the element of a house, other than rooms, that each word means."""
    return {_letters(word): what for what, words in table().elements.items() for word in words}


def _letters(word: str) -> str:
    """Return a word in normal form, without accents: the same for ``Living_Room`` and ``LivingRoom 2``."""
    return "".join(each for each in unicodedata.normalize("NFKD", word).casefold() if each.isalpha())
