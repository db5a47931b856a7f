"""Whether each line of a proof is needed: without it, the lines that are left have a house."""

from collections.abc import Callable, Collection

from benchmarks.briefs.attempts import Attempt
from logic.request.brief import Brief
from logic.request.brief_lines import requirements
from logic.request.eased import without

LINE = "brief: "
"""How a reason begins that is a line of the brief."""


def needed(brief: Brief, because: Collection[str], tried: Callable[[Brief], Attempt]) -> tuple[int, int, int]:
    """Of the lines of a proof: how many there are, how many are needed as the others have a house, and of how
    many it is not known, as the others end in a limit. ``tried`` makes an attempt.
    """
    words = {each.removeprefix(LINE) for each in because if each.startswith(LINE)}
    others = [each.where for each in requirements(brief) if each.words not in words]
    named = [each.where for each in requirements(brief) if each.words in words]
    found = [tried(without(brief, [*others, place])) for place in named]
    return len(named), sum(bool(each.houses) for each in found), sum(bool(each.limit) for each in found)
