# /// script
# requires-python = ">=3.11,<3.14"
# dependencies = ["navix==0.7.4", "jax==0.10.2", "jaxlib==0.10.2", "numpy==2.4.6"]
# ///
"""NAVIX, MiniGrid in JAX: ``uv run --no-project navix_rooms.py``.

The settings are those of its own benchmarks: ``jax.vmap`` over environments, ``lax.scan`` over steps, all
compiled. Its ``step`` resets ended environments at the step after the end. Only the last timestep is kept.
"""

from functools import partial

import jax
import navix
from rounds import Case, Play, measure

ENV = navix.make("Navix-FourRooms-v0", observation_fn=navix.observations.symbolic_first_person)


@partial(jax.jit, donate_argnums=0)
def roll(now, actions):
    """Return the environments after all steps, with observation, reward and end of the last step."""
    return jax.lax.scan(lambda now, action: (jax.vmap(ENV.step)(now, action), None), now, actions)[0]


def build(environments: int) -> Play:
    """Return the steps, with random actions drawn beforehand."""
    steps = max(32, 1024 // environments)
    key = jax.random.key(0)
    actions = jax.random.randint(key, (steps, environments), 0, len(ENV.action_set))
    now = jax.jit(jax.vmap(ENV.reset))(jax.random.split(key, environments))

    def play() -> int:
        nonlocal now
        now = jax.block_until_ready(roll(now, actions))
        return steps * environments

    return play


CASES = (
    Case(
        "four rooms of 19 by 19 cells, moves, a view of 7 by 7 cells, reward, reset",
        "Moves of a whole cell and turns of 90 degrees; no rays: a view that walls do not block; a new house "
        "at each reset; episodes end at the goal or after 1444 steps",
        (1, 256, 2048),
        build,
    ),
)

if __name__ == "__main__":
    measure("NAVIX", "navix", CASES, libraries=["jax", "jaxlib"])
