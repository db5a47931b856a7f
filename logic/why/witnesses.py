"""Witness of a house, by its topology."""

from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.house.house import House
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.why.shared_walls import PlanWitness
from vitruvius.logic.why.star import StarWitness
from vitruvius.logic.why.units import UnitsWitness
from vitruvius.logic.why.witness import Witness


def witness_of(builder: Builder, house: House) -> Witness:
    """Return the witness of a house, which generates the house again from its provenance.

    Raises as ``Witness`` does.
    """
    assert house.provenance is not None
    given = HouseRequest.read(house.provenance.request).given
    if given or builder.grammar.shares_walls:
        has_units = builder.loaded.depths and not given
        return (UnitsWitness if has_units else PlanWitness)(builder, house)
    return StarWitness(builder, house)
