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
from agent.algorithms.search.network import CONSTANT, ViewNetwork, in_view, unforeseen
from agent.algorithms.search.windows import FAR, LEVELS, PLACES, SCALE, ViewMaps, views
from agent.algorithms.table import PRESETS
from agent.evaluation.tables import Table
from agent.learning.environments import make_envs, shield
from agent.planner import TUNED
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


def _half(maps: ViewMaps) -> ViewMaps:
    """Windows of half as many places a side about the body."""
    inner = torch.zeros(PLACES, PLACES, dtype=torch.bool)
    inner[PLACES // 4 : -PLACES // 4, PLACES // 4 : -PLACES // 4] = True
    blocks = inner.repeat_interleave(2, 0).repeat_interleave(2, 1)
    return maps._replace(
        ways=torch.where(inner, maps.ways, FAR),
        blocks=maps.blocks * blocks, ages=maps.ages * blocks, foreseen=maps.foreseen * blocks,
        finds=maps.finds * inner, taken=maps.taken * inner,
    )  # fmt: skip


INPUTS: dict[str, Change] = {
    "memory": _zero("taken"),
    "finds": _zero("finds"),
    "ages": _zero("ages"),
    "since": _at_once,
    "start": lambda maps: maps._replace(start=torch.full_like(maps.start, ELSEWHERE)),
    "scalars": _zero("scalars"),
    "window": _half,
}
"""Maps without one thing that the network reads: which views were goals, where targets were found, how long
ago what was seen, whether since the last pick-up, where the episode began, time and number of finds, and what
lies in the outer half of the window's sides."""


def _shown(maps: ViewMaps) -> ViewMaps:
    """Labels of who knows the map alone: what views would show for what they cost."""
    turns = ViewNetwork((1, 1)).turns[maps.heading]
    cost = maps.ways.clamp(min=0)[:, None].float() + CONSTANT + turns
    return maps._replace(worth=(SCALE * in_view(maps.shown.float()) / cost * views(maps)).half())


LABELS: dict[str, Change] = {"truth": _shown}
"""Labels without one thing: what the house tells and the map does not."""

CONFIGS: dict[str, dict[str, Any]] = {
    "looks": {"looks": False},
    "foresight": {"foresight": False},
    "looks-foresight": {"looks": False, "foresight": False},
    "lowest": {"channels": (16, 32, 64)},
    "scales": {"channels": (16, 32)},
    "width": {"channels": (8, 16, 32, 48)},
    "focus": {"focus": 0.0},
}
"""Configs without one thing: what views show, what is foreseen, both, the lowest scale, the two lowest, half
of the channels, the weights of the loss."""

PARTS = (*CONFIGS, *INPUTS, *LABELS)

WHOLE = "as it is"


@dataclass(frozen=True)
class Views:
    """Train networks that value views with and without each part, from the same choices."""

    without: tuple[str, ...] = PARTS
    """Parts that are left out, one at a time."""

    houses: int = 20
    """Houses of each number of rooms, 2 to 6, to learn in, and half as many to be asked in."""

    choices: int = 6000
    """To learn from, and a sixth of it to be asked about."""

    updates: int = 500
    """Of each network."""

    seeds: int = 3
    """Networks of which nothing is left out, that begin with other weights and learn in another order."""

    out: Path = Path("runs/views")
    """Folder for houses and views.md."""

    replace: bool = False
    """Write into the folder whatever else it holds."""

    def run(self) -> None:
        """Collect choices, train, and print the table."""
        if self.houses < 2 or min(self.choices // 6, self.updates, self.seeds) < 1:
            raise RequestError(
                "--houses must be 2 or more, --choices 6 or more, --updates and --seeds 1 or more"
            )
        for part in self.without:
            if part not in PARTS:
                raise RequestError(f"--without: {unknown('part', part, PARTS)}")
        torch.set_num_threads(1)
        config = cast(SearchConfig, PRESETS[AGENT])
        known, asked = (
            kept_houses(self.out / f"{what}-{count}.jsonl", lambda n=count, s=seed: by_rooms(ROOMS, n, s))
            for what, count, seed in (("learn", self.houses, 100), ("ask", self.houses // 2, SEED))
        )
        learnt, blind, _ = collected(known, replace(config, buffer_size=self.choices))
        held, held_blind, house = collected(asked, replace(config, buffer_size=self.choices // 6, seed=1))
        rows, whole = [], np.zeros(0)
        for seed, part in [
            *((seed, WHOLE) for seed in range(self.seeds)),
            *((0, part) for part in self.without),
        ]:
            change, label = (changes.get(part, lambda maps: maps) for changes in (INPUTS, LABELS))
            variant = replace(config, seed=seed, **CONFIGS.get(part, {}))
            given, asked_about = (
                change(maps if variant.foresight else maps._replace(shown=shown))
                for maps, shown in ((learnt, blind), (held, held_blind))
            )
            network = fitted(variant, known[:1], label(given), self.updates)
            share = shares(network, asked_about)
            whole = whole if len(whole) else share
            name = f"{part}, seed {seed}" if part == WHOLE else f"without {part}"
            rows.append((
                name, f"{sum(each.numel() for each in network.parameters() if each.requires_grad):,}",
                f"{share.mean():.3f}", clustered(share - whole, house) if rows else "",
            ))  # fmt: skip
            say(f"{name}: {share.mean():.3f}")
        untrained = shares(ViewNetwork(config.channels, config.foresight, config.looks), held)
        rows.append(("untrained", "", f"{untrained.mean():.3f}", clustered(untrained - whole, house)))
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
        self.blind[at] = self.reader.looks(maps._replace(foreseen=unforeseen(maps)))[valid]
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
        self.blind = torch.zeros_like(self.buffer.shown)
        while self.made < self.config.buffer_size:
            self.iterate()


def collected(houses: list[House], config: SearchConfig) -> tuple[ViewMaps, Tensor, np.ndarray]:
    """Choices, as many as the buffer has, with what views are worth; what views would show (n, 8, G, G) to
    who foresees nothing; and the houses (n,) int that choices were made in.
    """
    small = replace(config, channels=(1, 1))
    collector = Collector(small, make_envs(houses, config.num_envs, config.targets))
    collector.collect()
    return collector.buffer, collector.blind, collector.house


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
without_window = _without("window")


def untrained(envs: HouseVectorEnv) -> Explorer:
    """The body led by a network that has learnt nothing, with the first weights of a preset's run."""
    config = cast(SearchConfig, PRESETS[AGENT])
    return cast(Explorer, policy_of(LearnedSearch.network_of(config), config, envs))


def again_after(steps: int) -> Maker:
    """The released agent, which chooses again after some steps though it is not there, in place of 32."""

    def make(envs: HouseVectorEnv) -> Explorer:
        chooser = ViewChooser(checkpoint.load(AGENT).network, envs.config)
        return Explorer(shield(envs), envs.config, replace(TUNED, replan_interval=steps), chooser=chooser)

    return make


often, seldom = again_after(12), again_after(128)


def without_looks(envs: HouseVectorEnv) -> Explorer:
    """The released agent, whom no view shows anything."""
    policy, chooser, _ = _released(envs)
    look = chooser.look

    def blind(environments: np.ndarray, maps: ViewMaps) -> ViewMaps:
        seen = look(environments, maps)
        return seen._replace(shown=torch.zeros_like(seen.shown))

    chooser.look = blind
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
