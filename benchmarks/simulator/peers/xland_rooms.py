# /// script
# requires-python = ">=3.11,<3.14"
# dependencies = ["xminigrid==0.9.3", "jax==0.10.2", "jaxlib==0.10.2", "numpy==2.4.6"]
# ///
"""XLand-MiniGrid, meta-learning gridworlds in JAX: ``uv run --no-project xland_rooms.py``.

The settings are those of its own ``scripts/benchmark_xland.py``: its wrapper that resets at the step of the
end, ``jax.vmap`` over environments, ``lax.scan`` over steps, all compiled, partitionable random numbers, up
to 8192 environments. Only the last timestep is kept, as there.
"""

from functools import partial

import jax
import xminigrid
from rounds import Case, Play, measure
from xminigrid.wrappers import GymAutoResetWrapper

jax.config.update("jax_threefry_partitionable", True)


def build(name: str):
    """Return the steps of one of its environments, with random actions drawn beforehand."""
    inner, params = xminigrid.make(name)
    env = GymAutoResetWrapper(inner)

    @partial(jax.jit, donate_argnums=0)
    def roll(now, actions):
        def step(now, action):
            return jax.vmap(env.step, in_axes=(None, 0, 0))(params, now, action), None

        return jax.lax.scan(step, now, actions)[0]

    def make(environments: int) -> Play:
        steps = max(32, 1024 // environments)
        key = jax.random.key(0)
        actions = jax.random.randint(key, (steps, environments), 0, env.num_actions(params))
        keys = jax.random.split(key, environments)
        now = jax.jit(jax.vmap(env.reset, in_axes=(None, 0)))(params, keys)

        def play() -> int:
            nonlocal now
            now = jax.block_until_ready(roll(now, actions))
            return steps * environments

        return play

    return make


NOTE = (
    "Moves of a whole cell and turns of 90 degrees; no rays: a view that walls do not block; a new house at "
    "each reset; episodes end at the goal or after"
)
SIZES = (1, 256, 1024, 8192)
CASES = (
    Case(
        "four rooms of 19 by 19 cells, moves, a view of 7 by 7 cells, reward, reset",
        f"{NOTE} 100 steps",
        SIZES,
        build("MiniGrid-FourRooms"),
    ),
    Case(
        "one room of 16 by 16 cells, its own benchmark's scene, moves, a view of 7 by 7 cells, reward, reset",
        "Moves of a whole cell and turns of 90 degrees; no rays, nothing to see but walls and the goal; one "
        "start; episodes end at the goal or after 1024 steps",
        SIZES,
        build("MiniGrid-Empty-16x16"),
    ),
)

if __name__ == "__main__":
    measure("XLand-MiniGrid", "xminigrid", CASES, libraries=["jax", "jaxlib"])
