"""A next-best-view planner: an occupancy map, viewpoints by information gain, paths.

It reads the agent's own rays and actions, and whether its moves were blocked. It knows nothing else: not its
pose, its house, its target or its reward. Headings are multiples of 45 degrees to walls that lie along two
axes, so odometry is exact. Axes: E environments, R rays, C channels, S by S cells.
``docs/planner.md`` tells how it works and what it costs.
"""

import numpy as np
import torch
from torch import Tensor

from agent.avoidance import air, clearance
from agent.planner.arrays import PlannerArrays
from agent.planner.body import BodyModel
from agent.planner.config import TUNED, PlannerConfig
from agent.planner.mapping.occupancy import FLAGS, LATEST, NEAR, OCCUPIED, SOLID, TILE, number_type
from agent.planner.mapping.visibility import FINE, fan
from agent.planner.paths import FAR
from agent.planner.state import AT, NONE, SIZE, TARGET
from agent.planner.step import lead_kernel, step_kernel
from agent.planner.viewpoints.belief import COUNT
from agent.planner.viewpoints.choice import views
from agent.planner.viewpoints.reachability import SIDE, UNKNOWN, WORDS
from logic.errors import RequestError
from sim.config import Config
from sim.runtime import Array, Launch, start, ti

__all__ = ["TUNED", "Planner", "PlannerConfig"]

UNSEEN, FREE, TAKEN = range(3)
"""What ``Planner.occupancy`` says of a cell."""

GIVEN = {"prior"}
"""The arrays of ``PlannerArrays`` that others write."""

STATE = (*(name for name in PlannerArrays._fields if name not in GIVEN), "states", "advice")
"""The arrays that the next steps depend on."""


def require_time(world: Config) -> None:
    """Raise ``ValueError`` for episodes too long for a cell to keep when it was seen."""
    if world.steps > LATEST - 2:
        raise ValueError(f"a cell has room for episodes of {LATEST - 2:,} steps, not of {world.steps:,}")


def memory_arrays(
    config: PlannerConfig, count: int, rays: int, errs: bool, prior: bool, slips: bool
) -> dict[str, Array]:
    """What planners of ``count`` environments keep: see ``PlannerArrays``; their states, and the advice."""
    area = count << 2 * config.map_bits
    return {
        "cells": Array(ti.u16, area),
        "distance": Array.of(np.full(area, FAR, np.uint16)),
        "queue": Array(number_type(config), area),
        "dirty": Array(ti.u8, area >> 2 * TILE),
        "reached": Array(ti.i32, count * rays),
        "tiles": Array(ti.u64, WORDS * area >> 2 * TILE),
        "odds": Array.of(np.full(area >> 2, UNKNOWN, np.uint8)),
        "candidates": Array(ti.u8, area >> 2),
        "gains": Array(ti.u16, area // config.viewpoint_pitch**2),
        "evidence": Array(ti.u8, area if errs else 1),
        "last": Array(ti.f32, count * rays if slips else 1),
        "prior": Array(ti.u16, area >> 2 if prior else 1),
        "states": Array(ti.i32, count * SIZE),
        "advice": Array(ti.i64, count),
    }


class Planner:
    """Planners of E environments: one kernel takes them all a step further.

    A planner keeps when it last saw each cell (half a body wide), which cells are occupied, and the target
    that it has seen. Its goal is that target, or else the viewpoint that shows most candidates, places where
    a target may lie that were not seen since the last pick-up, for its cost.
    """

    advice: Tensor
    """(E,) int64, the action that leads to the goal. The same memory after every step."""

    def __init__(
        self,
        world: Config,
        environments: int,
        config: PlannerConfig = TUNED,
        prior: bool = False,
        led: bool = False,
    ) -> None:
        """Make planners for E environments of the configuration ``world``, in each of which an episode
        begins.

        ``prior``: what places count, and which of the unseen ones stop sight, is read from the array of this
        name, which a network or a study that knows the house fills, and not estimated. ``led``: they choose
        no viewpoint; where they have none (``lost``) they are given one by ``lead``.
        Raises ``ValueError`` for episodes too long for a cell to keep when it was seen.
        """
        world.require_lattice("a planner")
        require_time(world)
        count, rays, side = environments, world.rays, max(world.body)
        step = max(1, round(4 * world.step / side))
        self.world, self.config, self.cell = world, config, 2 * world.step / step
        angles = world.ray_angles
        turned = angles + np.pi / 4 * np.arange(8)[:, None]
        directions = np.stack([np.cos(turned), -np.sin(turned)], axis=-1) * world.range / self.cell
        clear = clearance(angles, side, world.step, air(world)) / world.range
        starts, skips, cells = fan(config, angles, world.range / self.cell)
        errs = (world.most("noise") > 0 or world.most("slip") > 0) and not world.in_cells
        program = start()
        given = {
            "observation": Array(ti.f32, count * rays * world.channels),
            "action": Array(ti.i64, count),
            "blocked": Array(ti.u8, count),
            "begun": Array(ti.u8, count),
        }
        tables = {
            "directions": Array.of(directions.astype(np.float32).ravel()),
            "clear": Array.of(clear.astype(np.float32).ravel()),
            "starts": Array.of(starts.ravel()),
            "skips": Array.of(skips.ravel()),
            "fan": Array.of(cells),
            "views": Array.of(views(config)),
        }
        memory = memory_arrays(config, count, rays, errs, prior, world.most("slip") > 0)
        self.arrays = given | tables | memory | {"goals": Array(ti.i32, 3 * count)}
        self.body = body = BodyModel(
            rays=rays,
            columns=world.columns,
            step=step,
            touching=world.in_cells,
            target=world.target / 2 / self.cell,
            ray_range=FINE * world.range / self.cell,
            noise=world.noise / self.cell,
            dropout=world.dropout > 0,
            slip=world.most("slip") > 0,
            eighth=world.rays_in_a_turn,
            errs=errs,
            prior=prior,
            led=led,
        )
        self._launch = Launch(step_kernel(program, config, body), self.arrays)
        self._lead = Launch(lead_kernel(program, config, body), self.arrays) if led else None
        self._open(("observation", "blocked", "action", "begun"))

    def _open(self, given: tuple[str, ...]) -> None:
        """Hold the arrays as tensors: those of these names are given in each step."""
        tensors = {name: array.tensor(array.dtype, array.shape) for name, array in self.arrays.items()}
        self._given = [tensors[name] for name in given]
        self._states = tensors["states"].view(-1, SIZE)
        self.advice = tensors["advice"]

    def step(self, observation: Tensor, blocked: Tensor, action: Tensor, begun: Tensor) -> None:
        """Take what an action led to: ``observation`` (E, R, C), and whether it was ``blocked`` (E,) bool.

        Where ``begun`` (E,) bool, the observation is an episode's first one, and the action is ignored.
        """
        self._take(observation, blocked, action, begun)

    def _take(self, *given: Tensor) -> None:
        """Run the kernel with these in the place of those before."""
        for held, now in zip(self._given, given, strict=True):
            held.copy_(now.reshape(-1))
        self._launch()

    @property
    def lost(self) -> Tensor:
        """Where (E,) bool it has no goal: no viewpoint, and no target that is known."""
        return self.read("kind") == NONE

    def lead(self, environments: np.ndarray, goals: np.ndarray) -> None:
        """Give viewpoints to planners that are ``led``, in these environments (n,) int: ``goals`` (n, 3) int,
        the node, the heading there, and how many nodes the path is about long. The advice follows them.
        """
        if self._lead is None:
            raise ValueError("these planners choose their viewpoints: make them with led")
        given = self.arrays["goals"].view().reshape(-1, 3)
        given[:] = -1
        given[environments] = goals
        self._lead()

    def choose_again(self, environments: np.ndarray) -> None:
        """Choose a viewpoint again in the next step, in these environments (n,) int."""
        self.read("plan_age")[torch.from_numpy(environments)] = self.config.replan_interval

    @property
    def state(self) -> dict[str, Tensor]:
        """All that the next steps depend on: copies, to be given back another time."""
        return {name: torch.from_numpy(self.arrays[name].numpy()) for name in STATE}

    @state.setter
    def state(self, state: dict[str, Tensor]) -> None:
        if set(state) != set(STATE):
            raise RequestError("the planners were kept by another revision of agent.planner: start a new run")
        for name in STATE:
            self.arrays[name].fill(state[name].numpy())

    def read(self, name: str) -> Tensor:
        """A number (E,) int32 of all states, by its name in ``agent.planner.state``."""
        return self._states[:, AT[name]]

    @property
    def seeks(self) -> Tensor:
        """Where (E,) bool no target is known, so that one must be sought."""
        return self.read("kind") != TARGET

    @property
    def seen(self) -> Tensor:
        """How many cells (E,) int32 have been seen."""
        return self.read("seen")

    def pose(self, environment: int) -> tuple[float, float, int]:
        """Where the planner locates the eye: cells east and south of its start, and its heading. The frame's
        axes are the walls'; which of them is east was chosen so that the episode began at heading 0, or at 1
        if that was diagonal. Where no wall was in sight at first, it may begin again at the first wall.
        """
        x, y, heading = (int(self.read(name)[environment]) for name in ("x", "y", "heading"))
        return x / 2, y / 2, heading

    def goal(self, environment: int) -> tuple[float, float] | None:
        """Where it goes, cells east and south of its start: to where it believes the target to be, else to a
        viewpoint; None where it has no goal.
        """
        if self.read("kind")[environment] == NONE:
            return None
        if self.read("kind")[environment] == TARGET:
            x, y = self._states[environment, AT["target"] : AT["target"] + 2].view(torch.float32).tolist()
            return x, y
        side = 1 << self.config.map_bits
        y, x = divmod(int(self.read("goal")[environment]), side)
        return float((x + side // 2) % side - side // 2), float((y + side // 2) % side - side // 2)

    def occupancy(self, environment: int) -> np.ndarray:
        """Cells (S, S) uint8, south by east, unseen, free or taken; the start is the middle's corner."""
        cells = self._map("cells", environment)
        return np.where(cells & OCCUPIED, TAKEN, np.where(cells >> FLAGS, FREE, UNSEEN)).astype(np.uint8)

    def last_seen(self, environment: int) -> np.ndarray:
        """The steps (S, S) at which cells were last seen, 0 for never; placed as ``occupancy``."""
        return (self._map("cells", environment) & (OCCUPIED - 1)) >> FLAGS

    def unseen_floor(self, environment: int) -> np.ndarray:
        """What places never seen count as candidates (S / 2, S / 2) uint8, for two by two cells of
        ``occupancy`` each, from 0 to ``CERTAIN``: how surely they are free floor. 0 where that was not
        computed.
        """
        tiles, half = 1 << self.config.map_bits - TILE, 1 << self.config.map_bits - 2
        blocks = self.arrays["odds"].view().reshape(-1, tiles, tiles, SIDE, SIDE)[environment]
        odds = np.roll(blocks.swapaxes(1, 2).reshape(2 * half, 2 * half), (half, half), axis=(0, 1))
        return np.where(odds == UNKNOWN, 0, odds)

    def foreseen(self, environment: int) -> np.ndarray:
        """With a prior: what places count (S / 2, S / 2) uint8, two by two cells of ``occupancy`` each."""
        half = 1 << self.config.map_bits - 1
        blocks = self.arrays["prior"].view().reshape(-1, half, half)[environment]
        return (np.roll(blocks, (half // 2, half // 2), axis=(0, 1)) & COUNT).astype(np.uint8)

    def paths(self, environment: int) -> np.ndarray:
        """Nodes (S, S) from the goal where they were searched, else 65535; placed as ``occupancy``."""
        return self._map("distance", environment)

    def _map(self, name: str, environment: int) -> np.ndarray:
        """An array of one environment (S, S), rolled so that the start is in the middle."""
        side = 1 << self.config.map_bits
        one = self.arrays[name].view().reshape(-1, side, side)[environment]
        return np.roll(one, (side // 2, side // 2), axis=(0, 1))

    @property
    def walls(self) -> np.ndarray:
        """What the maps show to be occupied, solid and near, but not when it was seen: (E S S,) uint16."""
        return self.arrays["cells"].numpy() & np.uint16(OCCUPIED | SOLID | NEAR)

    def add_walls(self, walls: np.ndarray) -> None:
        """Add what other maps of the same episodes showed (``walls``): for studies of their value."""
        self.arrays["cells"].view()[:] |= walls
        self.arrays["dirty"].view()[:] = 1
