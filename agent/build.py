"""What a config names: its network, its avoidance layer, and the policy that plays by both."""

from itertools import pairwise
from typing import Any

import torch
from torch import Tensor, nn

from agent.actions import ACTIONS
from agent.avoidance import Layer, PaperRule
from agent.config import Config, PQNConfig
from agent.memory import Memory
from agent.network import QNetwork
from agent.planner import FEATURES
from agent.policies import QPolicy, Tracker
from agent.recurrent import RecurrentQNetwork
from agent.world import shield
from sim import HouseVectorEnv
from sim.config import PRESETS


class PaperNetwork(nn.Module):
    """The original's layers: 25 for each ray, the same for all; then 50, 100, 50, 25, 3: 61,653 parameters.

    Its softmax cannot hold what it is asked to learn: sums of rewards, which are greater than 1, for three
    actions whose values need not add up to 1.
    """

    def __init__(self, rays: int = 40, channels: int = 3) -> None:
        """Draw first weights from torch's generator."""
        super().__init__()
        self.shape = (rays, channels, (), 0)
        self.memory = Memory(())  # of nothing, so that it is called as the other networks are
        widths = (25 * rays, 50, 100, 50, 25)
        hidden = [(nn.Linear(a, b), nn.ReLU()) for a, b in pairwise(widths)]
        self.layers = nn.Sequential(
            *(nn.Linear(channels, 25), nn.ReLU(), nn.Flatten()),
            *(layer for pair in hidden for layer in pair),
            *(nn.Linear(widths[-1], ACTIONS), nn.Softmax(dim=1)),
        )

    def forward(self, observation: Tensor, memory: Tensor, features: Tensor | None = None) -> Tensor:
        """What stands for Q-values (B, A), from observations (B, R, C) alone."""
        return self.layers(observation)


class Free:
    """A layer that allows everything."""

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Which actions (E, A) bool are allowed: all."""
        return torch.ones(len(blocked), ACTIONS, dtype=torch.bool, device=blocked.device)


def network_of(config: Config) -> Any:
    """A new network as the config has it, for what its world shows; its weights are a function of the seed,
    and torch's own generator is left as it was.
    """
    world = PRESETS[config.world]
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(config.seed)
        match getattr(config, "network", "traces"):
            case "paper":
                return PaperNetwork(world.rays, world.channels)
            case "recurrent":
                return RecurrentQNetwork(world.rays, world.channels)
        features = FEATURES if isinstance(config, PQNConfig) and config.map else 0
        return QNetwork(world.rays, world.channels, config.half_lives, features)


def layer_of(config: Config, envs: HouseVectorEnv, generator: torch.Generator) -> Layer:
    """The config's avoidance layer, for the body and the rays of these worlds."""
    match config.avoidance:
        case "paper":
            return PaperRule(generator)
        case "none":
            return Free()
    return shield(envs)


def policy_of(network: Any, config: Config, envs: HouseVectorEnv, seed: int = 0) -> QPolicy:
    """A trained network's policy, as it is measured and filmed: its own layer, a few random actions."""
    generator = torch.Generator().manual_seed(seed)
    tracker = Tracker(envs.config) if network.shape[3] else None
    return QPolicy(network, layer_of(config, envs, generator), generator, tracker=tracker)
