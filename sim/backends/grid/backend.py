"""The grid backend: a body fills a cell, in a house whose edges are multiples of the cell."""

from collections.abc import Sequence
from dataclasses import replace
from math import ceil

from vitruvius.logic import House
from vitruvius.sim.backends.backend import Bank
from vitruvius.sim.backends.grid.cells import cell_side, off_grid
from vitruvius.sim.backends.grid.move import Motion
from vitruvius.sim.backends.grid.pack import pack
from vitruvius.sim.backends.grid.see import Sight
from vitruvius.sim.config import DEFAULT, Config
from vitruvius.sim.geometry import geometry, require_straight
from vitruvius.sim.runtime import ti


@ti.data_oriented
class Grid(Motion, Sight):
    """A body that fills a cell: see ``sim.backends.backend.Backend``."""

    @staticmethod
    def fit(config: Config, houses: Sequence[House]) -> Config:
        """Return a configuration with a body one cell wide and a step of one cell.

        Raises ``ValueError`` for a house that does not fit the grid.
        """
        require_straight(houses, "grid")
        config.require_few_directions()
        cell = cell_side(houses)
        if cell < DEFAULT.body[0] and any(house.occupancy for house in houses):
            times = ceil(DEFAULT.body[0] / cell)
            raise ValueError(
                f"the map's cells of {cell:g} m are narrower than the robot, {DEFAULT.body[0]:.3f} m: give "
                f"the grid backend House.of_map(house.occupancy.coarser({times}))"
            )
        if cell < DEFAULT.body[0]:
            raise ValueError(
                f"no grid with cells as wide as the robot, {DEFAULT.body[0]:.3f} m, fits these houses: "
                "generate all houses for the grid backend with the same --cell"
            )
        for index, house in enumerate(houses):
            stray = off_grid(geometry(house), cell)
            if stray is not None:
                raise ValueError(
                    f"house {index} of {len(houses)}: the edge at {stray:.3f} m does not lie on the grid of "
                    f"{cell:g} m: generate all houses for the grid backend with the same --cell"
                )
        body = {"body": (cell, cell), "eye": None, "step": cell, "in_cells": True}
        return replace(config, collision="swept", **body)

    def pack(self, houses: Sequence[House]) -> Bank:
        """Copy houses to the device: see ``Backend``."""
        return pack(houses, self.config)
