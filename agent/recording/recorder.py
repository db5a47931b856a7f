"""Recorder of an episode's trace: a watcher of ``agent.recording.film``."""

from collections import defaultdict

import msgspec
import numpy as np

from vitruvius.agent.planner import FREE, TAKEN, Planner
from vitruvius.agent.planner.belief_map import BeliefMap
from vitruvius.agent.planner.core.frame import metres, quarters
from vitruvius.agent.policies.episodes import Moment
from vitruvius.agent.policies.policies import Explorer, QPolicy
from vitruvius.agent.recording.trace import FORMAT, MARGIN_M, Map, Packed, Sensor, Trace, packed
from vitruvius.logic import House
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.actions import ACTION_NAMES
from vitruvius.sim.film import Scene
from vitruvius.sim.geometry import geometry

PICTURE_STEPS = 5
"""Steps between two pictures of the map: 20 a second of the paper's 15 s."""


class Recorder:
    """Recorder of the visible state at each step."""

    def __init__(self, name: str, mode: str, seed: int) -> None:
        """Record the episode of the agent ``name``, with targets in the mode ``mode``."""
        self.name, self.mode, self.seed = name, mode, seed

    def begin(self, envs: HouseVectorEnv, policy: QPolicy | Explorer) -> None:
        """Prepare for an episode: see ``Watcher``."""
        self.envs, self.policy, self.house = envs, policy, envs.houses[0]
        self.columns, self.places = defaultdict[str, list](list), list[np.ndarray]()
        self.targets = list[tuple[float, float]]()
        mapped = isinstance(policy, Explorer)
        self.map = _MapNotes(self.house, policy.tracker.planner) if mapped else None

    def note(self, moment: Moment) -> None:
        """Record the moment: see ``Watcher``."""
        if moment.step:
            self.columns["blocked"].append(bool(moment.blocked[0]))
        scene = self._state()
        if moment.actions is not None:
            self._choice(int(moment.actions[0]))
            if self.map:
                self.map.note(moment.step, scene)

    def _choice(self, action: int) -> None:
        """Record what the policy has chosen, and why."""
        columns, choice = self.columns, self.policy.choice
        columns["action"].append(action)
        columns["allowed"].append(sum(1 << a for a, free in enumerate(choice.allowed[0].tolist()) if free))
        columns["wanted"].append(int(choice.preference[0].argmax()))
        columns["values"].append(choice.values[0].tolist())
        if self.map:
            columns["advice"].append(int(self.map.planner.advice[0]))

    def _state(self) -> Scene:
        """Record the state of the environment; return its scene."""
        scene, columns = self.envs.scene(0), self.columns
        heading = round(float(scene.pose[2]) / (np.pi / 4)) % 8
        eye = np.array(scene.config.eye)
        self.places.append(scene.pose[:2] - (eye[heading % 2] - eye[0]))
        columns["heading"].append(heading)
        columns["distance"].append(np.rint(scene.distance / scene.config.range * 65535))
        columns["hits"].append(np.packbits(scene.is_target))
        if len(self.targets) == scene.found:
            self.targets.append((round(float(scene.target[0]), 4), round(float(scene.target[1]), 4)))
        columns["found"].append(min(scene.found, len(self.targets) - 1))
        return scene

    @property
    def trace(self) -> Trace:
        """Trace of the episode, after its end."""
        config = self.envs.config
        columns = {name: np.array(rows) for name, rows in self.columns.items()}
        steps = np.rint((np.array(self.places) - self.places[0]) / config.step)
        columns |= {"east": steps[:, 0], "south": steps[:, 1]}
        unit = max(float(np.abs(columns["values"]).max()), 1e-6) / 32767
        columns["values"] = np.rint(columns["values"] / unit)
        if self.map:
            columns |= self.map.columns
        sensor = {name: getattr(config, name) for name in Sensor.__struct_fields__}
        return Trace(
            format=FORMAT,
            agent=self.name,
            house=self.house.to_dict(),
            mode=self.mode,
            seed=self.seed,
            actions=ACTION_NAMES,
            sensor=msgspec.convert(sensor, Sensor),
            origin=(float(self.places[0][0]), float(self.places[0][1])),
            targets=tuple(self.targets),
            length=len(columns["action"]),
            longest=config.steps,
            columns=packed(columns),
            value_unit=unit,
            map=self.map.packed() if self.map else None,
        )


class _MapNotes:
    """Notes of a planner's knowledge and beliefs, in the house's orientation, which it does not know."""

    def __init__(self, house: House, planner: Planner) -> None:
        self.planner, self.belief_map = planner, BeliefMap(planner)
        west, north, east, south = geometry(house).bounds
        self.corner = np.array([west, north]) - MARGIN_M
        size = (np.array([south - north, east - west]) + 2 * MARGIN_M) / planner.cell
        self.shape = tuple(np.ceil(size).astype(int) + 1)
        self.ground, self.belief = list[np.ndarray](), list[np.ndarray]()
        self.goals, self.kinds = list[np.ndarray](), list[int]()

    def note(self, step: int, scene: Scene) -> None:
        """Record the planner's goal, and its map at every few steps."""
        planner = self.planner
        if planner.read("time")[0] == 1:
            self._begin(scene.pose)
        kind, goal = int(planner.read("kind")[0]), planner.goal(0)
        self.kinds.append(kind)
        place = metres(self.pose, np.array(goal or (0, 0)), planner.cell)
        self.goals.append(np.rint(100 * place) if goal else np.zeros(2))
        if step % PICTURE_STEPS == 0:
            self.ground.append(self._laid(_ground(planner)))
            known = bool(planner.read("known")[0])  # true: the target is there, and nowhere else
            belief = self.belief_map.read() * np.uint8(not known)
            self.belief.append(self._laid(belief.repeat(2, axis=0).repeat(2, axis=1)))

    def _begin(self, pose: np.ndarray) -> None:
        """Begin the map at the pose (3,) of the eye.

        This happens again if only the first wall shows the body's orientation. Pictures from before are then
        cleared, as they lie askew.
        """
        self.pose = pose
        self.first = np.floor((self.corner - pose[:2]) / self.planner.cell).astype(int)
        self.ground = [np.zeros_like(each) for each in self.ground]
        self.belief = [np.zeros_like(each) for each in self.belief]

    def _laid(self, cells: np.ndarray) -> np.ndarray:
        """Return a map (S, S), with the start in its middle, in the house's orientation and cut to it."""
        turned = np.rot90(cells, quarters(self.pose[2]))
        rows, columns = (
            np.arange(first, first + size) + len(cells) // 2
            for first, size in zip(self.first[::-1], self.shape, strict=True)
        )
        return turned.take(rows, axis=0, mode="wrap").take(columns, axis=1, mode="wrap")

    @property
    def columns(self) -> dict[str, np.ndarray]:
        """Goal at each step."""
        return {"goal": np.array(self.goals), "goal_kind": np.array(self.kinds)}

    def packed(self) -> Map:
        """Return all pictures."""
        west, north = self.pose[:2] + self.first * self.planner.cell
        ground, belief = (Packed.of(np.stack(each)) for each in (self.ground, self.belief))
        return Map(PICTURE_STEPS, float(west), float(north), self.planner.cell, ground, belief)


def _ground(planner: Planner) -> np.ndarray:
    """Return the ground of the first environment's map, (256, 256) uint8: indices in ``GROUND``."""
    states, since = planner.occupancy(0), int(planner.read("since")[0])
    ground = np.where(states == FREE, 1 + (planner.last_seen(0) >= since), 0)
    return np.where(states == TAKEN, 3, ground).astype(np.uint8)
