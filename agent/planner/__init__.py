"""A map in the agent's head: what it has seen of its house, where it might look next, and how to get there.

It is made of the agent's own rays and actions, and of whether its moves were blocked. It knows nothing else:
not its pose, its house, its target or its reward. Headings are multiples of 45 degrees to walls that lie
along two axes, so odometry is exact. Axes: E environments, R rays, C channels, F features.
"""

import numpy as np
import torch
from torch import Tensor

from agent.avoidance import air, clearance
from agent.planner.cells import FLAGS, LATEST, OCCUPIED, TILE
from agent.planner.counts import (
    COUNTS,
    FOUND,
    HEADING,
    KIND,
    NEW,
    PROGRESS,
    SEEN,
    TARGET,
    WAY,
    X,
    Y,
)
from agent.planner.fan import FINE, fan
from agent.planner.features import FEATURES
from agent.planner.flood import UNASKED, WORDS
from agent.planner.kernel import Body, step_kernel
from agent.planner.survey import PITCH
from agent.planner.views import looks
from agent.planner.ways import FAR
from logic.errors import RequestError
from sim.config import Config
from sim.runtime import Array, Launch, start, ti

__all__ = ["FEATURES", "Planner"]

BITS = 8
"""The grid is a torus of 2^8 cells a side, 36.7 m: in larger houses far ends would lie on each other."""

UNKNOWN, FREE, TAKEN = range(3)
"""What ``occupancy`` says of a cell."""

STATE = (
    *("cells", "field", "queue", "news", "swept", "tiles", "guesses", "hidden", "shown"),
    *("counts", "target", "advice", "features"),
)
"""What a map goes on from."""


class Planner:
    """Maps of E environments: one kernel takes them all a step further.

    A map remembers when it last saw each cell (half a body wide), which are occupied, and the target that it
    has seen. Its goal is that target, or else a place where one may hide, unseen since the last pick-up: it
    is kept until it is reached or seen. All searches are breadth-first, in whole numbers.
    """

    features: Tensor
    """(E, F) float32, what a network is told: the goal's kind, the way to it and its bearing, what is new;
    and for each of the eight headings, counter-clockwise from the body's own, whether a step is free, how
    much nearer it brings the goal, and whether it is advised. The same memory after every step."""

    advice: Tensor
    """(E,) int64, the action that leads to the goal. The same memory after every step."""

    def __init__(self, config: Config, environments: int) -> None:
        """Make maps for so many worlds of this configuration, all of them to be begun.

        Raises ``ValueError`` for episodes too long for a cell to tell when it was seen.
        """
        if config.steps > LATEST - 2:
            raise ValueError(f"a map has room for episodes of {LATEST - 2:,} steps, not of {config.steps:,}")
        count, rays, side = environments, config.rays, max(config.body)
        step = max(1, round(4 * config.step / side))
        self.config, self.cell = config, 2 * config.step / step
        angles = config.ray_angles
        turned = angles + np.pi / 4 * np.arange(8)[:, None]
        reaches = np.stack([np.cos(turned), -np.sin(turned)], axis=-1) * config.range / self.cell
        area = count << 2 * BITS
        starts, skips, behind = fan(angles, config.range / self.cell)
        program = start()
        self.arrays = {
            "observation": Array(ti.f32, count * rays * config.channels),
            "blocked": Array(ti.u8, count),
            "begun": Array(ti.u8, count),
            "action": Array(ti.i64, count),
            "directions": Array.of(reaches.astype(np.float32).ravel()),
            "clear": Array.of(
                (clearance(angles, side, config.step, air(config)) / config.range).astype(np.float32).ravel()
            ),
            "starts": Array.of(starts.ravel()),
            "skips": Array.of(skips.ravel()),
            "fan": Array.of(behind),
            "cells": Array(ti.u16, area),
            "field": Array(ti.u16, area),
            "queue": Array(ti.u16, area),
            "news": Array(ti.u8, area >> 2 * TILE),
            "swept": Array(ti.i32, count * rays),
            "tiles": Array(ti.u64, WORDS * area >> 2 * TILE),
            "guesses": Array(ti.u8, area >> 2),
            "hidden": Array(ti.u8, area >> 2),
            "shown": Array(ti.u16, area // PITCH**2),
            "looks": Array.of(looks()),
            "counts": Array(ti.i32, count * COUNTS),
            "target": Array(ti.f32, count * 2),
            "advice": Array(ti.i64, count),
            "features": Array(ti.f32, count * FEATURES),
        }
        self.arrays["field"].fill(np.full(area, FAR))
        self.arrays["guesses"].fill(np.full(area >> 2, UNASKED))
        half = config.target / 2 / self.cell
        far = FINE * config.range / self.cell
        body = Body(rays, config.channels, int(config.sees_angle), step, config.in_cells, half, far, BITS)
        self._launch = Launch(step_kernel(program, body), self.arrays)
        tensors = {name: array.tensor(array.dtype, array.shape) for name, array in self.arrays.items()}
        self._inputs = [tensors[name] for name in ("observation", "blocked", "action", "begun")]
        self._counts = tensors["counts"].view(count, COUNTS)
        self.advice, self.features = tensors["advice"], tensors["features"].view(count, FEATURES)

    def step(self, observation: Tensor, blocked: Tensor, action: Tensor, begun: Tensor) -> None:
        """Note what an action led to: ``observation`` (E, R, C), and whether it was ``blocked`` (E,) bool.

        Where ``begun`` (E,) bool, the observation is an episode's first one, and the action is ignored.
        """
        for held, given in zip(self._inputs, (observation, blocked, action, begun), strict=True):
            held.copy_(given.reshape(-1))
        self._launch()

    @property
    def state(self) -> dict[str, Tensor]:
        """All that the next steps depend on: copies, to be given back another time."""
        return {name: torch.from_numpy(self.arrays[name].numpy()) for name in STATE}

    @state.setter
    def state(self, state: dict[str, Tensor]) -> None:
        if set(state) != set(STATE):
            raise RequestError("the maps were kept by another revision of agent.planner: begin the run anew")
        for name in STATE:
            self.arrays[name].fill(state[name].numpy())

    @property
    def new(self) -> Tensor:
        """How many cells (E,) int32 were seen for the first time in the last step."""
        return self._counts[:, NEW]

    @property
    def progress(self) -> Tensor:
        """How many half cells (E,) int32 the last action brought the body nearer to the goal that it had."""
        return self._counts[:, PROGRESS]

    @property
    def seeks(self) -> Tensor:
        """Where (E,) bool no target is known, so that one must be sought."""
        return self._counts[:, KIND] != TARGET

    @property
    def seen(self) -> Tensor:
        """How many cells (E,) int32 have been seen."""
        return self._counts[:, SEEN]

    @property
    def found(self) -> Tensor:
        """How many targets (E,) int32 were picked up, as far as the map can tell."""
        return self._counts[:, FOUND]

    @property
    def way(self) -> Tensor:
        """Half cells (E,) int32 to the goal, 65535 where no way is known."""
        return self._counts[:, WAY]

    def pose(self, environment: int) -> tuple[float, float, int]:
        """Where the map thinks that the eye is: cells east and south of its start, and its heading. The
        frame's axes are the walls'; which of them is east was chosen so that the episode began at heading 0,
        or at 1 if that was diagonal. Where no wall told so at first, it may begin again at the first wall.
        """
        counts = self._counts[environment].tolist()
        return counts[X] / 2, counts[Y] / 2, counts[HEADING]

    def occupancy(self, environment: int) -> np.ndarray:
        """Cells (256, 256) uint8, south by east, unknown, free or taken; the start is the middle's corner."""
        side = 1 << BITS
        cells = self.arrays["cells"].view().reshape(-1, side, side)[environment]
        states = np.where(cells & OCCUPIED, TAKEN, np.where(cells >> FLAGS, FREE, UNKNOWN)).astype(np.uint8)
        return np.roll(states, (side // 2, side // 2), axis=(0, 1))

    def ways(self, environment: int) -> np.ndarray:
        """Nodes (256, 256) from the goal, as far as it was asked, else 65535; placed as ``occupancy``."""
        side = 1 << BITS
        field = self.arrays["field"].view().reshape(-1, side, side)[environment]
        return np.roll(field, (side // 2, side // 2), axis=(0, 1))
