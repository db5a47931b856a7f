"""Messages for names of things that the topologies cannot express."""

import json
import re
from functools import cache

from vitruvius.logic.grammar import RULES

READ = "docs/rules.md#limits-of-the-language"


@cache
def entries() -> list[dict]:
    """Return entries with a ``topic``, the ``words`` that ask for it, and a text for the user (``says``)."""
    return json.loads((RULES / "language" / "inexpressible.json").read_text(encoding="utf-8"))


def inexpressible(*names: str) -> str:
    """Return the message for a predicate with these names, its own or its arguments', or an empty text.

    ``max_house_area`` and ``maxHouseAreas`` contain the words *house area*.
    """
    held = {word.lower() for name in names for word in re.findall("[A-Z]?[a-z]+", name)}
    held |= {word.removesuffix("s") for word in held}
    for entry in entries():
        if any(held.issuperset(words.split()) for words in entry["words"]):
            return f"not expressible in this topology: {entry['topic']}: {entry['says']}: see {READ}"
    return ""
