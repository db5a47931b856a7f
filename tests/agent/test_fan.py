# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false
"""Which cells rays show: the table against geometry, and what a map sees against the rooms that it sees."""

from itertools import pairwise

import numpy as np
import pytest
import torch

from agent.planner import FREE, TAKEN, Planner
from agent.planner.cells import (
    DEPTH,
    FLAGS,
    NEAR,
    OCCUPIED,
    SOLID,
    TILE,
    WAYS,
    WIDEST,
    Bytes,
    Cells,
    Floats,
    Grid,
    Wholes,
)
from agent.planner.counts import HEADING, KNOWN, SINCE, TIME, X, Y
from agent.planner.fan import BESIDE, BEYOND, FINE, fan
from agent.world import make_worlds
from logic import Door, House, Rect, Room, generate
from sim import DEFAULT
from sim.runtime import Array, Launch, start, ti
from tests.worlds import random_house

ANGLES = DEFAULT.ray_angles
REACH = 55.0


def told(heading: int, odd: int) -> list[np.ndarray]:
    """Of each list (n, 3): how far a ray must reach, and the cells' middles from the eye, ahead and aside (to
    the left) of the heading, cells.
    """
    starts, _, entries = fan(ANGLES, REACH)
    begins, turn = starts[4 * heading + odd], np.pi / 4 * heading
    lists = []
    for first, last in pairwise(begins):
        far, way = entries[first:last] >> 16, entries[first:last] & 0xFFFF
        east, south = (((axis + 128) & 0xFF) - 128 for axis in (way & 0xFF, way >> 8))
        x, y = east + 0.5 - 0.5 * (odd & 1), south + 0.5 - 0.5 * (odd >> 1)
        ahead, aside = x * np.cos(turn) - y * np.sin(turn), -x * np.sin(turn) - y * np.cos(turn)
        lists.append(np.column_stack([far / FINE, ahead, aside]))
    return lists


@pytest.mark.parametrize("odd", range(4))
@pytest.mark.parametrize("heading", range(8))
def test_each_cell_before_the_eye_is_behind_one_ray_or_between_two(heading, odd):
    lists = told(heading, odd)
    assert len(lists) == 2 * len(ANGLES) - 1
    for number, cells in enumerate(lists):
        far, angle = cells[:, 0], np.arctan2(cells[:, 2], cells[:, 1])
        away = np.hypot(cells[:, 1], cells[:, 2])
        assert (np.diff(far) >= 0).all()
        # Half a cell and more before what the ray hits, whichever ray it is.
        assert (far <= away + BEYOND + 1 / FINE).all()
        along = np.sqrt(np.maximum(0, away**2 - BESIDE**2))
        assert (far >= np.minimum(along, away * np.cos(np.deg2rad(DEFAULT.ray_spacing))) + BEYOND).all()
        if number % 2:
            assert (angle < ANGLES[number // 2]).all()
            assert (angle > ANGLES[number // 2 + 1]).all()
        else:
            assert (np.abs(away * np.sin(angle - ANGLES[number // 2])) <= BESIDE + 1e-9).all()
    found = np.concatenate(lists)[:, 1:]
    # All cells' middles between the outer rays, found without a table.
    half = 0.5 * np.array([1 - (odd & 1), 1 - (odd >> 1)])
    east, south = (axis.ravel() for axis in np.meshgrid(np.arange(-60, 60), np.arange(-60, 60)))
    x, y, turn = east + half[0], south + half[1], np.pi / 4 * heading
    ahead, aside = x * np.cos(turn) - y * np.sin(turn), -x * np.sin(turn) - y * np.cos(turn)
    angle = np.arctan2(aside, ahead)
    within = (angle < ANGLES[0]) & (angle > ANGLES[-1]) & (np.hypot(x, y) + BEYOND < REACH - 0.01)
    places = {tuple(place) for place in np.rint(2 * found @ _turned(-heading)).astype(int).tolist()}
    assert len(places) == len(found)  # none is on two lists
    expected = {tuple(place) for place in np.rint(2 * np.column_stack([x, y])[within]).astype(int).tolist()}
    assert expected <= places
    assert len(places) < 1.1 * len(expected)


def _turned(heading: int) -> np.ndarray:
    """Ahead and aside of the opposite of a heading, as rows, to east and south."""
    turn = -np.pi / 4 * heading
    return np.array([[np.cos(turn), -np.sin(turn)], [-np.sin(turn), -np.cos(turn)]])


def test_ways_from_a_cell_go_round_the_torus():
    start()
    grid, chance = Grid(8), np.random.default_rng(0)
    cells, ways = chance.integers(0, 256, (2, 500, 2))

    @ti.kernel
    def ask(nodes: Wholes, packed: Wholes, ends: Wholes):
        for k in range(nodes.shape[0]):
            ends[k] = grid.beside(nodes[k], packed[k])

    packed = [(both[:, 1] << 8 | both[:, 0]).astype(np.int32) for both in (cells, ways)]
    arrays = {
        "nodes": Array.of(packed[0]),
        "packed": Array.of(packed[1]),
        "ends": Array(ti.i32, len(cells)),
    }
    Launch(ask, arrays)()
    ends = (cells + ways) % 256
    assert arrays["ends"].numpy().tolist() == (ends[:, 1] << 8 | ends[:, 0]).tolist()


@pytest.mark.parametrize(
    ("place", "solid"),
    [
        ((3.0, 2.5), {(3, 2), (3, 3)}),
        ((2.4, 5.0), {(2, 5), (3, 5)}),
        ((-1.0001, 0.5), {(-1, 0), (-1, 1)}),
        ((3.0, 3.03), {(3, 3)}),  # the wall may end here, and a door begin
        ((3.0, 2.97), {(3, 3)}),
        ((4.02, 7.0001), {(4, 7)}),
    ],
)
def test_what_touching_bodies_meet_leaves_no_room_on_its_line_alone(place, solid):
    start()
    grid = Grid(8, step=4, touching=True)

    @ti.kernel
    def ask(cells: Cells, news: Bytes, hit: Floats):
        for _ in range(1):
            grid.hit(cells, news, 0, hit[0], hit[1], 1)

    cells, news = Array(ti.u16, grid.area), Array(ti.u8, grid.area >> 2 * TILE)
    Launch(ask, {"cells": cells, "news": news, "hit": Array.of(np.array(place, np.float32))})()
    table = cells.numpy().reshape(256, 256)
    assert {((i + 128) % 256 - 128, (j + 128) % 256 - 128) for j, i in np.argwhere(table & SOLID)} == solid
    assert (table & OCCUPIED > 0).sum() >= 2  # on both sides of the line


@pytest.mark.parametrize("heading", [0.0, np.pi / 4, np.pi / 2, -3 * np.pi / 4])
def test_one_look_shows_the_room_before_the_eye_to_its_walls_and_nothing_behind_them(heading):
    """An empty room of 5 m by 4 m: of the cells that the eye's fan covers, all but the last at the walls."""
    house = House(Rect(0, 0, 5.0, 4.0), (Room(0.0, 4.0, 4.0, 3.0, "hall", (), Door(1.0, 4.0, 0.762, 0.0)),))
    worlds = make_worlds([house], 1, "main")
    eye = np.array([2.5, 2.0])
    options = {"house": [0], "pose": [[*eye, heading]], "target": [[0.6, 0.6]]}
    observation, _ = worlds.reset(seed=0, options=options)
    maps, no = Planner(worlds.config, 1), torch.zeros(1).bool()
    maps.step(torch.as_tensor(observation), no, torch.zeros(1, dtype=torch.int64), ~no)
    cells = maps.occupancy(0)
    south, east = (np.indices(cells.shape) - 127.5) * maps.cell
    octant = round(heading / (np.pi / 4)) % 8
    turn = (octant - octant % 2) * np.pi / 4  # the map's own east, where the episode began
    x = eye[0] + east * np.cos(turn) + south * np.sin(turn)
    y = eye[1] + south * np.cos(turn) - east * np.sin(turn)
    angle = (np.arctan2(eye[1] - y, x - eye[0]) - heading + np.pi) % (2 * np.pi) - np.pi
    covered = (angle < ANGLES[0]) & (angle > ANGLES[-1])
    target = (np.abs(x - 0.6) < 0.4) & (np.abs(y - 0.6) < 0.4)
    inside = np.minimum(np.minimum(x, 5.0 - x), np.minimum(y, 4.0 - y)) / maps.cell
    behind = np.hypot(x - 0.6, y - 0.6) < 1.2  # the target's shadow
    door = y > 3.9
    assert ((cells == FREE)[(inside > 1.5) & covered & ~behind]).all()
    assert not (cells == FREE)[(inside < -0.5) & ~door].any()
    assert not (cells == TAKEN)[(np.abs(inside) > 1.1) & ~door & ~target].any()


def test_ways_may_lead_where_something_was_seen_at_a_distance_along_one_of_eight_directions():
    """The bit that says so, against the cells that were seen, moved in NumPy."""
    house = House(Rect(0, 0, 5.0, 4.0), (Room(0.0, 4.0, 4.0, 3.0, "hall", (), Door(1.0, 4.0, 0.762, 0.0)),))
    worlds = make_worlds([house], 1, "main")
    observation, _ = worlds.reset(seed=0)
    maps, no = Planner(worlds.config, 1), torch.zeros(1).bool()
    maps.step(torch.as_tensor(observation), no, torch.zeros(1, dtype=torch.int64), ~no)
    for action in (0, 2, 2, 1, 2, 2, 0, 0, 2):
        observation, _, _, _, info = worlds.step(np.array([action]))
        maps.step(torch.as_tensor(observation), torch.as_tensor(info["blocked"]), torch.tensor([action]), no)
    cells = maps.arrays["cells"].numpy().reshape(256, 256)
    near = seen = cells >> FLAGS > 0
    for dx, dy in WAYS:
        near = near | np.roll(seen, (DEPTH * dy, DEPTH * dx), axis=(0, 1))
    assert seen.sum() > 200
    assert np.array_equal(cells & NEAR > 0, near)


def test_between_two_rays_nothing_is_seen_beyond_the_shorter_of_them():
    """One look from many starts in a furnished house, where near pieces stand before far walls."""
    number = 40
    worlds = make_worlds([random_house(0)], number, "main")
    observation, _ = worlds.reset(seed=2)
    maps, no = Planner(worlds.config, number), torch.zeros(number).bool()
    maps.step(torch.as_tensor(observation), no, torch.zeros(number, dtype=torch.int64), ~no)
    reach = observation[..., 0] * worlds.config.range / maps.cell
    kept_from = 0
    for e in range(number):
        cells = maps.occupancy(e)
        south, east = np.indices(cells.shape) - 127.5
        heading = maps.pose(e)[2] * np.pi / 4
        angle = (np.arctan2(-south, east) - heading + np.pi) % (2 * np.pi) - np.pi
        before = np.searchsorted(-ANGLES, -angle) - 1
        inside = (before >= 0) & (before < len(ANGLES) - 1)
        before = np.clip(before, 0, len(ANGLES) - 2)
        away = np.hypot(south, east)
        apart = away * np.sin(np.minimum(np.abs(angle - ANGLES[before]), np.abs(angle - ANGLES[before + 1])))
        beyond = inside & (apart > BESIDE) & (away > np.minimum(reach[e, before], reach[e, before + 1]) + 1.5)
        assert not (cells == FREE)[beyond].any()
        kept_from += (beyond & (away < np.maximum(reach[e, before], reach[e, before + 1]) - 1.5)).sum()
    assert kept_from > 200


@pytest.mark.parametrize("backend", ["continuous", "grid"])
def test_each_sweep_is_the_fan_of_the_eye_where_it_stands(backend):
    """What a kernel stamps with a step, against the same lists in NumPy: bodies on cells' corners and between
    them, at all headings, by advice and at random. Beside the fan it notes the body and what rays hit. Where
    nothing is new it may leave steps out, and where a body goes straight on, what was noted since it did.
    """
    number = 8
    houses = [random_house(0)] if backend == "continuous" else list(generate(3, seed=5, count=1, cell=0.3))
    worlds = make_worlds(houses, number, "mixed", backend=backend)
    observation, _ = worlds.reset(seed=2)
    maps, begun, chance = Planner(worlds.config, number), torch.ones(number).bool(), np.random.default_rng(0)
    blocked, actions = torch.zeros(number).bool(), np.zeros(number, np.int64)
    starts, _, entries = fan(ANGLES, worlds.config.range / maps.cell)
    poses, left_out, pickups, passed, missed, shown = set(), np.zeros(2, int), 0, 0, 0, 0
    new, known, since = np.zeros(number), np.zeros(number, int), np.ones(number)
    whole, straight = np.zeros(number), np.zeros(number, bool)  # when all was noted last; nothing else since
    for _ in range(160):
        straight &= ~(begun.numpy() | (actions < 2))
        maps.step(torch.as_tensor(observation), blocked, torch.as_tensor(actions), begun)
        # Half a part of a cell is for the kernel's rounding, in float32.
        reach = observation[..., 0].astype(float) * worlds.config.range / maps.cell * FINE
        cells, counts = maps.arrays["cells"].numpy().reshape(number, 256, 256), maps._counts.numpy()
        for e in range(number):
            time, x, y, heading = counts[e, [TIME, X, Y, HEADING]].tolist()
            due = new[e] > 0 or time % (4 if known[e] else 2) == 1 or not (straight[e] or known[e])
            left_out[known[e]] += not due
            poses.add((heading, x & 1, y & 1))
            first = starts[4 * heading + (x & 1) + 2 * (y & 1)]
            stamps = (cells[e] & ~np.uint16(OCCUPIED)) >> FLAGS
            least, most = np.zeros((2, 256, 256), bool)
            for list_, (begin, end) in enumerate(pairwise(first)):
                ray = list_ // 2
                far = reach[e, ray] if list_ % 2 == 0 else min(reach[e, ray], reach[e, ray + 1])
                way, needs = entries[begin:end] & 0xFFFF, entries[begin:end] >> 16
                south, east = ((y >> 1) + (way >> 8)) % 256, ((x >> 1) + way) % 256
                least[south, east] |= needs <= far - 1
                most[south, east] |= needs <= far + 1
            ends = reach[e] / FINE
            angle = ANGLES + heading * np.pi / 4
            hits = np.column_stack([-ends * np.sin(angle), ends * np.cos(angle)])
            hits = hits[(observation[e, :, 0] < 1) & (observation[e, :, -1] == 0)]
            if not due:  # but what is under the body
                least[:] = most[:] = False
                hits = hits[:0]
            elif straight[e] and not (backend == "grid" and heading % 2):
                passed += (stamps < time)[least].sum()
                missed += (stamps < whole[e])[least].sum()
                shown += least.sum()
            else:
                assert (stamps == time)[least].all()
                whole[e], straight[e] = time, True
            south, east = np.floor(np.array([y, x]) / 2 + hits).astype(int).T % 256
            assert (cells[e][south, east] & OCCUPIED > 0).all()
            more = np.argwhere((stamps == time) & ~most)
            off = (more - 128 + 0.5 - np.array([y, x]) / 2 + 128 + 128) % 256 - 128
            near = np.full(len(off), 9.0)
            if len(hits):
                near = np.abs(off[:, None] - hits).max(-1).min(-1, initial=9)
            assert ((np.hypot(*off.T) < 1.6) | (near < WIDEST / 2 + 1)).all()
        again = counts[:, SINCE] == since  # else a pick-up: all must be noted again
        straight &= again
        pickups += (~again).sum()
        new, known, since = maps.new.numpy().copy(), counts[:, KNOWN].copy(), counts[:, SINCE].copy()
        advised = chance.random(number) < 0.8
        actions = np.where(advised, maps.advice.numpy(), chance.choice(3, number, p=[0.2, 0.1, 0.7]))
        observation, _, _, _, info = worlds.step(actions)
        blocked, begun = torch.as_tensor(info["blocked"]), torch.zeros(number).bool()
    assert len(poses) >= (24 if backend == "continuous" else 8)  # of 8 headings by 4
    assert left_out.min() > 50  # where no target was known, and where one was
    assert pickups > 5
    # What was passed over had been noted since the body went straight on: but one cell in ten thousand.
    assert passed > 0.4 * shown
    assert missed < 1e-4 * shown
