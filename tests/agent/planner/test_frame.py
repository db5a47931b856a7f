"""Position of a map in the house, from how the body looked at the start."""

import numpy as np
import pytest

from vitruvius.agent.planner.core.frame import metres, quarters


@pytest.mark.parametrize("turn", range(4))
def test_the_east_of_a_map_is_where_the_body_looked_and_its_south_is_to_the_right(turn: int) -> None:
    heading = turn * np.pi / 2
    ahead = np.array([np.cos(heading), -np.sin(heading)])
    right = np.array([np.sin(heading), np.cos(heading)])
    places = metres(np.array([2.0, 3.0, heading]), np.array([[4, 0], [0, 4]]), 0.5)
    assert places == pytest.approx(np.array([2.0, 3.0]) + 2 * np.array([ahead, right]))


@pytest.mark.parametrize("turn", range(4))
def test_a_body_that_looks_along_a_diagonal_has_the_map_of_the_next_quarter_clockwise(turn: int) -> None:
    assert quarters(turn * np.pi / 2 + np.pi / 4) == quarters(turn * np.pi / 2) == turn
