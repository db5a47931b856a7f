"""Houses simulated thousands at a time: environments for Gymnasium."""

from vitruvius.logic.installation import required_by

with required_by("vitruvius.sim"):
    from vitruvius.sim.allowed import allow
    from vitruvius.sim.config import DEFAULT, PAPER, Config
    from vitruvius.sim.environment.rotation import HouseRotation
    from vitruvius.sim.environment.single import HouseEnv
    from vitruvius.sim.environment.vector import HouseVectorEnv
    from vitruvius.sim.oracle.oracle import Oracle, shortest_path
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
