"""A process of a row of ``vitruvius bench speed``, as torchrun starts it.

``python -m benchmarks.speed.worker CASE SECONDS``: a case is a JSON object of ``benchmarks.speed.run``.
The first process prints steps, seconds and processor seconds of all as JSON.
"""

import json
import math
from argparse import ArgumentParser
from collections.abc import Callable
from dataclasses import replace
from time import perf_counter, process_time
from typing import Any

import numpy as np
import torch

from vitruvius.agent.learning import ranks
from vitruvius.sim import HouseVectorEnv

Work = Callable[[], int]
"""A function that makes some steps and returns their number."""

STEPS = 16
"""Steps of all environments in one call."""

WARM_UP = 2
"""Calls before the clock runs."""

SHARES = (0.15, 0.15, 0.7)
"""Shares of the actions turn left, turn right and forward."""


def kernel(backend: str, device: str, count: int) -> Work:
    """Return the work of the compiled step alone, in houses that come with Vitruvius."""
    envs = made(backend, device, count, "mixed")

    def work() -> int:
        for _ in range(STEPS):
            envs.world.run("step")
        return STEPS * count

    return work


def step(backend: str, device: str, count: int) -> Work:
    """Return the work of ``step_torch`` by random actions."""
    envs = made(backend, device, count, "mixed")
    actions = list(torch.as_tensor(random_actions(envs, STEPS), device=device))

    def work() -> int:
        for each in actions:
            envs.step_torch(each)
        return STEPS * count

    return work


def planner(_: str, device: str, count: int) -> Work:
    """Return the work of planners and of the environments that follow them."""
    follow = follower(made("continuous", device, count, "secondary"))[0]

    def work() -> int:
        for _ in range(STEPS):
            follow()
        return STEPS * count

    return work


def play(agent: str, device: str, count: int) -> Work:
    """Return the work of an agent with simulator, planner and network, targets in secondary rooms."""
    from benchmarks.planner.contenders import contender
    from vitruvius.agent.evaluation.episodes import reset
    from vitruvius.agent.policies.episodes import moments

    envs = made("continuous", device, count, "secondary")
    now = moments(envs, contender(agent).make(envs), reset(envs, 0), through=True)

    def work() -> int:
        for _ in range(STEPS):
            next(now)
        return STEPS * count

    return work


def train(preset: str, device: str, count: int) -> Work:
    """Return the work of a learner: a rollout with its updates."""
    from vitruvius.agent.algorithms.build import learner_of
    from vitruvius.agent.algorithms.table import PRESETS
    from vitruvius.agent.learning.environments import make_envs
    from vitruvius.agent.learning.simulator import simulator
    from vitruvius.sim.environment.arguments import BANK, house_list

    config = replace(PRESETS[preset], num_envs=ranks.size() * count, steps=10**9, device=device)
    envs = make_envs(house_list(BANK), count, config.targets, preset=simulator(config), device=device)
    learner = learner_of(config, envs)

    def work() -> int:
        before = learner.steps
        return (learner.iterate().steps - before) // ranks.size()

    return work


PARTS = {"kernel": kernel, "step": step, "planner": planner, "play": play, "train": train}


def made(backend: str, device: str, count: int, targets: Any) -> HouseVectorEnv:
    """Return environments after a reset."""
    envs = HouseVectorEnv(num_envs=count, targets=targets, backend=backend, device=device)
    envs.reset(seed=ranks.rank())
    return envs


def random_actions(envs: HouseVectorEnv, steps: int) -> np.ndarray:
    """Return numbers of actions (steps, E), or (v, w) for bodies that drive (steps, E, 2) float32."""
    rng, size = np.random.default_rng(0), (steps, envs.num_envs)
    if not envs.config.drives:
        return rng.choice(3, p=SHARES, size=size)
    drive = envs.config.drive
    if drive.commands:
        return rng.integers(len(drive.commands), size=size)
    return rng.uniform(drive.low, drive.high, (*size, 2)).astype(np.float32)


def follower(envs: HouseVectorEnv) -> tuple[Callable[[], None], Any]:
    """Return a step of environments by the advice of their planners, and the planners."""
    from vitruvius.agent.planner import Planner

    planner, device = Planner(envs.config, envs.num_envs), envs.device
    begun = torch.ones(envs.num_envs, dtype=torch.bool, device=device)
    planner.step(torch.as_tensor(envs.reset(seed=0)[0], device=device), ~begun, planner.advice, begun)

    def follow() -> None:
        observation, _, terminated, truncated, info = envs.step_torch(planner.advice)
        planner.step(observation, info["blocked"], planner.advice, begun)
        torch.logical_or(terminated, truncated, out=begun)

    begun.fill_(False)
    return follow, planner


def measured(work: Work, device: str, seconds: float) -> dict[str, float]:
    """Return steps, seconds and processor seconds of all processes, over at least some seconds."""

    def timed(calls: int) -> tuple[int, float]:
        began, steps = perf_counter(), 0
        for _ in range(calls):
            steps += work()
        if device == "cuda":
            torch.cuda.synchronize()
        return steps, perf_counter() - began

    timed(WARM_UP)
    once = ranks.first(timed(1)[1])
    ranks.total([0])  # all begin together
    before = process_time()
    steps, taken = timed(max(1, math.ceil(seconds / once)))
    steps, spent, taken = ranks.total([steps, process_time() - before, taken])
    return {"steps": int(steps), "seconds": taken / ranks.size(), "processor_seconds": spent}


def main() -> None:
    """Measure a case and print what was found."""
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("case", type=json.loads)
    parser.add_argument("seconds", type=float)
    given = parser.parse_args()
    case = given.case
    torch.set_num_threads(1)
    with ranks.joined():
        work = PARTS[case["part"]](case["of"], case["device"], case["environments"])
        found = measured(work, case["device"], given.seconds)
        if not ranks.rank():
            print(json.dumps(found), flush=True)


if __name__ == "__main__":
    main()
