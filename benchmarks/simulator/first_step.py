"""What comes before the first step, in a process of its own: prints seconds by part, as JSON.

``python -m benchmarks.simulator.first_step FILE``: importing, packing FILE's houses for the first time and
again, and all the rest until the first step of 4096 environments is done. Kernels are compiled, or taken from
Taichi's cache on the disk; ``TI_OFFLINE_CACHE=0`` forbids the cache.
"""

import json
import sys
from collections.abc import Sequence
from time import perf_counter
from unittest.mock import patch

begun = perf_counter()

import numpy as np  # noqa: E402

import sim  # noqa: E402
from logic import House, load  # noqa: E402
from sim.world import World  # noqa: E402

imported = perf_counter() - begun


def main(file: str) -> None:
    houses = load(file)
    packing, take_in = [], World.load

    def load_timed(world: World, bank: Sequence[House]) -> None:
        before = perf_counter()
        take_in(world, bank)
        packing.append(perf_counter() - before)

    with patch.object(World, "load", load_timed):
        before = perf_counter()
        envs = sim.HouseVectorEnv(houses, num_envs=4096)
        envs.reset(seed=0)
        envs.step(np.zeros(4096, int))
        first = perf_counter() - before - packing[0]
        envs.set_houses(houses)
    parts = {"import": imported, "packing": packing[0], "first step": first, "packing again": packing[1]}
    print(json.dumps(parts))


if __name__ == "__main__":
    main(sys.argv[1])
