"""Parallel runs of the paper's agent equal single runs: network, updates, actions."""

from collections.abc import Sequence
from dataclasses import replace
from typing import cast

import numpy as np
import pytest
import torch
from torch import nn

from benchmarks.paper.side_by_side import Actors, Runs, find_gradients, forward, stacked
from vitruvius.agent.algorithms.paper.config import PaperConfig
from vitruvius.agent.algorithms.paper.learner import q_targets, squared_loss
from vitruvius.agent.algorithms.paper.network import PaperNetwork
from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.avoidance import PaperRule
from vitruvius.agent.learning.environments import make_envs
from vitruvius.agent.policies.policies import home
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.actions import ACTIONS, FORWARD, LEFT, RIGHT
from vitruvius.sim.environment.arguments import PAPER_HOUSE, house_list

pytestmark = pytest.mark.second_part("each study is run in small")

PRESET = replace(cast(PaperConfig, PRESETS["paper"]), batch_size=20, num_minibatches=20, buffer_size=4000)
CONFIGS = [
    PRESET,
    replace(PRESET, seed=1, homing=False, angles="own"),
    replace(PRESET, seed=2, avoidance="none", initialisation="torch"),
]


@pytest.fixture(scope="module")
def envs() -> HouseVectorEnv:
    torch.set_num_threads(1)
    return make_envs(house_list(PAPER_HOUSE), len(CONFIGS), PRESET.targets, preset=PRESET.world)


@pytest.fixture
def networks() -> list[PaperNetwork]:
    return [PaperNetwork.of(config) for config in CONFIGS]


def plain(network: PaperNetwork, s: torch.Tensor) -> torch.Tensor:
    """Return the output of the layers only, because angles are read before."""
    return network.layers(s)


def test_each_network_says_of_its_own_observations_what_it_says_alone(networks: list[PaperNetwork]) -> None:
    s = torch.rand(len(networks), 5, 40, 3)
    _, q = forward(stacked(networks), s)
    for run, network in enumerate(networks):
        torch.testing.assert_close(q[run], plain(network, s[run]))


def test_gradients_by_hand_are_those_of_the_loss(networks: list[PaperNetwork]) -> None:
    layers = [(weight.detach(), bias.detach()) for weight, bias in stacked(networks)]
    for part in (part for layer in layers for part in layer):
        part.grad = torch.full_like(part, 9.0)
    pair, a = torch.rand(3, 2, 40, 3), torch.tensor([LEFT, RIGHT, FORWARD])
    r, ended = torch.tensor([0.0, 1.0, 1.0]), torch.tensor([False, False, True])
    find_gradients(layers, pair, a, r, ended)
    for run, network in enumerate(networks):
        q, q_t = plain(network, pair[run]).chunk(2)
        target = q_targets(r[run : run + 1], ended[run : run + 1], q_t.detach())
        squared_loss(q, a[run : run + 1], target).backward()
        dense = [layer for layer in network.layers if isinstance(layer, nn.Linear)]
        for layer, (weight, bias) in zip(dense, layers, strict=True):
            torch.testing.assert_close(_gradient(weight)[run].T, layer.weight.grad)
            torch.testing.assert_close(_gradient(bias)[run, 0], layer.bias.grad)


def _gradient(part: torch.Tensor) -> torch.Tensor:
    assert part.grad is not None
    return part.grad


def test_bodies_avoid_and_home_as_the_agents_layers_say(
    envs: HouseVectorEnv, networks: list[PaperNetwork]
) -> None:
    actors = Actors(CONFIGS, stacked(networks), envs, seed=0)
    rng = np.random.default_rng(0)
    rule, count = PaperRule(torch.Generator()), len(CONFIGS)
    nothing = np.zeros(count, bool)
    for _ in range(200):
        read = rng.random((count, 40, 3), np.float32)
        read[..., 1] += rng.choice([0.0, 0.1])
        read[..., 2] = rng.random((count, 40)) < 0.02
        s = torch.from_numpy(read)
        near = ~rule(s, torch.zeros(count, dtype=torch.bool))[:, FORWARD].numpy()
        near[2] = False  # a run that avoids nothing
        homes = home(torch.zeros(count, ACTIONS), s).argmax(-1).numpy() == FORWARD
        homes[1] = False  # a run without homing
        q = [int(plain(network, s[run : run + 1]).argmax()) for run, network in enumerate(networks)]
        left, right = np.full(count, LEFT), np.full(count, RIGHT)
        assert actors.act(read, (nothing, left, right)).tolist() == np.where(near, RIGHT, q).tolist()
        random = np.where(near, RIGHT, np.where(homes, FORWARD, LEFT))
        assert actors.act(read, (~nothing, left, right)).tolist() == random.tolist()


def test_a_run_reads_the_angles_that_its_network_would(
    envs: HouseVectorEnv, networks: list[PaperNetwork]
) -> None:
    actors = Actors(CONFIGS, stacked(networks), envs, seed=0)
    observation = envs.reset(seed=0)[0]
    _, q = forward(actors.layers, torch.from_numpy(actors.read(observation))[:, None])
    for run, network in enumerate(networks):
        alone = network(torch.from_numpy(observation[run : run + 1]))
        torch.testing.assert_close(q[run], alone, rtol=1e-4, atol=1e-6)


def test_a_run_that_was_stopped_goes_on_bit_for_bit(envs: HouseVectorEnv) -> None:
    whole = Runs(CONFIGS, envs)
    whole.episode()
    state = whole.state()
    kept = {name: _copy(value) for name, value in state.items()}
    first = whole.episode()
    again = Runs(CONFIGS, envs)
    again.restore(kept)
    second = again.episode()
    assert all(np.array_equal(first[name], second[name]) for name in first)
    assert (again.updates, again.episodes) == (whole.updates, whole.episodes) == (40, 2)
    for one, other in zip(whole.layers, again.layers, strict=True):
        assert torch.equal(one[0], other[0])


def _copy(value: object) -> object:
    if isinstance(value, torch.Tensor):
        return value.detach().clone()
    if isinstance(value, dict):
        return {name: _copy(part) for name, part in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, str):
        return type(value)(_copy(part) for part in value)  # pyright: ignore[reportCallIssue]
    return value
