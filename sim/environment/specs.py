"""The spec of an environment: the arguments that it was made with, such that JSON keeps them."""

import sys
from collections.abc import Callable
from dataclasses import replace
from enum import Enum
from pathlib import Path
from typing import Any

import gymnasium
from gymnasium.envs.registration import EnvSpec

from logic import House
from sim.fields import stated
from sim.tasks.tasks import stated_task


class KeepsSpec:
    """An environment whose ``spec`` comes back from JSON as it was, and makes the same environment again."""

    _spec: EnvSpec | None = None
    episode_steps: int
    """Steps after which an episode is truncated."""

    @property
    def spec(self) -> EnvSpec | None:
        """The spec that ``gymnasium.make`` gave, its arguments in plain types, and the length of episodes."""
        return self._spec

    @spec.setter
    def spec(self, spec: EnvSpec | None) -> None:
        if spec is not None:
            if (limit := _limit_of(sys._getframe(1))) > self.episode_steps:
                self.lengthen(limit)
            kwargs = {name: PLAIN.get(name, _plain)(value) for name, value in spec.kwargs.items()}
            kwargs.pop("max_episode_steps", None)
            spec = replace(spec, kwargs=kwargs, max_episode_steps=self.episode_steps)
        self._spec = spec

    def lengthen(self, steps: int) -> None:
        """Truncate episodes after more steps than those of the arguments; an environment may refuse to."""


def _limit_of(frame: Any) -> int:
    """Return the ``max_episode_steps`` of a running ``gymnasium.make``, 0 for none and for another function.

    ``make`` passes the number to its wrapper ``TimeLimit`` alone, which can only shorten episodes.
    """
    if frame.f_code is not gymnasium.make.__code__:
        return 0
    asked, spec = frame.f_locals["max_episode_steps"], frame.f_locals["env_spec"]
    return (spec.max_episode_steps if asked is None else asked) or 0


def _plain(value: Any) -> Any:
    if isinstance(value, Path):
        return str(value)
    return value.value if isinstance(value, Enum) else stated(value)


def _houses(value: Any) -> Any:
    if isinstance(value, list | tuple):
        return [stated(each.to_dict() if isinstance(each, House) else each) for each in value]
    return _plain(value) if isinstance(value, str | Path | dict) else value


PLAIN: dict[str, Callable[[Any], Any]] = {"device": str, "houses": _houses, "targets": stated_task}
"""Functions that return an argument as JSON keeps it, by the argument's name; ``_plain`` for all others."""
