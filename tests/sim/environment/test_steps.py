"""Actions of steps, as users give them and as kernels read them."""

import re

import numpy as np
import pytest
import torch
from gymnasium import spaces
from gymnasium.error import ResetNeeded

from vitruvius.sim.drive import Drive
from vitruvius.sim.environment.steps import Choices, Commands, orders, require_going_on

THREE, FIFTEEN = (Choices(spaces.Discrete(n)) for n in (3, 15))
TWO = Commands(Drive())
ASIDE = Commands(Drive(sideways=0.5))


def test_a_space_of_numbers_is_read_as_choices_and_one_of_speeds_as_commands():
    assert isinstance(orders(spaces.Discrete(3), Drive()), Choices)
    assert isinstance(orders(spaces.Box(0, 1, (2,)), Drive()), Commands)
    assert [each.words for each in (THREE, FIFTEEN, TWO, ASIDE)] == [
        "one integer, 0, 1 or 2",
        "one integer, 0 to 14",
        "two numbers, (v, w)",
        "three numbers, (vx, vy, w)",
    ]


NO_ACTIONS = [
    (THREE, [0.5], "actions must be integers 0, 1 or 2, not float64"),
    (FIFTEEN, [True], "actions must be integers 0 to 14, not bool"),
    (THREE, [[0]], "actions have shape (1, 1): give one for each of 1 environments"),
    (THREE, [3], "actions must be 0 to 2, not 3 to 3"),
    (THREE, [-1], "actions must be 0 to 2, not -1 to -1"),
    (FIFTEEN, [0, 15], "actions must be 0 to 14, not 0 to 15"),
    (TWO, ["a"], "actions must be numbers, (v, w) for each environment, not <U1"),
    (ASIDE, [False], "actions must be numbers, (vx, vy, w) for each environment, not bool"),
    (TWO, [0.0, 0.0], "actions have shape (2,): give (v, w) for each of 2 environments"),
    (ASIDE, [[0.0, 0.0]], "actions have shape (1, 2): give (vx, vy, w) for each of 1 environments"),
    (
        TWO,
        [[0, 0], [-0.1, 0]],
        "action 1 is (-0.1, 0): v from 0 to 0.7 m/s, w up to 3 rad/s in either direction",
    ),
    (TWO, [[np.nan, 0]], "action 0 is (nan, 0): v from"),
    (TWO, [[0, 3.5], [1, 0]], "action 0 is (0, 3.5): v from"),
    (ASIDE, [[0, 0.6, 0]], "action 0 is (0, 0.6, 0): vx from 0 to 0.7 m/s, vy up to 0.5 m/s, w up to 3 rad"),
]


@pytest.mark.parametrize(("how", "actions", "words"), NO_ACTIONS, ids=[words for *_, words in NO_ACTIONS])
def test_what_is_no_action_is_refused_in_words(how, actions, words):
    with pytest.raises(ValueError, match=re.escape(words)):
        how.require(how.read(actions), len(actions))


@pytest.mark.parametrize(
    ("how", "actions"),
    [(THREE, [0, 2]), (FIFTEEN, [14, 0]), (TWO, [[0, -3], [0.7, 3]]), (ASIDE, [[0.7, -0.5, 3]])],
)
def test_actions_at_their_limits_are_taken_as_arrays_and_tensors(how, actions):
    given = how.read(actions)
    how.require(given, len(actions))
    how.require(torch.from_numpy(given), len(actions))


@pytest.mark.parametrize(("how", "dtype"), [(THREE, torch.int64), (TWO, torch.float32)])
def test_tensors_have_one_type_and_are_on_the_device(how, dtype):
    given = torch.zeros((4, 2), dtype=dtype)
    np.testing.assert_array_equal(how.read_tensor(given, "cpu"), np.zeros((4, 2)))
    for wrong in (given.to(torch.int32), given.numpy(), given.to("meta")):
        with pytest.raises(ValueError, match=f"must be an? {str(dtype)[6:]} tensor on the device 'cpu'"):
            how.read_tensor(wrong, "cpu")


def test_clipped_actions_may_be_anything_but_nan():
    clips = Commands(Drive(clips=True))
    clips.require(clips.read([[np.inf, -99]]), 1)
    with pytest.raises(ValueError, match=re.escape("action 0 is (0, nan)")):
        clips.require(clips.read([[0, np.nan]]), 1)


def test_kernels_get_two_speeds_as_they_are_and_three_in_whole_parts_of_the_greatest():
    two, three = TWO.read([[0.25, -1.5]]), ASIDE.read([[0.7, -0.25, 1.5], [-9, 9, 9]])
    assert TWO.given(two) is two
    given = ASIDE.given(three)
    np.testing.assert_allclose(given, [[0.7, -0.25, 1.5], [0, 0.5, 3]], atol=2e-6)
    parts = given / np.array(ASIDE.drive.part)
    np.testing.assert_allclose(parts, np.rint(parts), atol=0.1)
    np.testing.assert_array_equal(ASIDE.given(torch.from_numpy(three)).numpy(), given)
    assert THREE.given(three) is three


def test_a_step_of_an_episode_that_has_ended_names_its_environment():
    flags = np.zeros((3, 4), bool)
    require_going_on(flags)
    for row in range(2):
        ended = flags.copy()
        ended[row, 2] = True
        with pytest.raises(ResetNeeded, match="the episode of environment 2"):
            require_going_on(ended)
