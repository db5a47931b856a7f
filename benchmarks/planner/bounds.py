"""Limits of a network that chooses views: ``vitruvius bench bounds``.

In choices of bodies that the released network leads, views are chosen by gain over cost, with one part after
the other taken from the true house. The score is the chosen view's value in the true house, as a fraction of
the best view to which a path is known.
"""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import cast

import numpy as np
import torch
from torch import Tensor

from benchmarks.common.houses import ROOMS, by_rooms, kept_houses
from benchmarks.common.pages import write_arrays, write_tables
from benchmarks.planner.explorers import SEED
from benchmarks.planner.learning import clustered
from benchmarks.planner.views import AGENT, INPUTS
from vitruvius.agent.algorithms.map_completion.truth import Truth
from vitruvius.agent.algorithms.search.chooser import best, by_parts
from vitruvius.agent.algorithms.search.config import SearchConfig
from vitruvius.agent.algorithms.search.learner import LearnedSearch
from vitruvius.agent.algorithms.search.network import (
    MIN_SHOWN,
    PASSES,
    SIZES,
    TARGET_BLOCKS,
    TARGETS,
    cost,
    hides,
    in_view,
    stands,
    unforeseen,
)
from vitruvius.agent.algorithms.search.windows import PLACES, SCALE, ViewMaps, views
from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.baselines.posterior import SPOT, SPOTS
from vitruvius.agent.evaluation.tables import Table
from vitruvius.agent.learning.environments import make_envs
from vitruvius.agent.planner.core.frame import AXES
from vitruvius.agent.runs import checkpoint
from vitruvius.logic.errors import RequestError
from vitruvius.sim import HouseVectorEnv

NOTED = 0.3
"""Fraction of the choices that are judged, because the choices of an episode are similar."""

LATE = 1 / 3
"""Fraction of an episode after which its choices count as late, when most of the house was seen."""


@dataclass(frozen=True)
class Bounds:
    """Choose views with parts of the truth, and report their values."""

    houses: int = 12
    """Number of houses of each number of rooms, 2 to 6, of validation seeds."""

    choices: int = 1100
    """Number of choices that are judged: the first ones, from the beginning of an episode in each house."""

    out: Path = Path("runs/bounds")
    """Folder for houses and bounds.md."""

    replace: bool = False
    """Write into the folder even if it holds other files."""

    def run(self) -> None:
        """Play, judge, and print the table."""
        if min(self.houses, self.choices) < 1:
            raise RequestError("--houses and --choices must be 1 or more")
        torch.set_num_threads(1)
        path = self.out / f"ask-{self.houses}.jsonl"
        houses = kept_houses(path, lambda: by_rooms(ROOMS, self.houses, SEED))
        config = replace(
            cast(SearchConfig, PRESETS[AGENT]), num_envs=len(houses), buffer_size=1, restarts=0.0
        )
        judge = Judge(config, make_envs(houses, len(houses), config.targets))
        judge.network.load_state_dict(checkpoint.load(AGENT).network.state_dict())
        while sum(map(len, judge.house)) < self.choices:
            judge.iterate()
        house, time = np.concatenate(judge.house), np.concatenate(judge.time)
        found = {name: np.concatenate(each) for name, each in judge.found.items()}
        write_arrays(self.out / "bounds.npz", house=house, time=time, **found)
        first, late, rows = next(iter(found.values())), time > LATE, []
        for name, each in found.items():
            parts = (f"{each[part].mean():.3f}" if part.any() else "-" for part in (~late, late))
            rows.append((name, f"{each.mean():.3f}", *parts, clustered(each - first, house)))
        title = f"Worth of the chosen view, of the best one's; {len(house):,} choices, {late.sum():,} late"
        headings = "views are chosen by", "all", "early", "late", "less the first"
        write_tables([Table(title, headings, rows)], self.out / "bounds.md")


class Judge(LearnedSearch):
    """Learner that learns nothing, and judges some of the choices of a network."""

    def __init__(self, config: SearchConfig, envs: HouseVectorEnv) -> None:
        super().__init__(config, envs)
        self.known = Truth(envs, (), self.tracker.planner.cell)
        self.new = LearnedSearch.network_of(config)
        self.house: list[np.ndarray] = []
        self.time: list[np.ndarray] = []
        self.found: dict[str, list[np.ndarray]] = {}

    def act(self) -> Tensor:
        """Act as ``LearnedSearch``, and record the starts of new maps."""
        self.known.begin(np.flatnonzero(self.tracker.fresh.numpy()))
        return super().act()

    def learn(self) -> float:
        """Learn nothing."""
        return 0.0

    def choose(self, environments: np.ndarray, maps: ViewMaps) -> Tensor:
        """Return the network's views, and judge some of the choices."""
        worth = self.truth.read(environments, self.reader.corners(environments)).clone() * views(maps)
        most = worth.flatten(1).amax(1)
        kept = ~torch.from_numpy(self.truth.known(environments)) & (most > 0)
        kept &= torch.from_numpy(self.random.random(len(environments)) < NOTED)
        if kept.any():
            for name, values in self.variants(environments, maps, worth).items():
                picks = best(values.masked_fill(~views(maps), -torch.inf), maps).clamp(min=0)[:, None]
                share = worth.flatten(1).gather(1, picks)[:, 0] / most
                self.found.setdefault(name, []).append(share[kept].numpy())
            houses = self.envs.unwrapped.world.describe()[2]
            self.house.append(houses[environments[kept.numpy()]])
            self.time.append(maps.scalars[kept, 0].numpy())
        return self.chooser.greedy(environments, maps)

    def variants(self, environments: np.ndarray, maps: ViewMaps, worth: Tensor) -> dict[str, Tensor]:
        """Return values (n, 8, G, G) of views, by name."""
        look, turns = self.reader.looks, self.new.turns[maps.heading]
        corners = self.reader.corners(environments)
        house = self.known.read(environments, (corners - 1) / 2)
        spent = torch.from_numpy(self.truth.views.costs(len(environments)).copy())
        true_shows = torch.where(spent > 0, worth * spent / SCALE, 0.0)
        true_cost = torch.where(spent > 0, spent, torch.inf)
        sight = torch.from_numpy(house.solid == 0).float()
        prior = TARGET_BLOCKS * torch.from_numpy(house.target) * hides(maps)
        left = self.left(environments, corners)
        known, floor = cost(maps.ways, turns), stands(maps)[:, None]

        def shows(targets: Tensor, sight: Tensor | None = None) -> Tensor:
            planes = maps.foreseen.clone()
            planes[:, TARGETS] = (targets.clamp(max=4) * SIZES[TARGETS]).round()
            if sight is not None:
                planes[:, PASSES] = (sight * SIZES[PASSES]).round()
            return in_view(look(maps._replace(foreseen=planes)).float())

        def by(shows: Tensor, cost: Tensor) -> Tensor:
            return (shows + MIN_SHOWN).log() - cost.log()

        blind = in_view(look(maps._replace(foreseen=unforeseen(maps))).float())
        return {
            "untrained": by_parts(self.new, maps),
            "untrained, who foresees nothing": by(blind, known),
            "released": self.chooser.values(maps),
            **{f"released, without {part}": self.chooser.values(INPUTS[part](maps)) for part in INPUTS},
            "untrained, and where targets can lie": by(shows(prior) * floor, known),
            "and how far sight goes": by(shows(prior, sight) * floor, known),
            "and where the target may still lie": by(shows(left, sight) * floor, known),
            "and the true paths": by(shows(left, sight), true_cost),
            "what views show in truth, known paths": by(true_shows - MIN_SHOWN * (true_shows <= 0), known),
        }

    def left(self, environments: np.ndarray, corners: np.ndarray) -> Tensor:
        """Return the density of the exact posterior over targets' places, in blocks (n, 2G, 2G) float32."""
        truth, houses = self.truth, self.envs.unwrapped.world.describe()[2]
        arrays = truth.views.arrays
        rows, spots = arrays["rows"].numpy(), arrays["spots"].numpy().reshape(-1, 2)
        words = arrays["left"].numpy().reshape(self.envs.num_envs, -1)
        dense = np.zeros((len(environments), 2 * PLACES, 2 * PLACES), np.float32)
        for n, e in enumerate(environments):
            row = rows[houses[e]]
            still = np.unpackbits(words[e].view(np.uint8), bitorder="little")[: row[SPOTS]] > 0
            places = spots[row[SPOT] : row[SPOT] + row[SPOTS]][still]
            nodes = (places - truth.start[e]) @ AXES[truth.quarter[e]].T / truth.steps  # east and south
            blocks = ((np.floor(nodes[:, ::-1]) - corners[n] + 2) // 2).astype(int)
            blocks = blocks[((blocks >= 0) & (blocks < 2 * PLACES)).all(1)]
            np.add.at(dense[n], tuple(blocks.T), TARGET_BLOCKS / max(1, len(places)))
        return torch.from_numpy(dense)
