"""The proof that there is no house of units: which units there are not, and why, unit by unit."""

from logic.errors import Reason, Unsatisfiable
from logic.generation.barred_units import no_unit, option_reasons
from logic.generation.evidence import NoUnits
from logic.proofs.proof import Prover


def no_house(found: NoUnits) -> Unsatisfiable:
    """Why a request has no house: of units that there are not, the user's reasons for that."""
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
