"""Requests from the arguments of ``generate``, in any form in which a user states them."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypedDict, Unpack

from vitruvius.logic.errors import RequestError
from vitruvius.logic.grammar import Grammar, find
from vitruvius.logic.house.house import House
from vitruvius.logic.plain import plain
from vitruvius.logic.request.brief import Brief, alone, read_brief
from vitruvius.logic.request.counts import Count, range_of, ranges_of, real, whole
from vitruvius.logic.request.fixed_rooms import FixedRoom, fixed_rooms
from vitruvius.logic.request.house_request import DEFAULT, INFERENCES, SECONDS, HouseRequest
from vitruvius.logic.request.own_plan import OwnPlan
from vitruvius.logic.spelling import keywords

PLAIN = "plain"
"""Grammar for a brief without a grammar. It states nothing about rooms."""


class Counted(TypedDict, total=False):
    """Arguments of every function that takes a request, except ``rooms``: see ``generate``."""

    types: Mapping[str, Count] | None
    furniture: Mapping[str, Count] | None
    cell: float
    grammar: str | Path | None
    inferences: int
    seconds: float


class Drawn(Counted, total=False):
    """Arguments of functions that read a plan."""

    plan_unit: str | None
    snap: float
    storey: str | None
    keep: House | None


class Stated(Drawn, total=False):
    """Arguments of ``generate`` that state a request."""

    plan: str | Path | House | OwnPlan | Mapping[str, Any] | None
    brief: str | Path | Mapping[str, Any] | Brief | None


@keywords()
def house_request(rooms: int | tuple[int, int] | None = None, **stated: Unpack[Stated]) -> HouseRequest:
    """Return the request of the arguments of ``generate``, whose ``rooms`` may also be a range.

    Houses of a range take its numbers of rooms in turn. Raises ``RequestError`` for a request
    that makes no sense, ``GrammarError`` if there is no such grammar.
    """
    source, grammar = stated.get("brief"), stated.get("grammar")
    brief = None if source is None else read_brief(plain(source))
    if brief and grammar is None:
        brief, grammar = alone(brief), PLAIN
    rules = find(grammar or DEFAULT)
    plan, fixed = _plan_and_fixed(stated, rules)
    if rooms is None and (given := brief or plan):
        rooms = len(given.rooms)
    if rooms is None:
        raise RequestError("rooms: give a number, as in --rooms 6, or a plan, as in --plan FILE")
    least, most = range_of(rooms)
    made = HouseRequest(
        least,
        ranges_of("type", stated.get("types")),
        ranges_of("piece", stated.get("furniture")),
        real("cell", stated.get("cell", 0.0)),
        fixed,
        plan,
        brief,
        str(rules.directory),
        most,
        whole("inferences", stated.get("inferences", INFERENCES), 1),
        real("seconds", stated.get("seconds", SECONDS)),
    )
    vars(made)["rules"] = rules  # so that they are not searched again
    return made


def _plan_and_fixed(stated: Stated, rules: Grammar) -> tuple[OwnPlan | None, tuple[FixedRoom, ...]]:
    """Return the plan, and the kept rooms of a star. Kept rooms of other houses are part of the plan."""
    plan, source, keep = None, stated.get("plan"), stated.get("keep")
    if source is None and keep is None:
        return None, ()
    # The readers of plans take as long to import as all other modules of a request.
    from vitruvius.logic.request.given_plan import SNAP, keeping, read_plan

    if source is not None:
        how = stated.get("plan_unit"), stated.get("snap", SNAP), stated.get("storey")
        plan = read_plan(plain(source), *how, rules.types)
    if keep is None:
        return plan, ()
    if not isinstance(keep, House):
        raise RequestError(f'keep: must be a house, as in keep=house.only("R0"), not {keep!r}')
    if keep.main_room is None:
        if plan is None:
            raise RequestError(
                "keep: rooms that share walls stay in their plan: also give the plan, as in "
                'generate(plan=house, keep=house.only("R2"))'
            )
        return keeping(plan, keep), ()
    if not keep.secondary:
        raise RequestError('keep: the house has no room to keep: name rooms, as in keep=house.only("R0")')
    return plan, tuple(fixed_rooms(keep))
