"""Houses from rules: generate, check, explain, load, save."""

from logic.check import check
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
from logic.files import load, save
from logic.gallery import Houses
from logic.generate import count_layouts, generate, lint
from logic.house import House
from logic.parts import Door, Piece, Rect, Room, Window
from logic.star import Star, StarRoom
from logic.why import Why, explain_house

__all__ = [
    "Door",
    "Finding",
    "GrammarError",
    "GrammarWarning",
    "House",
    "HouseFileError",
    "Houses",
    "LimitReached",
    "MissingProgram",
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
    "save",
]
