"""Specs of environments, with arguments that survive a round trip through JSON."""

import sys
from collections.abc import Callable
from dataclasses import replace
from enum import Enum
from pathlib import Path
from typing import Any

import gymnasium
from gymnasium.envs.registration import EnvSpec

from vitruvius.logic import House
from vitruvius.sim.fields import stated
from vitruvius.sim.tasks.tasks import stated_task


class KeepsSpec:
    """Mixin for environments whose ``spec`` survives JSON unchanged and creates the same environment."""

    _spec: EnvSpec | None = None
    episode_steps: int
    """Steps after which an episode is truncated."""

    @property
    def spec(self) -> EnvSpec | None:
        """Spec from ``gymnasium.make``, with arguments in JSON types and the length of episodes."""
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
        """Truncate episodes after ``steps``, which is more than in the arguments, or raise an error."""


def _limit_of(frame: Any) -> int:
    """Return the ``max_episode_steps`` of the calling ``gymnasium.make``; 0 for another caller or no limit.

    ``make`` passes the number only to its wrapper ``TimeLimit``, which can shorten episodes but not lengthen
    them.
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
"""Functions that convert an argument to JSON types, by the argument's name; ``_plain`` converts the rest."""
