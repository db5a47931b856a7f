"""Places that the robot can reach in a house, compared with a raster of its floor."""

import math

import numpy as np
import shapely
from hypothesis import given, settings
from scipy.ndimage import label

from tests.logic.house.handmade import houses
from vitruvius.logic import House, Rect
from vitruvius.logic.checking.walk import first_space, spaces
from vitruvius.logic.house.parts import BODY


@settings(max_examples=20)
@given(houses())
def test_the_floor_that_a_body_reaches_is_that_of_a_flooded_raster(house: House) -> None:
    """A raster of 2.5 cm, flooded from the main room, reaches the same share of every room."""
    step, half = 0.025, BODY / 2
    rects = house.rooms
    x, y = np.meshgrid(
        np.arange(min(rect.box[0] for rect in rects), max(rect.box[2] for rect in rects), step),
        np.arange(min(rect.box[1] for rect in rects), max(rect.box[3] for rect in rects), step),
    )

    def within(rect: Rect, by_x: float = 0.0, by_y: float = 0.0) -> np.ndarray:
        west, north, east, south = rect.box
        return (x > west - by_x) & (x < east + by_x) & (y > north - by_y) & (y < south + by_y)

    free = np.any([within(rect, -half, -half) for rect in rects], axis=0)
    for door in (room.door for room in house.star.rooms):
        free |= within(door, -half, half) if door.width else within(door, half, -half)
    for item in (item for room in house.star.rooms for item in room.pieces):
        free &= ~within(item, half, half)
    parts = np.asarray(label(free)[0])  # pyright: ignore[reportIndexIssue]
    flooded = parts == parts[within(house.star.floor, -half, -half)].max()
    (bodies,) = spaces(house, BODY)
    main = first_space(house, bodies, BODY)
    assert math.isclose(flooded.sum() * step**2, main.area, rel_tol=0.03)
    for room in house.star.rooms:
        exact = main.intersection(shapely.box(*room.box)).area
        assert math.isclose((flooded & within(room)).sum() * step**2, exact, rel_tol=0.03, abs_tol=0.1)
