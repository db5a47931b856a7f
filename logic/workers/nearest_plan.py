"""The plan nearest to a user's that has a house: walls move, by as little as can be."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import msgspec

from logic.errors import Unsatisfiable
from logic.grammar import find
from logic.house.house import House
from logic.plain import plain
from logic.request.given_plan import SNAP, read_plan
from logic.request.own_plan import OwnPlan
from logic.request.request import Count, Request
from logic.spelling import keywords
from logic.workers.generate import generate
from logic.workers.messages import Moved, MovePlan, Open
from logic.workers.solver import answers

SEEN = 0.0005
"""Metres: a change that is said."""


class NearestPlan(NamedTuple):
    """A plan that has houses, and how its rooms differ from those of the user's: ``R3 0.14 m wider``."""

    plan: OwnPlan
    changes: tuple[str, ...]
    proof: Unsatisfiable | None = None
    """Why the user's has none."""


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
    """The plan that is nearest to this one of those that have houses; itself, where it has.

    Its walls move, each as a whole, by the least sum with which sizes, areas, doors and windows are the
    grammar's, for the plan's own types and doors; where it leaves these open, of a dozen choices. Arguments
    are those of ``generate``; ``seconds`` is for each house or proof that it takes. Raises as ``generate``
    does: ``Unsatisfiable`` where walls elsewhere make no house of it.
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
    """How each room that is not as it was differs."""
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
