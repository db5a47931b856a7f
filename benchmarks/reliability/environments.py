"""``vitruvius bench calls``: environments under random sequences of calls, each compared with others.

A call is answered, or it is refused by an error of Gymnasium's or a ``ValueError`` and nothing is changed.
The calls that were answered are made again in other environments, of all at once and of one alone: the
same observations, rewards and infos come out, bit for bit.
"""

import copy
import pickle
import time
import traceback
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import count
from typing import Any, NamedTuple

import numpy as np
from gymnasium.error import Error

from logic import House, generate
from logic.errors import HouseFileError
from sim import HouseRotation, HouseVectorEnv
from sim.config import DEFAULT, PRESETS, Config
from sim.drive import COMMANDS, Drive
from sim.world.episodes import SEED

COUNT = 3
"""Environments that are stepped at once."""

REFUSALS = (ValueError, TypeError, Error, HouseFileError)
"""Errors that refuse a call."""

CALLS = 40
"""Of a sequence."""

MODES = "NextStep", "SameStep", "Disabled"

FAR_M = (-0.5, 50.0, 1e5, 1e30, 1e300, np.nan, np.inf)
"""Places that no house has, metres."""


class CallKind(NamedTuple):
    """Arguments of environments; kernels are compiled for each, and for each mode."""

    preset: Config
    targets: Any = "all"
    backend: str = "continuous"
    steps: int = 12
    """Of an episode: many end."""
    rotates: bool = False
    """True for houses in rotation, which the mode NextStep alone has."""


ALL = ("rays", "bump", "last_action", "odometry", "goal", "geodesic")

KINDS = {
    "default": CallKind(DEFAULT),
    "distances": CallKind(Config(geodesic=True), "mixed"),
    "observed": CallKind(Config(observe=ALL, flat=True, rays=4, ray_spacing=45, drift=0.02), "secondary"),
    "terms": CallKind(Config(observe=("rays", "geodesic"), rays=8, ray_spacing=45), {
        "task": "mixed", "terms": {"progress": 0.1, "bump": -1, "targets": 2},
    }),
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


@dataclass
class Call:
    """A call that was answered, to be made again."""

    name: str
    arguments: dict[str, Any]
    answer: Any


class Player:
    """Environments of a kind and a mode, and the calls that are made of them."""

    def __init__(self, kind: str, mode: str, banks: Sequence[list[House]], by_ray: bool = False) -> None:
        """``banks``: lists of houses that environments take in turn. ``by_ray``: calls are made again in the
        loop of a GPU, by environment and ray.
        """
        self.kind, self.mode, self.banks = KINDS[kind], mode, banks
        self.calls = Counter[str]()
        self.envs, self.again, self.alone = self._made(COUNT), self._made(COUNT, by_ray), self._made(1)

    def _made(self, number: int, by_ray: bool = False) -> HouseVectorEnv:
        return HouseVectorEnv(
            self._houses(0),
            number,
            preset=self.kind.preset,
            targets=self.kind.targets,
            backend=self.kind.backend,
            autoreset_mode=self.mode,
            max_episode_steps=self.kind.steps,
            by_ray=by_ray,
        )

    def _houses(self, bank: int) -> list[House] | HouseRotation:
        houses = self.banks[bank]
        return HouseRotation(houses, 1, 9) if self.kind.rotates else houses

    def play(self, seed: int, calls: int = CALLS) -> None:
        """Make a sequence of calls, and make it again. Raises ``AssertionError`` for what differs."""
        rng = np.random.default_rng(seed)
        draw = Draw(rng, self.banks)
        made = [self._call("set_houses", {"bank": 0}), self._call("reset", {"seed": seed})]
        for _ in range(calls):
            name = str(rng.choice(list(WEIGHTS), p=np.array(list(WEIGHTS.values())) / sum(WEIGHTS.values())))
            if name in COPIES:
                self._copy(name, go_on=rng.random() < 0.5)
            else:
                made.append(self._call(name, getattr(draw, name)(self.envs)))
            draw.note(self.envs)
        e = int(rng.integers(COUNT))
        for call in filter(None, made):
            require_same(
                call.answer, self._answer(self.again, call.name, call.arguments), f"{call.name} again"
            )
            if (arguments := _of_one(call.name, call.arguments, e)) is not None:
                alone = self._answer(self.alone, call.name, arguments)
                require_same(_answer_of_one(call, e, alone), alone, f"{call.name} of one alone")

    def _call(self, name: str, arguments: dict[str, Any]) -> Call | None:
        """Make a call. Raises ``AssertionError`` where a refused one changes something."""
        envs = self.envs
        before, was_ready = snapshot(envs), envs._ready
        self.calls[name] += 1
        try:
            answer = self._answer(envs, name, arguments)
        except REFUSALS as error:
            text = str(error)
            from_inside = any(words in text for words in ("broadcast", "cannot convert"))
            assert not from_inside, f"{name}: {text}"
            self.calls["refused"] += 1
            require_same(before, snapshot(envs), f"a refused {name} ({error})")
            return None
        if name in ("reset", "step", "step_torch"):
            require_in(envs, answer[0], name)
        if name == "reset" and not was_ready:  # those of one alone would draw others
            seeds = np.ascontiguousarray(envs.state["wholes"][:, SEED:]).view("<u8").ravel()
            arguments = arguments | {"seed": [int(each) for each in seeds]}
        return Call(name, arguments, copy.deepcopy(answer))

    def _copy(self, name: str, go_on: bool) -> None:
        """Compare a copy with what it was made of, and go on in it."""
        self.calls[name] += 1
        made: HouseVectorEnv = (
            copy.deepcopy(self.envs) if name == "deepcopy" else pickle.loads(pickle.dumps(self.envs))
        )
        require_same(snapshot(self.envs), snapshot(made), name)
        if go_on:
            self.envs = made

    def _answer(self, envs: HouseVectorEnv, name: str, arguments: dict[str, Any]) -> Any:
        if name == "set_houses":
            bank = arguments["bank"]
            return envs.set_houses(
                self._houses(bank) if isinstance(bank, int) else bank, **arguments.get("more", {})
            )
        if name == "set_state":
            envs.state = arguments["state"]
            return None
        if name == "step_torch":
            import torch

            given = arguments["actions"]
            answer = envs.step_torch(torch.from_numpy(given) if isinstance(given, np.ndarray) else given)
            *rest, terminated, truncated, info = _plain(answer)
            if "final_obs" in info:
                info["_final_obs"] = terminated | truncated
            return _valid((*rest, terminated, truncated, info))
        if name == "looks":
            return envs.info() | {"targets": envs.targets(arguments["count"]), "doors": envs.world.open_doors}
        return _valid(getattr(envs, name)(**arguments))


class Draw:
    """Arguments of calls, by the calls' names: right ones, and some that are wrong."""

    def __init__(self, rng: np.random.Generator, banks: Sequence[list[House]]) -> None:
        self.rng, self.banks = rng, banks
        self.states: list[dict[str, np.ndarray]] = []
        self.poses: list[np.ndarray] = []
        self.points: list[np.ndarray] = []

    def note(self, envs: HouseVectorEnv) -> None:
        """Keep states, poses and targets that there were."""
        if envs._ready:
            self.states.append(envs.state)
            info = envs.info()
            self.poses.extend(info["pose"])
            self.points.extend(info["target"])

    def _is(self, share: float) -> bool:
        return bool(self.rng.random() < share)

    def step(self, envs: HouseVectorEnv) -> dict[str, Any]:
        """Actions, sometimes wrong ones."""
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
        """A seed, and options of all kinds."""
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
        """Poses: where bodies were, anywhere in a house, or somewhere else."""
        found = self._places(envs, house, self.poses, 3)
        turned = self.rng.random(COUNT) < 0.6
        angles = self.rng.integers(-9, 9, COUNT) * np.pi / 4
        if envs.config.drives and self._is(0.5):
            angles = self.rng.uniform(-9, 9, COUNT)
        found[turned, 2] = angles[turned]
        return found

    def _targets(self, envs: HouseVectorEnv, house: Any) -> np.ndarray:
        """Targets: where some were, on places of a lattice within and without, or somewhere else."""
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
        """A state that was, or a wrong one."""
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
        """A bank, and sometimes a wrong one, or other targets."""
        wrong: list[Any] = [[], None, [1], "nowhere.jsonl", {"rooms": -1}, 3.5, [self.banks[0][0], None]]
        bank = int(self.rng.integers(len(self.banks)))
        found = wrong[self.rng.integers(len(wrong))] if self._is(0.2) else bank
        targets = ("all", "main", "nowhere", {"points": [[-99.0, 0.0]]}, {"task": "reach", "room": "x"}, 7)
        more = {"targets": targets[self.rng.integers(len(targets))]} if self._is(0.3) else {}
        return {"bank": found, "more": more}

    def looks(self, envs: HouseVectorEnv) -> dict[str, Any]:
        """How many targets are asked for."""
        return {"count": (1, 3, 0, -1, 1.5, 2**40)[self.rng.integers(6)]}


COPIES = "pickle", "deepcopy"

WEIGHTS = {
    "step": 10.0, "step_torch": 6.0, "reset": 8.0, "set_state": 3.0, "set_houses": 1.0, "looks": 1.0,
    "pickle": 0.3, "deepcopy": 0.3,
}  # fmt: skip
"""How often each call is drawn."""


def snapshot(envs: HouseVectorEnv) -> dict[str, Any]:
    """Return all that can be known of environments now."""
    kept: dict[str, Any] = {"ready": envs._ready, "houses": envs.houses, "task": envs.world.task}
    kept["random"] = copy.deepcopy(envs.np_random.bit_generator.state)
    return kept | (
        envs.state | {f"info {key}": value for key, value in envs.info().items()} if envs._ready else {}
    )


def require_same(one: Any, other: Any, where: str) -> None:
    """Raise ``AssertionError`` for values that are not the same, bit for bit."""
    if isinstance(one, Mapping):
        assert one.keys() == other.keys(), f"{where}: {one} {other}"
        for key in one:
            require_same(one[key], other[key], f"{where}: {key}")
    elif isinstance(one, tuple):
        assert len(one) == len(other), where
        for number, pair in enumerate(zip(one, other, strict=True)):
            require_same(*pair, f"{where} [{number}]")
    elif isinstance(one, np.ndarray):
        is_same = one.shape == other.shape and one.dtype == other.dtype and one.tobytes() == other.tobytes()
        assert is_same, f"{where}: {one} {other}"
    else:
        assert one == other, f"{where}: {one} {other}"


def require_in(envs: HouseVectorEnv, observation: Any, name: str) -> None:
    """Raise ``AssertionError`` for an observation that is not of its space."""
    assert envs.observation_space.contains(observation), f"{name}: {observation} is not of its space"


def _of_one(name: str, arguments: dict[str, Any], e: int) -> dict[str, Any] | None:
    """Return the arguments of a call for environment ``e`` alone; None where the call leaves it as it is."""
    match name:
        case "step" | "step_torch":
            return {"actions": np.asarray(arguments["actions"])[e : e + 1]}
        case "set_state":
            return {"state": {key: _state_of_one(key, value, e) for key, value in arguments["state"].items()}}
        case "reset":
            options = {
                key: None if value is None else np.asarray(value)[e : e + 1]
                for key, value in (arguments.get("options") or {}).items()
            }
            mask = options.get("reset_mask")
            if mask is not None and not mask.all():
                return None
            seed = arguments.get("seed")
            if isinstance(seed, list):
                seed = [seed[e]]
            elif seed is not None:
                seed = (int(seed) + e) % 2**64
            return {"seed": seed, "options": options}
    return arguments


def _state_of_one(name: str, value: Any, e: int) -> np.ndarray:
    array = np.asarray(value)
    if name == "passed":
        return array
    if name == "flags":
        return array[:, e : e + 1]
    rows = array.reshape(COUNT, -1, *array.shape[1:])[e]
    return rows[0][None] if len(array) == COUNT else rows


def _answer_of_one(call: Call, e: int, alone: Any) -> Any:
    """Return the rows of environment ``e`` of an answer; what else an info has, as it is there alone."""

    def row(value: Any, like: Any) -> Any:
        if isinstance(value, Mapping):
            is_there = {key: key in like or value.get(f"_{key}", value[key])[e] for key in value}
            return {key: row(each, like.get(key)) for key, each in value.items() if is_there[key]}
        if isinstance(value, tuple):
            return tuple(row(*pair) for pair in zip(value, like, strict=True))
        if isinstance(value, np.ndarray):
            return value[e : e + 1][..., : like.shape[-1]] if call.name == "looks" else value[e : e + 1]
        return value

    return row(call.answer, alone)


def _plain(value: Any) -> Any:
    """Return tensors as arrays: copies."""
    if isinstance(value, Mapping):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, tuple):
        return tuple(map(_plain, value))
    return value.numpy().copy() if hasattr(value, "numpy") else value


def _valid(value: Any, where: Any = None) -> Any:
    """Return an answer with zeros in the rows that its masks say are not valid."""
    if isinstance(value, Mapping):
        return {key: _valid(each, value.get(f"_{key}", where)) for key, each in value.items()}
    if isinstance(value, tuple):
        return tuple(_valid(each, where) for each in value)
    if isinstance(value, np.ndarray) and where is not None:
        value = value.copy()
        value[~where] = 0
    return value


def banks_of(kind: str) -> list[list[House]]:
    """Return some lists of houses for environments of a kind."""
    cell = 0.3 if KINDS[kind].backend == "grid" else 0.0
    houses = list(generate(rooms=3, count=4, seed=5, cell=cell))
    homes = list(generate(rooms=4, count=2, seed=5, grammar="home")) if not cell else houses[:1]
    return [houses[:2], houses[2:], [houses[0], *homes]] if kind != "paper" else [houses[:2], houses[2:]]


@dataclass(frozen=True)
class Calls:
    """Make random sequences of calls of environments of many kinds, and make them again."""

    seconds: float = 600.0
    """How long, for all kinds and modes together."""

    kinds: tuple[str, ...] = tuple(KINDS)
    """Kinds of environments."""

    seed: int = 0
    """Of the first sequence."""

    def run(self) -> int:
        """Print the calls that were made of each kind and mode; 1 if one fails."""
        failures, total = 0, Counter[str]()
        pairs = [(kind, mode) for kind in self.kinds for mode in MODES[: 1 if KINDS[kind].rotates else 3]]
        for kind, mode in pairs:
            calls, found = self._played(kind, mode, self.seconds / len(pairs))
            failures += len(found)
            total += calls
            words = ", ".join(f"{number:,} {name}" for name, number in sorted(calls.items()))
            print(f"{kind}, {mode}: {words}; {len(found)} failures", flush=True)
            for words in found:
                print(f"  {words}", flush=True)
        made = sum(number for name, number in total.items() if name != "refused")
        print(f"{made:,} calls, {total['refused']:,} of them refused: {failures} failures")
        return int(failures > 0)

    def _played(self, kind: str, mode: str, seconds: float) -> tuple[Counter[str], list[str]]:
        calls, failures, end = Counter[str](), list[str](), time.monotonic() + seconds
        banks = banks_of(kind)
        player = Player(kind, mode, banks, by_ray=True)
        for seed in count(self.seed):
            if time.monotonic() > end or len(failures) >= 5:
                break
            try:
                player.play(seed)
            except Exception as error:
                place = traceback.extract_tb(error.__traceback__)[-1]
                failures.append(f"seed {seed}: {type(error).__name__}: {str(error)[:300]} ({place.name})")
                calls += player.calls
                player = Player(kind, mode, banks, by_ray=True)
        return calls + player.calls, failures
