"""Values that the simulator draws for each episode: noise, slips, drift, and limits of the body."""

from vitruvius.sim.config import VARIABLE, Config
from vitruvius.sim.runtime import ti
from vitruvius.sim.world.philox import VARIED, philox, uniform


@ti.data_oriented
class Varying:
    """Sampler of an episode's values, which are functions of the episode's seed and number."""

    def __init__(self, config: Config) -> None:
        """Take the fixed values and the ranges of a configuration."""
        self.usual = {name: float(getattr(config, name, 1.0)) for name in VARIABLE}
        self.ranges = {name: (low, high) for name, low, high in config.varied}

    @ti.func
    def value(self, state, name: ti.template()):
        """Return the value of the field ``name`` in the episode of ``state`` (f32)."""
        found = ti.f32(ti.static(self.usual[name]))
        if ti.static(name in self.ranges):
            counter = ti.Vector([state.episode, ti.static(VARIABLE.index(name)), 0, VARIED])
            share = uniform(philox(state.seed, ti.cast(counter, ti.u64))[0])
            low, high = ti.static(self.ranges[name])
            found = low + (high - low) * share
        return found
