"""Choice of the body's next view: the network's best, never the same view twice between two pick-ups."""

from collections.abc import Callable
from typing import cast

import numpy as np
import torch
from torch import Tensor

from vitruvius.agent.algorithms.search.maps import MapReader
from vitruvius.agent.algorithms.search.network import ViewNetwork
from vitruvius.agent.algorithms.search.windows import ViewMaps, gone_to
from vitruvius.agent.planner import Planner
from vitruvius.sim.config import Config

BATCH_WINDOWS = 16
"""Number of windows in a batch: as many as fit a processor's cache."""

AGAIN_PENALTY = 1e3
"""Penalty on the value of a view that was the goal before: it is chosen only if there is no other."""

Picks = Callable[[np.ndarray, ViewMaps], Tensor]
"""Function that returns the views (n,) int64 to go to, of windows of environments (n,): see ``best``."""


class ViewChooser:
    """Chooser of the views of E planners that are lost."""

    def __init__(self, network: ViewNetwork, world: Config, picks: Picks | None = None) -> None:
        """Choose by a network, or by ``picks`` if given."""
        self.network, self.world, self.picks = network, world, picks or self.greedy
        self.reader: MapReader | None = None

    def reader_of(self, planner: Planner) -> MapReader:
        """Return the reader of these planners' maps."""
        if self.reader is None or self.reader.planner is not planner:
            self.reader = MapReader(self.world, planner)
        return self.reader

    def __call__(self, planner: Planner) -> None:
        """Choose views for the planners that are lost: see ``Chooser``."""
        reader = self.reader_of(planner)
        reader.note()
        lost = np.flatnonzero(planner.lost.numpy())
        if len(lost):
            # Batches of maps of similar size, as a batch takes as long as its largest map.
            lost = lost[planner.seen.numpy()[lost].argsort(kind="stable")]
            maps = self.look(lost, reader.read(lost))
            reader.lead(lost, self.picks(lost, maps).numpy(), maps.ways.numpy())

    def look(self, environments: np.ndarray, maps: ViewMaps) -> ViewMaps:
        """Return maps of environments (n,) int, read last, with predictions and what views would show."""
        if not self.network.looks and self.network.completion is None:
            return maps
        maps = maps._replace(foreseen=by_parts(lambda part: self.network.foresee(part).foreseen, maps))
        return maps._replace(shown=cast(MapReader, self.reader).looks(maps)) if self.network.looks else maps

    def greedy(self, environments: np.ndarray, maps: ViewMaps) -> Tensor:
        """Return the best views by the network."""
        return best(self.values(maps), maps)

    def values(self, maps: ViewMaps) -> Tensor:
        """Return the network's values of the views (n, 8, G, G)."""
        return by_parts(self.network, maps)


@torch.inference_mode()
def by_parts(read: Callable[[ViewMaps], Tensor], maps: ViewMaps) -> Tensor:
    """Return what ``read`` returns for maps (n, ...), some maps at a time."""
    parts = zip(*(field.split(BATCH_WINDOWS) for field in maps), strict=True)
    return torch.cat([read(ViewMaps(*part)) for part in parts])


def best(values: Tensor, maps: ViewMaps) -> Tensor:
    """Return the views with the greatest finite values, as flat places (n,) int64 in (8, G, G).

    Views that were the goal before are chosen only if there is no other; -1 without any view.
    """
    most, picks = (values - AGAIN_PENALTY * gone_to(maps)).flatten(1).max(1)
    return torch.where(most > -torch.inf, picks, -1)
