"""Houses of a request, by the arguments of Python's users."""

from collections.abc import Iterator
from typing import Unpack

from vitruvius.logic.house.house import House
from vitruvius.logic.request.arguments import Stated, house_request
from vitruvius.logic.request.counts import whole
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.spelling import keywords
from vitruvius.logic.workers.pool import houses


@keywords(pieces="furniture", n="count", number="count", rules="grammar", timeout="seconds")
def generate(
    rooms: int | None = None,
    *,
    seed: int = 0,
    count: int = 1,
    start: int = 0,
    workers: int = 1,
    **stated: Unpack[Stated],
) -> Iterator[House]:
    """Generate houses ``start`` to ``start + count - 1`` of a request, one by one, in order.

    ``rooms`` is the number of secondary rooms (1 to 128), which may be left out with a plan or a brief. House
    ``i`` is a function of the grammar, the request, the seed and ``i``. The number of ``workers``, each a
    process, changes only the time. Starting processes and loading rules takes some seconds and has a separate
    limit (``solver.START_UP``).

    ``types`` gives the number of rooms of some types, exact or as a range with None for no bound:
    ``{"bedroom": 2, "bathroom": (1, None)}``. ``furniture`` gives in the same way the number of pieces in
    each room that may have them, or in rooms of one type: ``{"bed": 1, "bedroom.wardrobe": (1, 2)}``. With a
    ``cell`` (metres, at least the robot's width of 0.287) every edge of a house lies on a grid of such cells.
    Fixed and least lengths are rounded up, greatest lengths down.

    ``brief`` states the requirements on each named room (``docs/briefs.md``), as JSON, a JSON file, or a
    ``Brief``. Without a grammar the brief alone defines the house.

    ``plan`` gives the places of all rooms, and optionally their types. It may be a house, GeoJSON, a plan of
    ResPlan, or a file of one of these or of HouseExpo, CubiCasa5K, IMDF or IFC (``docs/house-file.md``).
    Doors, windows and furniture are generated in the plan. ``plan_unit`` is the unit of the file: ``m``,
    ``cm``, ``mm``, ``ft``, or metres per unit. ``storey`` names the storey to read if there are several.
    Edges within ``snap`` metres of each other (by default 0.01) become one wall, with a ``PlanWarning``.

    The rooms of ``keep`` (as in ``house.only("R0", "R2")``) are fixed, with their doors and furniture, and
    count among the rooms. The rest, with the main room, is generated around them. To keep rooms that share
    walls, also give the same house as ``plan``.

    ``grammar`` is a shipped grammar's name or a directory; by default ``family``. ``inferences`` (of Prolog;
    by default 100 million) and ``seconds`` (by default 60) limit each house.

    Warns once (``GrammarWarning``) about each rule without effect in a grammar that is a directory. Raises
    ``RequestError`` for a request that makes no sense, ``GrammarError`` for a wrong grammar,
    ``Unsatisfiable`` if a proof shows that no such house exists, and ``LimitReached`` at a limit.
    """
    return houses_of(house_request(rooms, **stated), seed, count, start, workers)


def houses_of(request: HouseRequest, seed: int, count: int, start: int, workers: int) -> Iterator[House]:
    """Return houses ``start`` to ``start + count - 1`` of a request: see ``generate``."""
    count, workers = whole("count", count, 1), whole("workers", workers, 1)
    seed, start = whole("seed", seed, 0), whole("start", start, 0)
    whole("the index of the last house", start + count - 1, 0)
    return houses(request, seed, range(start, start + count), workers)
