"""Search for the house that breaks the fewest lines of a brief, if no house keeps all lines.

Each proof is a conflict: one of its lines must change. The search drops the fewest lines that hit all
conflicts found so far. If a house exists without these lines, no smaller number suffices; otherwise the proof
that there is none is a new conflict.
"""

from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple, Unpack

from msgspec.structs import replace

from vitruvius.logic.errors import LimitReached, Unsatisfiable
from vitruvius.logic.house.house import House
from vitruvius.logic.proofs.least import Hitting
from vitruvius.logic.request.arguments import Counted, house_request
from vitruvius.logic.request.brief import Brief
from vitruvius.logic.request.brief_lines import Requirement, Where, requirements
from vitruvius.logic.request.eased import is_length, off_by, widened, without
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.spelling import keywords, numbered
from vitruvius.logic.workers.pool import houses

MOST_CONFLICTS = 60
"""Largest number of conflicts of a brief that the search considers."""

PRECISION = 0.05
"""Relative precision of the share by which the bounds of a length are widened."""

MARGINS = (PRECISION, 5 * PRECISION, 20 * PRECISION)
"""Shares by which the bounds are then wider than necessary, tried in order until a house is found."""

MAX_EASING_INFERENCES = 10_000_000
"""Largest number of Prolog inferences for a house with wider bounds."""

ANY = 1e6
"""Share that removes a bound."""


class Broken(NamedTuple):
    """Line of a brief that a house cannot keep together with the others, and its replacement."""

    line: str
    instead: str = ""
    """The length in wider bounds, or an empty text if the line is left out."""

    def __str__(self) -> str:
        """Return both, as in ``Bed has 11 to 13 m²: Bed has 10.2 to 13 m²``."""
        return f"{self.line}: {self.instead or 'left out'}"


class Nearest(NamedTuple):
    """Brief that has houses, and the lines of the user's brief that these break, as few as possible."""

    brief: Brief
    broken: tuple[Broken, ...]


@keywords(pieces="furniture", rules="grammar", timeout="seconds")
def nearest(
    brief: str | Path | Mapping[str, Any] | Brief, *, seed: int = 0, index: int = 0, **stated: Unpack[Counted]
) -> Nearest:
    """Return the nearest brief that has houses, which is the given brief if it has houses.

    The result breaks as few lines as possible. Among equally small sets it breaks lengths first, and areas of
    large rooms before other lengths. Areas and sizes get wider bounds, widened only until a house is soon
    found (to a precision of 5 %). Other broken lines are left out.

    Arguments are those of ``generate``; ``seconds`` limits each house or proof on the way. Raises as
    ``generate`` does: ``Unsatisfiable`` if the grammar itself is contradictory.
    """
    return nearest_brief(house_request(brief=brief, **stated), seed, index)


def nearest_brief(request: HouseRequest, seed: int, index: int) -> Nearest:
    """Return the nearest brief to the request's with which house ``index`` exists: see ``nearest``."""
    wanted = request.brief
    assert wanted

    def house(some: Brief, inferences: int = request.inferences) -> House:
        asked = replace(request, brief=some, inferences=inferences)
        return next(houses(asked, seed, range(index, index + 1)))

    def house_of(some: Brief) -> House | None:
        with suppress(Unsatisfiable, LimitReached):
            return house(some, min(request.inferences, MAX_EASING_INFERENCES))
        return None

    out = _fewest(wanted, house)
    eased = wanted
    gone = [line.where for line in out]
    for line in out:
        if is_length(line.where):
            gone.remove(line.where)
            if better := _eased(eased, line.where, lambda some: house_of(without(some, gone))):
                eased = better
            else:
                gone.append(line.where)
    kept = {line.where: line.words for line in requirements(eased)}
    broken = (Broken(line.words, "" if line.where in gone else kept[line.where]) for line in out)
    return Nearest(without(eased, gone), tuple(broken))


def _fewest(wanted: Brief, house: Callable[[Brief], House]) -> list[Requirement]:
    """Return the fewest lines of a brief without which it has a house. Raises as ``house`` does."""
    lines = sorted(requirements(wanted), key=_largest_room_first)
    hitting = Hitting([not is_length(line.where) for line in lines])
    for _ in range(MOST_CONFLICTS):
        out = [lines[place] for place in hitting.set()]
        try:
            house(without(wanted, [line.where for line in out]))
        except Unsatisfiable as proof:
            conflict = {reason.text for reason in proof.reasons}
            named = [place for place, line in enumerate(lines) if line.reason in conflict and line not in out]
            if not named:  # the conflict is the grammar's own
                raise
            hitting.add(named)
        except LimitReached as late:
            without_ = f" without {numbered(len(out), 'line')} of it" if out else ""
            raise LimitReached(f"the brief{without_} could not be decided: {late}") from None
        else:
            return out
    raise LimitReached(
        f"the brief has at least {MOST_CONFLICTS} conflicts among its lines: leave some lines out"
    )


def _largest_room_first(line: Requirement) -> float:
    """Return a sort key that places large areas first, since a small share of them frees much area."""
    kind, *_, most = line.terms[0]
    return -most if kind == "area" and line.where[0] == "rooms" else 0.0


def _eased(brief: Brief, place: Where, house_of: Callable[[Brief], House | None]) -> Brief | None:
    """Return the brief with the bounds at ``place`` as little wider as a house was found for, or None."""

    def by(down: float, up: float) -> Brief:
        return widened(brief, place, down, up)

    for down, up in ((1, 0), (0, 1), (1, 1)):  # a lower bound, a higher one, or both
        if house := house_of(by(ANY * down, ANY * up)):
            break
    else:
        return None
    least, most = 0.0, off_by(house, brief, place)
    while most - least > PRECISION * (1 + least):
        half = (least + most) / 2
        if house := house_of(by(half * down, half * up)):
            most = min(half, off_by(house, brief, place))
        else:
            least = half
    # At the least share rooms have little choice in other lengths, and houses are hard to find.
    ample = ((most + more) * (1 + more) for more in MARGINS)
    return next((some for share in ample if house_of(some := by(share * down, share * up))), None)
