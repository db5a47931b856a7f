"""Houses from rules: generate, check, explain, load, save."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from vitruvius.logic.errors import (
    Finding,
    GrammarError,
    GrammarWarning,
    HouseFileError,
    LimitReached,
    MissingProgram,
    PlanWarning,
    RequestError,
    Unsatisfiable,
    VitruviusError,
)
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Door, FreeWall, Piece, Rect, Room, Window

if TYPE_CHECKING:
    from vitruvius.logic.dataset.reading import HouseSet, load
    from vitruvius.logic.dataset.stream import HouseStream
    from vitruvius.logic.files.gallery import Houses
    from vitruvius.logic.files.house_files import save
    from vitruvius.logic.house.star import Star, StarRoom
    from vitruvius.logic.why.answer import Why
    from vitruvius.logic.workers.check import check
    from vitruvius.logic.workers.count import count_layouts
    from vitruvius.logic.workers.explain import explain_house
    from vitruvius.logic.workers.generate import generate
    from vitruvius.logic.workers.lint import lint
    from vitruvius.logic.workers.nearest import Broken, Nearest, nearest
    from vitruvius.logic.workers.nearest_plan import NearestPlan, nearest_plan

__all__ = [
    "Broken",
    "Door",
    "Finding",
    "FreeWall",
    "GrammarError",
    "GrammarWarning",
    "House",
    "HouseFileError",
    "HouseSet",
    "HouseStream",
    "Houses",
    "LimitReached",
    "MissingProgram",
    "Nearest",
    "NearestPlan",
    "Piece",
    "PlanWarning",
    "Rect",
    "RequestError",
    "Room",
    "Star",
    "StarRoom",
    "Unsatisfiable",
    "VitruviusError",
    "Why",
    "Window",
    "check",
    "count_layouts",
    "explain_house",
    "generate",
    "lint",
    "load",
    "nearest",
    "nearest_plan",
    "save",
]

_LATER = {
    "Broken": "workers.nearest",
    "HouseSet": "dataset.reading",
    "HouseStream": "dataset.stream",
    "Houses": "files.gallery",
    "Nearest": "workers.nearest",
    "NearestPlan": "workers.nearest_plan",
    "Star": "house.star",
    "StarRoom": "house.star",
    "Why": "why.answer",
    "check": "workers.check",
    "count_layouts": "workers.count",
    "explain_house": "workers.explain",
    "generate": "workers.generate",
    "lint": "workers.lint",
    "load": "dataset.reading",
    "nearest": "workers.nearest",
    "nearest_plan": "workers.nearest_plan",
    "save": "files.house_files",
}
"""Modules of the public names that are imported when they are first used.

A solver process needs none of them, and a command few.
"""


def __getattr__(name: str) -> Any:
    """Return a public name of ``_LATER``, and keep it."""
    if name not in _LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = getattr(import_module(f"vitruvius.logic.{_LATER[name]}"), name)
    return globals()[name]


def __dir__() -> list[str]:
    """Return the public names, for completion."""
    return [*globals(), *_LATER]


def _plan(house: House, width: int) -> str:
    from vitruvius.logic.drawing.draw import plan_svg  # Imported here, since it imports Pillow.

    return plan_svg(house, width)


House.plan = _plan
