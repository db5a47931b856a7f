"""The released network that searches with a part of it taken away as it plays: what it relies on.

For ``vitruvius bench learning --agent benchmarks.planner.search_parts:without_memory``. Nothing is trained
again, so a part that others could stand in for may show as more than it is worth.
"""

from collections.abc import Callable
from typing import Any, cast

import torch
from torch import Tensor, nn

from agent.algorithms.build import policy_of
from agent.algorithms.search.chooser import ViewChooser, best
from agent.algorithms.search.network import LEVELS, ViewMaps
from agent.policies.policies import Explorer
from agent.runs import checkpoint
from benchmarks.planner.contenders import Shuffled
from sim import HouseVectorEnv

AGENT = "search"

ELSEWHERE = 1e3
"""Places to a start that is nowhere near."""

Change = Callable[[ViewMaps], ViewMaps]


def changed(envs: HouseVectorEnv, change: Change) -> Explorer:
    """The agent, to which maps are ``change``d."""
    made = checkpoint.load(AGENT)
    policy = cast(Explorer, policy_of(made.network, made.config, envs))
    chooser = cast(ViewChooser, policy.tracker.chooser)
    chooser.picks = lambda _, maps: best(chooser.values(change(maps)), change(maps))
    return policy


def without_memory(envs: HouseVectorEnv) -> Explorer:
    """It forgets which views were its goals."""
    return changed(envs, lambda maps: maps._replace(taken=torch.zeros_like(maps.taken)))


def without_finds(envs: HouseVectorEnv) -> Explorer:
    """It forgets where it found targets."""
    return changed(envs, lambda maps: maps._replace(finds=torch.zeros_like(maps.finds)))


def without_ages(envs: HouseVectorEnv) -> Explorer:
    """It forgets how long ago it saw what; not whether it was since the last pick-up."""
    return changed(envs, lambda maps: maps._replace(ages=torch.zeros_like(maps.ages)))


def without_since(envs: HouseVectorEnv) -> Explorer:
    """What it saw counts as seen since the last pick-up."""

    def change(maps: ViewMaps) -> ViewMaps:
        occupied, seen = maps.blocks % LEVELS, maps.blocks // LEVELS % LEVELS
        return maps._replace(blocks=occupied + LEVELS * seen + LEVELS**2 * seen)

    return changed(envs, change)


def without_start(envs: HouseVectorEnv) -> Explorer:
    """It does not know where the episode began."""
    return changed(envs, lambda maps: maps._replace(start=torch.full_like(maps.start, ELSEWHERE)))


def without_scalars(envs: HouseVectorEnv) -> Explorer:
    """It knows neither the time, nor when and how often it found a target."""
    return changed(envs, lambda maps: maps._replace(scalars=torch.zeros_like(maps.scalars)))


class _Elsewhere(nn.Module):
    """What a network predicts of another row of a batch."""

    def __init__(self, network: nn.Module) -> None:
        super().__init__()
        self.network, self.shuffled = network, Shuffled(network)

    def forward(self, *given: Tensor) -> Any:
        """See ``Shuffled``."""
        return self.shuffled(*given)


def foresight_elsewhere(envs: HouseVectorEnv) -> Explorer:
    """What it foresees is of another map, mostly of another house."""
    policy = changed(envs, lambda maps: maps)
    network: Any = cast(ViewChooser, policy.tracker.chooser).network
    network.completion = _Elsewhere(network.completion)
    return policy


def without_rays(envs: HouseVectorEnv) -> Explorer:
    """Its learnt rays show nothing."""
    policy = changed(envs, lambda maps: maps)
    network: Any = cast(ViewChooser, policy.tracker.chooser).network
    network.sight.register_forward_hook(lambda *each: torch.zeros_like(each[-1]))
    return policy
