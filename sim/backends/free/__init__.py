"""The free backend: a disc that drives by its speeds, among walls at any angle."""

from sim.backends.free.backend import FreeMotion

__all__ = ["FreeMotion"]
