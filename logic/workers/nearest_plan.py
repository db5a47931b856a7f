"""Search for the plan nearest to a user's plan that has a house: walls move as little as possible."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple, Unpack

from msgspec.structs import replace

from vitruvius.logic.errors import Unsatisfiable
from vitruvius.logic.house.house import House
from vitruvius.logic.request.arguments import Drawn, house_request
from vitruvius.logic.request.given_plan import read_plan
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.request.own_plan import OwnPlan
from vitruvius.logic.spelling import keywords
from vitruvius.logic.workers.messages import Moved, MovePlan, Open
from vitruvius.logic.workers.pool import houses
from vitruvius.logic.workers.solver import answers

SEEN = 0.0005
"""Smallest change that is reported, in metres."""


class NearestPlan(NamedTuple):
    """Plan that has houses, and the changes of its rooms, as in ``R3 0.14 m wider``."""

    plan: OwnPlan
    changes: tuple[str, ...]
    proof: Unsatisfiable | None = None
    """Proof that the user's plan has no house."""


@keywords(pieces="furniture", rules="grammar", timeout="seconds")
def nearest_plan(
    plan: str | Path | House | OwnPlan | Mapping[str, Any],
    *,
    seed: int = 0,
    index: int = 0,
    **stated: Unpack[Drawn],
) -> NearestPlan:
    """Return the nearest plan that has houses, which is the given plan if it has houses.

    Each wall moves as a whole. The sum of the moves is the least with which sizes, areas, doors and windows
    satisfy the grammar, for the plan's own types and doors. If the plan leaves these open, the result is the
    best of a dozen choices.

    Arguments are those of ``generate``; ``seconds`` limits each house or proof on the way. Raises as
    ``generate`` does: ``Unsatisfiable`` if no move of the walls gives a house.
    """
    return plan_nearest(house_request(plan=plan, **stated), seed, index)


def plan_nearest(request: HouseRequest, seed: int, index: int) -> NearestPlan:
    """Return the nearest plan to the request's with which house ``index`` exists: see ``nearest_plan``."""
    own = request.plan
    assert own

    def require_house(request: HouseRequest) -> None:
        next(houses(request, seed, range(index, index + 1)))

    try:
        require_house(request)
    except Unsatisfiable as proof:
        opening = Open(grammar=str(request.rules.directory))
        late = (
            f"the search for other wall positions took {request.seconds:g} s: raise the limit with --seconds"
        )
        [answer] = answers(opening, MovePlan(request=request, seed=seed), Moved, request.seconds, late)
        if answer.plan is None:
            raise
        moved = read_plan(answer.plan)
        require_house(replace(request, plan=moved))
        return NearestPlan(moved, tuple(_changes(own, moved)), proof)
    return NearestPlan(own, ())


def _changes(old: OwnPlan, new: OwnPlan) -> Iterator[str]:
    """Yield the differences of each changed room."""
    for one, other in zip(old.rooms, new.rooms, strict=True):
        parts = []
        for off, more, less in (
            (other.width - one.width, "wider", "narrower"),
            (other.height - one.height, "deeper", "shallower"),
        ):
            if abs(off) > SEEN:
                parts.append(f"{abs(off):.3f} m {more if off > 0 else less}")
        if parts:
            yield f"{one.name} {', '.join(parts)}"
