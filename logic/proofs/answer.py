"""A house of a request, or the proof that there is none."""

from vitruvius.logic.errors import LimitReached, OutOfInferences, Reason, Unsatisfiable
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.generation.loop import NoLayout, NoUnits
from vitruvius.logic.generation.unit import no_unit, option_reasons
from vitruvius.logic.house.house import House
from vitruvius.logic.proofs.giving_way import giving_way, unlike_stated_sizes
from vitruvius.logic.proofs.proof import Prover
from vitruvius.logic.request.house_request import HouseRequest


def house_or_proof(builder: Builder, request: HouseRequest, seed: int, index: int) -> House:
    """Return the house of ``Builder.house``. Raises ``Unsatisfiable`` if it finds no layout.

    Typical rules that contradict the request's statements about rooms give way. A proof that uses the areas
    of rooms covers only a part of the sizes that these areas allow; in that case all sizes are searched.
    """
    builder.begin()
    if request.given and (rules := unlike_stated_sizes(builder, request)):
        builder = builder.giving_way(rules)
    thorough = False
    while True:
        try:
            return builder.house(request, seed, index, thorough)
        except NoLayout as found:
            if rules := giving_way(found):
                builder, thorough = builder.giving_way(rules), False
                continue
            proof = unsatisfiable(found)
        rests_on_areas = any(reason.text.startswith("room_area(") for reason in proof.reasons)
        if thorough or not (rests_on_areas and builder.decides_areas(request)):
            raise proof
        thorough = True


def unsatisfiable(found: NoLayout) -> Unsatisfiable:
    """Return the proof that a request has no house, by the evidence that there is no layout."""
    try:
        return (
            _no_house(found) if isinstance(found, NoUnits) else Prover(found.feasibility).unsatisfiable(found)
        )
    except OutOfInferences:
        late = "the proof that there is no house reached its limit of inferences"
        raise LimitReached(f"{late}. {found.feasibility.placer.account}") from None


def _no_house(found: NoUnits) -> Unsatisfiable:
    """Return the proof that a request has no house. For infeasible units it has the user's own reasons."""
    whole, of_unit = Prover(found.feasibility).unsatisfiable(found), Prover(found.unit)
    units = {no_unit(unit): unit for unit in found.barred.values()}
    reasons: dict[Reason, None] = {}
    for reason in whole.reasons:
        if reason not in units:
            reasons[reason] = None
            continue
        own, forbidding = option_reasons(units[reason]), of_unit.conflict(units[reason])
        reasons |= dict.fromkeys(each for each in forbidding if each not in own)
    return Unsatisfiable(whole.grammar, whole.request, tuple(reasons), whole.advice)
