"""A network over viewpoints begins as the explorer, learns which offers pay, and is kept whole."""

from dataclasses import replace
from typing import cast

import numpy as np
import pytest
import torch

from agent.algorithms.build import network_of, policy_of
from agent.algorithms.presets import PRESETS
from agent.algorithms.viewpoint_q.config import ViewpointQConfig
from agent.algorithms.viewpoint_q.learner import Choices, ViewpointQ
from agent.algorithms.viewpoint_q.network import Situation, features
from agent.evaluation.baselines import explorer
from agent.learning.environments import make_envs
from agent.policies.policies import Policy
from agent.runs import checkpoint
from agent.runs.checkpoint import Checkpoint
from logic.errors import RequestError
from sim import HouseVectorEnv
from tests.sample_houses import random_house

E, K = 8, 5
PRESET = cast(ViewpointQConfig, PRESETS["viewpoints"])
CONFIG = replace(PRESET, num_envs=E, steps=1200 * E, batch_size=64, sim=("steps=600",))


@pytest.fixture
def envs() -> HouseVectorEnv:
    torch.set_num_threads(1)
    return make_envs([random_house(seed) for seed in range(E)], E, "secondary")


def walk(envs: HouseVectorEnv, policy: Policy, steps: int = 300) -> torch.Tensor:
    observation = torch.as_tensor(envs.reset(seed=1, options={"house": np.arange(E)})[0])
    blocked, actions = torch.zeros(E, dtype=torch.bool), []
    policy.begin(E)
    for _ in range(steps):
        actions.append(policy(observation, blocked).clone())
        observation, _, _, _, info = envs.step_torch(actions[-1])
        blocked = info["blocked"].clone()
    return torch.stack(actions)


def situations(number: int, seed: int = 0) -> Situation:
    """Choices among 2 to K offers; the first is worth most."""
    noise = np.random.default_rng(seed)
    gain, cost = noise.uniform(5, 200, (number, K)), noise.uniform(5, 100, (number, K))
    order = np.argsort(-gain / cost, axis=1)
    gain, cost = (np.take_along_axis(each, order, axis=1) for each in (gain, cost))
    offers = noise.uniform(0, 5, (number, K, 12))
    offers[..., 4], offers[..., 5], offers[..., 6], offers[..., 7] = cost, gain, gain / 2, 2 * gain
    offers[..., 8:10] = noise.uniform(-50, 50, (number, K, 2))
    choice = np.column_stack([noise.integers(2, K + 1, number), np.ones(number), np.full(number, 900.0)])
    whole = np.tile([300.0, 50.0, 3.0, 1.0], (number, 1))
    return Situation(*(torch.from_numpy(each).float() for each in (offers, choice, whole)))


def test_a_new_network_acts_as_the_explorer_bit_for_bit(envs):
    policy = policy_of(network_of(CONFIG), CONFIG, envs)
    assert torch.equal(walk(envs, policy), walk(envs, explorer(envs, 0)))


def test_a_network_that_prefers_other_offers_goes_elsewhere(envs):
    network = network_of(CONFIG)
    network.scale.data.fill_(-0.1)
    assert not torch.equal(walk(envs, policy_of(network, CONFIG, envs)), walk(envs, explorer(envs, 0)))


def test_the_first_offer_is_the_best_at_first_and_no_missing_one_is_ever_chosen():
    network, now = network_of(CONFIG), situations(400)
    assert (network(now).argmax(1) == 0).all()
    for weights in network.parameters():
        torch.nn.init.normal_(weights, generator=torch.Generator().manual_seed(1))
    picks = network(now).argmax(1)
    assert (picks < now.choice[:, 0]).all()
    assert len(picks.unique()) == K


def test_offers_may_come_in_any_order_but_for_the_first():
    network, now = network_of(CONFIG), situations(50)
    for weights in network.parameters():
        torch.nn.init.normal_(weights, generator=torch.Generator().manual_seed(1))
    now.choice[:, 0] = K
    order = torch.tensor([0, 3, 1, 4, 2])
    other = Situation(now.offers[:, order], now.choice, now.whole)
    assert torch.allclose(network(other), network(now)[:, order], atol=1e-4)


def test_features_are_finite_and_of_about_one_size():
    for part in features(situations(300), 1500)[:2]:
        assert part.isfinite().all()
        assert part.abs().max() < 5


def test_it_learns_which_offers_pay(envs):
    """Returns are rigged: the second offer is worth 1 more wherever it shows more than 60."""
    learner = ViewpointQ(replace(CONFIG, learning_rate=3e-3, update_epochs=40), envs)
    now = situations(1500)
    picks = (torch.rand(1500, generator=torch.Generator().manual_seed(0)) * now.choice[:, 0]).long()
    pays = (now.offers[:, 1, 5] > 60).float()
    learner.learn(Choices(picks, picks, now, picks), 1.0 + (picks == 1) * (2 * pays - 1))
    chosen, new = learner.network(situations(500, seed=1)).argmax(1), situations(500, seed=1)
    assert ((chosen == 1) == (new.offers[:, 1, 5] > 60)).float().mean() > 0.8


def test_the_privileged_reward_adds_up_as_the_targets_do(envs):
    many = make_envs(envs.houses, 64, "secondary")
    learner = ViewpointQ(replace(CONFIG, sim=(), num_envs=64), many)
    r, _, seen = learner.play()
    assert seen is not None
    reward = learner.expected(r, seen)
    assert reward.sum() == pytest.approx(float(r.sum()), rel=0.1)
    assert (reward > 0).sum() > 5 * (r > 0).sum()
    assert reward.max() <= 1


def test_a_run_reports_learns_and_is_a_function_of_its_seed(envs):
    def trained() -> tuple[list[float], dict[str, torch.Tensor]]:
        own = make_envs(envs.houses, E, "secondary", preset=envs.config)
        learner = ViewpointQ(replace(CONFIG, sim=()), own)
        return [now.loss for now in learner.train()], learner.network.state_dict()

    (losses, one), (_, other) = trained(), trained()
    assert losses
    assert all(torch.equal(one[name], other[name]) for name in one)
    assert not all(torch.equal(value, one[name]) for name, value in network_of(CONFIG).state_dict().items())


def test_a_checkpoint_is_read_as_it_was_written(tmp_path):
    network = network_of(CONFIG)
    for weights in network.parameters():
        torch.nn.init.normal_(weights)
    checkpoint.save(Checkpoint(network, CONFIG, steps=3), tmp_path / "agent.safetensors")
    found = checkpoint.load(tmp_path / "agent.safetensors")
    assert found.config == CONFIG
    assert torch.equal(found.network(situations(20)), network(situations(20)))


def test_what_no_run_can_have_is_refused():
    with pytest.raises(RequestError, match="device"):
        ViewpointQConfig(device="cuda")
    with pytest.raises(RequestError, match="gamma"):
        ViewpointQConfig(gamma=1.5)
    with pytest.raises(RequestError, match="batch_size"):
        ViewpointQConfig(batch_size=0)
