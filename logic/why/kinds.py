"""Witness of a house, by the class that generated the house."""

from logic.generation.brief import BriefMaker
from logic.generation.builder import Builder
from logic.generation.given_plan import GivenPlanMaker
from logic.generation.maker import Maker
from logic.generation.shared_walls import SharedWallsMaker
from logic.generation.star import StarMaker
from logic.generation.units import UnitsMaker
from logic.house.house import House
from logic.request.request import Request
from logic.why.shared_walls import PlanWitness
from logic.why.star import StarWitness
from logic.why.units import UnitsWitness
from logic.why.witness import Witness

WITNESSES: dict[type[Maker], type[Witness]] = {
    StarMaker: StarWitness,
    SharedWallsMaker: PlanWitness,
    UnitsMaker: UnitsWitness,
    GivenPlanMaker: PlanWitness,
    BriefMaker: PlanWitness,
}


def witness_of(builder: Builder, house: House, inferences: int) -> Witness:
    """Return the witness of a house, which generates the house again from its provenance.

    Raises as ``Witness`` does.
    """
    assert house.provenance is not None
    request = Request.read(house.provenance.request)
    return WITNESSES[builder.maker_class(request)](builder, house, inferences)
