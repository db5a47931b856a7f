"""Test for each line of a proof if it is needed: without a needed line, the others have a house."""

from collections.abc import Callable, Collection

from benchmarks.briefs.attempts import Attempt
from vitruvius.logic.request.brief import Brief
from vitruvius.logic.request.brief_lines import requirements
from vitruvius.logic.request.eased import without


def needed(brief: Brief, because: Collection[str], tried: Callable[[Brief], Attempt]) -> tuple[int, int, int]:
    """Return the number of a proof's lines, of needed lines, and of lines for which the answer is not known.

    A line is needed if the others have a house. It is not known if the attempt at the others ends in a limit.
    ``tried`` makes an attempt.
    """
    lines = requirements(brief)
    others = [each.where for each in lines if each.reason not in because]
    named = [each.where for each in lines if each.reason in because]
    found = [tried(without(brief, [*others, place])) for place in named]
    return len(named), sum(bool(each.houses) for each in found), sum(bool(each.limit) for each in found)
