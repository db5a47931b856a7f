"""The free backend: a disc with continuous motion, among walls at any angle."""

from vitruvius.sim.backends.free.backend import FreeMotion

__all__ = ["FreeMotion"]
