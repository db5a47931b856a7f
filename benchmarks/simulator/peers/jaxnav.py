# /// script
# requires-python = ">=3.11,<3.14"
# dependencies = ["jaxmarl==0.2.0", "jax==0.10.2", "jaxlib==0.10.2", "numpy==2.4.6"]
# ///
"""JaxNav, robot navigation in JAX, of JaxMARL: ``uv run --no-project jaxnav.py``.

The settings are those of JaxMARL's own training: ``jax.vmap`` over environments, ``lax.scan`` over steps, all
compiled. Only the results of the last step are kept, as for the other peers. The ``step`` of JaxNav resets
ended environments, and makes a new map for every environment at every step to do so. ``reset_state`` avoids
this with start states made beforehand.
"""

from functools import partial

import house
import jax
from jaxmarl.environments.jaxnav.jaxnav_env import JaxNav
from rounds import Case, Play, measure

ENV = JaxNav(num_agents=1, lidar_num_beams=house.RAYS, lidar_angle_factor=house.FIELD / 360)


def build(reset: str):
    """Return the steps with resets to ``new`` maps, to ``kept`` start states, or with ``none``."""

    def step(key, states, starts, action):
        keys = jax.random.split(key, len(action) + 1)
        given = keys[1:], states, {"agent_0": action}
        if reset == "new":
            seen, states, *rest = jax.vmap(ENV.step)(*given)
        elif reset == "kept":
            seen, states, *rest = jax.vmap(ENV.step)(*given, starts)
        else:
            seen, states, *rest = jax.vmap(ENV.step_env)(*given)
        return keys[0], states, (seen, *rest)

    @partial(jax.jit, donate_argnums=0)
    def roll(now, starts, actions):
        return jax.lax.scan(lambda now, action: (step(now[0], now[1], starts, action), None), now, actions)[0]

    def make(environments: int) -> Play:
        steps = max(8, 512 // environments)
        keys = jax.random.split(jax.random.key(0), environments + 2)
        starts = jax.jit(jax.vmap(ENV.reset))(keys[2:])[1]
        actions = jax.random.uniform(keys[0], (steps, environments, 2), minval=-1.0, maxval=1.0)
        now = jax.jit(step)(keys[1], starts, starts, actions[0])

        def play() -> int:
            nonlocal now
            now = jax.block_until_ready(roll(now, starts, actions))
            return steps * environments

        return play

    return make


NOTE = (
    "A robot with limits on speed and acceleration among cells of 1 m; rays sampled every 5 cm up to 6 m, "
    "distances alone; episodes end at a wall or a goal or after 500 steps"
)
WHAT = "11 by 11 cells, one robot with a lidar of 40 beams, collisions, reward"
SIZES = (1, 256, 2048)
CASES = (
    Case(f"{WHAT}, reset to a new map", f"{NOTE}; as shipped", SIZES, build("new")),
    Case(f"{WHAT}, reset to a kept start", f"{NOTE}; nearest to a bank of houses", SIZES, build("kept")),
    Case(f"{WHAT}, no reset", f"{NOTE}; ended robots stand still", SIZES, build("none")),
)

if __name__ == "__main__":
    measure("JaxNav", "jaxmarl", CASES, libraries=["jax", "jaxlib"])
