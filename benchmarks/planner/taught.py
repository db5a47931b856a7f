"""The released view network in tasks that it was not trained for, without any further training.

``vitruvius bench learning --agent benchmarks.planner.taught:any_task --targets habit`` plays it unchanged, or
with the predictions of that task's map completion instead of its own.
"""

import numpy as np
import torch
from torch import Tensor

from vitruvius.agent.algorithms.map_completion.marks import Marks
from vitruvius.agent.algorithms.map_completion.network import CompletionNetwork
from vitruvius.agent.algorithms.search.chooser import ViewChooser, by_parts
from vitruvius.agent.algorithms.search.network import ViewNetwork, foreseen
from vitruvius.agent.algorithms.search.windows import ViewMaps
from vitruvius.agent.learning.config import TrainConfig
from vitruvius.agent.learning.environments import shield
from vitruvius.agent.planner import Planner
from vitruvius.agent.policies.policies import Explorer, Tracker
from vitruvius.agent.runs import checkpoint
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.config import Config

AGENT = "search"


def any_task(envs: HouseVectorEnv) -> Explorer:
    """Return the released agent, unchanged."""
    return Explorer(
        shield(envs), envs.config, chooser=ViewChooser(checkpoint.load(AGENT).network, envs.config)
    )


class Foreseeing:
    """Maker of the released agent with the predictions of another network, a released map completion."""

    def __init__(self, name: str) -> None:
        self.name = name

    @property
    def config(self) -> TrainConfig:
        """Config of the other network's run, whose sensor the agent uses."""
        return checkpoint.load(self.name).config

    def __call__(self, envs: HouseVectorEnv) -> Explorer:
        """Return the agent's policy."""
        network = checkpoint.load(AGENT).network
        chooser = MarkedChooser(network, envs.config, checkpoint.load(self.name).network)
        return Explorer(shield(envs), envs.config, tracker=Marking(envs.config, chooser=chooser))


class Marking(Tracker):
    """Tracker that also shows a chooser the observations of the bodies."""

    def look(self, observation: Tensor, blocked: Tensor) -> Planner:
        """Return the planners after the last actions: see ``Tracker``."""
        if isinstance(self.chooser, MarkedChooser):
            self.chooser.observation = observation
        return super().look(observation, blocked)


class MarkedChooser(ViewChooser):
    """Chooser with predictions of a network that also reads marks on the map: kinds of furniture, finds."""

    observation: Tensor

    def __init__(self, network: ViewNetwork, world: Config, completion: CompletionNetwork) -> None:
        super().__init__(network, world)
        self.completion = completion
        self.marks: Marks | None = None

    def __call__(self, planner: Planner) -> None:
        """Choose the next views: see ``Chooser``."""
        if self.marks is None or self.marks.planner is not planner:
            self.marks = Marks(self.world, planner)
        self.marks.note(self.observation)
        super().__call__(planner)

    def look(self, environments: np.ndarray, maps: ViewMaps) -> ViewMaps:
        """Return the maps with the other network's predictions: see ``ViewChooser``."""
        assert self.marks is not None
        reader = self.reader_of(self.marks.planner)
        # A window begins two cells before its first node, and a block of marks at every other node.
        corners = (reader.corners(environments) - 2) // 2
        marks = torch.from_numpy(self.marks.read(environments, corners))
        planes = by_parts(
            lambda part: foreseen(self.completion, part, part.shown), maps._replace(shown=marks)
        )
        maps = maps._replace(foreseen=planes)
        return maps._replace(shown=reader.looks(maps))


habit, bed = Foreseeing("map-completion-habit"), Foreseeing("map-completion-bed")
