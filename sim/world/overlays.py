"""Overlays of worlds: the only place that names them."""

from vitruvius.sim.backends.doors import Doors
from vitruvius.sim.backends.overlay import Overlay
from vitruvius.sim.config import Config

OVERLAYS: tuple[type[Overlay], ...] = (Doors,)
"""All overlays, in the order in which they shorten moves and rays."""


def overlays_of(config: Config) -> tuple[type[Overlay], ...]:
    """Return the overlays that a configuration asks for."""
    return tuple(overlay for overlay in OVERLAYS if overlay.asked(config))
