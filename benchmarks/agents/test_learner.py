"""Where a training step's time goes, by number of environments.

``vitruvius bench learner`` runs it: each row's ``extra_info`` has ``environments``, ``steps_per_second`` on
one core, and, where matrix products are the bound, ``of_bound``: its share of what these alone would allow at
the speed that one of the largest layer's shape has here and now. A round is a rollout of 8192 steps, from
which ``update`` learns. ``python -m benchmarks.agents.test_learner`` prints which operations take time.
"""

from argparse import ArgumentParser
from dataclasses import replace
from time import perf_counter

import pytest
import torch
from torch.nn.functional import linear
from torch.profiler import profile

from agent.algorithms.pqn.config import PQNConfig
from agent.algorithms.pqn.learner import PQN
from agent.algorithms.table import PRESETS
from agent.learning.environments import make_envs, shield
from agent.policies.network import STRIDE, WINDOW
from logic import generate

SIZES = [64, 256, 512, 1024]


def started(environments: int = 512) -> PQN:
    """A run by the preset ``pqn`` on one core that does not end, after its first rollout."""
    torch.set_num_threads(1)
    preset = PRESETS["pqn"]
    assert isinstance(preset, PQNConfig)
    num_steps = preset.num_steps * preset.num_envs // environments
    config = replace(preset, num_envs=environments, num_steps=num_steps, steps=10**9)
    learner = PQN(config, make_envs(list(generate(rooms=4, count=64)), environments))
    learner.iterate()
    return learner


def operations(learner: PQN) -> int:
    """Floating-point operations of the network's products for one observation, forwards."""
    network, rays = learner.network, learner.envs.config.rays
    windows = (rays - WINDOW) // STRIDE + 1
    return 2 * sum(
        layer.weight.numel() * (windows if layer is network.look else 1)
        for layer in network.modules()
        if isinstance(layer, torch.nn.Linear)
    )


def product_speed(learner: PQN, rows: int) -> float:
    """Floating-point operations a second of a product of the largest layer with this many rows, the best."""
    weight = learner.network.judge[0].weight.detach()
    given, times = torch.rand(rows, weight.shape[1]), []
    for _ in range(30):
        before = perf_counter()
        linear(given, weight)
        times.append(perf_counter() - before)
    return 2 * rows * weight.numel() / min(times)


@pytest.fixture(scope="module", params=SIZES)
def learner(request) -> PQN:
    return started(request.param)


def measure(benchmark, learner: PQN, work, acting: int = 0, learning: int = 0) -> None:
    """Time it, and note how many environment steps per second the median round made.

    ``acting`` is how often each step passes the network without gradients, ``learning`` how often with them:
    these cost three times as much.
    """
    benchmark.pedantic(work, rounds=7, warmup_rounds=1)
    rate = learner.rollout.a.numel() / benchmark.stats.stats.median
    benchmark.extra_info["environments"] = learner.envs.num_envs
    benchmark.extra_info["steps_per_second"] = rate
    if acting or learning:
        batch = learner.rollout.a.numel() // learner.config.num_minibatches
        seconds = acting * operations(learner) / product_speed(learner, learner.envs.num_envs)
        seconds += 3 * learning * operations(learner) / product_speed(learner, batch)
        benchmark.extra_info["of_bound"] = rate * seconds


def act(learner: PQN) -> None:
    config = learner.config
    learner.rollout.fill(
        *(learner.envs, learner.network, learner.avoidance),
        epsilon=config.final_epsilon,
        forward=config.forward,
        generator=learner.generator,
        simulating=learner.simulating,
    )


@pytest.mark.benchmark(group="simulator")
def test_simulator(benchmark, learner):
    """``step_torch`` alone."""
    measure(benchmark, learner, lambda: [learner.envs.step_torch(a) for a in learner.rollout.a])


@pytest.mark.benchmark(group="avoidance")
def test_avoidance(benchmark, learner):
    """The shield alone."""
    layer, rollout = shield(learner.envs), learner.rollout
    states = list(zip(rollout.s[:-1], rollout.blocked[:-1], strict=True))
    measure(benchmark, learner, lambda: [layer(*state) for state in states])


@pytest.mark.benchmark(group="network")
def test_network(benchmark, learner):
    """The network's values alone, without gradients."""
    states = list(zip(learner.rollout.s[:-1], learner.rollout.memory[:-1], strict=True))

    @torch.inference_mode()
    def values():
        for s, memory in states:
            learner.network(s, memory)

    measure(benchmark, learner, values, acting=1)


@pytest.mark.benchmark(group="rollout")
def test_rollout(benchmark, learner):
    """All of acting: the three above, exploration, memory and copies."""
    measure(benchmark, learner, lambda: act(learner), acting=1)


@pytest.mark.benchmark(group="update")
def test_update(benchmark, learner):
    """Returns, and all minibatches forwards and backwards."""
    epochs = learner.config.update_epochs
    measure(benchmark, learner, lambda: learner.train_epochs(learner.returns()), learning=epochs)


@pytest.mark.benchmark(group="iteration")
def test_iteration(benchmark, learner):
    """A rollout and its update."""
    measure(benchmark, learner, learner.iterate, acting=1, learning=learner.config.update_epochs)


if __name__ == "__main__":
    ArgumentParser(description=__doc__).parse_args()
    run = started()
    for name, part in (("acting", lambda: act(run)), ("update", lambda: run.train_epochs(run.returns()))):
        with profile() as watched:
            part()
        print(name, watched.key_averages().table(sort_by="self_cpu_time_total", row_limit=20), sep="\n")
