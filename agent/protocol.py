"""The whole protocol: agents and all baselines in one bank, in each target mode, and the figures of that.

Every player meets the same starts and the same targets in the same order: house i's are those of seed + i.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from agent.baselines import baselines
from agent.build import policy_of
from agent.checkpoint import Checkpoint
from agent.evaluate import MARKS, Score, begin, play
from agent.policies import Policy
from agent.progress import Report
from agent.statistics import Estimate, interquartile_mean, mean
from agent.world import make_worlds
from logic import House
from sim import HouseVectorEnv
from sim.config import DEFAULT, PAPER, Config
from sim.lookout import Lookout
from sim.oracle import Oracle

MODES = ("main", "secondary", "mixed")
"""Where targets lie."""

HUMAN = {"main": 27, "secondary": 10}
"""What the paper's human picked up in the paper's house, with the whole map in sight."""

HUMAN_RATIO = 0.48
"""Of what the oracle picks up there: 27 of 56, 10 of 21."""

SOON = 300
"""Steps within which the first target must be picked up for a success."""


@dataclass(frozen=True)
class Result:
    """What all players did in one target mode."""

    targets: str
    """The mode."""

    rooms: np.ndarray
    """(H,) secondary rooms of each house."""

    shortest: np.ndarray
    """(H,) fewest steps from the start to the first target."""

    players: dict[str, tuple[Score, ...]]
    """By name, a score for each training run: one for a baseline. The last is the oracle's."""

    @property
    def oracle(self) -> np.ndarray:
        """(H,) what the oracle picked up."""
        return self.players["oracle"][0].targets

    def stacked(self, player: str, value: Callable[[Score], np.ndarray]) -> np.ndarray:
        """A value of each house for each of a player's runs, (S, H)."""
        return np.stack([value(score) for score in self.players[player]])

    def ratio(self, player: str, rooms: int | None = None) -> Estimate:
        """Share of the oracle's targets in the same house, over all houses or those of so many rooms:
        interquartile mean. A house where the oracle finds none says nothing and is left out.
        """
        chosen = (self.oracle > 0) & ((self.rooms == rooms) | (rooms is None))
        counts = self.stacked(player, lambda score: score.targets)
        return interquartile_mean(counts[:, chosen] / self.oracle[chosen])

    def figures(self, player: str) -> dict[str, Estimate]:
        """The figures of a player, by name; see ``DEFINITIONS``."""
        counts = self.stacked(player, lambda score: score.targets)
        first = self.stacked(player, lambda score: score.first)
        soon = first <= SOON
        coverage = {
            f"coverage_{mark}": mean(self.stacked(player, lambda score, k=k: score.coverage[k]))
            for k, mark in enumerate(MARKS)
        }
        rooms = self.stacked(player, lambda score: score.rooms) / np.maximum(self.rooms, 1)
        runs = self.players[player]
        blocked, interventions = (
            np.array([[1000 * getattr(score, name) / score.steps] for score in runs])
            for name in ("blocked", "interventions")
        )
        return {
            "targets": interquartile_mean(counts),
            "ratio": self.ratio(player),
            "success": mean(soon),
            "spl": mean(soon * self.shortest / np.maximum(first, self.shortest)),
            **coverage,
            "rooms": mean(rooms),
            "blocked": mean(blocked),
            "interventions": mean(interventions),
            **({"human": mean(counts > HUMAN[self.targets])} if self.targets in HUMAN else {}),
        }

    def by_rooms(self, player: str) -> dict[int, Estimate]:
        """The ratio to the oracle in houses of each number of rooms."""
        return {int(rooms): self.ratio(player, int(rooms)) for rooms in np.unique(self.rooms)}


DEFINITIONS = {
    "targets": "picked up in an episode of 1500 steps: interquartile mean over houses and training runs",
    "ratio": "targets as a share of the oracle's in the same house: interquartile mean",
    "success": f"share of episodes whose first target was picked up within {SOON} steps",
    "spl": "success weighted by the shortest way's length over the way taken, in steps",
    "coverage_500": "share of the house looked at after 500 steps: of the places where a target may lie, "
    "in any room, those where it would have been seen",
    "coverage_1500": "the same after 1500 steps",
    "rooms": "share of the secondary rooms that it was in",
    "blocked": "moves that walls or furniture blocked, per 1000 steps",
    "interventions": "actions that the avoidance layer changed, per 1000 steps",
    "human": f"share of houses with more targets than the paper's human had in the paper's house: "
    f"{HUMAN['main']} in the main room, {HUMAN['secondary']} in secondary rooms",
}
"""What each figure is. Those without another word are means; all have 95 % intervals by a stratified
bootstrap over training runs and houses, but blocked and interventions, over runs."""


def measure(
    agents: Mapping[str, Sequence[Checkpoint]],
    houses: Sequence[House],
    modes: Sequence[str] = MODES,
    seed: int = 0,
    tell: Report = lambda done, words: None,
    *,
    backend: str = "continuous",
) -> Iterator[Result]:
    """Measure agents, by name the training runs of each, and all baselines in a bank, mode by mode.

    An agent of the paper's world plays in the others', but that its rays are the paper's: the same body, the
    same starts and targets. Raises ``HouseFileError`` where a mode cannot be played in one of the houses.
    """
    for number, mode in enumerate(modes):
        stages = {name: Stage(houses, mode, eyes, backend) for name, eyes in EYES.items()}
        envs = stages["default"].envs
        begin(envs, seed)
        shortest = np.array([np.inf if way is None else len(way) for way in Oracle(envs).paths()])
        scores: dict[str, tuple[Score, ...]] = {}
        runs = [(name, each, stages[each.config.world]) for name, all in agents.items() for each in all]
        makers: list[tuple[str, Callable[[], Policy], Stage]] = [
            (name, partial(policy_of, each.network, each.config, stage.envs, seed), stage)
            for name, each, stage in runs
        ]
        makers += [(name, make, stages["default"]) for name, make in baselines(envs, seed).items()]
        for place, (name, make, stage) in enumerate(makers):
            tell((number + place / len(makers)) / len(modes), f"{mode}: {name}")
            score = play(name, stage.envs, make(), seed, watch=stage.watch)
            scores[name] = (*scores.get(name, ()), score)
        yield Result(mode, np.array([len(house.rooms) for house in houses]), shortest, scores)
    tell(1.0, f"{len(houses)} houses")


class Stage:
    """The worlds that agents with the same eyes play in, and what watches them: made when first asked for."""

    def __init__(self, houses: Sequence[House], targets: str, eyes: Config, backend: str) -> None:
        """Worlds over these houses."""
        self.make = partial(make_worlds, houses, len(houses), targets, preset=eyes, backend=backend)

    @cached_property
    def envs(self) -> HouseVectorEnv:
        """An environment for each house."""
        return self.make()

    @cached_property
    def watch(self) -> Lookout:
        """What notes how much is looked at."""
        return Lookout(self.envs)


EYES = {"default": DEFAULT, "paper": replace(DEFAULT, first_ray=PAPER.first_ray, sees_angle=PAPER.sees_angle)}
"""By the world that an agent learnt in, the world that it is measured in."""
