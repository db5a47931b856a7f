"""What the parts of the network that searches are worth: ``vitruvius bench views``, in two ways.

Trained again: each variant learns from the same choices, of bodies that mostly go to the true best views, by
as many updates, and is asked in houses of validation seeds which view it would choose. The score is what that
view is worth in the true house, as a share of the best one; errors are over houses.

As it plays: the released network with a part taken away, for ``vitruvius bench learning --agent
benchmarks.planner.views:without_memory``. Nothing is trained again, so a part that others could stand in for
may show as more than it is worth.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast

import numpy as np
import torch
from torch import Tensor, nn

from agent.algorithms.build import policy_of
from agent.algorithms.search.chooser import ViewChooser, best
from agent.algorithms.search.config import SearchConfig
from agent.algorithms.search.learner import LearnedSearch
from agent.algorithms.search.network import LEVELS, ViewMaps, ViewNetwork, views
from agent.algorithms.table import PRESETS
from agent.evaluation.tables import Table
from agent.learning.environments import make_envs
from agent.policies.policies import Explorer
from agent.runs import checkpoint
from benchmarks.common.houses import ROOMS, by_rooms, kept_houses
from benchmarks.common.pages import write_tables
from benchmarks.common.processes import say
from benchmarks.planner.contenders import Maker, Shuffled
from benchmarks.planner.explorers import SEED
from benchmarks.planner.learning import clustered
from logic import House
from logic.errors import RequestError
from logic.spelling import unknown
from sim import HouseVectorEnv

AGENT = "search"

ELSEWHERE = 1e3
"""Places to a start that is nowhere near."""

POWER = 8
"""Of what a view is worth: how often it is gone to, where choices are collected."""

TURNS = 20
"""Times that the learning rate falls."""

Change = Callable[[ViewMaps], ViewMaps]


def _zero(name: str) -> Change:
    return lambda maps: maps._replace(**{name: torch.zeros_like(getattr(maps, name))})


def _at_once(maps: ViewMaps) -> ViewMaps:
    occupied, seen = maps.blocks % LEVELS, maps.blocks // LEVELS % LEVELS
    return maps._replace(blocks=occupied + LEVELS * seen + LEVELS**2 * seen)


INPUTS: dict[str, Change] = {
    "memory": _zero("taken"),
    "finds": _zero("finds"),
    "ages": _zero("ages"),
    "since": _at_once,
    "start": lambda maps: maps._replace(start=torch.full_like(maps.start, ELSEWHERE)),
    "scalars": _zero("scalars"),
}
"""Maps without one thing that the network reads: which views were goals, where targets were found, how long
ago what was seen, whether since the last pick-up, where the episode began, and time and number of finds."""

CONFIGS: dict[str, dict[str, Any]] = {
    "rays": {"rays": 0},
    "foresight": {"foresight": False},
    "rays-foresight": {"rays": 0, "foresight": False},
    "lowest": {"channels": (16, 32, 64)},
    "width": {"channels": (8, 16, 32, 48)},
    "focus": {"focus": 0.0},
}
"""Configs without one thing: the scale of the lowest level, half of the channels, the weights of the loss."""

WHOLE = "as it is"


@dataclass(frozen=True)
class Views:
    """Train networks that value views with and without each part, from the same choices."""

    without: tuple[str, ...] = (*CONFIGS, *INPUTS)
    """Parts that are left out, one at a time."""

    houses: int = 20
    """Houses of each number of rooms, 2 to 6, to learn in, and half as many to be asked in."""

    choices: int = 6000
    """To learn from, and a sixth of it to be asked about."""

    updates: int = 500
    """Of each network."""

    out: Path = Path("runs/views")
    """Folder for houses and views.md."""

    replace: bool = False
    """Write into the folder whatever else it holds."""

    def run(self) -> None:
        """Collect choices, train, and print the table."""
        if self.houses < 2 or min(self.choices // 6, self.updates) < 1:
            raise RequestError("--houses must be 2 or more, --choices 6 or more, --updates 1 or more")
        for part in self.without:
            if part not in {**CONFIGS, **INPUTS}:
                raise RequestError(f"--without: {unknown('part', part, [*CONFIGS, *INPUTS])}")
        torch.set_num_threads(1)
        config = cast(SearchConfig, PRESETS[AGENT])
        known, asked = (
            kept_houses(self.out / f"{what}-{count}.jsonl", lambda n=count, s=seed: by_rooms(ROOMS, n, s))
            for what, count, seed in (("learn", self.houses, 100), ("ask", self.houses // 2, SEED))
        )
        learnt, _ = collected(known, replace(config, buffer_size=self.choices))
        held, house = collected(asked, replace(config, buffer_size=self.choices // 6, seed=1))
        rows, whole = [], np.zeros(0)
        for part in (WHOLE, *self.without):
            change = INPUTS.get(part, lambda maps: maps)
            variant = replace(config, **CONFIGS.get(part, {}))
            network = fitted(variant, known[:1], change(learnt), self.updates)
            share = shares(network, change(held))
            whole = whole if len(whole) else share
            name = part if part == WHOLE else f"without {part}"
            rows.append((
                name, f"{sum(each.numel() for each in network.parameters() if each.requires_grad):,}",
                f"{share.mean():.3f}", clustered(share - whole, house) if part != WHOLE else "",
            ))  # fmt: skip
            say(f"{name}: {share.mean():.3f}")
        title = (
            f"Worth of the chosen view, of the best one's; {self.choices:,} choices, {self.updates} updates"
        )
        write_tables(
            [Table(title, ("network", "weights", "share", "difference"), rows)], self.out / "views.md"
        )


class Collector(LearnedSearch):
    """Learns nothing, but notes choices: of bodies that go to views by what these are worth."""

    def choose(self, environments: np.ndarray, maps: ViewMaps) -> Tensor:
        """A view at random, in proportion to its worth to the power ``POWER``; all are noted."""
        worth = self.truth.read(environments, self.reader.corners(environments)) * views(maps)
        before = self.made
        valid = ~torch.from_numpy(self.truth.known(environments)) & (worth.flatten(1).amax(1) > 0)
        self.note(maps._replace(worth=worth.half()), valid.clone())
        at = (before + np.arange(self.made - before)) % self.config.buffer_size
        self.house[at] = self.envs.unwrapped.world.describe()[2][environments[valid.numpy()]]
        noise = -torch.from_numpy(self.random.exponential(size=worth.shape)).float().log()
        drawn = POWER * worth.clamp(min=1e-6).log() + noise
        return best(torch.where(views(maps), drawn, -torch.inf), maps)

    def learn(self) -> float:
        """Nothing."""
        return 0.0

    def collect(self) -> None:
        """Play until the buffer is full."""
        self.house = np.zeros(self.config.buffer_size, int)
        while self.made < self.config.buffer_size:
            self.iterate()


def collected(houses: list[House], config: SearchConfig) -> tuple[ViewMaps, np.ndarray]:
    """Choices, as many as the buffer has, with what views are worth; and the houses (n,) int that they were
    made in.
    """
    small = replace(config, channels=(1, 1), rays=0, foresight=False)
    collector = Collector(small, make_envs(houses, config.num_envs, config.targets))
    collector.collect()
    return collector.buffer, collector.house


def fitted(config: SearchConfig, houses: list[House], choices: ViewMaps, updates: int) -> ViewNetwork:
    """A network that learns from choices; it plays nowhere."""
    config = replace(config, num_envs=1, buffer_size=len(choices.blocks), steps=TURNS)
    learner = LearnedSearch(config, make_envs(houses, 1, config.targets))
    learner.buffer, learner.made = choices, len(choices.blocks)
    for turn in range(TURNS):
        learner.steps = turn
        learner.due = updates // TURNS + (turn < updates % TURNS)
        learner.learn()
    return learner.network


def shares(network: ViewNetwork, choices: ViewMaps) -> np.ndarray:
    """What the views (n,) that a network would choose are worth, as shares of the best ones."""
    found = []
    with torch.inference_mode():
        for part in zip(*(field.split(16) for field in choices), strict=True):
            maps = ViewMaps(*part)
            worth = maps.worth.float().flatten(1)
            chosen = best(network(maps), maps)[:, None]
            found.append(worth.gather(1, chosen)[:, 0] / worth.amax(1))
    return torch.cat(found).numpy()


def _without(part: str) -> Maker:
    """The released agent without an input as it plays."""

    def make(envs: HouseVectorEnv) -> Explorer:
        policy, chooser, _ = _released(envs)
        change = INPUTS[part]
        chooser.picks = lambda _, maps: best(chooser.values(change(maps)), change(maps))
        return policy

    return make


without_memory, without_finds, without_ages = _without("memory"), _without("finds"), _without("ages")
without_since, without_start, without_scalars = _without("since"), _without("start"), _without("scalars")


def without_rays(envs: HouseVectorEnv) -> Explorer:
    """The released agent, whose learnt rays show nothing."""
    policy, _, network = _released(envs)
    network.sight.register_forward_hook(lambda *each: torch.zeros_like(each[-1]))
    return policy


def foresight_elsewhere(envs: HouseVectorEnv) -> Explorer:
    """The released agent, who gets what is foreseen on another map, mostly of another house."""
    policy, _, network = _released(envs)
    network.completion = _Elsewhere(network.completion)
    return policy


class _Elsewhere(nn.Module):
    """What a network predicts of another row of a batch."""

    def __init__(self, network: nn.Module) -> None:
        super().__init__()
        self.network, self.shuffled = network, Shuffled(network)

    def forward(self, *given: Tensor) -> Any:
        """See ``Shuffled``."""
        return self.shuffled(*given)


def _released(envs: HouseVectorEnv) -> tuple[Explorer, ViewChooser, Any]:
    """The released agent's policy, its chooser and its network."""
    made = checkpoint.load(AGENT)
    policy = cast(Explorer, policy_of(made.network, made.config, envs))
    chooser = cast(ViewChooser, policy.tracker.chooser)
    return policy, chooser, chooser.network
