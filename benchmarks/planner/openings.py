"""``vitruvius bench openings``: do agents search as well through openings as through doors?

All play the same episodes in the same houses twice: as they are, and with each opening narrowed to a door in
its middle. Houses differ in nothing else, so the paired difference is what openings change.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from msgspec import structs

from agent.evaluation.protocol import measure
from agent.evaluation.statistics import interquartile_mean, paired_difference
from agent.learning.config import TargetMode
from agent.runs import checkpoint
from agent.runs.released import located
from benchmarks.common.processes import say
from logic import House, load
from logic.errors import RequestError
from logic.house.parts import Door

DOOR = 0.8
"""Metres: how wide a door is that takes the place of an opening."""

HEAD = """\
| agent | with openings | with doors | difference |
|---|---|---|---|"""


@dataclass(frozen=True)
class Openings:
    """What openings in the place of doors change for agents that search, paired."""

    houses: Path
    """A file of houses, some of which have openings (`opening/2`); the others are passed over."""

    agents: tuple[str, ...] = ("map-completion",)
    """Released agents, or checkpoints, to play beside the planner alone and the searcher."""

    targets: TargetMode = "secondary"
    """Where targets lie."""

    episodes: int = 2
    """In each house."""

    def run(self) -> None:
        """Play, and print a table."""
        houses = [house for house in load(self.houses) if any(door.opening for door in house.doors)]
        if not houses:
            raise RequestError(f"houses: none of {self.houses} has an opening: see docs/plans.md")
        openings = sum(door.opening is True for each in houses for door in each.doors)
        say(f"{len(houses)} houses, {openings} openings")
        both = [self.ratios(each) for each in (houses, [narrowed(house) for house in houses])]
        print(HEAD)
        for name, opened in both[0].items():
            closed = both[1][name]
            found = (interquartile_mean(opened).text(3), interquartile_mean(closed).text(3))
            difference = paired_difference(opened, closed).signed(3)
            print(f"| {name} | {found[0]} | {found[1]} | {difference} |")

    def ratios(self, houses: Sequence[House]) -> dict[str, np.ndarray]:
        """(H,) targets as shares of the oracle's by agent, each the mean of a house's episodes."""
        agents = {name: [checkpoint.load(located(name))] for name in self.agents}
        baselines = ("explorer", "searcher", "oracle")
        [found] = measure(agents, houses, [self.targets], baselines=baselines, episodes=self.episodes)
        return {
            name: found.ratios(name)[0].reshape(self.episodes, -1).mean(axis=0)
            for name in found.policies
            if name != "oracle"
        }


def narrowed(house: House) -> House:
    """The same house with a door in the middle of each opening, no wider than it was."""
    return structs.replace(house, doors=tuple(map(_narrowed, house.doors)))


def _narrowed(door: Door) -> Door:
    if not door.opening or door.length <= DOOR:
        return door
    more = (door.length - DOOR) / 2
    if door.width > door.height:
        return structs.replace(door, x=door.x + more, width=DOOR, opening=False)
    return structs.replace(door, y=door.y + more, height=DOOR, opening=False)
