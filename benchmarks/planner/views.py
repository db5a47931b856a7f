"""Value of the parts of the network that chooses views: ``vitruvius bench views``.

Each variant learns from the same choices with the same number of updates. The choices are those of bodies
that the untrained network leads. Then the variant chooses views in other such choices, in houses of
validation seeds. The score is the chosen view's value in the true house, as a fraction of the best view's;
errors are over houses. Choices and networks are kept, so that a stopped study can continue, and any network
plays by ``vitruvius bench learning --agent runs/views/NETWORK.safetensors``. ``benchmarks.planner.changed``
has agents with a part changed in play alone.
"""

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np
import torch
from torch import Tensor

from benchmarks.common.houses import ROOMS, by_rooms, kept_houses
from benchmarks.common.pages import write_arrays, write_tables
from benchmarks.common.processes import say
from benchmarks.planner.explorers import SEED
from benchmarks.planner.learning import clustered
from vitruvius.agent.algorithms.search.chooser import best, by_parts
from vitruvius.agent.algorithms.search.config import SearchConfig
from vitruvius.agent.algorithms.search.learner import MIN_HELD_BATCHES, LearnedSearch
from vitruvius.agent.algorithms.search.network import ViewNetwork, cost, in_view, stands, unforeseen
from vitruvius.agent.algorithms.search.windows import FAR, LEVELS, PLACES, SCALE, ViewMaps, views
from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.banks import bank_hash
from vitruvius.agent.evaluation.tables import Table
from vitruvius.agent.learning.environments import make_envs
from vitruvius.agent.runs import checkpoint
from vitruvius.agent.runs.checkpoint import Checkpoint
from vitruvius.logic import House
from vitruvius.logic.errors import RequestError
from vitruvius.logic.spelling import unknown

AGENT = "search"

ELSEWHERE = 1e3
"""Distance in places to a start that is far away."""

NOTED = 0.35
"""Fraction of the choices that are recorded, because the choices of an episode are similar."""

TURNS = 20
"""Number of times that the learning rate falls."""

Change = Callable[[ViewMaps], ViewMaps]


def _zero(name: str) -> Change:
    return lambda maps: maps._replace(**{name: torch.zeros_like(getattr(maps, name))})


def _blind(maps: ViewMaps) -> ViewMaps:
    """Return the maps without predictions: unseen ground may be floor, as in play."""
    return maps._replace(foreseen=by_parts(unforeseen, maps))


def _at_once(maps: ViewMaps) -> ViewMaps:
    occupied, seen = maps.blocks % LEVELS, maps.blocks // LEVELS % LEVELS
    return maps._replace(blocks=occupied + LEVELS * seen + LEVELS**2 * seen)


def _half(maps: ViewMaps) -> ViewMaps:
    """Return the maps with windows of half as many places per side around the body."""
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
    "planes": _blind,
    "window": _half,
}
"""Maps without one input of the network: goals among views; places of finds; ages of observations;
observations since the last pick-up; start of the episode; time and number of finds; predictions (views still
show them); and the outer half of the window's sides."""


def _shown(maps: ViewMaps) -> ViewMaps:
    """Return maps with labels from the map and its predictions only: gain of views over cost."""
    shows = in_view(maps.shown.float()) * stands(maps)[:, None]
    worth = SCALE * shows / cost(maps.ways, ViewNetwork((1, 1)).turns[maps.heading])
    return maps._replace(worth=(worth * views(maps)).half())


LABELS: dict[str, Change] = {"truth": _shown}
"""Labels without one source: knowledge of the house that the map lacks."""

CONFIGS: dict[str, dict[str, Any]] = {
    "looks": {"looks": False},
    "foresight": {"foresight": False},
    "lowest": {"channels": (16, 32, 64)},
    "scales": {"channels": (16, 32)},
    "width": {"channels": (8, 16, 32, 48)},
    "narrowness": {"channels": (24, 48, 96, 144)},
    "choice": {"loss": "value"},
    "cooling": {"final_heat": 0.2},
}
"""Configs without one part: gains of views; predictions; the lowest scale; the two lowest; half of the
channels. Or with half as many more channels; with the loss of values instead of that of choices; and with
constant heat."""

PARTS = (*CONFIGS, *INPUTS, *LABELS)

WHOLE = "as it is"


@dataclass(frozen=True)
class Views:
    """Train networks that value views with and without each part, from the same choices."""

    without: tuple[str, ...] = PARTS
    """Parts that are left out, one at a time."""

    houses: int = 60
    """Number of training houses of each number of rooms, 2 to 6; a third as many serve for evaluation."""

    choices: int = 6000
    """Number of choices for training; a sixth as many serve for evaluation."""

    updates: int = 800
    """Number of updates of each network."""

    seeds: int = 3
    """Number of complete networks, with different first weights and orders of training."""

    out: Path = Path("runs/views")
    """Folder for houses, choices, networks and views.md."""

    replace: bool = False
    """Write into the folder even if it holds other files."""

    def run(self) -> None:
        """Collect choices, train, and print the table."""
        config = cast(SearchConfig, PRESETS[AGENT])
        least = MIN_HELD_BATCHES * config.batch_size
        if self.houses < 3 or self.choices < least or min(self.updates, self.seeds) < 1:
            raise RequestError(
                f"--houses must be 3 or more, --choices {least} or more, --updates and --seeds 1 or more"
            )
        for part in self.without:
            if part not in PARTS:
                raise RequestError(f"--without: {unknown('part', part, PARTS)}")
        torch.set_num_threads(1)
        known, asked = (
            kept_houses(self.out / f"{what}-{count}.jsonl", lambda n=count, s=seed: by_rooms(ROOMS, n, s))
            for what, count, seed in (("learn", self.houses, 100), ("ask", self.houses // 3, SEED))
        )
        learnt = self.collected("learn", known, replace(config, buffer_size=self.choices))
        held = self.collected("ask", asked, replace(config, buffer_size=self.choices // 6, seed=1))
        first = shares(LearnedSearch.network_of(config), held.maps)
        rows = [("untrained", "", f"{first.mean():.3f}", "", "")]
        whole = np.zeros(0)
        for name, part, variant in [
            *((f"{WHOLE}, seed {seed}", WHOLE, replace(config, seed=seed)) for seed in range(self.seeds)),
            *((f"without {part}", part, replace(config, **CONFIGS.get(part, {}))) for part in self.without),
        ]:
            network = self.trained(part, variant, known[:1], learnt)
            share = shares(network, without(part, variant, held))
            weights = sum(each.numel() for each in network.parameters() if each.requires_grad)
            less = clustered(share - whole, held.house) if len(whole) else ""
            whole = whole if len(whole) else share
            rows.append(
                (name, f"{weights:,}", f"{share.mean():.3f}", clustered(share - first, held.house), less)
            )
            say(" | ".join(rows[-1]))
        title = (
            f"Worth of the chosen view, of the best one's; {self.choices:,} choices, {self.updates} updates"
        )
        headings = "network", "weights", "share", "gain over untrained", "gain over seed 0"
        write_tables([Table(title, headings, rows)], self.out / "views.md")

    def collected(self, what: str, houses: list[House], config: SearchConfig) -> "ViewChoices":
        """Return choices in these houses, as many as the config's buffer holds, from a file if it exists."""
        path = self.path(what, bank_hash(houses), config).with_suffix(".npz")
        if not path.exists():
            made = collected(houses, config)
            fields = {name: field.numpy() for name, field in made.maps._asdict().items()}
            write_arrays(path, blind=made.blind.numpy(), house=made.house, **fields)
        kept = np.load(path)
        maps = ViewMaps(**{name: torch.from_numpy(kept[name]) for name in ViewMaps._fields})
        return ViewChoices(maps, torch.from_numpy(kept["blind"]), kept["house"])

    def trained(
        self, part: str, config: SearchConfig, houses: list[House], choices: "ViewChoices"
    ) -> ViewNetwork:
        """Return a network without a part that has learnt from choices, from a file if it exists."""
        path = self.path(
            f"{part.replace(' ', '-')}-{config.seed}", config, self.choices, self.houses, self.updates
        )
        path = path.with_suffix(".safetensors")
        if not path.exists():
            given = LABELS.get(part, lambda maps: maps)(without(part, config, choices))
            network = fitted(config, houses, given, self.updates)
            checkpoint.save(Checkpoint(network, config, 0, AGENT), path)
        return cast(ViewNetwork, checkpoint.load(path).network)

    def path(self, what: str, *known: Any) -> Path:
        """Return the file, without suffix, of a result that depends on ``known``."""
        return self.out / f"{what}-{hashlib.sha256(repr(known).encode()).hexdigest()[:16]}"


class ViewChoices(NamedTuple):
    """Choices of views."""

    maps: ViewMaps
    """Maps with the values of views (n, ...)."""

    blind: Tensor
    """(n, 8, G, G) float16: gains of views without predictions."""

    house: np.ndarray
    """(n,) int: house of each choice."""


def without(part: str, config: SearchConfig, choices: ViewChoices) -> ViewMaps:
    """Return the maps for a variant."""
    maps = choices.maps if config.foresight else _blind(choices.maps._replace(shown=choices.blind))
    return INPUTS[part](maps) if part in INPUTS else maps


class Collector(LearnedSearch):
    """Learner that learns nothing, but records some of the choices of an untrained network."""

    def choose(self, environments: np.ndarray, maps: ViewMaps) -> Tensor:
        """Return the network's views, and record some of the choices."""
        some = np.flatnonzero(self.random.random(len(environments)) < NOTED)
        if len(some):
            given, before = environments[some], self.made
            noted = ViewMaps(*(field[some] for field in maps))
            blind = self.reader.looks(_blind(maps))[some]
            worth = self.truth.read(given, self.reader.corners(given)) * views(noted)
            valid = ~torch.from_numpy(self.truth.known(given)) & (worth.flatten(1).amax(1) > 0)
            self.note(noted._replace(worth=worth.half()), valid.clone())
            at = (before + np.arange(self.made - before)) % self.config.buffer_size
            self.blind[at] = blind[valid]
            self.house[at] = self.envs.unwrapped.world.describe()[2][given[valid.numpy()]]
        return self.chooser.greedy(environments, maps)

    def learn(self) -> float:
        """Learn nothing."""
        return 0.0

    def collect(self) -> None:
        """Play until the buffer is full."""
        self.house = np.zeros(self.config.buffer_size, int)
        self.blind = torch.zeros_like(self.buffer.shown)
        while self.made < self.config.buffer_size:
            self.iterate()


def collected(houses: Sequence[House], config: SearchConfig) -> ViewChoices:
    """Return choices in houses, as many as the config's buffer holds."""
    config = replace(config, num_envs=len(houses))
    collector = Collector(config, make_envs(houses, len(houses), config.targets))
    collector.collect()
    return ViewChoices(collector.buffer, collector.blind, collector.house)


def fitted(config: SearchConfig, houses: Sequence[House], choices: ViewMaps, updates: int) -> ViewNetwork:
    """Return a network that learns from choices; it does not play."""
    config = replace(config, num_envs=1, buffer_size=len(choices.blocks), steps=TURNS)
    learner = LearnedSearch(config, make_envs(houses, 1, config.targets))
    learner.buffer, learner.made = choices, len(choices.blocks)
    for turn in range(TURNS):
        learner.steps = turn
        learner.due = updates // TURNS + (turn < updates % TURNS)
        learner.learn()
    return learner.network


def shares(network: ViewNetwork, choices: ViewMaps) -> np.ndarray:
    """Return the values of the views (n,) that a network chooses, as fractions of the best values."""
    found = []
    with torch.inference_mode():
        for part in zip(*(field.split(16) for field in choices), strict=True):
            maps = ViewMaps(*part)
            worth = maps.worth.float().flatten(1)
            chosen = best(network(maps), maps)[:, None]
            found.append(worth.gather(1, chosen)[:, 0] / worth.amax(1))
    return torch.cat(found).numpy()
