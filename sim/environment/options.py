"""Options of a reset, read and checked before anything is changed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from gymnasium.error import Error, ResetNeeded

from vitruvius.logic.spelling import unknown
from vitruvius.sim.world.arrays import HEADING
from vitruvius.sim.world.phases import KEEP, SAMPLE
from vitruvius.sim.world.world import World

SHAPES = {"house": (), "pose": (3,), "target": (2,), "reset_mask": ()}
"""Shapes of an environment's options."""


MAX_COORDINATE_M = 1e6
"""Largest distance of a place from the origin: further away, float32 does not resolve centimetres."""


TARGET_MARGIN_M = 100.0
"""Largest distance of a given target from its house. Bodies cannot see a target outside the house."""


@dataclass(frozen=True)
class ResetOptions:
    """Options of a reset, for each environment."""

    mask: np.ndarray
    """(E,) bool: True for the environments that begin an episode."""
    wholes: np.ndarray
    """(E, 4) int32: house, or ``SAMPLE``, or ``KEEP`` outside the mask; on a lattice then the cell of the
    start."""
    reals: np.ndarray
    """(E, 4) float32: origin of that cell and centre of the target, metres; NaN for values that are
    sampled. For bodies that drive (E, 5): the place, the centre, and the heading in radians."""


def for_one(options: Any) -> dict[str, Any]:
    """Return the options of one environment as those of a vector of one.

    Raises ``ValueError`` for wrong shapes.
    """
    batched = {}
    for option, value in require_mapping(options).items():
        if value is not None:
            given = _array(option, value)
            if given.shape != SHAPES.get(option, given.shape):
                raise ValueError(f"option {option}: give shape {SHAPES[option]}, not {given.shape}")
            batched[option] = given[None]
    return batched


def require_mapping(options: Any) -> Mapping[str, Any]:
    """Return the options as a mapping, empty for ``None``. Raises ``ValueError`` for anything else."""
    if options is None:
        return {}
    if not isinstance(options, Mapping):
        raise ValueError(f'options must be a dict, as in {{"house": 0}}, not {options!r}')
    return options


def read_options(options: Mapping[str, Any], world: World, first: bool) -> ResetOptions:
    """Read the options of a world's reset; ``first`` is True for its first reset.

    Raises ``ValueError`` for unknown or invalid options, and ``ResetNeeded`` for a first reset of only some
    environments.
    """
    for option in options:
        if option not in SHAPES:
            raise ValueError(unknown("reset option", option, SHAPES))
    count = world.num_envs
    mask = np.ones(count, bool)
    wholes, reals = world.unguided()
    if options.get("reset_mask") is not None:
        mask = _array("reset_mask", options["reset_mask"])
        if mask.shape != (count,) or mask.dtype != bool:
            raise ValueError(f"option reset_mask: give {count} bools, not {mask.dtype} {mask.shape}")
        if not mask.any():
            raise ValueError("option reset_mask: every value is False, so nothing would be reset")
        if first and not mask.all():
            raise ResetNeeded("the first reset must reset all environments: leave out reset_mask")
    if options.get("house") is not None:
        wholes[:, 0] = house_numbers(options["house"], world)
    if options.get("pose") is not None:
        if options.get("house") is None:
            raise ValueError("option pose: name the houses of the poses by option house")
        poses = _floats("pose", options["pose"], (count, 3))
        reals[:, :2], cells = world.place(wholes[:, 0], poses)
        if world.config.drives:
            reals[:, HEADING] = cells
        else:
            wholes[:, 1:] = cells
    if options.get("target") is not None:
        targets = _floats("target", options["target"], (count, 2))
        _require_near(targets[mask], wholes[mask, 0], world)
        reals[:, 2:4] = targets
    wholes[~mask, 0] = KEEP
    return ResetOptions(mask, wholes, reals)


def read_seeds(seed: Any, count: int) -> list[int | None]:
    """Return the seeds of environments: ``seed + i`` for a number, or those of a sequence.

    A seed in a sequence may be ``None``, for no new seed. Raises ``ValueError`` for a wrong number of seeds
    and, as Gymnasium does, ``Error`` for an invalid seed.
    """
    if isinstance(seed, np.ndarray):
        seed = seed.tolist()
    if not isinstance(seed, Sequence) or isinstance(seed, str):
        return [(_seed(seed) + i) % 2**64 for i in range(count)]
    seeds = [None if one is None else _seed(one) for one in seed]
    if len(seeds) != count:
        raise ValueError(f"{len(seeds)} seeds for {count} environments: give one each")
    return seeds


def _seed(one: Any) -> int:
    if isinstance(one, bool) or not isinstance(one, int | np.integer) or not 0 <= one < 2**64:
        raise Error(f"a seed is a whole number from 0 to 2**64 - 1, not {one!r}")
    return int(one)


def house_numbers(value: Any, world: World) -> np.ndarray:
    """Return numbers (E,) int of houses in a world's bank. Raises ``ValueError`` for anything else."""
    given = _array("house", value)
    if given.shape != (world.num_envs,) or not np.issubdtype(given.dtype, np.integer):
        raise ValueError(f"option house: give {world.num_envs} integers, not {given.dtype} {given.shape}")
    if given.min() < 0 or given.max() >= len(world.houses):
        raise ValueError(f"option house: there are houses 0 to {len(world.houses) - 1}")
    return given


def _require_near(targets: np.ndarray, numbers: np.ndarray, world: World) -> None:
    """Raise ``ValueError`` for a target (n, 2) too far from its house.

    For a sampled house, the target must be near every house of the bank.
    """
    bounds = np.array([shape.bounds for shape in world.bank.geometries])
    low, high = bounds[:, None, :2] - TARGET_MARGIN_M, bounds[:, None, 2:] + TARGET_MARGIN_M
    near = ((low <= targets) & (targets <= high)).all(axis=2)  # (H, n)
    good = np.where(numbers == SAMPLE, near.all(axis=0), near[numbers, np.arange(len(targets))])
    if not good.all():
        (x, y), number = targets[~good][0].tolist(), numbers[~good][0]
        house = int((~near[:, ~good][:, 0]).argmax()) if number == SAMPLE else number
        where = f"more than {TARGET_MARGIN_M:g} m from house {house}"
        raise ValueError(f"option target: ({x:.3f}, {y:.3f}) m is {where}")


def _array(name: str, value: Any) -> np.ndarray:
    try:
        return np.asarray(value)
    except ValueError:
        raise ValueError(f"option {name}: the rows differ in length: {value!r}") from None


def _floats(name: str, value: Any, shape: tuple[int, ...]) -> np.ndarray:
    try:
        array = _array(name, value)
        if array.dtype.kind not in "iuf":
            raise TypeError("no real numbers")
    except (TypeError, ValueError):
        raise ValueError(f"option {name}: give finite numbers of shape {shape}, not {value!r}") from None
    array = array.astype(np.float64)
    if array.shape != shape or not (np.abs(array) < MAX_COORDINATE_M).all():
        found = (
            f"shape {array.shape}" if array.shape != shape else ("values that are not finite or too far away")
        )
        raise ValueError(f"option {name}: give finite numbers of shape {shape}, not {found}")
    return array
