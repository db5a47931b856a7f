"""The learning run: act for a rollout, learn from it, say how it goes, again."""

import math
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from time import perf_counter

import torch

from agent.actions import mirrored
from agent.avoidance import Layer
from agent.config import Config
from agent.map import Map, mirrored_features
from agent.memory import mirrored_memory
from agent.network import QNetwork
from agent.pqn import lambda_returns, linear, q_loss
from agent.rollout import Rollout
from sim import HouseVectorEnv

EPISODE = 1500
"""Steps to which counts of targets refer: the paper's 15 s."""


@dataclass(frozen=True)
class Progress:
    """How a run stands after an update."""

    steps: int
    """Environment steps so far, without those that the world ignored (after an episode's end)."""

    seconds: float
    """Wall-clock time so far."""

    fraction: float
    """How much of the run is done, 0 to 1; the schedules follow it."""

    targets: float
    """Targets picked up per 1500 steps, exploring, over the last 1500 steps or so of every world."""

    loss: float
    """Mean loss of the rollout's updates."""

    epsilon: float
    """Share of random actions in the rollout."""

    overruled: float
    """Share of actions in the rollout that the avoidance layer changed."""

    simulator: float
    """Steps a second of the simulator alone, over the whole run."""

    learner: float
    """Steps a second of all else, over the whole run: acting, avoidance, returns and updates."""

    map: float = math.inf
    """Steps a second of the maps alone, over the whole run."""


def learn(envs: HouseVectorEnv, network: QNetwork, avoidance: Layer, config: Config) -> Iterator[Progress]:
    """Train the network in the worlds, in place, and yield after every update.

    Logging, checkpoints and evaluation are the caller's: between two yields nothing moves, and whoever stops
    asking stops the run. ``envs`` has NEXT_STEP autoreset.
    """
    generator = torch.Generator().manual_seed(config.seed)
    optimizer = torch.optim.RAdam(network.parameters(), lr=config.learning_rate)
    observation = torch.as_tensor(envs.reset(seed=config.seed)[0])
    map = Map(envs.config, envs.num_envs) if config.map else None
    rollout = Rollout.starting(config.rollout, observation, network.memory.empty(envs.num_envs), map)
    recent: deque[tuple[float, int]] = deque(maxlen=max(1, round(EPISODE / config.rollout)))
    steps, fraction, seconds, simulating, mapping, start = 0, 0.0, 0.0, 0.0, 0.0, perf_counter()
    while fraction < 1:
        epsilon = linear(config.epsilon, config.final_epsilon, fraction / max(config.exploration, 1e-9))
        for group in optimizer.param_groups:
            group["lr"] = config.learning_rate * linear(1.0, config.final_rate, fraction)
        rollout.fill(
            *(envs, network, avoidance),
            epsilon=epsilon,
            forward=config.forward,
            generator=generator,
            guided=config.guided,
        )
        novelty = linear(config.novelty, 0.0, fraction / max(config.fading, 1e-9))
        loss = update(network, optimizer, rollout, config, generator, novelty)

        counted = int(rollout.valid.sum())
        recent.append((float(rollout.r.sum()), counted))
        steps, simulating, seconds = steps + counted, simulating + rollout.simulating, perf_counter() - start
        mapping += rollout.mapping
        fraction = max(steps / config.steps, seconds / config.seconds if config.seconds else 0.0)
        yield Progress(
            steps=steps,
            seconds=seconds,
            fraction=min(1.0, fraction),
            targets=EPISODE * sum(reward for reward, _ in recent) / max(1, sum(count for _, count in recent)),
            loss=loss,
            epsilon=epsilon,
            overruled=rollout.overruled / rollout.a.numel(),
            simulator=steps / simulating,
            learner=steps / (seconds - simulating - mapping),
            map=steps / mapping if mapping else math.inf,
        )


def update(
    network: QNetwork,
    optimizer: torch.optim.Optimizer,
    rollout: Rollout,
    config: Config,
    generator: torch.Generator,
    novelty: float = 0.0,
) -> float:
    """Learn from a rollout, in every second epoch from its mirror image; give back the mean loss.

    ``novelty`` is what the map's bonus is worth beside the rewards.
    """
    s, memory, features = (
        states[:-1].flatten(0, 1) for states in (rollout.s, rollout.memory, rollout.features)
    )
    a, valid = rollout.a.flatten(), rollout.valid.flatten()
    g = lambda_returns(
        rollout.r + novelty * rollout.bonus if novelty else rollout.r,
        rollout.terminated,
        rollout.truncated,
        rollout.v[1:],
        discount=config.discount,
        trace=config.trace,
    ).flatten()
    losses = []
    for epoch in range(config.epochs):
        for batch in torch.randperm(len(a), generator=generator).chunk(config.minibatches):
            s_tm1, m_tm1, f_tm1, a_tm1 = s[batch], memory[batch], features[batch], a[batch]
            if epoch % 2:
                s_tm1, m_tm1, a_tm1 = s_tm1.flip(1), mirrored_memory(m_tm1), mirrored(a_tm1)
                f_tm1 = mirrored_features(f_tm1)
            loss = q_loss(network(s_tm1, m_tm1, f_tm1), a_tm1, g[batch], valid[batch])
            optimizer.zero_grad()
            loss.backward()
            torch.nn.utils.clip_grad_norm_(network.parameters(), config.clip)
            optimizer.step()
            losses.append(loss.detach())
    return float(torch.stack(losses).mean())
