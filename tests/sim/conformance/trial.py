"""A vector environment under test: the form of the result of every call is checked."""

from collections.abc import Callable, Hashable, Iterator, Sequence
from copy import deepcopy
from dataclasses import dataclass
from typing import Any, NoReturn

import numpy as np
from gymnasium import Space, spaces
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import concatenate, create_empty_array, iterate

FAR = 1000
"""Difference of seeds whose episodes must differ."""


class ConformanceError(AssertionError):
    """A wrong behaviour of a vector environment: the call, its result, and the expected one."""


@dataclass(frozen=True)
class StepResult:
    """Result of ``step``, or of ``reset``, which has no rewards and ends."""

    observation: Any
    reward: np.ndarray
    terminated: np.ndarray
    truncated: np.ndarray
    info: dict[str, Any]

    @property
    def ended(self) -> np.ndarray:
        """Mask (N,) bool of the environments whose episode has ended."""
        return self.terminated | self.truncated


class Trial:
    """Player of the same random actions each time, with ``seed`` and for at most ``steps`` steps."""

    def __init__(self, envs: VectorEnv, steps: int, seed: int, options: dict[str, Any] | None = None) -> None:
        """Take an environment. ``where`` names the latest call, for messages."""
        self.envs, self.steps, self.seed, self.options = envs, steps, seed, options or {}
        self.where = str(envs)
        self._reset, self._count = "", 0
        self._actions: list[Any] = []
        self._first_end: int | None = None

    @property
    def mode(self) -> AutoresetMode:
        """Autoreset mode that the environment states."""
        return self.envs.metadata["autoreset_mode"]

    def fail(self, what: str) -> NoReturn:
        """Raise ``ConformanceError`` about the latest call."""
        raise ConformanceError(f"{self.where}: {what}")

    def refused(self, what: str, call: Callable[[], Any]) -> None:
        """Fail unless the call raises an exception."""
        try:
            call()
        except Exception:
            return
        self.where = what
        self.fail("was accepted, expected an error")

    def action(self, k: int) -> Any:
        """Return the k-th of a list of random batches of actions, which is always the same."""
        if not self._actions:
            self._space = deepcopy(self.envs.action_space)
            self._space.seed(self.seed)
        while len(self._actions) <= k:
            self._actions.append(self._space.sample())
        return deepcopy(self._actions[k])

    def split(self, actions: Any) -> list[Any]:
        """Return each environment's action."""
        return list(iterate(self.envs.action_space, actions))

    def batch(self, actions: Sequence[Any]) -> Any:
        """Return one batch of the environments' actions."""
        single = self.envs.single_action_space
        return concatenate(single, actions, create_empty_array(single, n=len(actions)))

    def each(self, observation: Any) -> list[Any]:
        """Return each environment's observation."""
        return list(iterate(self.envs.observation_space, observation))

    def fingerprint(self, observation: Any) -> dict[str, Hashable]:
        """Return the fingerprint of one environment's observation, in a batch's types or its own."""
        single = self.envs.single_observation_space
        return fingerprint(concatenate(single, [observation], create_empty_array(single, n=1)))

    def reset(self, seed: Any = None, mask: np.ndarray | None = None) -> StepResult:
        """Reset all environments, or those of the ``mask`` (N,) bool."""
        self.where = f"reset(seed={seed}" + ("" if mask is None else f", reset_mask={mask}") + ")"
        self._reset, self._count = self.where, 0
        # A new dict for each call, as some environments pop from it: the claim ``options`` is about that.
        given = self.envs.reset(seed=seed, options=None if mask is None else {"reset_mask": mask.copy()})
        if not (isinstance(given, tuple) and len(given) == 2):
            self.fail(f"returned {brief(given)}: expected a tuple of observations and infos")
        size = self.envs.num_envs
        return self._formed(
            StepResult(given[0], np.zeros(size), np.zeros(size, bool), np.zeros(size, bool), given[1])
        )

    def step(self, actions: Any) -> StepResult:
        """Step, and check that the call does not change the actions."""
        self._count += 1
        self.where = f"step {self._count} after {self._reset}"
        before = deepcopy(actions)
        given = self.envs.step(actions)
        if difference(before, actions):
            self.fail("changed the actions that it was given")
        if not (isinstance(given, tuple) and len(given) == 5):
            self.fail(
                f"returned {brief(given)}: expected observations, rewards, terminations, truncations, infos"
            )
        return self._formed(StepResult(*given))

    def play(self, count: int, seed: Any = None) -> Iterator[StepResult]:
        """Yield a reset and ``count`` steps of random actions; in ``DISABLED`` also resets by mask."""
        yield self.reset(self.seed if seed is None else seed)
        for k in range(count):
            now = self.step(self.action(k))
            over = now.ended
            yield now
            if self.mode is AutoresetMode.DISABLED and over.any():
                yield self.reset(mask=over)

    def first_end(self) -> int:
        """Return the number of steps that ``play`` makes until an episode ends; fail if none ends."""
        if self._first_end is None:
            ends = (k for k, now in enumerate(self.play(self.steps)) if now.ended.any())
            self._first_end = next(ends, None)
        if self._first_end is None:
            self.fail(f"no episode ended in {self.steps} steps, so no end was checked: try more steps")
        return self._first_end

    def at(self, count: int) -> StepResult:
        """Play again up to a step that is not later than the first end, and return its result."""
        play = self.play(count)
        for _ in range(count):
            next(play)
        return next(play)

    def fits(self, name: str, value: Any, space: Space) -> None:
        """Fail unless a value is in a space, with its shape and dtype."""
        if isinstance(space, spaces.Dict) and isinstance(value, dict) and value.keys() == space.keys():
            for key, part in space.items():
                self.fits(f"{name}[{key!r}]", value[key], part)
        elif isinstance(space, spaces.Tuple) and isinstance(value, tuple) and len(value) == len(space):
            for k, part in enumerate(space):
                self.fits(f"{name}[{k}]", value[k], part)
        elif isinstance(space, spaces.Box | spaces.MultiDiscrete | spaces.MultiBinary) and not (
            isinstance(value, np.ndarray) and value.shape == space.shape and value.dtype == space.dtype
        ):
            self.fail(f"{name} is {brief(value)}: expected an array {space.shape} of {space.dtype}")
        elif not space.contains(value):
            self.fail(f"{name} is not in its space {space}: {value}")

    def _formed(self, now: StepResult) -> StepResult:
        self.fits("observation", now.observation, self.envs.observation_space)
        self._flat("reward", now.reward, np.floating)
        if not np.isfinite(now.reward).all():
            self.fail(f"reward is {now.reward}: expected finite numbers")
        self._flat("terminated", now.terminated, np.bool_)
        self._flat("truncated", now.truncated, np.bool_)
        if not isinstance(now.info, dict):
            self.fail(f"info is {brief(now.info)}: expected a dict")
        self._informs("info", now.info)
        return now

    def _flat(self, name: str, value: Any, kind: type[np.generic]) -> None:
        shape = (self.envs.num_envs,)
        if not (isinstance(value, np.ndarray) and value.shape == shape and np.issubdtype(value.dtype, kind)):
            self.fail(f"{name} is {brief(value)}: expected an array {shape} of {kind.__name__}")

    def _informs(self, name: str, info: dict[str, Any]) -> None:
        for key, value in info.items():
            path = f"{name}[{key!r}]"
            if key.startswith("_"):
                self._flat(path, value, np.bool_)
                if key[1:] not in info:
                    self.fail(f"{path} is a mask for {key[1:]!r}, which is not there")
            elif isinstance(value, dict):
                self._informs(path, value)
            elif not isinstance(value, np.ndarray) or value.shape[:1] != (self.envs.num_envs,):
                self.fail(f"{path} is {brief(value)}: expected an array with a row for each environment")


def hold(name: str, trial: Trial, claim: Callable[[Trial], None]) -> None:
    """Check a claim, and turn any exception into a ``ConformanceError`` that begins with the claim's name."""
    try:
        claim(trial)
    except ConformanceError as broken:
        raise ConformanceError(f"{name}: {broken}") from None
    except Exception as error:
        raise ConformanceError(f"{name}: {trial.where} raised {type(error).__name__}: {error}") from error


def leaves(data: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the values in nested dicts, tuples, lists and arrays of objects, each with the path to it."""
    if isinstance(data, dict):
        for key, value in data.items():
            yield from leaves(value, f"{path}[{key!r}]" if path else str(key))
    elif isinstance(data, tuple | list) or (isinstance(data, np.ndarray) and data.dtype == object):
        for k, value in enumerate(data):
            yield from leaves(value, f"{path}[{k}]")
    else:
        yield path, data


def fingerprint(data: Any) -> dict[str, Hashable]:
    """Return hashes that are equal for data that are equal to the last bit; the data are not copied."""
    return {
        path: (leaf.dtype.str, leaf.shape, hash(leaf.tobytes()))
        if isinstance(leaf, np.ndarray | np.generic)
        else repr(leaf)
        for path, leaf in leaves(data)
    }


def difference(one: Any, other: Any) -> str:
    """Return the path to the first difference of two values, or an empty text."""
    ours, theirs = fingerprint(one), fingerprint(other)
    return next((path or "it" for path in {**ours, **theirs} if ours.get(path) != theirs.get(path)), "")


def shared(one: Any, other: Any) -> str:
    """Return the path to an array of one value that shares memory with the other, or an empty text."""
    theirs = [leaf for _, leaf in leaves(other) if isinstance(leaf, np.ndarray)]
    for path, leaf in leaves(one):
        if isinstance(leaf, np.ndarray) and any(np.shares_memory(leaf, array) for array in theirs):
            return path or "it"
    return ""


def brief(value: Any) -> str:
    """Return a short description of a value."""
    if isinstance(value, np.ndarray):
        return f"an array {value.shape} of {value.dtype}"
    if isinstance(value, tuple | list | dict):
        return f"a {type(value).__name__} of {len(value)}"
    return f"{type(value).__name__} {value!r}"
