"""What a searcher believes of a target before it looks: where it may lie, and how likely.

A prior gives each word of 64 samples of a house's spots a weight. The samples of a region fill a word, so
one weight a region says how likely it is, and what was learnt changes few numbers.
"""

from typing import Literal

import numpy as np

from sim.baselines.coverage import WORD, origins_of
from sim.tasks.places import Region, free_floor
from sim.tasks.survey import Survey
from sim.world.episodes import FOUND, HOUSE, NUMBER, WHOLES
from sim.world.world import World

DRAWS = 8192
"""Assignments of a house's shares to its regions by which finds are judged."""

PriorName = Literal["task", "floor", "finds"]


class Uniform:
    """All places of the task alike: right for tasks whose targets are drawn so."""

    def __init__(self, world: World, tables: list[Survey], pitch: int) -> None:
        """Sample places on a grid of ``pitch`` steps."""
        self.spots = [here.targets for here in world.places]
        """For each house (m, 2) float32: where a target may lie, in steps, from the westernmost on."""
        self.samples = [here.spread(pitch) for here in world.places]
        """For each house (n,) int: the spots by which looks are judged."""

    def begin(self) -> None:
        """Forget what was learnt."""

    def weigh(self, weights: np.ndarray) -> None:
        """Write the weights (E * W,) float32 of each environment's words; they are 1 at first."""


class Floor(Uniform):
    """All free floor of a house alike, as if it did not know the task."""

    def __init__(self, world: World, tables: list[Survey], pitch: int) -> None:
        """Raise ``ValueError`` where targets lie at given places, which need not be free floor."""
        super().__init__(world, tables, pitch)
        if any(here.given for here in world.places):
            raise ValueError("prior floor: this task's targets lie at given places")
        bank = zip(world.houses, world.bank.geometries, world.lattices, tables, strict=True)
        self.spots = [
            free_floor(house, shape, lattice, table, world.config) for house, shape, lattice, table in bank
        ]
        self.samples = [
            chosen if len(chosen) else np.zeros(1, int)
            for chosen in (np.flatnonzero((spots % pitch == 0).all(axis=1)) for spots in self.spots)
        ]


class Weighted(Uniform):
    """The regions of a ``WeightedTask`` with their shares."""

    def __init__(self, world: World, tables: list[Survey], pitch: int) -> None:
        """Take a word of samples of each region: evenly from its places in their order, some twice if few."""
        super().__init__(world, tables, pitch)
        self.world, self.regions = world, [here.regions for here in world.places]
        if not all(self.regions):
            raise ValueError(f"prior finds: {world.task} has no regions, as habit has")
        self.samples = [np.concatenate([_word(region) for region in regions]) for regions in self.regions]
        self.shares = [np.array([region.share for region in regions]) for regions in self.regions]

    def begin(self) -> None:
        """Forget what was learnt."""
        self.noted = np.full((self.world.num_envs, 2), -1)

    def weigh(self, weights: np.ndarray) -> None:
        """Write the weights of environments with a new target."""
        wholes, rows = self.world.arrays["wholes"].view(), weights.reshape(self.world.num_envs, -1)
        now = wholes.reshape(-1, WHOLES)[:, [NUMBER, FOUND]]
        for e in np.flatnonzero((now != self.noted).any(axis=1)):
            house, again = int(wholes[e, HOUSE]), now[e, 0] == self.noted[e, 0]
            shares = self.believed(int(e), house, again=bool(again))
            rows[e] = 0
            rows[e, : len(shares)] = shares
        self.noted = now.copy()

    def believed(self, e: int, house: int, *, again: bool) -> np.ndarray:
        """How likely each region is for an environment's next target; ``again``: it has found one more."""
        return self.shares[house]


class Finds(Weighted):
    """The regions and their shares, but not which region has which: the posterior of that, from the finds.

    It is by importance: random assignments of shares to regions, each as likely as it makes the finds.
    """

    def __init__(self, world: World, tables: list[Survey], pitch: int) -> None:
        """Draw the assignments of each house."""
        super().__init__(world, tables, pitch)
        self.drawn = [_assigned(shares) for shares in self.shares]
        self.likelihood = np.zeros((world.num_envs, DRAWS), np.float32)
        self.last = np.zeros((world.num_envs, 2), np.float32)

    def believed(self, e: int, house: int, *, again: bool) -> np.ndarray:
        """The posterior mean of each region's share."""
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
    """A word of samples (64,) of a region."""
    return region.targets[np.arange(WORD) * len(region.targets) // WORD]


def _assigned(shares: np.ndarray) -> np.ndarray:
    """Random assignments of shares to regions, (``DRAWS``, C) float32: the same for as many regions."""
    order = np.random.default_rng(0).random((DRAWS, len(shares))).argsort(axis=1)
    return shares[order].astype(np.float32)


def task_prior(world: World, tables: list[Survey], pitch: int) -> Uniform:
    """Where the task puts targets, and how often."""
    weighted = all(here.regions for here in world.places)
    return (Weighted if weighted else Uniform)(world, tables, pitch)


PRIORS = {"task": task_prior, "floor": Floor, "finds": Finds}
"""By name, what makes a searcher's prior of a world, what bodies can do in its houses, and a pitch."""
