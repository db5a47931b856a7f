# /// script
# requires-python = ">=3.11,<3.14"
# dependencies = ["ir-sim==2.12.0", "shapely==2.2.0", "numpy==2.4.6"]
# ///
"""IR-SIM, a robot simulator in Python: ``uv run --no-project irsim_house.py``.

The settings are those of its documentation for training: ``headless``, and a list of environments that are
stepped one after the other, because IR-SIM has no batch. The caller resets them.
"""

import json
import math
import tempfile
from pathlib import Path

import house
import irsim
import numpy as np
from rounds import Case, Play, measure

EPISODE = 500
BODY = {"name": "circle", "radius": house.RADIUS}
WORLD = {
    "world": {"height": 2 * house.HALF, "width": 2 * house.HALF, "offset": [-house.HALF] * 2},
    "robot": {
        "kinematics": {"name": "diff"},
        "shape": BODY,
        "state": [*house.ROOMS[0], 0.0],
        "goal": [*house.ROOMS[2], 0.0],
        "sensors": [
            {
                "name": "lidar2d",
                "number": house.RAYS,
                "angle_range": math.radians(house.FIELD),
                "range_max": house.RANGE,
            }
        ],
    },
    "obstacle": [
        *({"shape": {"name": "linestring", "vertices": wall}, "state": [0, 0, 0]} for wall in house.WALLS),
        *(
            {"shape": {"name": "rectangle", "length": length, "width": width}, "state": [*middle, 0]}
            for middle, (length, width) in house.BOXES
        ),
    ],
}
"""Scene of IR-SIM, which reads YAML; JSON is a part of YAML."""


def build(environments: int) -> Play:
    """Return the steps of a list of environments, with random actions drawn beforehand."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "house.yaml"
        path.write_text(json.dumps(WORLD))
        envs = [irsim.make(str(path), headless=True, log_level="ERROR", seed=i) for i in range(environments)]
    plan = np.random.default_rng(0).uniform((0.0, -1.0), (1.0, 1.0), (max(4, 64 // environments), 2))
    ages = [0] * environments

    def play() -> int:
        for action in plan:
            for i, env in enumerate(envs):
                env.step(action[:, None])
                env.get_lidar_scan()
                ages[i] += 1
                if env.done() or ages[i] == EPISODE:
                    env.reset()
                    ages[i] = 0
        return len(plan) * environments

    return play


CASES = (
    Case(
        "four rooms, 58 segments, one robot with a lidar of 40 beams, collisions, ends, reset",
        "A round robot with differential drive; exact rays, distances alone; no reward; one scene and one "
        "start for all environments; episodes end at a wall or the goal or after 500 steps",
        (1, 16),
        build,
    ),
)

if __name__ == "__main__":
    measure("IR-SIM", "ir-sim", CASES, libraries=["shapely", "numpy"])
