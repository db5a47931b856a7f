"""The continuous backend: exact geometry of axis-aligned boxes, in metres."""

from vitruvius.sim.backends.continuous.backend import Continuous

__all__ = ["Continuous"]
