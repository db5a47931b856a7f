"""Houses of a request: solver processes generate them, and their answers come in order."""

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from vitruvius.logic.errors import Finding, GrammarError, RequestError
from vitruvius.logic.grammar import find
from vitruvius.logic.house.house import House
from vitruvius.logic.plain import plain
from vitruvius.logic.request.brief import Brief, alone, read_brief
from vitruvius.logic.request.fixed_rooms import fixed_rooms
from vitruvius.logic.request.given_plan import SNAP, keeping, read_plan
from vitruvius.logic.request.own_plan import OwnPlan
from vitruvius.logic.request.request import MOST_ROOMS, Count, Request, whole
from vitruvius.logic.spelling import keywords
from vitruvius.logic.workers.messages import Counted, CountLayouts, Done, Judged, Lint, Loaded, Open
from vitruvius.logic.workers.series import HouseSeries
from vitruvius.logic.workers.solver import GRACE, Solver

PLAIN = "plain"
"""Grammar for a brief without a grammar. It states nothing about rooms."""

TRIED = (10, 20)
"""Numbers of rooms for which lint tries each rule to find the slow one, if judging the rules is too slow."""


@keywords(pieces="furniture", n="count", number="count", rules="grammar", timeout="seconds")
def generate(
    rooms: int | None = None,
    *,
    types: Mapping[str, Count] | None = None,
    furniture: Mapping[str, Count] | None = None,
    cell: float = 0.0,
    plan: str | Path | House | OwnPlan | Mapping[str, Any] | None = None,
    plan_unit: str | None = None,
    snap: float = SNAP,
    storey: str | None = None,
    keep: House | None = None,
    brief: str | Path | Mapping[str, Any] | Brief | None = None,
    grammar: str | Path | None = None,
    seed: int = 0,
    count: int = 1,
    start: int = 0,
    workers: int = 1,
    inferences: int = 100_000_000,
    seconds: float = 60.0,
) -> Iterator[House]:
    """Generate houses ``start`` to ``start + count - 1`` of a request, one by one, in order.

    ``rooms`` is the number of secondary rooms (1 to 128). ``types`` gives the number of rooms of some types,
    exact or as a range with None for no bound: ``{"bedroom": 2, "bathroom": (1, None)}``. ``furniture`` gives
    in the same way the number of pieces in each room that may have them, or in rooms of one type: ``{"bed":
    1, "bedroom.wardrobe": (1, 2)}``. With a ``cell`` (metres, at least the robot's width of 0.287) every edge
    of a house lies on a grid of such cells. Fixed and least lengths are rounded up, greatest lengths down.
    The rooms of ``keep`` (as in ``house.only("R0", "R2")``) are fixed, with their doors and furniture, and
    count among the ``rooms``. The rest, with the main room, is generated around them. To keep rooms that
    share walls, also give the same house as ``plan``. ``plan`` gives the places of all rooms, and optionally
    their types. It may be a house, GeoJSON, a plan of ResPlan, or a file of one of these or of HouseExpo,
    CubiCasa5K, IMDF or IFC (``docs/house-file.md``). Doors, windows and furniture are generated in the plan,
    and ``rooms`` may be left out. ``plan_unit`` is the unit of the file: ``m``, ``cm``, ``mm``, ``ft``, or
    metres per unit. ``storey`` names the storey to read if there are several. Edges within ``snap`` metres of
    each other become one wall, with a ``PlanWarning``. ``brief`` states the requirements on each named room
    (``docs/briefs.md``), as JSON, a JSON file, or a ``Brief``. Without a grammar the brief alone defines the
    house. ``grammar`` is a shipped grammar's name or a directory; by default ``family``. House ``i`` is a
    function of the grammar, the request, the seed and ``i``. The number of ``workers``, each a process,
    changes only the time. ``inferences`` (of Prolog) and ``seconds`` limit each house. Starting processes and
    loading rules takes some seconds and has a separate limit (``solver.START_UP``).

    Warns once (``GrammarWarning``) about each rule without effect in a grammar that is a directory. Raises
    ``RequestError`` for a request that makes no sense, ``GrammarError`` for a wrong grammar,
    ``Unsatisfiable`` if a proof shows that no such house exists, and ``LimitReached`` at a limit.
    """
    count, workers = whole("count", count, 1), whole("workers", workers, 1)
    seed, start = whole("seed", seed, 0), whole("start", start, 0)
    whole("the index of the last house", start + count - 1, 0)
    asked = {"types": types, "furniture": furniture, "cell": cell, "keep": keep, "brief": brief}
    drawn = {"plan": plan, "plan_unit": plan_unit, "snap": snap, "storey": storey}
    series = series_of(rooms, **asked, **drawn, grammar=grammar, inferences=inferences, seconds=seconds)
    return series.houses(seed, range(start, start + count), workers)


def series_of(
    rooms: int | tuple[int, int] | None = None,
    *,
    types: Mapping[str, Count] | None = None,
    furniture: Mapping[str, Count] | None = None,
    cell: float = 0.0,
    plan: str | Path | House | OwnPlan | Mapping[str, Any] | None = None,
    plan_unit: str | None = None,
    snap: float = SNAP,
    storey: str | None = None,
    keep: House | None = None,
    brief: str | Path | Mapping[str, Any] | Brief | None = None,
    grammar: str | Path | None = None,
    inferences: int = 100_000_000,
    seconds: float = 60.0,
) -> HouseSeries:
    """Return the series from which ``generate`` takes houses by seed and index.

    Arguments and errors are those of ``generate``, except that ``rooms`` may be a range of ``n`` numbers from
    ``least`` on. House ``i`` then has ``least + i % n`` rooms.
    """
    own = None
    if plan is not None:
        own = read_plan(plain(plan), plan_unit, snap, storey, find(grammar or "family").types)
    asked = None if brief is None else read_brief(plain(brief))
    if keep is not None and keep.main_room is None:
        if own is None:
            raise RequestError(
                "keep: rooms that share walls are kept in their plan: give it too, as in "
                'generate(plan=house, keep=house.only("R2"))'
            )
        own, keep = keeping(own, keep), None
    if own:
        rooms = _rooms_of(own, rooms, cell, keep)
    if asked:
        rooms = _rooms_of_brief(asked, rooms, cell, own, keep)
    if rooms is None:
        raise RequestError("rooms: say how many, as in --rooms 6, or give a plan of them, as in --plan FILE")
    rooms, most = rooms if isinstance(rooms, tuple) else (rooms, rooms)
    rooms = whole("rooms", rooms, 1, MOST_ROOMS)
    most = whole("the most rooms", most, rooms, MOST_ROOMS)
    inferences = whole("inferences", inferences, 1)
    if not 0 < seconds < 1e6:
        raise RequestError(f"seconds must be above 0 and below a million, not {seconds!r}")
    seconds, cell = float(seconds), float(cell)
    wanted = Request.read({"rooms": rooms, "types": types or {}, "furniture": furniture or {}, "cell": cell})
    if keep is not None:
        if cell:
            raise RequestError("keep: fixed rooms need not lie on the grid: leave out cell or keep")
        fixed = len(keep.secondary)
        if not fixed:
            raise RequestError('keep: the house has no room to keep: name some, as in keep=house.only("R0")')
        if fixed > rooms:
            raise RequestError(
                f"keep: the house has {fixed} rooms to keep, but rooms={rooms}: ask for rooms={fixed} or "
                'more, or keep some of them: keep=house.only("R0"), on the command line --keep-rooms R0'
            )
        wanted = replace(wanted, fixed=tuple(fixed_rooms(keep)))
    if asked and grammar is None:
        asked, grammar = alone(asked), PLAIN
    wanted = replace(wanted, plan=own, brief=asked)
    request = wanted.to_dict() | ({"rooms": [rooms, most]} if most > rooms else {})
    return HouseSeries(find(grammar or "family"), request, inferences, seconds)


def _rooms_of(plan: OwnPlan, rooms: int | tuple[int, int] | None, cell: float, keep: House | None) -> int:
    """Return the number of rooms of a plan. Raises ``RequestError`` for arguments that contradict a plan."""
    number = len(plan.rooms)
    if rooms not in (None, number):
        raise RequestError(f"plan: it has {number} rooms, but rooms={rooms}: leave rooms out")
    for name, given in (("cell", cell), ("keep", keep)):
        if given:
            raise RequestError(f"plan: all rooms have their places already: leave out {name} or plan")
    return number


def _rooms_of_brief(
    brief: Brief, rooms: int | tuple[int, int] | None, cell: float, plan: OwnPlan | None, keep: House | None
) -> int:
    """Return the number of rooms of a brief.

    Raises ``RequestError`` for arguments that contradict a brief.
    """
    number = len(brief.rooms)
    if rooms not in (None, number):
        raise RequestError(f"brief: it has {number} rooms, but rooms={rooms}: leave rooms out")
    for name, given in (("plan", plan), ("keep", keep)):
        if given:
            raise RequestError(f"brief: its rooms have no places yet: leave out {name} or brief")
    if cell:
        raise RequestError("cell: rooms of a brief lie on no grid yet: leave out cell or brief")
    return number


@keywords(pieces="furniture", rules="grammar", timeout="seconds")
def count_layouts(
    rooms: int,
    *,
    types: Mapping[str, Count] | None = None,
    furniture: Mapping[str, Count] | None = None,
    grammar: str | Path = "family",
    seconds: float = 60.0,
    report: Callable[[str, int], None] = lambda name, number: None,
) -> Iterator[tuple[str, int, bool]]:
    """Count the layouts from which stage 1 samples: those of the rooms, and those of each type's furniture.

    Yields tuples of a name, a number, and True if the number is exact. False means that ``seconds`` ran out
    before the end of the count. Each count gets its share of the remaining seconds. Room layouts state types,
    sides and corners; furniture layouts state all atoms that ``rules/room/room.lp`` shows.

    ``report`` is called once a second with a name and the number so far. Raises as ``generate`` does.
    """
    wanted = Request.read({"rooms": rooms, "types": types or {}, "furniture": furniture or {}})
    return _layouts(Open(grammar=str(find(grammar).directory)), wanted, seconds, report)


def _layouts(
    opening: Open, wanted: Request, seconds: float, report: Callable[[str, int], None]
) -> Iterator[tuple[str, int, bool]]:
    """Yield the counts one by one."""
    worker = Solver(opening)
    try:
        worker.loaded()
        end = time.monotonic() + seconds
        worker.ask(CountLayouts(request=wanted.to_dict(), share=seconds), seconds + GRACE)
        late = f"counting took {seconds:g} s: raise it with --seconds"
        while True:
            left = end + GRACE - time.monotonic()
            match worker.answer((Counted, Done), left, late, [wanted.rooms]):
                case Done():
                    return
                case Counted(name, number, None):
                    report(name, number)
                case Counted(name, number, bool(exact)):
                    yield name, number, exact
    finally:
        worker.end()


def lint(grammar: str | Path = "family", seconds: float = 60.0) -> list[Finding]:
    """Return the mistakes in a grammar's files that the solvers ignore, without running the grammar.

    ``generate`` refuses a grammar with an error. Raises ``GrammarError`` if there is no such grammar, and
    ``LimitReached`` after ``seconds``.
    """
    opening = Open(grammar=str(find(grammar).directory), errors=True)
    end = time.monotonic() + seconds
    worker = Solver(opening)
    try:
        answer = worker.loaded(seconds)
        if isinstance(answer, Loaded):
            left = end - time.monotonic()
            worker.ask(Lint(), left)
            answer = worker.answer(Judged, left, f"{grammar}: lint took {seconds:g} s", TRIED)
        return answer.findings
    except GrammarError as error:
        return [Finding("error", str(error.file), error.line or 1, error.column or 1, error.message)]
    finally:
        worker.end()
