"""Proof that there is no house of units: the infeasible units, and the reasons of each."""

from vitruvius.logic.errors import Reason, Unsatisfiable
from vitruvius.logic.generation.barred_units import no_unit, option_reasons
from vitruvius.logic.generation.evidence import NoUnits
from vitruvius.logic.proofs.proof import Prover


def no_house(found: NoUnits) -> Unsatisfiable:
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
