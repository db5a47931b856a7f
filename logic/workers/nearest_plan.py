"""Search for the plan nearest to a user's plan that has a house: walls move as little as possible."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import msgspec

from vitruvius.logic.errors import Unsatisfiable
from vitruvius.logic.grammar import find
from vitruvius.logic.house.house import House
from vitruvius.logic.plain import plain
from vitruvius.logic.request.given_plan import SNAP, read_plan
from vitruvius.logic.request.own_plan import OwnPlan
from vitruvius.logic.request.request import Count, Request
from vitruvius.logic.spelling import keywords
from vitruvius.logic.workers.generate import generate
from vitruvius.logic.workers.messages import Moved, MovePlan, Open
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
    plan_unit: str | None = None,
    snap: float = SNAP,
    storey: str | None = None,
    types: Mapping[str, Count] | None = None,
    furniture: Mapping[str, Count] | None = None,
    grammar: str | Path | None = None,
    seed: int = 0,
    index: int = 0,
    inferences: int = 100_000_000,
    seconds: float = 60.0,
) -> NearestPlan:
    """Return the nearest plan that has houses, which is the given plan if it has houses.

    Each wall moves as a whole. The sum of the moves is the least with which sizes, areas, doors and windows
    satisfy the grammar, for the plan's own types and doors. If the plan leaves these open, the result is the
    best of a dozen choices.

    Arguments are those of ``generate``; ``seconds`` limits each house or proof on the way. Raises as
    ``generate`` does: ``Unsatisfiable`` if no move of the walls gives a house.
    """
    own = read_plan(plain(plan), plan_unit, snap, storey, find(grammar or "family").types)
    asked: dict[str, Any] = {"types": types or {}, "furniture": furniture or {}}

    def house(some: OwnPlan) -> House:
        own = {"grammar": grammar, "seed": seed, "start": index, "inferences": inferences}
        return next(generate(plan=some, **asked, **own, seconds=seconds))

    try:
        house(own)
    except Unsatisfiable as proof:
        wanted = Request.read({"rooms": len(own.rooms), **asked})
        wanted = Request(wanted.rooms, wanted.types, wanted.furniture, plan=own)
        question = MovePlan(request=wanted.to_dict(), seed=seed)
        opening = Open(grammar=str(find(grammar or "family").directory))
        late = f"where else walls could be took {seconds:g} s: raise it with --seconds"
        [answer] = answers(opening, question, Moved, seconds, late)
        if answer.plan is None:
            raise
        moved = msgspec.convert(answer.plan, OwnPlan)
        house(moved)
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
