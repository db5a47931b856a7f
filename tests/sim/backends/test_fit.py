"""Configurations that each backend accepts or refuses for a bank."""

from dataclasses import replace

import pytest
from msgspec import structs

from tests import sample_houses
from vitruvius.logic import House
from vitruvius.logic.house.parts import FreeWall, Provenance
from vitruvius.sim import DEFAULT
from vitruvius.sim.backends.continuous import Continuous
from vitruvius.sim.backends.free import FreeMotion
from vitruvius.sim.backends.grid import Grid

ON_GRID = sample_houses.drawn("aaaa\naaAa\naaaa\na+aa\n....\n....\n....", cell=0.45)
SLANTED = structs.replace(ON_GRID, topology="own", free_walls=(FreeWall(1, 1, 2, 1.5, 0.1),))
FINE = House.from_grid([[0] * 30] * 30, 0.1)


def test_the_continuous_backend_takes_a_configuration_as_it_is():
    assert Continuous.fit(DEFAULT, [ON_GRID, FINE]) is DEFAULT


def test_the_body_of_the_grid_is_a_cell_and_goes_a_cell_a_step():
    fitted = Grid.fit(replace(DEFAULT, collision="original", rays=8), [ON_GRID])
    assert fitted.body == pytest.approx((0.45, 0.45))
    assert fitted.eye == pytest.approx((0.225, 0.225))
    assert fitted.step == pytest.approx(0.45)
    assert (fitted.in_cells, fitted.collision, fitted.rays) == (True, "swept", 8)


def test_a_body_that_moves_freely_drives():
    assert FreeMotion.fit(replace(DEFAULT, ray_spacing=2), [SLANTED]).drives


@pytest.mark.parametrize("backend", [Continuous, Grid])
def test_backends_of_a_lattice_refuse_other_directions(backend):
    with pytest.raises(ValueError, match="ray_spacing is 2 degrees: it must divide 45"):
        backend.fit(replace(DEFAULT, ray_spacing=2), [ON_GRID])
    with pytest.raises(ValueError, match=r"house 1 of 2 has walls at an angle: the (continuous|grid) "):
        backend.fit(DEFAULT, [ON_GRID, SLANTED])


@pytest.mark.parametrize(
    ("house", "message"),
    [
        (FINE, r"cells of 0.1 m are narrower than the robot, 0.287"),
        (
            sample_houses.drawn("aa\na+\n..\n..", cell=0.28),
            "no grid with cells as wide as the robot, 0.287 m",
        ),
    ],
    ids=["map", "house"],
)
def test_cells_narrower_than_the_body_are_refused(house, message):
    with pytest.raises(ValueError, match=message):
        Grid.fit(DEFAULT, [house])


def made_for(cell, house=ON_GRID):
    """Return a house that states the side of its grid's cells."""
    return structs.replace(house, provenance=Provenance("drawn", "", {"cell": cell}, 0, 0, {}))


def test_houses_off_their_grid_or_on_different_grids_are_refused():
    with pytest.raises(ValueError, match=r"house 0 of 1: the edge at .* m does not lie on the grid of"):
        Grid.fit(DEFAULT, [made_for(0.35)])
    with pytest.raises(ValueError, match=r"grids with different cells, \[0.3, 0.45\] m"):
        Grid.fit(DEFAULT, [made_for(0.3), made_for(0.45)])


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"body": (0.3, 0.4)}, "body is 0.300 and 0.400 m: in the backend free the robot is a"),
        ({"collision": "original"}, "the backend free does not support collision 'original'"),
        (
            {"random_start": False},
            "the backend free does not support random_start=False, but a task with a start",
        ),
        ({"closed_doors": 1}, "the backend free does not support closed_doors"),
        ({"geodesic": True}, "the backend free does not support distance to the target"),
    ],
    ids=str,
)
def test_a_body_that_moves_freely_lacks_what_lattices_have(wrong, message):
    with pytest.raises(ValueError, match=message):
        FreeMotion.fit(replace(DEFAULT, **wrong), [ON_GRID])
