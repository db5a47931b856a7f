"""The options of a reset, read and checked before anything is changed."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from gymnasium.error import Error, ResetNeeded

from logic.spelling import unknown
from sim.world.kernels import KEEP, SAMPLE
from sim.world.world import World

OPTIONS = "house", "pose", "target", "reset_mask"


@dataclass(frozen=True)
class ResetOptions:
    """What a reset is asked for, by environment."""

    mask: np.ndarray
    """(E,) bool: which environments begin an episode."""
    wholes: np.ndarray
    """(E, 4) int32: house, or ``SAMPLE``, or ``KEEP`` outside the mask; then the cell of the start."""
    reals: np.ndarray
    """(E, 4) float32: origin of that cell and centre of the target, metres; NaN where they are sampled."""


def read_options(options: dict[str, Any], world: World, first: bool) -> ResetOptions:
    """Read the options of a world's reset, its ``first`` one or not.

    Raises ``ValueError`` for options that are unknown or wrong, ``ResetNeeded`` for a first one of some only.
    """
    for option in options:
        if option not in OPTIONS:
            raise ValueError(unknown("reset option", option, OPTIONS))
    count = world.num_envs
    mask = np.ones(count, bool)
    wholes, reals = np.zeros((count, 4), np.int32), np.full((count, 4), np.nan, np.float32)
    wholes[:, 0] = SAMPLE
    if options.get("reset_mask") is not None:
        mask = np.asarray(options["reset_mask"])
        if mask.shape != (count,) or mask.dtype != bool:
            raise ValueError(f"option reset_mask: {count} bools, found {mask.dtype} {mask.shape}")
        if not mask.any():
            raise ValueError("option reset_mask: it is False everywhere, so there is nothing to reset")
        if first and not mask.all():
            raise ResetNeeded("the first reset is everywhere's: leave out reset_mask")
    if options.get("house") is not None:
        wholes[:, 0] = house_numbers(options["house"], world)
    if options.get("pose") is not None:
        if options.get("house") is None:
            raise ValueError("option pose: say in which houses, by option house")
        poses = _floats("pose", options["pose"], (count, 3))
        reals[:, :2], wholes[:, 1:] = world.place(wholes[:, 0], poses)
    if options.get("target") is not None:
        reals[:, 2:] = _floats("target", options["target"], (count, 2))
    wholes[~mask, 0] = KEEP
    return ResetOptions(mask, wholes, reals)


def read_seeds(seed: Any, count: int) -> np.ndarray:
    """Seeds (E,) uint64 of environments: ``seed + i`` of a number, or those of a sequence.

    Raises ``ValueError`` for another number of them and, as Gymnasium does, ``Error`` for what is no seed.
    """
    seeds = [seed] if isinstance(seed, int | float | np.number) else list(seed)
    for one in seeds:
        if isinstance(one, bool) or not isinstance(one, int | np.integer) or not 0 <= one < 2**64:
            raise Error(f"a seed is a whole number from 0 to 2**64 - 1, not {one!r}")
    if seeds and not np.iterable(seed):
        seeds = [(int(seed) + i) % 2**64 for i in range(count)]
    if len(seeds) != count:
        raise ValueError(f"{len(seeds)} seeds for {count} environments")
    return np.array(seeds, np.uint64)


def house_numbers(value: Any, world: World) -> np.ndarray:
    """Numbers (E,) int of houses in a world's bank; ``ValueError`` for others."""
    given = np.asarray(value)
    if given.shape != (world.num_envs,) or not np.issubdtype(given.dtype, np.integer):
        raise ValueError(f"option house: {world.num_envs} integers, found {given.dtype} {given.shape}")
    if given.min() < 0 or given.max() >= len(world.houses):
        raise ValueError(f"option house: the bank has houses 0 to {len(world.houses) - 1}")
    return given


def _floats(name: str, value: Any, shape: tuple[int, ...]) -> np.ndarray:
    array = np.asarray(value, np.float64)
    if array.shape != shape or not np.isfinite(array).all():
        found = f"shape {array.shape}" if array.shape != shape else "some that are not finite"
        raise ValueError(f"option {name}: finite numbers of shape {shape}, found {found}")
    return array
