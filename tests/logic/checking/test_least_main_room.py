"""The least main room that fits a house's rooms, compared with a search and a linear program."""

import math

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from tests.logic.house.handmade import DOOR, Sketch, built, turned_house
from vitruvius.logic import check
from vitruvius.logic.checking.least_main_room import least_area, least_rectangle

lengths = st.floats(0.5, 20.0)


@settings(max_examples=100)
@given(width=lengths, height=lengths, area=st.floats(0.1, 200.0))
def test_no_rectangle_is_smaller_than_the_least_rectangle(width: float, height: float, area: float) -> None:
    least = least_rectangle(width, height, area)
    w = np.geomspace(max(width, height / 2), 60, 3000)
    h = np.maximum.reduce([np.full_like(w, height), w / 2, area / w])
    found = (w * h)[h <= 2 * w].min()
    assert least - 1e-9 <= found <= least * 1.01


@settings(max_examples=60)
@given(data=st.data())
def test_the_least_main_room_is_that_of_rooms_pushed_together(data: st.DataObject) -> None:
    """The comparison is with a linear program that moves the rooms of each side and shrinks its wall."""
    sketch = st.builds(
        Sketch,
        st.just("bedroom"),
        st.floats(1.8, 4.0),
        st.floats(1.0, 3.0),
        door=st.floats(0.0, 1.0),
    )
    gap = data.draw(st.floats(0.0, 0.5))
    sides = []
    for _ in range(4):
        place, row = data.draw(st.sampled_from([-0.5, 0.0, 0.5])), []
        for room in data.draw(st.lists(sketch, max_size=3)):
            place = max(place, -room.door) if not row else place
            row.append(Sketch("bedroom", room.width, room.depth, place, room.door))
            place += room.width + gap
        sides.append(tuple(row))
    house = built(15.0, 15.0, tuple(sides))
    assume(not any("overlaps" in line for line in check(house)))
    gaps = [gap] * any(len(row) > 1 for row in sides)
    for one, other in ((side - 1, side) for side in range(4)):
        if sides[one] and sides[other]:
            gaps.append(max(15.0 - sides[one][-1].shift - sides[one][-1].width, sides[other][0].shift))
    least_gap = min(gaps, default=0.0)
    needed = [_shortest_wall(row, least_gap, *_corners(sides, side)) for side, row in enumerate(sides)]
    largest = max((s.width * s.depth for row in sides for s in row), default=0.0)
    expected = least_rectangle(max(needed[0], needed[2]), max(needed[1], needed[3]), largest)
    turns = data.draw(st.integers(0, 3))
    assert math.isclose(least_area(turned_house(house, turns).star), expected, rel_tol=1e-6, abs_tol=1e-6)


def _corners(sides: list, side: int) -> tuple[bool, bool]:
    """Return for each end of a side True if the chain of rooms must stay inside its corner."""
    first = bool(sides[side - 1]) and not (sides[side] and sides[side][0].shift < -1e-6)
    end = sides[side] and sides[side][-1].shift + sides[side][-1].width > 15.0 + 1e-6
    return first, bool(sides[(side + 1) % 4]) and not end


def _shortest_wall(row: tuple[Sketch, ...], gap: float, first: bool, last: bool) -> float:
    """Return the least length of a wall, by a linear program over the places of its rooms and its length."""
    if not row:
        return 0.0
    count = len(row)
    above, below = [], []

    def at_most(terms: dict[int, float], value: float) -> None:
        above.append([terms.get(k, 0.0) for k in range(count + 1)])
        below.append(value)

    for k, room in enumerate(row):
        at_most({k: -1.0}, room.door)
        at_most({k: 1.0, count: -1.0}, -room.door - DOOR)
        if k:
            at_most({k - 1: 1.0, k: -1.0}, -row[k - 1].width - gap)
    if first:
        at_most({0: -1.0}, -gap)
    if last:
        at_most({count - 1: 1.0, count: -1.0}, -row[-1].width - gap)
    bounds = [(None, None)] * count + [(0, None)]
    return float(linprog([0.0] * count + [1.0], above, below, bounds=bounds).fun)
