"""Spaces of observations, and the conversion of kernel outputs to these spaces."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium import spaces

from vitruvius.logic.spelling import unknown
from vitruvius.sim.actions import ACTIONS
from vitruvius.sim.config import EXTRAS, RAYS, Config
from vitruvius.sim.drive import Drive
from vitruvius.sim.parts import MEMORY, PARTS


def single_spaces(config: Config) -> tuple[spaces.Space[Any], spaces.Space[Any]]:
    """Return the spaces of one environment's observations and actions.

    The space of observations is a ``Box`` for rays alone, else a ``Dict`` of the parts in ``Config.observe``,
    in the same order. With ``Config.flat``, it is one ``Box`` (n,).
    """
    parts: dict[str, spaces.Space[Any]] = {name: _box(config, name) for name in config.observe}
    if config.flat:
        low, high = (np.concatenate([getattr(part, end).ravel() for part in parts.values()]) for end in ENDS)
        seen: spaces.Space[Any] = spaces.Box(low, high, low.shape, np.float32)
    else:
        seen = parts[RAYS] if config.observe == (RAYS,) else spaces.Dict(parts, sort_keys=False)
    return seen, _commands(config.drive) if config.drives else spaces.Discrete(ACTIONS)


def _commands(drive: Drive) -> spaces.Space[Any]:
    """Return the action space of a body that drives: its commands, or all numbers within its limits."""
    if drive.commands:
        return spaces.Discrete(len(drive.commands))
    low, high = np.array(drive.low, np.float32), np.array(drive.high, np.float32)
    return spaces.Box(low, high, low.shape, np.float32)


ENDS = "low", "high"


def _box(config: Config, name: str) -> spaces.Box:
    """Return the space of one part."""
    if name != RAYS:
        part = PARTS[name]
        return spaces.Box(part.low, part.high, (config.numbers_of(name),), np.float32)
    shape = (config.rays, config.channels)
    # An angle of 359.5 degrees would be more than 1 in units of 359: the original's unit is kept.
    high = np.ones(shape, np.float32)
    if config.sees_angle:
        high[:, config.column("angle")] = 360 / 359
    return spaces.Box(np.zeros(shape, np.float32), high, shape, np.float32)


def observed(config: Config, rays: Any, extras: Any) -> Any:
    """Return an observation in its space, except for ``flat``, without copies.

    ``rays`` (E, R, C) and ``extras`` (E, n), the numbers of the other parts, are arrays or tensors.
    """
    if config.observe == (RAYS,):
        return rays
    parts, at = {}, 0
    for name in config.observe:
        if name == RAYS:
            parts[name] = rays
        else:
            parts[name] = extras[:, at : at + config.numbers_of(name)]
            at += config.numbers_of(name)
    return parts


def only(observation: Any) -> Any:
    """Return the observation of the only environment."""
    if isinstance(observation, Mapping):
        return {name: part[0] for name, part in observation.items()}
    return observation[0]


def require_observed(config: Config, backend: type) -> None:
    """Raise ``ValueError`` for a part of observations that a backend lacks, by its attribute ``lacks``."""
    lacks = (*getattr(backend, "lacks", ()), *(() if config.drives else ("speed",)))
    if MEMORY in config.observe and not config.memory:
        raise ValueError(
            "observe: the task's terms have no memory: use terms that have one, such as visit or battery"
        )
    for name in config.observe:
        if name in lacks:
            has = [each for each in (RAYS, *EXTRAS) if each not in lacks]
            raise ValueError(f"observe: backend {backend.__name__}: {unknown('observation', name, has)}")
