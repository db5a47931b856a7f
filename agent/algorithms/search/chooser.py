"""The body's next view: the best one by the network, never one twice between two pick-ups."""

from collections.abc import Callable
from typing import cast

import numpy as np
import torch
from torch import Tensor

from agent.algorithms.search.maps import MapReader
from agent.algorithms.search.network import ViewNetwork
from agent.algorithms.search.windows import ViewMaps, gone_to
from agent.planner import Planner
from sim.config import Config

AT_ONCE = 16
"""Windows in a batch: what fits a processor's cache."""

AGAIN = 1e3
"""What the value of a view that was the goal before falls by: it is taken where there is no other."""

Picks = Callable[[np.ndarray, ViewMaps], Tensor]
"""The views (n,) int64 to go to of windows of environments (n,): see ``best``."""


class ViewChooser:
    """Chooses the views of E planners, wherever they are lost."""

    def __init__(self, network: ViewNetwork, world: Config, picks: Picks | None = None) -> None:
        """Choose by a network, or otherwise by ``picks``."""
        self.network, self.world, self.picks = network, world, picks or self.greedy
        self.reader: MapReader | None = None

    def reader_of(self, planner: Planner) -> MapReader:
        """What reads the maps of these planners."""
        if self.reader is None or self.reader.planner is not planner:
            self.reader = MapReader(self.world, planner)
        return self.reader

    def __call__(self, planner: Planner) -> None:
        """See ``Chooser``."""
        reader = self.reader_of(planner)
        reader.note()
        lost = np.flatnonzero(planner.lost.numpy())
        if len(lost):
            # In batches of maps of about one size: a batch takes as long as the largest.
            lost = lost[planner.seen.numpy()[lost].argsort(kind="stable")]
            maps = self.look(lost, reader.read(lost))
            reader.lead(lost, self.picks(lost, maps).numpy(), maps.ways.numpy())

    def look(self, environments: np.ndarray, maps: ViewMaps) -> ViewMaps:
        """Maps of environments (n,) int that were read last, with what is foreseen, and what views would
        show.
        """
        if not self.network.looks and self.network.completion is None:
            return maps
        maps = maps._replace(foreseen=by_parts(lambda part: self.network.foresee(part).foreseen, maps))
        return maps._replace(shown=cast(MapReader, self.reader).looks(maps)) if self.network.looks else maps

    def greedy(self, environments: np.ndarray, maps: ViewMaps) -> Tensor:
        """The best views by the network."""
        return best(self.values(maps), maps)

    def values(self, maps: ViewMaps) -> Tensor:
        """What the network says of the views (n, 8, G, G)."""
        return by_parts(self.network, maps)


@torch.inference_mode()
def by_parts(read: Callable[[ViewMaps], Tensor], maps: ViewMaps) -> Tensor:
    """What is read of maps (n, ...), some at a time."""
    parts = zip(*(field.split(AT_ONCE) for field in maps), strict=True)
    return torch.cat([read(ViewMaps(*part)) for part in parts])


def best(values: Tensor, maps: ViewMaps) -> Tensor:
    """The flat places (n,) int64 in (8, G, G) of the greatest values that are finite, of views that were not
    the goal before if there is one; -1 where there is no view.
    """
    most, picks = (values - AGAIN * gone_to(maps)).flatten(1).max(1)
    return torch.where(most > -torch.inf, picks, -1)
