"""The loop of generation: sample a layout, place it, furnish it, and learn from what failed.

Each kind of house has ``Stages`` of its own: a star (rooms around a main room), a plan of shared walls, a
house by a brief, a house in a given plan, a unit, and a building of units. The stages of a building run the
loop again for its units.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np
from clingo import Symbol

from vitruvius.logic.errors import OutOfInferences
from vitruvius.logic.generation.feasibility import Feasibility
from vitruvius.logic.generation.movable_doors import Refuted
from vitruvius.logic.house.house import House
from vitruvius.logic.layout.program import Program
from vitruvius.logic.placement.placer import Failure
from vitruvius.logic.request.house_request import HouseRequest

Sampled = TypeVar("Sampled")
Placed = TypeVar("Placed")
Made = TypeVar("Made")


class Stages(NamedTuple, Generic[Sampled, Placed, Made]):
    """Stages of a house, or of a part of a house, as functions."""

    sample: Callable[[], Sampled]
    """Stage that returns a layout that no known failure excludes, or raises ``NoLayout`` if there is none."""
    place: Callable[[Sampled], Placed]
    """Stage that returns a layout with lengths, or raises a ``Failure`` if there are none."""
    furnish: Callable[[Sampled, Placed], Made]
    """Stage that returns the furnished result, or raises a ``Failure`` if a room cannot be furnished."""
    learn: Callable[[Sampled, Failure], Sampled | None]
    """Stage that excludes a failure, and returns the next layout, or None to sample again.

    Raises ``LimitReached`` after too many failures.
    """


def made(stages: Stages[Sampled, Placed, Made]) -> Made:
    """Return the result of the first layout that passes all stages."""
    layout = stages.sample()
    while True:
        try:
            return stages.furnish(layout, stages.place(layout))
        except Failure as failure:
            found = failure
        layout = stages.learn(layout, found) or stages.sample()


class Work:
    """Random numbers for a house, and the number of Prolog inferences that its lengths may still use."""

    def __init__(self, rng: np.random.Generator, inferences: int) -> None:
        """Set the random generator and the number of inferences."""
        self.rng, self.inferences = rng, inferences

    def seed(self) -> int:
        """Sample a seed for SWI-Prolog."""
        return int(self.rng.integers(2**63))

    def spend(self, inferences: int) -> None:
        """Count the inferences of a stage."""
        self.inferences -= inferences

    def spend_in_vain(self, inferences: int) -> None:
        """Count the inferences of a failure. Raises ``OutOfInferences`` if none are left."""
        self.spend(inferences)
        if self.inferences <= 0:
            raise OutOfInferences


@dataclass(frozen=True, eq=False)
class Maker:
    """Generator of the houses of one topology, of one brief, or in one plan."""

    feasibility: Feasibility
    """Rules for the proof that a request has no house."""
    made: Callable[[HouseRequest, Work], tuple[House, Any]]
    """Returns a furnished house and its origin. The request and the random numbers determine the house.

    Raises ``NoLayout`` if there is provably no house, ``OutOfInferences`` and ``LimitReached`` at limits.
    """
    stated: Callable[[HouseRequest], Program]
    """Returns a program with the grammar's facts for the request, from which the houses' promises follow."""
    of_units: Feasibility | None = None
    """Rules of the choice of units, for houses of units."""


@dataclass
class NoLayout(Exception):
    """Evidence that a request has no house, from which ``logic.proofs`` makes a proof.

    Stage 1 found no layout outside the layouts that are proved infeasible.
    """

    request: HouseRequest
    feasibility: Feasibility
    """Rules for the proof."""
    unfurnishable: Collection[str] = ()
    """Room types that cannot be furnished at any size."""
    orders: Sequence[Mapping[Symbol, bool]] = ()
    """Orders in which the rooms do not fit between the fixed rooms."""
    refuted: Sequence[Refuted] = ()
    """Rooms of the user's plan that cannot be furnished."""


@dataclass
class NoUnits(NoLayout):
    """Evidence that a request has no house of units, with the infeasible units."""

    unit: Feasibility = field(kw_only=True)
    """Rules of one unit."""
    barred: Mapping[Symbol, HouseRequest] = field(kw_only=True)
    """Infeasible units: see ``barred_units``."""
