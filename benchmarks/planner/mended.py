"""The network that searches before it has learnt anything, with three of the rules mended by which it goes:
for ``vitruvius bench learning --agent benchmarks.planner.mended:mended``.

A path costs its steps, two a node; no target is looked for beside blocks that were seen since the last
pick-up, as a target is two blocks wide; and a view counts as much as there is likely floor to stand on.
"""

from typing import cast

import numpy as np
import torch.nn.functional as F
from torch import Tensor

from agent.algorithms.search.chooser import ViewChooser
from agent.algorithms.search.config import SearchConfig
from agent.algorithms.search.learner import LearnedSearch
from agent.algorithms.search.maps import MapReader
from agent.algorithms.search.network import CONSTANT, FLOOR, HARDLY, TARGETS, WHOLE, in_view
from agent.algorithms.search.windows import LEVELS, ViewMaps
from agent.algorithms.table import PRESETS
from agent.learning.environments import shield
from agent.policies.policies import Explorer
from sim import HouseVectorEnv

NODE = 2.0
"""Steps from a node to the next one: a cell is half a body wide."""

MOSTLY = 3
"""Cells of a block from which on it counts as seen."""


def cost(ways: Tensor, turns: Tensor) -> Tensor:
    """What views (n, 8, G, G) cost: the steps of paths of ``ways`` (n, G, G) nodes, the ``turns``, and some
    steps for a choice.
    """
    return NODE * ways[:, None].float().clamp(min=0) + CONSTANT + turns


def hides(maps: ViewMaps) -> Tensor:
    """Where (n, 2G, 2G) bool a target's middle may lie that was not seen since the last pick-up: a target is
    two blocks wide, so it would have been seen from beside a block too.
    """
    since = (maps.blocks // LEVELS**2)[:, None].float()
    return F.max_pool2d(since, 3, 1, 1)[:, 0] < MOSTLY


def stands(maps: ViewMaps) -> Tensor:
    """How likely a body can stand at each place (n, G, G) float32: paths lead some way over unseen ground,
    which is floor as far as is foreseen.
    """
    floor = (maps.foreseen[:, FLOOR] / WHOLE).masked_fill(maps.blocks // LEVELS % LEVELS >= MOSTLY, 1.0)
    return F.avg_pool2d(floor[:, None], 2)[:, 0]


def without_beside(maps: ViewMaps) -> ViewMaps:
    """Maps on which no target is foreseen beside blocks that were seen."""
    planes = maps.foreseen.clone()
    planes[:, TARGETS] *= hides(maps)
    return maps._replace(foreseen=planes)


class MendedChooser(ViewChooser):
    """Goes to the best view by a network's values, with what the rules have of these mended."""

    def look(self, environments: np.ndarray, maps: ViewMaps) -> ViewMaps:
        """See ``ViewChooser``."""
        maps = without_beside(super().look(environments, maps))
        return maps._replace(shown=cast(MapReader, self.reader).looks(maps))

    def values(self, maps: ViewMaps) -> Tensor:
        """What the network says of the views (n, 8, G, G)."""
        shows, known = in_view(maps.shown.float()), cost(maps.ways, self.network.turns[maps.heading])
        nodes = known - (NODE - 1) * maps.ways[:, None].float().clamp(min=0)
        likely = (shows * stands(maps)[:, None] + HARDLY).log() - (shows + HARDLY).log()
        return super().values(maps) + likely + nodes.log() - known.log()


def mended(envs: HouseVectorEnv) -> Explorer:
    """The body, led by the mended rules."""
    network = LearnedSearch.network_of(cast(SearchConfig, PRESETS["search"]))
    return Explorer(shield(envs), envs.config, chooser=MendedChooser(network, envs.config))
