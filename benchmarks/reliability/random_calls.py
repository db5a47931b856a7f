"""Random calls of environments: kinds of environments, and arguments, of which some are wrong."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from vitruvius.logic import House, generate
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.config import DEFAULT, PRESETS, Config
from vitruvius.sim.drive import COMMANDS, Drive

COUNT = 3
"""Number of environments in a batch."""

FAR_M = (-0.5, 50.0, 1e5, 1e30, 1e300, np.nan, np.inf)
"""Coordinates outside any house, in metres."""

WEIGHTS = {
    "step": 10.0, "step_torch": 6.0, "reset": 8.0, "set_state": 3.0, "set_houses": 1.0, "looks": 1.0,
    "pickle": 0.3, "deepcopy": 0.3,
}  # fmt: skip
"""Relative frequency of each call."""


class CallKind(NamedTuple):
    """Arguments of environments. Taichi compiles kernels for each kind and mode."""

    preset: Config
    targets: Any = "all"
    backend: str = "continuous"
    steps: int = 12
    """Number of steps of an episode, small so that many episodes end."""
    rotates: bool = False
    """True for houses in rotation, which need the mode NextStep."""


ALL = ("rays", "bump", "last_action", "odometry", "goal", "geodesic")

KINDS = {
    "default": CallKind(DEFAULT),
    "distances": CallKind(Config(geodesic=True), "mixed"),
    "observed": CallKind(Config(observe=ALL, flat=True, rays=4, ray_spacing=45, drift=0.02), "secondary"),
    "terms": CallKind(Config(observe=("rays", "geodesic"), rays=8, ray_spacing=45), {
        "task": "mixed", "terms": {"progress": 0.1, "bump": -1, "targets": 2},
    }),
    "remembering": CallKind(
        Config(
            observe=("rays", "memory"), rays=8, ray_spacing=15, varied=(("slip", 0, 0.5), ("width", 0.5, 1)),
        ),
        {"task": "mixed", "at_once": 2, "starts": "all", "terms": {"class": "visit", "step": -0.25}},
    ),
    "late": CallKind(Config(latency=3, noise=0.02, dropout=0.1, slip=0.2, rays=8, ray_spacing=15)),
    "doors": CallKind(Config(closed_doors=2, sees_kind=True, rays=8, ray_spacing=15), "secondary"),
    "rotation": CallKind(Config(rays=8, ray_spacing=15), rotates=True),
    "paper": CallKind(PRESETS["paper"], "main"),
    "points": CallKind(Config(rays=3, ray_spacing=15), {"points": [[0.0, 0.0]]}),
    "grid": CallKind(Config(geodesic=True, rays=8, ray_spacing=15), backend="grid"),
    "free": CallKind(Config(observe=("rays", "speed", "goal", "odometry"), rays=8), backend="free"),
    "free-sideways": CallKind(
        Config(rays=8, latency=2, angle_noise=3.0, drive=Drive(sideways=0.4, clips=True)), backend="free"
    ),
    "free-commands": CallKind(Config(rays=8, drive=Drive(commands=COMMANDS)), backend="free"),
}  # fmt: skip


def banks_of(kind: str) -> list[list[House]]:
    """Return lists of houses for environments of a kind."""
    cell = 0.3 if KINDS[kind].backend == "grid" else 0.0
    houses = list(generate(rooms=3, count=4, seed=5, cell=cell))
    homes = list(generate(rooms=4, count=2, seed=5, grammar="home")) if not cell else houses[:1]
    return [houses[:2], houses[2:], [houses[0], *homes]] if kind != "paper" else [houses[:2], houses[2:]]


class Draw:
    """Random arguments of calls, in a method for each call; some arguments are wrong."""

    def __init__(self, rng: np.random.Generator, banks: Sequence[list[House]]) -> None:
        self.rng, self.banks = rng, banks
        self.states: list[dict[str, np.ndarray]] = []
        self.poses: list[np.ndarray] = []
        self.points: list[np.ndarray] = []

    def note(self, envs: HouseVectorEnv) -> None:
        """Keep the current states, poses and targets for later calls."""
        if envs._ready:
            self.states.append(envs.state)
            info = envs.info()
            self.poses.extend(info["pose"])
            self.points.extend(info["target"])

    def _is(self, share: float) -> bool:
        return bool(self.rng.random() < share)

    def step(self, envs: HouseVectorEnv) -> dict[str, Any]:
        """Return actions, sometimes wrong ones."""
        envs.action_space.seed(int(self.rng.integers(2**31)))
        actions: Any = envs.action_space.sample()
        if not self._is(0.04):
            return {"actions": actions}
        wrong = [
            actions[:-1], actions[None], actions.astype(str), actions * 1000, actions - 2**40, "abc", None,
            [], [[1], [1, 2]], actions.astype(complex), actions * np.nan, np.full(actions.shape, np.inf), {},
            actions.astype(object), 10**30,
        ]  # fmt: skip
        return {"actions": wrong[self.rng.integers(len(wrong))]}

    step_torch = step

    def reset(self, envs: HouseVectorEnv) -> dict[str, Any]:
        """Return a seed, and options of all kinds."""
        rng, number = self.rng, len(envs.houses)
        seed: Any = None
        if self._is(0.4):
            seed = int(rng.integers(2**63))
        elif self._is(0.3):
            seed = [None if self._is(0.4) else int(rng.integers(99)) for _ in range(COUNT)]
        elif self._is(0.05):
            seed = (-1, 1.5, "a", [1], [1, 2, "b"], 2**64, np.int64(3), True)[rng.integers(8)]
        options: dict[str, Any] = {}
        if self._is(0.6):
            options["house"] = rng.integers(number, size=COUNT)
        if self._is(0.35):
            options["pose"] = self._poses(envs, options.get("house"))
        if self._is(0.4):
            options["target"] = self._targets(envs, options.get("house"))
        if self._is(0.3):
            options["reset_mask"] = rng.random(COUNT) < 0.6
        if options and self._is(0.08):
            name = str(rng.choice(list(options)))
            given = options[name]
            wrong = [
                given[:-1], given.astype(str), "abc", [[1], [1, 2]], given.astype(float) * np.nan, {},
                given[None], given.astype(object), None, given.astype(np.float64) * 1e39,
                given.astype(complex), given.astype(int) - 9,
            ]  # fmt: skip
            options[name] = wrong[rng.integers(len(wrong))]
        elif self._is(0.02):
            options["poses"] = 1
        return {"seed": seed} | ({"options": options} if options or self._is(0.1) else {})

    def _poses(self, envs: HouseVectorEnv, house: Any) -> np.ndarray:
        """Return poses: earlier ones, random ones in the house, and a few far outside."""
        found = self._places(envs, house, self.poses, 3)
        turned = self.rng.random(COUNT) < 0.6
        angles = self.rng.integers(-9, 9, COUNT) * np.pi / 4
        if envs.config.drives and self._is(0.5):
            angles = self.rng.uniform(-9, 9, COUNT)
        found[turned, 2] = angles[turned]
        return found

    def _targets(self, envs: HouseVectorEnv, house: Any) -> np.ndarray:
        """Return targets: some at earlier places, some at the lattice's places in and outside the house."""
        found = self._places(envs, house, self.points, 2)
        for e in np.flatnonzero(self.rng.random(COUNT) < 0.3):
            lattice = envs.world.lattices[0 if house is None else int(house[e])]
            place = self.rng.integers(-60, 200, 2).astype(np.float32)
            found[e] = np.float32(lattice.origin) + place * np.float32(lattice.pitch)
        return found

    def _places(self, envs: HouseVectorEnv, house: Any, known: list[np.ndarray], size: int) -> np.ndarray:
        found = np.zeros((COUNT, size))
        for e in range(COUNT):
            west, north, east, south = envs.geometries[0 if house is None else int(house[e])].bounds
            if known and self._is(0.6):
                found[e] = known[self.rng.integers(len(known))]
            else:
                found[e, :2] = self.rng.uniform((west, north), (east, south))
            if self._is(0.03):
                found[e, self.rng.integers(size)] = self.rng.choice(FAR_M)
        return found

    def set_state(self, envs: HouseVectorEnv) -> dict[str, Any]:
        """Return an earlier state, or a wrong one."""
        if not self.states or self._is(0.05):
            return {"state": ({}, None, {"reals": 1}, "abc")[self.rng.integers(4)]}
        state = dict(self.states[self.rng.integers(len(self.states))])
        if self._is(0.15):
            name = str(self.rng.choice(list(state)))
            array = state[name]
            wrong = [
                array[:-1], array.astype(np.float64), array.astype(str), -1 - array.astype(int),
                np.full(array.shape, 2**30).astype(array.dtype), None,
            ]  # fmt: skip
            state[name] = wrong[self.rng.integers(len(wrong))]
            if self._is(0.3):
                del state[name]
        return {"state": state}

    def set_houses(self, envs: HouseVectorEnv) -> dict[str, Any]:
        """Return a bank, sometimes a wrong one, and sometimes other targets."""
        wrong: list[Any] = [[], None, [1], "nowhere.jsonl", {"rooms": -1}, 3.5, [self.banks[0][0], None]]
        bank = int(self.rng.integers(len(self.banks)))
        found = wrong[self.rng.integers(len(wrong))] if self._is(0.2) else bank
        targets = ("all", "main", "nowhere", {"points": [[-99.0, 0.0]]}, {"task": "reach", "room": "x"}, 7)
        more = {"targets": targets[self.rng.integers(len(targets))]} if self._is(0.3) else {}
        return {"bank": found, "more": more}

    def looks(self, envs: HouseVectorEnv) -> dict[str, Any]:
        """Return a number of targets, sometimes a wrong one."""
        return {"count": (1, 3, 0, -1, 1.5, 2**40)[self.rng.integers(6)]}
