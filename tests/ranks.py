"""Work of each rank of ``test_ranks.py``, and of the single process."""

import weakref

import torch
import torch.distributed as dist

from tests.sample_houses import random_house
from vitruvius.agent.algorithms.pqn.config import PQNConfig
from vitruvius.agent.algorithms.pqn.learner import PQN
from vitruvius.agent.learning import ranks
from vitruvius.sim import HouseVectorEnv

WORLDS = 8
CONFIG = PQNConfig(
    num_envs=WORLDS,
    num_steps=30,
    steps=10**6,
    update_epochs=1,
    num_minibatches=1,
    epsilon=0.0,
    final_epsilon=0.0,
)


def main(file: str) -> None:
    """Learn from two rollouts in which episodes end; the first rank writes gradients and weights."""
    torch.set_num_threads(1)
    record, group = {}, None
    with ranks.joined():
        if dist.is_initialized():
            group = weakref.ref(dist.group.WORLD)
        houses = [random_house(seed) for seed in range(4)]
        envs = HouseVectorEnv(houses, WORLDS // ranks.size(), max_episode_steps=20)
        learner, gradients = PQN(CONFIG, envs), []
        step = learner.optimizer.step

        def noted(*given):
            gradients.append(torch.cat([p.grad.flatten().clone() for p in learner.network.parameters()]))
            return step(*given)

        setattr(learner.optimizer, "step", noted)  # noqa: B010
        reports = [learner.iterate() for _ in range(2)]
        weights = torch.cat([p.detach().flatten() for p in learner.network.parameters()])
        everyones = ranks.gathered(weights)
        if not ranks.rank():
            steps, targets = [now.steps for now in reports], [now.targets for now in reports]
            record = {"gradients": gradients, "weights": everyones, "steps": steps, "targets": targets}
    if record:
        torch.save({**record, "left": group is None or group() is None}, file)
