"""What generation has found where there is no layout: the evidence of a proof, which others make."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

from clingo import Symbol

from logic.generation.feasibility import Feasibility
from logic.generation.movable_doors import Refuted
from logic.request.request import Request


@dataclass
class NoLayout(Exception):
    """Stage 1 finds no layout of a request outside of what is proved infeasible."""

    request: Request
    feasibility: Feasibility
    """The rules it is to be proved by."""
    unfurnishable: Collection[str] = ()
    """Types of room that have no furniture, at any size."""
    orders: Sequence[Mapping[Symbol, bool]] = ()
    """Orders of the rooms that do not fit between the fixed rooms."""
    refuted: Sequence[Refuted] = ()
    """Rooms of the user's plan that have no furniture."""


@dataclass
class NoUnits(NoLayout):
    """The same of a house of units, some of which there are not."""

    unit: Feasibility = field(kw_only=True)
    """The rules of one unit."""
    barred: Mapping[Symbol, Request] = field(kw_only=True)
    """Those that there are not: see ``barred_units``."""
