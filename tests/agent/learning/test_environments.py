"""Agent in the real simulator: the shield, and mirrored houses."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch

from tests.sample_houses import random_house
from vitruvius.agent.algorithms.pqn.config import PQNConfig
from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.avoidance import PaperRule
from vitruvius.agent.evaluation.episodes import play
from vitruvius.agent.learning.environments import make_envs, shield
from vitruvius.agent.learning.simulator import sensor, simulator, with_sensor
from vitruvius.agent.policies.policies import RandomPolicy
from vitruvius.logic import House, HouseFileError, Rect, Star, StarRoom
from vitruvius.sim import DEFAULT, PAPER, HouseVectorEnv
from vitruvius.sim.actions import FORWARD, LEFT, RIGHT
from vitruvius.sim.config import DRIVE

E = 16
EAST, NORTH = 0.0, math.pi / 2
CORRIDOR, TWO_ROOMS, MIRRORED, MIRROR = 12, 13, 14, 15


def mirror(house: House) -> House:
    """Return the house with west and east exchanged about x = 0."""

    def flipped(value: Any) -> Any:
        if isinstance(value, dict):
            changed = {key: flipped(item) for key, item in value.items()}
            return changed | {"x": -changed["x"] - changed["width"]} if "x" in changed else changed
        return [flipped(item) for item in value] if isinstance(value, list) else value

    return House.from_dict(flipped(house.to_dict()))


@pytest.fixture(scope="module")
def envs() -> HouseVectorEnv:
    """Return environments for all tests: 12 random houses and those named above.

    All tests share them, as each new one compiles its kernels.
    """
    torch.set_num_threads(1)  # batches of 16: a second thread only costs
    door = Rect(4.0, 2.0 - 0.381, 0.0, 0.762)
    hall = StarRoom(4.0, 0.5, 3.0, 3.0, type="hall", children=(), door=door)
    two_rooms = House.of_star(Star(Rect(0, 0, 4, 4), (hall,)))
    corridor = House.of_star(Star(Rect(0, 0, 8, 0.9)))
    furnished = [random_house(seed) for seed in range(13)]
    return make_envs([*furnished[:12], corridor, two_rooms, furnished[12], mirror(furnished[12])], E)


def everywhere(house: int) -> np.ndarray:
    """Return the house for each environment."""
    return np.full(E, house)


def chance(seed: int = 0) -> torch.Generator:
    return torch.Generator().manual_seed(seed)


def test_fields_of_the_simulator_replace_those_of_the_preset_and_the_sensor_is_kept_for_measuring():
    config = PQNConfig(world="paper", sim=("rays=20", "body=[0.2, 0.3]", "collision=swept", "steps=70"))
    learnt_in = replace(PAPER, rays=20, body=(0.2, 0.3), collision="swept", steps=70)
    assert simulator(config) == learnt_in
    measured_in = replace(DEFAULT, rays=20, first_ray=PAPER.first_ray, sees_angle=True)
    assert sensor(config) == measured_in


@pytest.mark.parametrize(
    "fields",
    [{"sees_kind": True}, {"sees_angle": True, "sees_kind": True, "kinds": ("table",)}],
    ids="+".join,
)
def test_what_a_body_senses_besides_changes_nothing_for_layers_and_pictures(fields):
    worlds = DEFAULT, replace(DEFAULT, **fields)
    both = [make_envs([random_house(seed) for seed in range(4)], 8, "all", preset=world) for world in worlds]
    layers = [(shield(envs), PaperRule(chance(), distance=envs.config.column("distance"))) for envs in both]
    walk, forward, blocked = RandomPolicy(layers[0][0], chance()), 0, torch.zeros(8, dtype=torch.bool)
    steps: list[Any] = [envs.reset(seed=3) for envs in both]
    for _ in range(100):
        seen = [torch.from_numpy(step[0]) for step in steps]
        for one, other in zip(*layers, strict=True):
            assert torch.equal(one(seen[0], blocked), other(seen[1], blocked))
        assert (both[0].scene(0).distance == both[1].scene(0).distance).all()
        actions = walk(seen[0], blocked)
        steps = [envs.step(actions.numpy()) for envs in both]
        forward, blocked = (
            forward + int((actions == FORWARD).sum()),
            torch.from_numpy(steps[0][-1]["blocked"]),
        )
    assert forward > 200
    assert with_sensor(DEFAULT, worlds[1]) == worlds[1]


def test_the_presets_learn_in_the_simulators_presets():
    assert {name: simulator(preset) for name, preset in PRESETS.items()} == {
        name: {"default": DEFAULT, "drive": DRIVE, "paper": PAPER}[preset.world]
        for name, preset in PRESETS.items()
    }


def test_in_a_corridor_no_step_that_the_shield_allows_is_blocked(envs):
    """In a corridor of 8 m by 0.9 m, 16 bodies walk 1500 steps, through all headings."""
    score = play(envs, RandomPolicy(shield(envs), chance()), seed=0, houses=everywhere(CORRIDOR))
    assert score.steps == E * 1500
    assert score.interventions > 1000
    assert score.blocked == 0


def test_the_shield_lets_a_body_straight_through_a_door(envs):
    """Bodies start at every offset that their margin permits, 1 m before the door, and go 1 m beyond."""
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
    """Rays are 3 degrees apart and end at 58.5: corners next to the body can stay unseen, but rarely."""
    shielded = play(envs, RandomPolicy(shield(envs), chance()), seed=0)
    free = play(envs, RandomPolicy(lambda observation, blocked: torch.ones(E, 3).bool(), chance()), seed=0)
    assert shielded.blocked < 0.05 * free.blocked


def test_in_a_flipped_house_the_rays_are_the_flipped_rays(envs):
    floor = envs.houses[MIRRORED].star.floor
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


def test_a_house_where_nothing_can_stand_is_refused_as_a_wrong_file():
    with pytest.raises(HouseFileError, match="house 0"):
        make_envs([House.of_star(Star(Rect(0, 0, 0.2, 0.2)))], 1)
