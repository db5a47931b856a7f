"""Agents that explore a map from the same starts, and the area that they have seen along their path."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import torch
from scipy.ndimage import label

from benchmarks.exploration.frontier import NearestFrontier
from benchmarks.exploration.seen import OPEN, Seen
from vitruvius.agent.evaluation.episodes import reset
from vitruvius.agent.learning.environments import shield
from vitruvius.agent.planner import TUNED
from vitruvius.agent.policies.policies import Explorer
from vitruvius.logic import House
from vitruvius.logic.house.occupancy import FREE
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.config import DEFAULT, Config

EXPLORER, FRONTIER = "explorer", "nearest frontier"
AGENTS = EXPLORER, FRONTIER

BEAMS = 2500
"""Number of beams over a whole turn that determine the seen area, as in MapEx."""

APART = 0.3
"""Distance in metres between two looks of the laser, as in MapEx; the camera of other bodies looks at each
step."""

NOTHING = 1e-3
"""Side in metres of a target that no agent finds, because there is nothing but the map to be found."""

SENSORS: dict[str, dict[str, Any]] = {
    "own": {},
    "laser": {"rays": 360, "first_ray": 180.0, "ray_spacing": 1, "range": 20.0},
}
"""Sensors by name: the released agents' 40 rays over 120 degrees, of 7.9 m; MapEx's, all around, of 20 m."""


@dataclass(frozen=True)
class Walk:
    """Walk of one body, after each of n looks: distance, number of steps, and fraction of the area seen.

    The area is the free cells that are connected to the start.
    """

    metres: np.ndarray
    steps: np.ndarray
    share: np.ndarray
    way: np.ndarray
    """(n, 2) x and y, metres."""

    def mean_share(self, most: float, by: str = "metres") -> float:
        """Return the mean fraction seen from 0 to ``most`` ``metres`` or ``steps``.

        It is the area under the curve, which stays constant after the walk's end; 1 means everything from the
        beginning.
        """
        at = np.linspace(0, most, 1001)
        return float(self.at(at, by).mean())

    def at(self, where: np.ndarray, by: str = "metres") -> np.ndarray:
        """Return the fraction seen at some distances or numbers of steps."""
        place = np.searchsorted(getattr(self, by), where, side="right") - 1
        return self.share[np.maximum(place, 0)]


def configuration(sensor: str, steps: int) -> Config:
    """Return the simulator's configuration, with nothing to find."""
    return replace(DEFAULT, **SENSORS[sensor], steps=steps, target=NOTHING)


def walks(
    house: House, sensor: str, agent: str, starts: int, seed: int, metres: float, steps: int
) -> list[Walk]:
    """Return one walk from each of the starts, until it has the given distance or number of steps."""
    assert house.occupancy
    config = configuration(sensor, steps + 1)
    envs = HouseVectorEnv([house], num_envs=starts, targets="all", preset=config)
    whole = sensor == "laser"
    field = 2 * np.pi if whole else np.deg2rad(config.rays * config.ray_spacing)
    beams = round(BEAMS * field / 2 / np.pi)
    lattice = envs.world.lattices[0]
    seen = Seen(house.occupancy, lattice, config.body[0], starts, beams, field, config.range)
    observation = reset(envs, seed, np.zeros(starts, int))
    pose = envs.world.describe()[0].astype(float).copy()
    floor = _floor(house, seen, pose)
    policy = _Agent(envs, agent, seen)
    blocked, looked = np.zeros(starts, bool), np.full((starts, 2), np.inf)
    gone, notes = np.zeros(starts), [[] for _ in range(starts)]
    for step in range(steps + 1):
        going = (gone < metres) & ~policy.done
        moved = np.hypot(*(pose[:, :2] - looked).T)
        looks = going & ((moved >= APART - 1e-3) | (policy.arrived & (moved > 0)) | (not whole))
        if looks.any():
            seen.look(pose, looks)
            looked[looks], policy.arrived[looks] = pose[looks, :2], False
            for e in np.flatnonzero(looks):
                if whole or step % 10 == 0:  # counting takes longer than looking
                    share = np.count_nonzero((seen.known[e] == OPEN) & floor[e]) / np.count_nonzero(floor[e])
                    notes[e].append((gone[e], step, share, *pose[e, :2]))
        if step == steps or not going.any():
            break
        actions = policy.act(observation, pose, blocked)
        observation, _, _, _, info = envs.step_torch(torch.from_numpy(actions))
        now = envs.world.describe()[0].astype(float)
        gone += np.hypot(*(now[:, :2] - pose[:, :2]).T)
        pose, blocked = now.copy(), info["blocked"].numpy().copy()
    envs.close()
    return [Walk(*np.array(each).T[:3], np.array(each)[:, 3:]) for each in notes]


def _floor(house: House, seen: Seen, pose: np.ndarray) -> np.ndarray:
    """Return masks (E, H, W) bool of the free cells that are connected to each body's start."""
    assert house.occupancy
    parts, _ = label(house.occupancy.values == FREE)
    columns, rows = seen.cells(pose[:, :2]).astype(int).T
    return parts == parts[rows, columns][:, None, None]


class _Agent:
    """One of ``AGENTS`` in environments."""

    def __init__(self, envs: HouseVectorEnv, agent: str, seen: Seen) -> None:
        self.policy: Explorer | NearestFrontier
        self.nothing = np.zeros(envs.num_envs, bool)
        if agent == FRONTIER:
            self.policy = NearestFrontier(seen, envs.config.rays * envs.config.ray_spacing < 360)
            return
        longest = max(seen.shape) * seen.grid.cell
        cell = envs.config.body[0] / 2
        bits = next((bits for bits in (8, 9, 10) if longest < cell * (1 << bits)), 10)
        world = replace(envs.config, target=DEFAULT.target)
        self.policy = Explorer(shield(envs), world, replace(TUNED, map_bits=bits))
        self.policy.begin(envs.num_envs)

    @property
    def done(self) -> np.ndarray:
        """(E,) bool: True for agents that have stopped, because they know of nothing left to see."""
        return self.policy.done if isinstance(self.policy, NearestFrontier) else self.nothing

    @property
    def arrived(self) -> np.ndarray:
        """(E,) bool: True for agents that look from their place."""
        return self.policy.arrived if isinstance(self.policy, NearestFrontier) else self.nothing

    def act(self, observation: torch.Tensor, pose: np.ndarray, blocked: np.ndarray) -> np.ndarray:
        """Return actions (E,)."""
        if isinstance(self.policy, NearestFrontier):
            return self.policy.act(pose)
        observation[..., -1] = 0  # a ray that meets the target carries no information
        return self.policy(observation, torch.from_numpy(blocked)).numpy()
