"""What differs from episode to episode: noise, slips, drift, and how a body drives."""

from sim.config import VARIABLE, Config
from sim.runtime import ti
from sim.world.philox import VARIED, philox, uniform


@ti.data_oriented
class Varying:
    """Tells the values of an episode, functions of its seed and number."""

    def __init__(self, config: Config) -> None:
        """Of a configuration."""
        self.usual = {name: float(getattr(config, name, 1.0)) for name in VARIABLE}
        self.ranges = {name: (low, high) for name, low, high in config.varied}

    @ti.func
    def value(self, state, name: ti.template()):
        """A value in the episode of a state (f32)."""
        found = ti.f32(ti.static(self.usual[name]))
        if ti.static(name in self.ranges):
            counter = ti.Vector([state.episode, ti.static(VARIABLE.index(name)), 0, VARIED])
            share = uniform(philox(state.seed, ti.cast(counter, ti.u64))[0])
            low, high = ti.static(self.ranges[name])
            found = low + (high - low) * share
        return found
