"""Furnished houses from rules, environments in them, and agents: generate, check, explain, load, save.

``vitruvius.sim`` has the environments, ``vitruvius.agent`` the agents. Importing this package registers the
environments: ``gymnasium.make_vec("Vitruvius/House-v0", num_envs=4096, houses="houses.jsonl")``.
"""

# ruff: noqa: F403, F405 - type checkers see the names of logic here; at run time __getattr__ finds them
from typing import TYPE_CHECKING, Any

from vitruvius import environments

if TYPE_CHECKING:
    from vitruvius.logic import *

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

environments.register_soon()


def __getattr__(name: str) -> Any:
    """Return a public name of ``logic``, imported with the first one: help comes at once."""
    if name in __all__:
        from vitruvius import logic

        return getattr(logic, name)
    raise AttributeError(f"module 'vitruvius' has no attribute {name!r}")


def __dir__() -> list[str]:
    """Return the public names, for completion."""
    return [*globals(), *__all__]
