"""Training of search: a network plays, and learns the worth of each view where it chose one."""

from typing import Any

import numpy as np
import torch
from torch import Tensor

from vitruvius.agent.algorithms.search.chooser import ViewChooser, best
from vitruvius.agent.algorithms.search.config import SearchConfig
from vitruvius.agent.algorithms.search.crop import by_size
from vitruvius.agent.algorithms.search.network import ViewNetwork
from vitruvius.agent.algorithms.search.values import TrueValues
from vitruvius.agent.algorithms.search.windows import ViewMaps, empty, gone_to, turned, views
from vitruvius.agent.learning.environments import require_own_maps, shield
from vitruvius.agent.learning.map_learner import MapLearner
from vitruvius.agent.policies.network import seeded
from vitruvius.agent.policies.policies import Explorer
from vitruvius.logic.errors import RequestError
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.config import DEFAULT

UPDATES_TOGETHER = 4
"""Number of updates whose choices are drawn together."""

MIN_HELD_BATCHES = 4
"""Number of batches of choices that must be stored before training starts."""

MIN_VIEW_WEIGHT = 0.02
"""Least weight of a view in the loss."""

MAX_LOG_VALUE = 4.0
"""Logarithm of values above which the loss is linear."""


class LearnedSearch(MapLearner):
    """Run of a network that searches.

    In each turn the network leads explorers, and its choices go into a buffer. Then the network learns from
    random choices of the buffer.
    """

    config: SearchConfig
    network: ViewNetwork

    @staticmethod
    def network_of(config: SearchConfig) -> ViewNetwork:
        """Return a new network: see ``Learner``."""
        with seeded(config.seed):
            return ViewNetwork(config.channels, config.foresight, config.looks)

    @staticmethod
    def policy_of(
        network: ViewNetwork, config: SearchConfig, envs: HouseVectorEnv, seed: int = 0
    ) -> Explorer:
        """Return an explorer that is led by the network."""
        require_own_maps(config, envs)
        return Explorer(shield(envs), envs.config, chooser=ViewChooser(network, envs.config))

    def __init__(self, config: SearchConfig, envs: HouseVectorEnv) -> None:
        """Begin a run; ``envs`` has NEXT_STEP autoreset.

        Raises ``RequestError`` for closed doors, and for a body other than the default one.
        """
        if envs.config.closed_doors:
            raise RequestError("search needs open doorways: leave out --sim closed_doors")
        if (max(envs.config.body), envs.config.step) != (max(DEFAULT.body), DEFAULT.step):
            raise RequestError(
                f"search is trained only on maps of the default robot, {max(DEFAULT.body):.3f} m wide, with "
                f"steps of {DEFAULT.step:.3f} m"
            )
        super().__init__(config, envs)
        self.reader = self.chooser.reader_of(self.tracker.planner)
        self.truth = TrueValues(envs, self.tracker.planner)
        # Full size from the start: a state whose size grew could not be read again.
        self.buffer = empty(config.buffer_size)
        self.made, self.due = 0, 0.0
        self.rows = torch.zeros(0, config.batch_size, dtype=torch.int64)
        self.reset_envs()

    def explorer_of(self) -> Explorer:
        """Return an explorer that is led by choices that are noted."""
        self.chooser = ViewChooser(self.network, self.envs.config, self.choose)
        return Explorer(self.avoidance, self.envs.config, chooser=self.chooser)

    @property
    def epsilon(self) -> float:
        """Fraction of the choices that are the true best views, not the network's."""
        return max(0.0, 1 - self.fraction / max(self.config.guided, 1e-9))

    def act(self) -> Tensor:
        """Return the explorer's actions: see ``MapLearner``.

        Update the posteriors over the true target places.
        """
        self.truth.watch(np.flatnonzero(self.tracker.fresh.numpy()), self.reader)
        return self.explorer(self.s, self.blocked)

    def choose(self, environments: np.ndarray, maps: ViewMaps) -> Tensor:
        """Return the views to go to, the network's or the true best; note the worth of all views."""
        worth = self.truth.read(environments, self.reader.corners(environments)) * views(maps)
        picks = self.chooser.greedy(environments, maps)
        self.note(maps._replace(worth=worth.half()), ~torch.from_numpy(self.truth.known(environments)))
        told = torch.from_numpy(self.random.random(len(environments)) < self.epsilon)
        return torch.where(told & (worth.flatten(1).amax(1) > 0), best(worth, maps), picks)

    def note(self, maps: ViewMaps, valid: Tensor) -> None:
        """Store ``valid`` (n,) bool choices over the oldest ones, if any of their views has a worth."""
        valid &= maps.worth.float().flatten(1).amax(1) > 0
        number, size = int(valid.sum()), self.config.buffer_size
        at = (self.made + torch.arange(number)) % size
        for kept, field in zip(self.buffer, maps, strict=True):
            if field.shape[1:] == kept.shape[1:]:  # an input that the network does not read is absent
                kept[at] = field[valid]
        self.made += number
        self.due += self.config.passes * number / self.config.batch_size

    def learn(self) -> float:
        """Learn from random choices as often as is due; return the mean loss."""
        config, losses = self.config, []
        self.rows = self.rows[:0]  # rows drawn before a state was kept are not drawn again
        self.anneal(config.final_lr_fraction)
        held = min(self.made, config.buffer_size)
        while self.due >= 1 and held >= MIN_HELD_BATCHES * config.batch_size:
            rows = self.drawn(held)
            batch = turned(
                ViewMaps(*(field[rows] for field in self.buffer)),
                int(self.random.integers(4)),
                bool(self.random.random() < 0.5),
            )
            with torch.autocast("cpu", torch.bfloat16, enabled=config.precision == "medium"):
                values = self.network(batch)
            loss = self.loss(values.float(), batch)
            losses.append(self.descend(loss, config.max_grad_norm))
            self.due -= 1
        return float(torch.stack(losses).mean()) if losses else 0.0

    def loss(self, values: Tensor, choices: ViewMaps) -> Tensor:
        """Return the loss of log-values (n, 8, G, G) that the network gives to the views of choices."""
        config = self.config
        if config.loss == "value":
            return value_loss(values, choices.worth.float())
        heat = config.heat * (config.final_heat / config.heat) ** self.fraction
        return choice_loss(values, choices, heat)

    def drawn(self, held: int) -> Tensor:
        """Return random choices of the first ``held`` for an update.

        The choices of some updates are drawn together. Each update then takes choices of similar size, as a
        batch takes as long as its largest.
        """
        if not len(self.rows):
            rows = torch.from_numpy(self.random.integers(0, held, UPDATES_TOGETHER * self.config.batch_size))
            order = by_size(self.buffer._replace(blocks=self.buffer.blocks[rows]))
            parts = rows[order].view(UPDATES_TOGETHER, -1)
            self.rows = parts[torch.from_numpy(self.random.permutation(UPDATES_TOGETHER))]
        first, self.rows = self.rows[0], self.rows[1:]
        return first

    def own_state(self) -> dict[str, Any]:
        """Return the learner's state: see ``MapLearner``. It includes the posteriors and the choices."""
        return super().own_state() | {
            "reader": self.reader.state,
            "truth": self.truth.state,
            "buffer": self.buffer._asdict(),
            "counts": {"made": self.made, "due": self.due},
        }

    def restore_own(self, state: dict[str, Any]) -> None:
        """Restore what ``own_state`` returned."""
        super().restore_own(state)
        self.reader.state, self.truth.state = state["reader"], state["truth"]
        self.buffer = ViewMaps(**state["buffer"])
        self.made, self.due = int(state["counts"]["made"]), float(state["counts"]["due"])


def choice_loss(values: Tensor, choices: ViewMaps, heat: float) -> Tensor:
    """Return how much less a view is worth than the best one, as a fraction of the best.

    This is an expectation over views that were not the goal before, drawn in proportion to their values to
    the power 1 / ``heat``. ``values`` (n, 8, G, G) are logarithms, minus infinity for no view.
    """
    legal = torch.isfinite(values)
    free = legal & ~gone_to(choices)
    free = torch.where(free.flatten(1).any(1)[:, None, None, None], free, legal).flatten(1)
    drawn = (values.flatten(1) / heat).masked_fill(~free, -torch.inf).softmax(1)
    worth = choices.worth.float().flatten(1) * free
    return 1 - ((drawn * worth).sum(1) / worth.amax(1).clamp(min=1e-6)).mean()


def value_loss(values: Tensor, worth: Tensor) -> Tensor:
    """Return the deviance of log-``values`` (n, 8, G, G), minus infinity for no view, from ``worth``.

    ``worth`` (n, 8, G, G) is treated as counts (Poisson regression). The deviance is least at the mean of the
    worth, so it averages over what cannot be known.

    Views weigh by the network's own opinion of them: their value relative to the best. Weights that do not
    depend on the label leave the mean where it is.
    """
    legal = torch.isfinite(values)
    values = values.masked_fill(~legal, -20.0)
    with torch.no_grad():
        most = values.flatten(1).amax(1)[:, None, None, None]
        weight = (values - most).exp().clamp(min=MIN_VIEW_WEIGHT) * legal
        weight /= weight.sum((1, 2, 3), keepdim=True)
    mean = torch.where(
        values > MAX_LOG_VALUE,
        (1 + values - MAX_LOG_VALUE) * float(np.exp(MAX_LOG_VALUE)),
        values.clamp(max=MAX_LOG_VALUE).exp(),
    )
    return ((mean - worth * values) * weight).sum((1, 2, 3)).mean()
