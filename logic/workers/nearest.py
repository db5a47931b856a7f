"""Search for the house that breaks the fewest lines of a brief, if no house keeps all lines.

Each proof is a conflict: one of its lines must change. The search drops the fewest lines that hit all
conflicts found so far. If a house exists without these lines, no smaller number suffices; otherwise the proof
that there is none is a new conflict.
"""

from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

from logic.errors import LimitReached, Unsatisfiable
from logic.house.house import House
from logic.plain import plain
from logic.proofs.least import Hitting
from logic.request.brief import Brief, alone, read_brief
from logic.request.brief_lines import Requirement, Where, requirements
from logic.request.eased import is_length, off_by, widened, without
from logic.request.request import Count
from logic.spelling import keywords, numbered
from logic.workers.generate import generate

MOST_CONFLICTS = 60
"""So many conflicts of a brief are looked at."""

NEAR = 0.05
"""How precisely the share is found by which bounds of a length are wider."""

AMPLE = (NEAR, 5 * NEAR, 20 * NEAR)
"""Shares by which the bounds are wider than that, the first with which a house is made."""

EASING = 10_000_000
"""So many Prolog inferences may a house of wider bounds take."""

ANY = 1e6
"""A share that leaves a bound out."""


class Broken(NamedTuple):
    """A line of a brief that a house cannot keep with the others, and what it keeps of it in its place."""

    line: str
    instead: str = ""
    """A length in wider bounds; nothing where the line is left out."""

    def __str__(self) -> str:
        """Both, as in ``Bed has 11 to 13 m²: Bed has 10.2 to 13 m²``."""
        return f"{self.line}: {self.instead or 'left out'}"


class Nearest(NamedTuple):
    """A brief that has houses, and the lines of the user's that these break: as few as can be."""

    brief: Brief
    broken: tuple[Broken, ...]


@keywords(pieces="furniture", rules="grammar", timeout="seconds")
def nearest(
    brief: str | Path | Mapping[str, Any] | Brief,
    *,
    types: Mapping[str, Count] | None = None,
    furniture: Mapping[str, Count] | None = None,
    grammar: str | Path | None = None,
    seed: int = 0,
    index: int = 0,
    inferences: int = 100_000_000,
    seconds: float = 60.0,
) -> Nearest:
    """The brief that is nearest to this one of those that have houses; itself, where it has.

    As few lines as can be are broken, lengths before others where as many would do, and areas of large rooms
    first. Of these, areas and sizes are kept in wider bounds, as little wider as a house is soon found for
    (to a twentieth), and others are left out. Arguments are those of ``generate``; ``seconds`` is for each
    house or proof that it takes. Raises as ``generate`` does: ``Unsatisfiable`` where the conflict is the
    grammar's own.
    """

    def house(some: Brief, inferences: int = inferences) -> House:
        return next(
            generate(
                brief=some,
                types=types,
                furniture=furniture,
                grammar=grammar,
                seed=seed,
                start=index,
                inferences=inferences,
                seconds=seconds,
            )
        )

    def house_of(some: Brief) -> House | None:
        with suppress(Unsatisfiable, LimitReached):
            return house(some, min(inferences, EASING))
        return None

    wanted = read_brief(plain(brief))
    wanted = wanted if grammar else alone(wanted)
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
    """The fewest lines of a brief without which it has a house; raises as ``house`` does."""
    lines = sorted(requirements(wanted), key=_largest_room_first)
    hitting = Hitting([not is_length(line.where) for line in lines])
    for _ in range(MOST_CONFLICTS):
        out = [lines[place] for place in hitting.set()]
        try:
            house(without(wanted, [line.where for line in out]))
        except Unsatisfiable as proof:
            conflict = {reason.text for reason in proof.reasons}
            named = [place for place, line in enumerate(lines) if line.reason in conflict and line not in out]
            if not named:  # the grammar's own, whatever the brief says
                raise
            hitting.add(named)
        except LimitReached as late:
            without_ = f" without {numbered(len(out), 'line')} of it" if out else ""
            raise LimitReached(f"whether the brief{without_} has a house was not found out: {late}") from None
        else:
            return out
    raise LimitReached(
        f"the brief has {MOST_CONFLICTS} conflicts among its lines, and more: leave some of them out"
    )


def _largest_room_first(line: Requirement) -> float:
    """An order of lines: of a large area a small share makes up for much."""
    kind, *_, most = line.terms[0]
    return -most if kind == "area" and line.where[0] == "rooms" else 0.0


def _eased(brief: Brief, place: Where, house_of: Callable[[Brief], House | None]) -> Brief | None:
    """The brief with the length at this place as little wider as a house was found for; None for none."""

    def by(down: float, up: float) -> Brief:
        return widened(brief, place, down, up)

    for down, up in ((1, 0), (0, 1), (1, 1)):  # less, more, or either
        if house := house_of(by(ANY * down, ANY * up)):
            break
    else:
        return None
    least, most = 0.0, off_by(house, brief, place)
    while most - least > NEAR * (1 + least):
        half = (least + most) / 2
        if house := house_of(by(half * down, half * up)):
            most = min(half, off_by(house, brief, place))
        else:
            least = half
    # At the least share rooms have hardly any other lengths, and houses are hard to find.
    ample = ((most + more) * (1 + more) for more in AMPLE)
    return next((some for share in ample if house_of(some := by(share * down, share * up))), None)
