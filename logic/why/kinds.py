"""Which witness a house has, by its topology."""

from logic.generation.builder import Builder
from logic.house.house import House
from logic.why.shared_walls import PlanWitness
from logic.why.star import StarWitness
from logic.why.units import UnitsWitness
from logic.why.witness import Witness


def witness_of(builder: Builder, house: House, inferences: int) -> Witness:
    """The house, made again by the rules that it says it is of; raises as ``Witness``."""
    assert house.provenance is not None
    if not builder.grammar.shares_walls:
        return StarWitness(builder, house, inferences)
    is_of_units = builder.loaded.depths and not house.provenance.request.get("plan")
    return (UnitsWitness if is_of_units else PlanWitness)(builder, house, inferences)
