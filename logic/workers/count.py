"""Numbers of the layouts from which stage 1 samples houses."""

from collections.abc import Callable, Iterator
from typing import Unpack

from vitruvius.logic.request.arguments import Counted, house_request
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.spelling import keywords
from vitruvius.logic.workers.messages import Counted as Number
from vitruvius.logic.workers.messages import CountLayouts, Open
from vitruvius.logic.workers.solver import GRACE, answers

Report = Callable[[str, int], None]
"""Function that is called with a name and the number of its layouts so far."""


@keywords(pieces="furniture", rules="grammar", timeout="seconds")
def count_layouts(
    rooms: int, *, report: Report = lambda name, number: None, **stated: Unpack[Counted]
) -> Iterator[tuple[str, int, bool]]:
    """Count the layouts from which stage 1 samples: those of the rooms, and those of each type's furniture.

    Yields tuples of a name, a number, and True if the number is exact. False means that ``seconds`` ran out
    before the end of the count. Each count gets its share of the remaining seconds. Room layouts state types,
    sides and corners; furniture layouts state all atoms that ``rules/room/room.lp`` shows.

    ``report`` is called once a second with a name and the number so far. Other arguments and errors are those
    of ``generate``; a plan, a brief and rooms to keep have no counts.
    """
    return counted(house_request(rooms, **stated), report)


def counted(request: HouseRequest, report: Report) -> Iterator[tuple[str, int, bool]]:
    """Yield the counts of ``count_layouts`` one by one."""
    opening = Open(grammar=str(request.rules.directory), cell=request.cell)
    seconds = request.seconds
    question = CountLayouts(request=request, share=seconds)
    late = f"counting took {seconds:g} s: raise it with --seconds"
    for found in answers(opening, question, Number, seconds + GRACE, late, tried=(request.rooms,)):
        if found.exact is None:
            report(found.name, found.number)
        else:
            yield found.name, found.number, found.exact
