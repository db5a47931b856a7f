"""Time before the first step in a new process: prints seconds by part, as JSON.

``python -m benchmarks.simulator.first_step FILE`` measures the import, packing FILE's houses for the first
time and again, and the rest until the first step of 4096 environments is done. Kernels are compiled, or taken
from Taichi's cache on the disk; ``TI_OFFLINE_CACHE=0`` disables the cache.
"""

import json
from argparse import ArgumentParser
from time import perf_counter
from typing import Any
from unittest.mock import patch


def main(file: str) -> None:
    """Print the seconds."""
    begun = perf_counter()
    import numpy as np

    from vitruvius.logic import load
    from vitruvius.sim import HouseVectorEnv
    from vitruvius.sim.world.world import World

    imported = perf_counter() - begun
    houses = load(file)
    packing, take_in = [], World.load

    def load_timed(world: World, *arguments: Any) -> None:
        before = perf_counter()
        take_in(world, *arguments)
        packing.append(perf_counter() - before)

    with patch.object(World, "load", load_timed):
        before = perf_counter()
        envs = HouseVectorEnv(houses, num_envs=4096)
        envs.reset(seed=0)
        envs.step(np.zeros(4096, int))
        first = perf_counter() - before - packing[0]
        envs.set_houses(houses)
    parts = {"import": imported, "packing": packing[0], "first step": first, "packing again": packing[1]}
    print(json.dumps(parts))


if __name__ == "__main__":
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("file")
    main(parser.parse_args().file)
