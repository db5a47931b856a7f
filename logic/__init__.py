"""Houses from rules: generate, check, explain, load, save."""

from logic.check import check
from logic.errors import (
    Finding,
    GrammarError,
    GrammarWarning,
    HouseFileError,
    LimitReached,
    MissingProgram,
    RequestError,
    Unsatisfiable,
    VitruviusError,
)
from logic.files import load, save
from logic.generate import count_layouts, generate, lint
from logic.house import Door, House, Piece, Rect, Room
from logic.why import Why, explain_house

__all__ = [
    "Door",
    "Finding",
    "GrammarError",
    "GrammarWarning",
    "House",
    "HouseFileError",
    "LimitReached",
    "MissingProgram",
    "Piece",
    "Rect",
    "RequestError",
    "Room",
    "Unsatisfiable",
    "VitruviusError",
    "Why",
    "check",
    "count_layouts",
    "explain_house",
    "generate",
    "lint",
    "load",
    "save",
]
