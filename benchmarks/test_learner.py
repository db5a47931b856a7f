"""Where a training step's time goes, by number of environments: simulator, avoidance, network, update.

``pytest benchmarks/test_learner.py``: each row's ``extra_info`` has ``environments`` and
``steps_per_second``; a round is a rollout of 32 steps (``update`` learns from one, two epochs).
"""

from dataclasses import dataclass

import pytest
import torch

from agent.config import PRESETS, Config
from agent.network import QNetwork, seeded_network
from agent.rollout import Rollout
from agent.train import update
from agent.world import make_worlds, shield
from sim import HouseVectorEnv
from tests.worlds import random_house

SIZES = [64, 256, 1024]
CONFIG = PRESETS["pqn"]
HOUSES = [random_house(seed) for seed in range(64)]


@dataclass
class Loop:
    """What a training run holds."""

    envs: HouseVectorEnv
    network: QNetwork
    rollout: Rollout
    config: Config = CONFIG

    def fill(self) -> None:
        self.rollout.fill(
            self.envs,
            self.network,
            shield(self.envs),
            epsilon=0.02,
            forward=0.93,
            generator=torch.Generator(),
        )


@pytest.fixture(scope="module", params=SIZES)
def loop(request) -> Loop:
    torch.set_num_threads(CONFIG.threads)
    envs, network = make_worlds(HOUSES, request.param), seeded_network(0)
    observation = torch.as_tensor(envs.reset(seed=0)[0])
    loop = Loop(
        envs, network, Rollout.starting(CONFIG.rollout, observation, network.memory.empty(request.param))
    )
    loop.fill()
    return loop


def measure(benchmark, loop: Loop, work) -> None:
    """Time it, and note how many environment steps a second the median round made."""
    benchmark.pedantic(work, rounds=7, warmup_rounds=1)
    benchmark.extra_info["environments"] = loop.envs.num_envs
    benchmark.extra_info["steps_per_second"] = loop.rollout.a.numel() / benchmark.stats.stats.median


@pytest.mark.benchmark(group="simulator")
def test_simulator(benchmark, loop):
    """``step_torch`` alone."""
    measure(benchmark, loop, lambda: [loop.envs.step_torch(actions) for actions in loop.rollout.a])


@pytest.mark.benchmark(group="avoidance")
def test_avoidance(benchmark, loop):
    """The shield alone."""
    layer, rollout = shield(loop.envs), loop.rollout
    states = list(zip(rollout.s[:-1], rollout.blocked[:-1], strict=True))
    measure(benchmark, loop, lambda: [layer(*state) for state in states])


@pytest.mark.benchmark(group="network")
def test_network(benchmark, loop):
    """The network's values alone, without gradients."""
    states = list(zip(loop.rollout.s[:-1], loop.rollout.memory[:-1], strict=True))

    @torch.no_grad()
    def values():
        for state in states:
            loop.network(*state)

    measure(benchmark, loop, values)


@pytest.mark.benchmark(group="rollout")
def test_rollout(benchmark, loop):
    """All of acting: the three above, exploration, memory and copies."""
    measure(benchmark, loop, loop.fill)


@pytest.mark.benchmark(group="update")
def test_update(benchmark, loop):
    """Returns, and two epochs of four minibatches forwards and backwards."""
    optimizer = torch.optim.RAdam(loop.network.parameters(), lr=0.0)
    measure(
        benchmark,
        loop,
        lambda: update(loop.network, optimizer, loop.rollout, loop.config, torch.Generator().manual_seed(0)),
    )
