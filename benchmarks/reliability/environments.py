"""``vitruvius bench calls``: environments under random sequences of calls, compared with other environments.

An environment answers a call, or refuses the call with an error of Gymnasium or a ``ValueError`` and changes
nothing. The study repeats the answered calls in a second batch and in a single environment: observations,
rewards and infos are the same, bit for bit.
"""

import copy
import pickle
import time
import traceback
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import count
from typing import Any

import numpy as np
from gymnasium.error import Error

from benchmarks.reliability.random_calls import COUNT, KINDS, WEIGHTS, Draw, banks_of
from vitruvius.logic import House
from vitruvius.logic.errors import HouseFileError
from vitruvius.sim import HouseRotation, HouseVectorEnv
from vitruvius.sim.world.arrays import COUNTERS, SEED

REFUSALS = (ValueError, TypeError, Error, HouseFileError)
"""Errors that refuse a call."""

CALLS = 40
"""Number of calls in a sequence."""

COPIES = "pickle", "deepcopy"

MODES = "NextStep", "SameStep", "Disabled"


@dataclass
class Call:
    """An answered call, for a repetition in other environments."""

    name: str
    arguments: dict[str, Any]
    answer: Any


class Player:
    """Environments of a kind and a mode, which answer random calls."""

    def __init__(self, kind: str, mode: str, banks: Sequence[list[House]], by_ray: bool = False) -> None:
        """Create the environments for ``banks``, which are lists of houses.

        ``by_ray``: the second batch repeats calls in the loop of a GPU, by environment and ray.
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
        """Make a sequence of calls, and repeat it. Raises ``AssertionError`` for answers that differ."""
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
        """Make a call. Raises ``AssertionError`` if a refused call changes something."""
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
            assert envs.observation_space.contains(answer[0]), f"{name}: {answer[0]} is not of its space"
        if name == "reset" and not was_ready:  # one environment alone would draw other seeds
            seeds = np.ascontiguousarray(envs.state["wholes"][:, SEED:COUNTERS]).view("<u8").ravel()
            arguments = arguments | {"seed": [int(each) for each in seeds]}
        return Call(name, arguments, copy.deepcopy(answer))

    def _copy(self, name: str, go_on: bool) -> None:
        """Compare a copy with its original, and continue in the copy if ``go_on``."""
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


def snapshot(envs: HouseVectorEnv) -> dict[str, Any]:
    """Return all observable state of environments."""
    kept: dict[str, Any] = {"ready": envs._ready, "houses": envs.houses, "task": envs.world.task}
    kept["random"] = copy.deepcopy(envs.np_random.bit_generator.state)
    return kept | (
        envs.state | {f"info {key}": value for key, value in envs.info().items()} if envs._ready else {}
    )


def require_same(one: Any, other: Any, where: str) -> None:
    """Raise ``AssertionError`` unless two values are the same, bit for bit."""
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


def _of_one(name: str, arguments: dict[str, Any], e: int) -> dict[str, Any] | None:
    """Return the arguments of a call for environment ``e`` alone; None if the call does not change it."""
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
    """Return the rows of environment ``e`` of an answer, with the keys of the answer ``alone``."""

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
    """Return an answer with copied arrays in place of tensors."""
    if isinstance(value, Mapping):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, tuple):
        return tuple(map(_plain, value))
    return value.numpy().copy() if hasattr(value, "numpy") else value


def _valid(value: Any, where: Any = None) -> Any:
    """Return an answer with zeros in the rows that are not valid by its masks."""
    if isinstance(value, Mapping):
        return {key: _valid(each, value.get(f"_{key}", where)) for key, each in value.items()}
    if isinstance(value, tuple):
        return tuple(_valid(each, where) for each in value)
    if isinstance(value, np.ndarray) and where is not None:
        value = value.copy()
        value[~where] = 0
    return value


@dataclass(frozen=True)
class Calls:
    """Make random sequences of calls of environments of many kinds, and repeat each sequence."""

    seconds: float = 600.0
    """Seconds for all kinds and modes together."""

    kinds: tuple[str, ...] = tuple(KINDS)
    """Kinds of environments."""

    seed: int = 0
    """Seed of the first sequence."""

    def run(self) -> int:
        """Print the number of calls for each kind and mode, and return 1 if a sequence fails."""
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
