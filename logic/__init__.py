"""Houses from rules: generate, check, explain, load, save."""

from logic.dataset.reading import HouseSet, load
from logic.errors import (
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
from logic.house.files import save
from logic.house.gallery import Houses
from logic.house.house import House
from logic.house.parts import Door, FreeWall, Piece, Rect, Room, Window
from logic.house.star import Star, StarRoom
from logic.why.answer import Why
from logic.workers.explain import explain_house
from logic.workers.generate import count_layouts, generate, lint
from logic.workers.nearest import Broken, Nearest, nearest
from logic.workers.nearest_plan import NearestPlan, nearest_plan
from logic.workers.standards import check
from logic.workers.stream import HouseStream

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


def _plan(house: House, width: int) -> str:
    from logic.drawing.draw import plan_svg  # Imported here, since it imports matplotlib.

    return plan_svg(house, width)


House.plan = _plan
