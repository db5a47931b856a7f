"""The grid backend, for houses whose edges lie on a grid of cells: motion and sight are table look-ups."""

from vitruvius.sim.backends.grid.backend import Grid

__all__ = ["Grid"]
