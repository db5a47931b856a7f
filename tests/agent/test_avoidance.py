"""Avoidance layer: the shield compared with exact geometry, the paper's rule, and the order of layers."""

import numpy as np
import pytest
import torch

from vitruvius.agent.avoidance import (
    FORWARD,
    LEFT,
    RIGHT,
    Layer,
    PaperRule,
    Shield,
    Stack,
    best_value,
    random_preference,
    subsume,
)

REACH, BODY, STEP = 7.8889, 0.2869, 0.0717
ANGLES = np.deg2rad(58.5 - 3 * np.arange(40))
SHIELD = Shield(ANGLES, REACH, BODY, STEP, margin=0.0)


def smooth(scene):
    """Return a mask without a blocked move."""
    return torch.zeros(len(scene), dtype=torch.bool)


def sight(x, y, heading, width, height):
    """Return observations (E, 40, 2) in an empty room from poses (E,); its west and north walls are at 0."""
    angle = np.asarray(heading)[:, None] + ANGLES
    with np.errstate(divide="ignore"):
        across = np.where(np.cos(angle) > 0, width - x[:, None], x[:, None]) / np.abs(np.cos(angle))
        along = np.where(np.sin(angle) < 0, height - y[:, None], y[:, None]) / np.abs(np.sin(angle))
    distance = np.minimum(np.minimum(across, along) / REACH, 1)
    return torch.tensor(np.stack([distance, np.zeros_like(distance)], -1), dtype=torch.float32)


def poses(number, width, height, seed=0):
    """Return random poses (x, y, heading) of a body that stands inside the room."""
    rng, half = np.random.default_rng(seed), BODY / 2
    x, y = rng.uniform(half, width - half, number), rng.uniform(half, height - half, number)
    return x, y, rng.integers(8, size=number)


@pytest.mark.parametrize(("width", "height"), [(0.6, 0.6), (0.5, 6.0), (3.0, 4.0)])
def test_in_an_empty_room_the_shield_forbids_exactly_the_moves_that_a_wall_blocks(width, height):
    x, y, octant = poses(5000, width, height)
    heading = octant * np.pi / 4
    after_x, after_y = x + STEP * np.round(np.cos(heading)), y - STEP * np.round(np.sin(heading))
    air = np.min([after_x, width - after_x, after_y, height - after_y], axis=0) - BODY / 2
    allowed = SHIELD(scene := sight(x, y, heading, width, height), smooth(scene))[:, FORWARD].numpy()
    clear = np.abs(air) > 1e-5  # nearer than that, rounding decides
    assert 0.1 < allowed.mean() < 0.99
    assert (allowed == (air > 0))[clear].all()


def test_the_rays_show_whether_the_heading_is_diagonal():
    x, y, octant = poses(2000, 3.0, 4.0)
    diagonal = SHIELD.diagonal(sight(x, y, octant * np.pi / 4, 3.0, 4.0)[..., 0])
    assert (diagonal.numpy() == (octant % 2 == 1)).all()


def test_a_margin_is_kept_free_before_the_body():
    heading = np.zeros(2)
    x = 3.0 - BODY / 2 - STEP - np.array([0.019, 0.021])
    scene = sight(x, np.ones(2), heading, 3.0, 4.0)
    allowed = Shield(ANGLES, REACH, BODY, STEP, margin=0.02)(scene, smooth(scene))
    assert allowed[:, FORWARD].tolist() == [False, True]


def test_a_turn_is_always_allowed_and_a_target_never_in_the_way():
    near = torch.tensor([0.01, 1.0]).repeat(1, 40, 1)
    assert SHIELD(near, smooth(near))[0].tolist() == [True, True, True]
    near[..., 1] = 0
    assert SHIELD(near, smooth(near))[0].tolist() == [True, True, False]


def test_after_a_bump_the_same_move_is_forbidden_and_then_no_longer():
    open_floor = torch.cat([torch.ones(2, 40, 1), torch.zeros(2, 40, 1)], dim=-1)
    assert SHIELD(open_floor, torch.tensor([True, False]))[:, FORWARD].tolist() == [False, True]


def test_a_closed_door_is_never_in_the_way_and_a_bump_before_one_is_a_push():
    shield = Shield(ANGLES, REACH, BODY, STEP, distance=0, door=1)
    near, far = 0.01, 0.5
    scene = torch.ones(4, 40, 3)
    scene[:, :, 1:] = 0
    scene[:, 18:22, 0] = torch.tensor([near, near, far, far])[:, None]
    scene[::2, 18:22, 1] = 1
    still, bumped = smooth(scene), ~smooth(scene)
    assert shield(scene, still)[:, FORWARD].tolist() == [True, False, True, True]
    assert shield(scene, bumped)[:, FORWARD].tolist() == [True, False, False, False]


def test_the_papers_rule_leaves_one_random_rotation_near_anything_but_the_target():
    rule = PaperRule(torch.Generator().manual_seed(0))
    scene = torch.ones(1000, 40, 2)
    scene[..., 1] = 0
    assert rule(scene, smooth(scene)).all()
    scene[:, 7, 0] = 0.048
    allowed = rule(scene, smooth(scene))
    assert not allowed[:, FORWARD].any()
    assert (allowed.sum(-1) == 1).all()
    assert 400 < allowed[:, LEFT].sum() < 600
    scene[:, 7, 1] = 1
    assert rule(scene, smooth(scene)).all()


def test_a_lower_layer_chooses_among_what_is_left_and_is_ignored_where_it_wants_nothing_of_that():
    def only(*actions: int) -> Layer:
        return lambda observation, blocked: torch.tensor([[action in actions for action in range(3)]])

    scene, no = torch.zeros(1, 40, 2), torch.zeros(1).bool()
    assert Stack(only(LEFT, RIGHT), only(FORWARD))(scene, no).tolist() == [[True, True, False]]
    assert Stack(only(LEFT, RIGHT), only(FORWARD, LEFT))(scene, no).tolist() == [[True, False, False]]
    assert Stack(only(LEFT, RIGHT), only(RIGHT), only(LEFT))(scene, no).tolist() == [[False, True, False]]


def test_the_best_allowed_action_is_taken_and_its_value_is_the_best_value():
    q = torch.tensor([[1.0, 2.0, 3.0], [1.0, 2.0, 3.0]])
    allowed = torch.tensor([[True, True, True], [True, True, False]])
    assert subsume(q, allowed).tolist() == [FORWARD, RIGHT]
    assert best_value(q, allowed).tolist() == [3.0, 2.0]


@pytest.mark.parametrize("forward", [0.93, 0.0, 1.0])
def test_random_preferences_have_the_stated_shares_also_under_a_mask(forward):
    preference = random_preference(torch.empty(20_000, 3), torch.Generator().manual_seed(0), forward)
    shares = torch.bincount(preference.argmax(-1), minlength=3) / 20_000
    assert shares.tolist() == pytest.approx([(1 - forward) / 2, (1 - forward) / 2, forward], abs=0.01)
    if forward < 1:
        masked = subsume(preference, torch.tensor([True, True, False]))
        assert (masked == LEFT).float().mean().item() == pytest.approx(0.5, abs=0.02)
