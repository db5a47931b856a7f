"""The grid backend: houses whose edges lie on a grid of cells, looked up and not computed."""

from sim.backends.grid.backend import Grid

__all__ = ["Grid"]
