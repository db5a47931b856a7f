"""Houses simulated thousands at a time: environments for Gymnasium, registered on import.

``gymnasium.make_vec("vitruvius:Vitruvius/House-v0", num_envs=4096, houses="houses.jsonl")``
"""

# ruff: noqa: E402 - that logic is ours is checked before it is imported
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import gymnasium

_logic = find_spec("logic")
if _logic and Path(_logic.origin or "").resolve().parent.parent != Path(__file__).resolve().parent.parent:
    raise ImportError(f"{_logic.origin}: hides the package logic of Vitruvius: give it another name")

from vitruvius.sim.allowed import allow
from vitruvius.sim.baselines.oracle import Oracle, shortest_path
from vitruvius.sim.config import DEFAULT, PAPER, Config
from vitruvius.sim.environment.arguments import BACKENDS, CELL_HOUSES
from vitruvius.sim.environment.rotation import HouseRotation
from vitruvius.sim.environment.single import HouseEnv
from vitruvius.sim.environment.vector import HouseVectorEnv
from vitruvius.sim.tasks.tasks import Collect, FixedTask, Points, Reach, Rooms, Task

__all__ = [
    "DEFAULT",
    "PAPER",
    "Collect",
    "Config",
    "FixedTask",
    "HouseEnv",
    "HouseRotation",
    "HouseVectorEnv",
    "Oracle",
    "Points",
    "Reach",
    "Rooms",
    "Task",
    "allow",
    "shortest_path",
]


def _register(name: str, **arguments: Any) -> None:
    """Register an environment and its vector environment, with the given default arguments."""
    one, many = "vitruvius.sim.environment.single:HouseEnv", "vitruvius.sim.environment.vector:HouseVectorEnv"
    gymnasium.register(f"Vitruvius/{name}-v0", entry_point=one, vector_entry_point=many, kwargs=arguments)


_register("House")
for _backend in BACKENDS:  # for libraries such as TorchRL, which have their own keyword ``backend``
    _register(
        f"House-{_backend}", backend=_backend, **({"houses": CELL_HOUSES} if _backend == "grid" else {})
    )
_register("Paper", houses="paper-house", targets="paper-main", preset="paper")
gymnasium.register("Vitruvius/MiniGrid-v0", entry_point="vitruvius.sim.adapters.minigrid:MiniGridHouseEnv")
