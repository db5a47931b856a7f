"""Findings of generation without a layout: the evidence from which ``logic.proofs`` makes a proof."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

from clingo import Symbol

from vitruvius.logic.generation.feasibility import Feasibility
from vitruvius.logic.generation.movable_doors import Refuted
from vitruvius.logic.request.house_request import HouseRequest


@dataclass
class NoLayout(Exception):
    """Stage 1 found no layout of a request outside the layouts that are proved infeasible."""

    request: HouseRequest
    feasibility: Feasibility
    """Rules to prove it by."""
    unfurnishable: Collection[str] = ()
    """Room types that have no furniture, at any size."""
    orders: Sequence[Mapping[Symbol, bool]] = ()
    """Orders of the rooms that do not fit between the fixed rooms."""
    refuted: Sequence[Refuted] = ()
    """Rooms of the user's plan that have no furniture."""


@dataclass
class NoUnits(NoLayout):
    """Stage 1 found no layout of a house of units, some of which are infeasible."""

    unit: Feasibility = field(kw_only=True)
    """Rules of one unit."""
    barred: Mapping[Symbol, HouseRequest] = field(kw_only=True)
    """Infeasible units: see ``barred_units``."""
