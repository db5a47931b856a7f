"""What this topology cannot express, for names that ask for it."""

import json
import re
from functools import cache

from logic.grammar import RULES

READ = "docs/rules.md#what-cannot-be-said"


@cache
def entries() -> list[dict]:
    """Each with its ``topic``, the ``words`` that ask for it, and what the user is to know (``says``)."""
    return json.loads((RULES / "language" / "inexpressible.json").read_text(encoding="utf-8"))


def inexpressible(*names: str) -> str:
    """What to say of a predicate with these names, its own or also its arguments'; empty if it is unknown.

    ``max_house_area`` and ``maxHouseAreas`` hold the words *house area*.
    """
    held = {word.lower() for name in names for word in re.findall("[A-Z]?[a-z]+", name)}
    held |= {word.removesuffix("s") for word in held}
    for entry in entries():
        if any(held.issuperset(words.split()) for words in entry["words"]):
            return f"not expressible in this topology: {entry['topic']}: {entry['says']}: see {READ}"
    return ""
