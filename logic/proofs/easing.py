"""Changes of a request with which a layout is soon found, for a search that takes too long.

A search that ends at its limit proves nothing about the rules. Therefore the user's statements are left out
one by one. Each search for a layout has a limit on clingo's conflicts, which grows in each round. Nothing
here is a proof, since a search that ends at its limit shows nothing.
"""

from collections.abc import Iterator, Sequence
from functools import cache

from msgspec.structs import replace

from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import SHIPPED
from vitruvius.logic.layout.account import LAYOUT
from vitruvius.logic.layout.conditional import ABSENT
from vitruvius.logic.layout.program import TooMany
from vitruvius.logic.layout.relaxed import Relaxed, Statement
from vitruvius.logic.request.house_request import HouseRequest

FIRST_CONFLICTS, CONFLICTS_FACTOR = 2_000, 4
"""Number of conflicts of clingo in the first round, and the factor for each further round."""

ROOM_FRACTIONS = (0.9, 0.75, 0.5)
"""Fractions of the requested number of rooms that are tried, too."""


def easing(builder: Builder, request: HouseRequest) -> Iterator[str]:
    """Yield changes that make a layout easy to find: without a statement of the user, or with fewer rooms.

    Rules of shipped grammars are not named. The search goes on until some change is found.
    """
    builder.account.at(LAYOUT, "what makes layouts hard to find (clingo)")
    feasibility = builder.maker_of(request).feasibility
    relaxed, statements = feasibility.house(request)
    relaxed.forget()
    tried = sorted(filter(_is_own, statements), key=_is_copied)
    conflicts, found = FIRST_CONFLICTS, False
    while not found and not _has_layout(relaxed, statements, conflicts):
        for each in tried:
            others = [other for other in statements if other is not each]
            if _has_layout(relaxed, others, conflicts // CONFLICTS_FACTOR if _is_copied(each) else conflicts):
                found = True
                yield f"without {each.reason}"
        if not (found or request.given or request.fixed):
            fewer = (round(share * request.rooms) for share in ROOM_FRACTIONS)
            for other in (replace(request, rooms=rooms) for rooms in fewer if rooms):
                if _has_layout(*feasibility.house(other), conflicts):
                    found = True
                    yield f"with --rooms {other.rooms}"
                    break
        conflicts *= CONFLICTS_FACTOR


def _has_layout(relaxed: Relaxed, statements: Sequence[Statement], conflicts: int) -> bool:
    """Return True if a layout, without stage 2, is found within this number of clingo's conflicts."""
    try:
        return relaxed.model(statements, conflicts=conflicts) is not None
    except TooMany:
        return False


def _is_own(statement: Statement) -> bool:
    """Return True for a requirement of the user: a choice of the request, or a rule that is not shipped."""
    reason = statement.reason
    if not reason.file:
        return True
    required = not statement.clause and not reason.text.startswith("option(")
    return required and str(SHIPPED) not in reason.file and not reason.text.endswith(ABSENT)


def _is_copied(statement: Statement) -> bool:
    """Return True for a rule that a shipped grammar also has, since users often begin with a copy."""
    return bool(statement.reason.file) and statement.reason.text in _shipped()


@cache
def _shipped() -> str:
    """Return the text of all shipped grammars, on one line."""
    return " ".join(" ".join(file.read_text(encoding="utf-8").split()) for file in SHIPPED.glob("*/*.lp"))
