"""Which type of room other programs' words mean: the table ``types.json``."""

import json
import unicodedata
from collections.abc import Iterable
from functools import cache
from pathlib import Path

OUTSIDE = "outside"
"""In the table: of what is no room of the house, such as a balcony or a column."""


def meant(words: Iterable[str]) -> tuple[str, bool]:
    """The type that the first of some words means, and whether any is known. No type, where any may be.

    ``outside``: it is no room of the house.
    """
    found = [_table()[key] for word in words if (key := _letters(word)) in _table()]
    return next(filter(None, found), ""), bool(found)


@cache
def _table() -> dict[str, str]:
    """The type for each word."""
    record = json.loads(Path(__file__).with_name("types.json").read_text(encoding="utf-8"))
    return {_letters(word): kind for kind, words in record.items() for word in words}


def _letters(word: str) -> str:
    """Alike for ``Living_Room``, ``living room 2`` and ``LivingRoom``, and however Unicode composes it."""
    return "".join(each for each in unicodedata.normalize("NFKC", word).casefold() if each.isalpha())
