"""Your own behaviour between our shield and an agent's network: a layer of Brooks' subsumption in ten lines.

./run python examples/own_behaviour.py houses.jsonl
"""

from pathlib import Path

import torch
import tyro
from torch import Tensor

from vitruvius import load
from vitruvius.agent.avoidance import Stack
from vitruvius.agent.evaluation.episodes import play
from vitruvius.agent.learning.environments import make_envs, shield
from vitruvius.agent.policies.policies import QPolicy
from vitruvius.agent.runs import checkpoint
from vitruvius.sim import DEFAULT
from vitruvius.sim.actions import ACTIONS, LEFT, RIGHT


def stride(observation: Tensor, blocked: Tensor) -> Tensor:
    """Return the mask (E, A) bool of allowed actions: no turn with 2 m free ahead and no target in sight."""
    free = observation[:, 19:21, 0].amin(1) > 2 / DEFAULT.range
    on = free & ~observation[..., 1].bool().any(1)
    allowed = torch.ones(len(on), ACTIONS, dtype=torch.bool)
    allowed[:, [LEFT, RIGHT]] = ~on[:, None]
    return allowed


def main(houses: tyro.conf.Positional[Path], agent: str = "pqn") -> None:
    """Play an episode in each house with and without the layer."""
    bank, network = load(houses), checkpoint.load(agent).network
    envs = make_envs(bank, len(bank), "main")
    for name, layer in {"shield": shield(envs), "shield, stride": Stack(shield(envs), stride)}.items():
        policy = QPolicy(network, layer, torch.Generator().manual_seed(0))
        score = play(envs, policy, seed=0)
        print(f"{name}: {score.targets.mean():.1f} targets, {score.interventions} actions overruled")


if __name__ == "__main__":
    tyro.cli(main)
