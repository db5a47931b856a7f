"""Whether each line of a proof is needed: without it, the lines that are left have a house."""

from collections.abc import Callable, Collection

from benchmarks.briefs.attempts import Attempt
from logic.request.brief import Brief
from logic.request.brief_lines import requirements
from logic.request.eased import without


def needed(brief: Brief, because: Collection[str], tried: Callable[[Brief], Attempt]) -> tuple[int, int, int]:
    """Of the lines of a proof: how many there are, how many are needed as the others have a house, and of how
    many it is not known, as the others end in a limit. ``tried`` makes an attempt.
    """
    lines = requirements(brief)
    others = [each.where for each in lines if each.reason not in because]
    named = [each.where for each in lines if each.reason in because]
    found = [tried(without(brief, [*others, place])) for place in named]
    return len(named), sum(bool(each.houses) for each in found), sum(bool(each.limit) for each in found)
