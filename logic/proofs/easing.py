"""Where a search for a layout takes too long: without what of the user's one is soon found.

A search that ends at its limit says nothing of the rules. So the user's statements are left out one by one,
and a layout is looked for with a bound on the conflicts that clingo may meet, again and again with a larger
one. Nothing here is a proof: a search that ends at its bound shows nothing.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache

from logic.generation.builder import Builder
from logic.grammar import SHIPPED
from logic.layout.account import LAYOUT
from logic.layout.conditional import ABSENT
from logic.layout.program import TooMany
from logic.layout.relaxed import Relaxed, Statement
from logic.request.request import Request

FIRST, LARGER = 2_000, 4
"""Conflicts of clingo's in which a layout is soon found, and how many times as many are allowed next."""

FEWER = (0.9, 0.75, 0.5)
"""The shares of the rooms that are asked for which are tried too."""


def easing(builder: Builder, request: Request) -> Iterator[str]:
    """What makes a layout easy to find, as it is found: without a statement of the user's, or with fewer
    rooms. Rules of shipped grammars are not named. Goes on until something is found.
    """
    builder.account.at(LAYOUT, "what makes layouts hard to find (clingo)")
    feasibility = builder.maker_of(request).feasibility
    relaxed, statements = feasibility.house(request)
    relaxed.forget()
    tried = sorted(filter(_is_own, statements), key=_is_copied)
    conflicts, found = FIRST, False
    while not found and not _has_layout(relaxed, statements, conflicts):
        for each in tried:
            others = [other for other in statements if other is not each]
            if _has_layout(relaxed, others, conflicts // LARGER if _is_copied(each) else conflicts):
                found = True
                yield f"without {each.reason}"
        if not (found or request.plan or request.fixed):
            fewer = (round(share * request.rooms) for share in FEWER)
            for other in (replace(request, rooms=rooms) for rooms in fewer if rooms):
                if _has_layout(*feasibility.house(other), conflicts):
                    found = True
                    yield f"with --rooms {other.rooms}"
                    break
        conflicts *= LARGER


def _has_layout(relaxed: Relaxed, statements: Sequence[Statement], conflicts: int) -> bool:
    """Whether a layout is found, without stage 2, before clingo meets so many conflicts."""
    try:
        return relaxed.model(statements, conflicts=conflicts) is not None
    except TooMany:
        return False


def _is_own(statement: Statement) -> bool:
    """Whether the user requires it: a choice of the request's, or a rule of a grammar that is not shipped."""
    reason = statement.reason
    if not reason.file:
        return True
    required = not statement.clause and not reason.text.startswith("option(")
    return required and str(SHIPPED) not in reason.file and not reason.text.endswith(ABSENT)


def _is_copied(statement: Statement) -> bool:
    """Whether a shipped grammar says it too: those of users often begin as a copy."""
    return bool(statement.reason.file) and statement.reason.text in _shipped()


@cache
def _shipped() -> str:
    """The text of all shipped grammars, on one line."""
    return " ".join(" ".join(file.read_text(encoding="utf-8").split()) for file in SHIPPED.glob("*/*.lp"))
