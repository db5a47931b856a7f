"""Adapter of the planner for these tests: the one place that knows the names of its arrays."""

from typing import Any

import numpy as np
import torch

from vitruvius.agent.planner import Planner as Tested
from vitruvius.agent.planner.core.state import AT
from vitruvius.agent.planner.mapping.occupancy import FLAGS, NEAR, OCCUPIED, SOLID
from vitruvius.sim.config import Config

SIDE, UNKNOWN = 256, 65535
"""Cells of a map along each axis; value of a node without a distance, or of a viewpoint without a gain."""

BITS = {"occupied": OCCUPIED, "solid": SOLID, "near": NEAR}
KINDS = ("none", "search", "target")
SHAPES = {
    "cells": (SIDE, SIDE),
    "distance": (SIDE, SIDE),
    "candidates": (128, 128),
    "gains": (64, 64),
    "prior": (128, 128),
}
MEMORY = ("cells", "distance", "candidates", "gains", "advice", "states")


class Memory:
    """Memory of one environment's planner: the arrays, and all numbers by name."""

    def __init__(self, arrays: dict[str, np.ndarray]) -> None:
        self.arrays, numbers = arrays, {name: int(arrays["states"][at]) for name, at in AT.items()}
        self.__dict__.update(numbers)
        self.kind, self.goal = KINDS[numbers["kind"]], (numbers["goal"] % SIDE, numbers["goal"] // SIDE)
        self.target = arrays["states"][AT["target"] : AT["target"] + 2].view(np.float32)
        self.prior = arrays.get("prior")
        self.tried, self.advice = arrays["candidates"] > 127, int(arrays["advice"][0])

    def __getattr__(self, name: str) -> Any:
        """Return an array of cells [y, x]: steps of the last sight, 0 for never; a bit; or distances."""
        value = self.arrays["cells" if name in (*BITS, "seen_at") else name]
        if name in BITS:
            value = value & BITS[name] > 0
        elif name == "seen_at":
            value = (value & (OCCUPIED - 1)).astype(int) >> FLAGS
        elif name == "distance":
            value = np.where(value == UNKNOWN, -1, value.astype(int))
        self.__dict__[name] = value
        return value


class Planner:
    """Planners of E environments, whose memory is read and written as NumPy arrays."""

    def __init__(self, world: Config, environments: int, prior: bool = False) -> None:
        self.tested, self.environments = Tested(world, environments, prior=prior), environments
        self.kept = (*MEMORY, *["prior"] * prior)

    def step(self, *inputs: np.ndarray) -> None:
        """Step with observation, blocked, action and begun of all environments."""
        self.tested.step(*(torch.as_tensor(each) for each in inputs))

    def array(self, name: str) -> np.ndarray:
        """Return an array of all environments, (E, ...), as a view."""
        view = self.tested.arrays[name].view()
        return view.reshape(self.environments, *SHAPES.get(name, (-1,)))

    def memory(self, e: int) -> Memory:
        """Return a copy of the memory of an environment's planner."""
        return Memory({name: self.array(name)[e].copy() for name in self.kept})

    def write(self, e: int, cells: Any = None, **numbers: Any) -> None:
        """Change some numbers of an environment, or all its cells, to those of a memory."""
        if cells is not None:
            flags = cells.occupied * OCCUPIED | cells.solid * SOLID | cells.near * NEAR
            self.array("cells")[e], self.array("dirty")[e] = cells.seen_at << FLAGS | flags, 1
        for name, number in numbers.items():
            state = self.array("states")[e, AT[name] :]
            if name == "target":
                state[:2].view(np.float32)[:] = number
            else:
                state[0] = KINDS.index(number) if name == "kind" else number

    def forget_tiles(self) -> None:
        """Mark every tile as dirty."""
        self.array("dirty")[:] = 1
