"""What a config names: its network, and the policy that plays by it."""

import shlex
from typing import Any

import torch

from agent.algorithms.map_completion.config import CompletionConfig
from agent.algorithms.map_completion.foresight import Foresight
from agent.algorithms.map_completion.network import CompletionNetwork
from agent.algorithms.map_completion.truth import GROUND
from agent.algorithms.paper import PaperNetwork
from agent.learning.config import PaperConfig, PQNConfig, QLearningConfig, TrainConfig
from agent.learning.environments import layer_of, shield
from agent.learning.simulator import simulator
from agent.policies.network import QNetwork, seeded
from agent.policies.policies import Explorer, QPolicy
from agent.policies.recurrent import RecurrentQNetwork
from logic.errors import RequestError
from sim import HouseVectorEnv
from sim.tasks.tasks import task


def network_of(config: TrainConfig) -> Any:
    """A new network as the config has it, for what its simulator shows; its weights are a function of the
    seed, and torch's own generator is left as it was.
    """
    world = simulator(config)
    if isinstance(config, PaperConfig):
        return PaperNetwork.of(config)
    with seeded(config.seed):
        if isinstance(config, CompletionConfig):
            return CompletionNetwork(len(GROUND) + len(config.kinds), len(world.kinds), config.channels)
        assert isinstance(config, QLearningConfig)
        if isinstance(config, PQNConfig) and config.network == "recurrent":
            return RecurrentQNetwork(world.rays, world.channels)
        return QNetwork(world.rays, world.channels, config.half_lives)


def policy_of(network: Any, config: TrainConfig, envs: HouseVectorEnv, seed: int = 0) -> QPolicy | Explorer:
    """A trained network's policy, as it is measured and filmed: its own layer, a few random actions. That of
    map completion: the explorer, by planners that foresee.
    """
    if isinstance(config, CompletionConfig):
        _require_foreseen(config, envs)
        return Explorer(shield(envs), envs.config, tracker=Foresight(envs.config, network))
    generator = torch.Generator().manual_seed(seed)
    layer = layer_of(config, envs, generator)
    if isinstance(config, PaperConfig) and config.plays_as_original:
        return QPolicy(network, layer, generator, config.final_epsilon, config.forward, homing=True)
    return QPolicy(network, layer, generator)


def _require_foreseen(config: CompletionConfig, envs: HouseVectorEnv) -> None:
    """Raise ``RequestError`` for another task than map completion has learnt, or a map of other cells."""
    body, learnt = max(envs.config.body), max(simulator(config).body)
    if body != learnt:
        raise RequestError(
            f"map completion that learnt maps of a body of {learnt:.3f} m cannot read those of one "
            f"of {body:.3f} m"
        )
    if task(config.targets) != envs.world.task:
        raise RequestError(
            "map completion plays no other task than the one that it has learnt: "
            f"give --targets {shlex.quote(config.targets)}"
        )
