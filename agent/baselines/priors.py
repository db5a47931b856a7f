"""Priors of a searcher: the places where a target may lie, and their probabilities.

A prior assigns a weight to each word of 64 samples of a house's spots. The samples of a region fill a word,
so one weight gives the probability of a region, and an update changes few numbers.
"""

from typing import Literal

import numpy as np

from vitruvius.agent.baselines.coverage import WORD, origins_of
from vitruvius.sim.tasks.places import Region, free_floor
from vitruvius.sim.tasks.survey import Survey
from vitruvius.sim.world.arrays import FOUND, HOUSE, NUMBER
from vitruvius.sim.world.world import World

DRAWS = 8192
"""Number of random assignments of a house's shares to its regions, which approximate the posterior."""

PriorName = Literal["task", "floor", "finds"]


class Uniform:
    """Uniform prior over all places of the task, which is exact for tasks with uniformly drawn targets."""

    def __init__(self, world: World, tables: list[Survey], pitch: int) -> None:
        """Sample places on a grid of ``pitch`` steps."""
        self.spots = [here.targets for here in world.places]
        """For each house (m, 2) float32: possible places of a target, in steps, from west to east."""
        self.samples = [here.spread(pitch) for here in world.places]
        """For each house (n,) int: the spots that serve as samples."""

    def begin(self) -> None:
        """Discard what the prior learnt."""

    def weigh(self, weights: np.ndarray) -> None:
        """Write the weights (E * W,) float32 of each environment's words, which are 1 at first."""


class Floor(Uniform):
    """Uniform prior over all free floor of a house, without knowledge of the task."""

    def __init__(self, world: World, tables: list[Survey], pitch: int) -> None:
        """Take all free floor as spots.

        Raises ``ValueError`` for targets at given places, which need not be free floor.
        """
        super().__init__(world, tables, pitch)
        if any(here.given for here in world.places):
            raise ValueError("prior floor: this task places its targets at given points")
        bank = zip(world.houses, world.bank.geometries, world.lattices, tables, strict=True)
        self.spots = [
            free_floor(house, shape, lattice, table, world.config) for house, shape, lattice, table in bank
        ]
        self.samples = [
            chosen if len(chosen) else np.zeros(1, int)
            for chosen in (np.flatnonzero((spots % pitch == 0).all(axis=1)) for spots in self.spots)
        ]


class Weighted(Uniform):
    """Prior with the regions of a ``WeightedTask`` and their shares."""

    def __init__(self, world: World, tables: list[Survey], pitch: int) -> None:
        """Take a word of samples of each region, evenly spread over its places; small regions repeat some."""
        super().__init__(world, tables, pitch)
        self.world, self.regions = world, [here.regions for here in world.places]
        if not all(self.regions):
            raise ValueError(f"prior finds: {world.task} has no regions; the task habit has them")
        self.samples = [np.concatenate([_word(region) for region in regions]) for regions in self.regions]
        self.shares = [np.array([region.share for region in regions]) for regions in self.regions]

    def begin(self) -> None:
        """Discard what the prior learnt."""
        self.noted = np.full((self.world.num_envs, 2), -1)

    def weigh(self, weights: np.ndarray) -> None:
        """Write the weights of environments with a new target."""
        wholes, rows = self.world.arrays["wholes"].view(), weights.reshape(self.world.num_envs, -1)
        now = wholes[:, [NUMBER, FOUND]]
        for e in np.flatnonzero((now != self.noted).any(axis=1)):
            house, again = int(wholes[e, HOUSE]), now[e, 0] == self.noted[e, 0]
            shares = self.believed(int(e), house, again=bool(again))
            rows[e] = 0
            rows[e, : len(shares)] = shares
        self.noted = now.copy()

    def believed(self, e: int, house: int, *, again: bool) -> np.ndarray:
        """Return the probability of each region for an environment's next target.

        ``again``: True if the environment has found another target in the same episode.
        """
        return self.shares[house]


class Finds(Weighted):
    """Prior that knows the regions and the shares, but not which region has which share.

    Found targets give the posterior over the assignments, by importance sampling: each of many random
    assignments of shares to regions is weighted with the likelihood of the found targets.
    """

    def __init__(self, world: World, tables: list[Survey], pitch: int) -> None:
        """Draw the assignments of each house."""
        super().__init__(world, tables, pitch)
        self.drawn = [_assigned(shares) for shares in self.shares]
        self.likelihood = np.zeros((world.num_envs, DRAWS), np.float32)
        self.last = np.zeros((world.num_envs, 2), np.float32)

    def believed(self, e: int, house: int, *, again: bool) -> np.ndarray:
        """Return the posterior mean of each region's share."""
        if again:
            step, corner = self.world.config.step, origins_of(self.world).reshape(-1, 2)[house]
            found = np.abs(self.spots[house] * step + corner - self.last[e]).max(axis=1).argmin()
            density = [np.isin(found, region.targets) / len(region.targets) for region in self.regions[house]]
            self.likelihood[e] += np.log(self.drawn[house] @ np.array(density, np.float32) + 1e-30)
        else:
            self.likelihood[e] = 0
        self.last[e] = self.world.arrays["reals"].view()[e, 2:4]
        likely = np.exp(self.likelihood[e] - self.likelihood[e].max())
        return likely @ self.drawn[house] / likely.sum()


def _word(region: Region) -> np.ndarray:
    """Return a word of samples (64,) of a region."""
    return region.targets[np.arange(WORD) * len(region.targets) // WORD]


def _assigned(shares: np.ndarray) -> np.ndarray:
    """Return random assignments of shares to regions, (``DRAWS``, C) float32.

    The random orders are the same for all houses with the same number of regions.
    """
    order = np.random.default_rng(0).random((DRAWS, len(shares))).argsort(axis=1)
    return shares[order].astype(np.float32)


def task_prior(world: World, tables: list[Survey], pitch: int) -> Uniform:
    """Return the prior that equals the task's distribution of targets."""
    weighted = all(here.regions for here in world.places)
    return (Weighted if weighted else Uniform)(world, tables, pitch)


PRIORS = {"task": task_prior, "floor": Floor, "finds": Finds}
"""Functions that create a searcher's prior from a world, the surveys of its houses, and a pitch, by name."""
