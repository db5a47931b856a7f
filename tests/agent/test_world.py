"""The agent in the real simulator: the shield, the mirror, what a rollout keeps, learning."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch

from agent.actions import FORWARD, LEFT, RIGHT
from agent.build import network_of
from agent.config import PQNConfig
from agent.evaluation.episodes import play
from agent.learner import Progress
from agent.network import QNetwork
from agent.policies import RandomPolicy
from agent.pqn import PQN
from agent.rollout import Rollout
from agent.world import make_worlds, shield
from logic import Door, House, HouseFileError, Rect, Room
from sim import HouseVectorEnv
from tests.worlds import random_house

E = 16
EAST, NORTH = 0.0, math.pi / 2
CORRIDOR, TWO_ROOMS, MIRRORED, MIRROR = 12, 13, 14, 15


def mirror(house: House) -> House:
    """The house with west and east exchanged about x = 0."""

    def flipped(value: Any) -> Any:
        if isinstance(value, dict):
            changed = {key: flipped(item) for key, item in value.items()}
            return changed | {"x": -changed["x"] - changed["width"]} if "x" in changed else changed
        return [flipped(item) for item in value] if isinstance(value, list) else value

    return House.from_dict(flipped(house.to_dict()))


@pytest.fixture(scope="module")
def envs() -> HouseVectorEnv:
    """One world for all tests, as each compiles its kernels: 12 random houses and those named above."""
    torch.set_num_threads(1)  # batches of 16: a second thread only costs
    door = Door(4.0, 2.0 - 0.381, 0.0, 0.762)
    two_rooms = House(Rect(0, 0, 4, 4), (Room(4.0, 0.5, 3.0, 3.0, type="hall", children=(), door=door),))
    corridor = House(Rect(0, 0, 8, 0.9), ())
    furnished = [random_house(seed) for seed in range(13)]
    return make_worlds([*furnished[:12], corridor, two_rooms, furnished[12], mirror(furnished[12])], E)


def everywhere(house: int) -> np.ndarray:
    """That house for each environment."""
    return np.full(E, house)


def chance(seed: int = 0) -> torch.Generator:
    return torch.Generator().manual_seed(seed)


def test_in_a_corridor_no_step_that_the_shield_allows_is_blocked(envs):
    """8 m by 0.9 m: 16 bodies walk 1500 steps, through all headings."""
    score = play(envs, RandomPolicy(shield(envs), chance()), seed=0, houses=everywhere(CORRIDOR))
    assert score.steps == E * 1500
    assert score.interventions > 1000
    assert score.blocked == 0


def test_the_shield_lets_a_body_straight_through_a_door(envs):
    """From every offset at which the body fits with its margin, 1 m before the door to 1 m behind it."""
    most = (0.762 - envs.config.body[0]) / 2 - 0.006
    poses = np.column_stack([np.full(E, 3.0), 2.0 + np.linspace(-most, most, E), np.full(E, EAST)])
    options = {"house": everywhere(TWO_ROOMS), "pose": poses, "target": np.full((E, 2), 0.5)}
    observation, layer = torch.as_tensor(envs.reset(seed=0, options=options)[0]), shield(envs)
    for _ in range(28):
        assert layer(observation, torch.zeros(E, dtype=torch.bool))[:, FORWARD].all()
        observation, _, _, _, info = envs.step_torch(torch.full((E,), FORWARD))
        assert not info["blocked"].any()
    assert (envs.step(np.full(E, LEFT))[4]["pose"][:, 0] > 4.9).all()


def test_in_furnished_houses_hardly_a_step_that_the_shield_allows_is_blocked(envs):
    """Rays are 3 degrees apart and end at 58.5: corners beside the body can stay unseen, but rarely."""
    shielded = play(envs, RandomPolicy(shield(envs), chance()), seed=0)
    free = play(envs, RandomPolicy(lambda observation, blocked: torch.ones(E, 3).bool(), chance()), seed=0)
    assert shielded.blocked < 0.05 * free.blocked


def test_a_mirrored_house_is_seen_as_the_mirror_has_it(envs):
    floor = envs.houses[MIRRORED].floor
    x, y = floor.x + floor.width / 2, floor.y + floor.height / 2
    poses, targets = np.array([[x, y, NORTH], [-x, y, NORTH]]), np.array([[x, y - 0.9], [-x, y - 0.9]])
    options = {
        "house": np.array([MIRRORED, MIRROR] * (E // 2)),
        "pose": np.tile(poses, (E // 2, 1)),
        "target": np.tile(targets, (E // 2, 1)),
    }
    observation, _ = envs.reset(seed=0, options=options)
    assert observation[0, :, 1].any()
    for action in (LEFT, FORWARD, FORWARD, RIGHT, FORWARD, LEFT, LEFT, FORWARD):
        np.testing.assert_allclose(observation[1, ::-1], observation[0], atol=1e-5)
        mirrored = action if action == FORWARD else RIGHT - action
        observation, *_ = envs.step(np.array([action, mirrored] * (E // 2)))


def filled(envs: HouseVectorEnv, network: QNetwork, *, length: int, times: int) -> tuple[torch.Tensor, ...]:
    """Observations, memories, actions and validity of so many rollouts, end to end."""
    observation = torch.as_tensor(envs.reset(seed=0)[0])
    rollout, kept = Rollout.starting(length, observation, network.memory.empty(E)), []
    for _ in range(times):
        rollout.fill(envs, network, shield(envs), epsilon=0.0, forward=0.9, generator=chance())
        kept.append(
            [part.clone() for part in (rollout.s[:-1], rollout.memory[:-1], rollout.a, rollout.valid)]
        )
    return tuple(torch.cat(parts) for parts in zip(*kept, strict=True))


def test_a_rollout_leaves_out_the_step_after_an_end_and_forgets_what_came_before(envs):
    _, memory, _, valid = filled(envs, network_of(PQNConfig()), length=500, times=4)
    assert valid.logical_not().nonzero()[:, 0].tolist() == [1500] * E
    held = memory.sum((2, 3)).gt(0)
    assert not held[[0, 1501]].any()
    assert held[1:1501].all()
    assert held[1502:].all()


def test_a_rollout_goes_on_where_the_one_before_it_ended(envs):
    network = network_of(PQNConfig())
    halves, whole = filled(envs, network, length=20, times=2), filled(envs, network, length=40, times=1)
    assert all(torch.equal(a, b) for a, b in zip(halves, whole, strict=True))


SHORT = PQNConfig(environments=E, rollout=8, steps=600)


def trained(envs: HouseVectorEnv, config: PQNConfig) -> tuple[QNetwork, list[Progress]]:
    learner = PQN(config, envs)
    return learner.network, list(learner.train())


def test_a_short_run_learns_something_and_says_how_it_goes(envs):
    network, history = trained(envs, SHORT)
    assert [progress.steps for progress in history] == [128, 256, 384, 512, 640]
    assert history[-1].fraction == 1
    assert history[0].epsilon == 0.4
    assert history[-1].epsilon == pytest.approx(SHORT.final_epsilon)
    assert all(math.isfinite(progress.loss) for progress in history)
    pairs = zip(network.parameters(), network_of(PQNConfig()).parameters(), strict=True)
    assert not any(torch.equal(weight, first) for weight, first in pairs)


def test_the_same_config_and_seed_give_the_same_weights(envs):
    one, same, other = (trained(envs, replace(SHORT, seed=seed))[0].state_dict() for seed in (1, 1, 2))
    assert all(torch.equal(one[name], same[name]) for name in one)
    assert not torch.equal(one["look.weight"], other["look.weight"])


def test_steps_that_the_world_ignores_are_not_counted(envs):
    _, history = trained(envs, replace(SHORT, rollout=1501, minibatches=1, epochs=1))
    assert history[0].steps == 1500 * E  # an episode, without the step that begins the next one


def test_a_clock_that_runs_out_ends_the_run(envs):
    _, history = trained(envs, replace(SHORT, steps=10**9, seconds=0.5))
    assert history[-1].fraction == 1
    assert history[-1].seconds < 5


def test_a_house_where_nothing_can_stand_is_refused_as_a_wrong_file():
    with pytest.raises(HouseFileError, match="house 0"):
        make_worlds([House(Rect(0, 0, 0.2, 0.2), ())], 1)
