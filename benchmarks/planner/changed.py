"""Agents that search with a part changed in play.

``vitruvius bench learning --agent benchmarks.planner.changed:without_memory`` measures one. Nothing is
trained again, so a part that others could replace may seem more valuable than it is;
``benchmarks.planner.views`` trains networks without a part.
"""

from dataclasses import replace
from typing import Any, cast

import numpy as np
import torch
from torch import Tensor, nn

from benchmarks.planner.contenders import Maker, Shuffled
from benchmarks.planner.views import AGENT, INPUTS
from vitruvius.agent.algorithms.build import policy_of
from vitruvius.agent.algorithms.search.chooser import ViewChooser, best
from vitruvius.agent.algorithms.search.config import SearchConfig
from vitruvius.agent.algorithms.search.learner import LearnedSearch
from vitruvius.agent.algorithms.search.windows import ViewMaps
from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.learning.environments import shield
from vitruvius.agent.planner import TUNED
from vitruvius.agent.policies.policies import Explorer
from vitruvius.agent.runs import checkpoint
from vitruvius.sim import HouseVectorEnv


def _without(part: str) -> Maker:
    """Return a maker of the released agent, without an input in play."""

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
    """Return an agent with an untrained network, with the first weights of a preset's run."""
    config = cast(SearchConfig, PRESETS[AGENT])
    return cast(Explorer, policy_of(LearnedSearch.network_of(config), config, envs))


def again_after(steps: int) -> Maker:
    """Return a maker of the released agent that chooses again after ``steps`` steps instead of 32."""

    def make(envs: HouseVectorEnv) -> Explorer:
        chooser = ViewChooser(checkpoint.load(AGENT).network, envs.config)
        return Explorer(shield(envs), envs.config, replace(TUNED, replan_interval=steps), chooser=chooser)

    return make


often, seldom = again_after(12), again_after(128)


def without_looks(envs: HouseVectorEnv) -> Explorer:
    """Return the released agent without the gains of views."""
    policy, chooser, _ = _released(envs)
    look = chooser.look

    def blind(environments: np.ndarray, maps: ViewMaps) -> ViewMaps:
        seen = look(environments, maps)
        return seen._replace(shown=torch.zeros_like(seen.shown))

    chooser.look = blind
    return policy


def foresight_elsewhere(envs: HouseVectorEnv) -> Explorer:
    """Return the released agent with the predictions for another map, mostly of another house."""
    policy, _, network = _released(envs)
    network.completion = _Elsewhere(network.completion)
    return policy


class _Elsewhere(nn.Module):
    """Network that returns the predictions for another row of a batch."""

    def __init__(self, network: nn.Module) -> None:
        super().__init__()
        self.network, self.shuffled = network, Shuffled(network)

    def forward(self, *given: Tensor) -> Any:
        """Return the shuffled predictions: see ``Shuffled``."""
        return self.shuffled(*given)


def _released(envs: HouseVectorEnv) -> tuple[Explorer, ViewChooser, Any]:
    """Return the released agent's policy, its chooser and its network."""
    made = checkpoint.load(AGENT)
    policy = cast(Explorer, policy_of(made.network, made.config, envs))
    chooser = cast(ViewChooser, policy.tracker.chooser)
    return policy, chooser, chooser.network
