"""Witness of a house, by the class that generated the house."""

from vitruvius.logic.generation.brief import BriefMaker
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.generation.given_plan import GivenPlanMaker
from vitruvius.logic.generation.maker import Maker
from vitruvius.logic.generation.shared_walls import SharedWallsMaker
from vitruvius.logic.generation.star import StarMaker
from vitruvius.logic.generation.units import UnitsMaker
from vitruvius.logic.house.house import House
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.why.shared_walls import PlanWitness
from vitruvius.logic.why.star import StarWitness
from vitruvius.logic.why.units import UnitsWitness
from vitruvius.logic.why.witness import Witness

WITNESSES: dict[type[Maker], type[Witness]] = {
    StarMaker: StarWitness,
    SharedWallsMaker: PlanWitness,
    UnitsMaker: UnitsWitness,
    GivenPlanMaker: PlanWitness,
    BriefMaker: PlanWitness,
}


def witness_of(builder: Builder, house: House) -> Witness:
    """Return the witness of a house, which generates the house again from its provenance.

    Raises as ``Witness`` does.
    """
    assert house.provenance is not None
    request = HouseRequest.read(house.provenance.request)
    return WITNESSES[builder.maker_class(request)](builder, house)
