"""The environments that Gymnasium knows by name once ``vitruvius`` is imported."""

import sys
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from types import ModuleType
from typing import Any

BACKENDS = ("continuous", "free", "grid")
"""Names of the backends of ``sim.environment.arguments``, which imports the simulator."""


def register_soon() -> None:
    """Register the environments at once if Gymnasium is imported, or else after its import (0.15 s)."""
    if "gymnasium" in sys.modules:
        register()
    else:
        sys.meta_path.insert(0, _Registering())


def register() -> None:
    """Register the environments with Gymnasium. Imports neither the simulator nor Taichi."""
    from gymnasium import register as add

    def add_house(name: str, **arguments: Any) -> None:
        module = "vitruvius.sim.environment"
        one, many = f"{module}.single:HouseEnv", f"{module}.vector:HouseVectorEnv"
        add(f"Vitruvius/{name}-v0", entry_point=one, vector_entry_point=many, kwargs=arguments)

    add_house("House")
    for backend in BACKENDS:  # for libraries such as TorchRL, which have their own keyword ``backend``
        houses = {"houses": "cell-houses"} if backend == "grid" else {}
        add_house(f"House-{backend}", backend=backend, **houses)
    add_house("Paper", houses="paper-house", targets="paper-main", preset="paper")
    add("Vitruvius/MiniGrid-v0", entry_point="vitruvius.sim.adapters.minigrid:MiniGridHouseEnv")


class _Registering:
    """Registers the environments after the first import of Gymnasium."""

    def find_spec(self, fullname: str, path: Any, target: ModuleType | None = None) -> ModuleSpec | None:
        if fullname != "gymnasium":
            return None
        sys.meta_path.remove(self)
        try:
            spec = find_spec(fullname)
        finally:
            sys.meta_path.insert(0, self)  # A search for the module alone does not import it.
        loader: Any = spec and spec.loader
        if loader:
            execute = loader.exec_module

            def execute_and_register(module: ModuleType) -> None:
                sys.meta_path.remove(self)
                execute(module)
                register()

            loader.exec_module = execute_and_register
        return spec
