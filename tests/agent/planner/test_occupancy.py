"""The occupancy map of a planner, against the rays themselves and the true houses."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch

from tests.agent.planner.adapter import SIDE, Planner
from tests.agent.planner.brute_force import about
from tests.agent.planner.conftest import E, Step, Walk
from vitruvius.agent.learning.environments import make_envs
from vitruvius.logic import House, Piece, Rect, Star, StarRoom
from vitruvius.logic.errors import RequestError
from vitruvius.sim import DEFAULT, HouseVectorEnv
from vitruvius.sim.actions import FORWARD, HEADINGS, LEFT, RIGHT
from vitruvius.sim.backends.grid.cells import STANDS, middle
from vitruvius.sim.backends.grid.pack import pack

SQUARE = ((0, 0), (0, 1), (1, 0), (1, 1))


def octant(pose: np.ndarray) -> int:
    return round(pose[2] / (np.pi / 4)) % 8


def in_house(walk: Walk, e: int, points: np.ndarray) -> np.ndarray:
    """Return points (n, 2) in cells of a planner's frame as metres in the house, by the first pose."""
    start = walk.poses[0][e]
    turn = octant(start) // 2 * np.pi / 2
    x, y = points.T * walk.cell
    east, south = x * np.cos(turn) + y * np.sin(turn), y * np.cos(turn) - x * np.sin(turn)
    return np.stack([start[0] + east, start[1] + south], axis=-1)


def test_a_planner_knows_its_pose_from_its_own_moves(walk: Walk) -> None:
    """Exactly, by the simulator's poses in the house; it tells a diagonal start from a straight one."""
    for number, (e, _, _, _, _, after) in enumerate(walk):
        start, pose = walk.poses[0][e], walk.poses[number // walk.envs.num_envs][e]
        place = in_house(walk, e, np.array([[after.x, after.y]]) / 2)
        np.testing.assert_allclose(place[0], pose[:2], atol=1e-4)
        assert after.heading == (octant(pose) - octant(start) + octant(start) % 2) % 8


def ends(walk: Walk, step: Step) -> np.ndarray:
    """Return the ends of rays (R, 2), in cells of the planner's frame."""
    world, after = walk.envs.config, step.after
    angles = world.ray_angles + after.heading * np.pi / 4
    far = step.observation[:, 0].astype(float)[:, None] * world.range / walk.cell
    return np.array([after.x, after.y]) / 2 + far * np.column_stack([np.cos(angles), -np.sin(angles)])


def cells(places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the rows and columns of the cells that places (n, 2) lie in."""
    column, row = np.floor(places).astype(int).T % SIDE
    return row, column


def test_floor_that_rays_pass_is_seen_and_none_beyond_their_ends(walk: Walk) -> None:
    """Rays see the cells that they cross in their middle, up to a cell before their end.

    One cell in a thousand may be missing. Among cells that are seen now, none lies more than a cell beyond
    the ends of the two nearest rays.
    """
    passed, missed = 0, 0
    for step in walk:
        after, far = step.after, ends(walk, step)
        if after.time % 4 == step.e % 4 and after.straight == 0:  # rays were swept
            eye = np.array([after.x, after.y]) / 2
            long = np.hypot(*(far - eye).T)
            along = np.arange(0.5, long.max(), 0.5)[:, None]
            places = (eye + along[..., None] * (far - eye) / np.maximum(long, 1e-9)[:, None])[
                along < long - 1
            ]
            places = places[(np.abs(places % 1 - 0.5) < 0.25).all(1)]
            passed, missed = passed + len(places), missed + (after.seen_at[cells(places)] == 0).sum()
            now = np.argwhere((after.seen_at == after.time) & ~after.occupied)[:, ::-1] + 0.5
            now = (now - eye + 128) % SIDE - 128
            way = np.arctan2(-now[:, 1], now[:, 0]) - after.heading * np.pi / 4
            off = np.abs((way[:, None] - walk.envs.config.ray_angles + np.pi) % (2 * np.pi) - np.pi)
            about = np.sort(off, axis=1)[:, 1] + 1e-6
            reach = np.where(off <= about[:, None], long, 0).max(1)
            assert (np.hypot(*now.T) < np.maximum(reach, 1) + 1).all()
    assert passed > 10_000
    assert missed < 1e-3 * passed


def test_walls_are_occupied_where_rays_end_and_where_two_ends_join(walk: Walk) -> None:
    """Each cell in which swept rays end is occupied.

    No other cell is, except within a centimetre of an end or of the line between two adjacent ends.
    """
    checked = 0
    for step in walk:
        after, before = step.after, step.before
        hit = (step.observation[:, 0] < 1) & (step.observation[:, -1] == 0)
        far = ends(walk, step)
        new = after.occupied & ~before.occupied if after.time > 1 else after.occupied
        if not new.any():
            continue
        assert after.occupied[cells(far[hit])].all()
        joined = hit[1:] & hit[:-1]
        parts = np.linspace(far[:-1][joined], far[1:][joined], 60).reshape(-1, 2)
        middles = np.argwhere(new)[:, ::-1] + 0.5
        off = np.abs((middles[:, None] - np.concatenate([far[hit], parts]) + 128) % SIDE - 128).max(-1).min(1)
        assert (off < 0.5 + 0.07 + 0.05).all()
        checked += len(off)
    assert checked > 200


def test_bodies_have_no_room_at_the_corners_of_occupied_cells(continuous: Walk) -> None:
    """Nor where something stopped them; but where they have stood there is."""
    halted, stood = np.zeros((2, E, SIDE, SIDE), bool)
    for e, _, blocked, _, _, after in continuous:
        if blocked or not after.forward:
            dx, dy = HEADINGS[after.heading]
            for x, y in about(after.x + dx, after.y + dy):
                halted[e, y % SIDE, x % SIDE] = True
        if after.x % 2 == after.y % 2 == 0:
            here = after.y // 2 % SIDE, after.x // 2 % SIDE
            stood[e][here] = True
            assert not after.solid[here]
        if after.time % 5 == 0:
            corners = np.any([np.roll(after.occupied, way, (0, 1)) for way in SQUARE], axis=0)
            assert not (after.solid & ~corners & ~halted[e]).any()
            assert not (corners & ~after.solid & ~stood[e]).any()


def test_paths_may_lead_near_what_was_seen(walk: Walk) -> None:
    """The distance is along one of eight directions."""
    for step in walk:
        if step.after.time % 50 == 0:
            seen = step.after.seen_at > 0
            near = np.any([seen, *(np.roll(seen, (8 * y, 8 * x), (0, 1)) for x, y in HEADINGS)], axis=0)
            assert seen.sum() > 200
            assert np.array_equal(step.after.near, near)
            assert 0.8 * seen.sum() < step.after.seen <= seen.sum()


def test_floor_on_the_map_is_floor_of_the_house(continuous: Walk) -> None:
    """Every wall is in its cell or within a centimetre of it; hardly a free cell has a wall in its middle."""
    for e, house in enumerate(continuous.houses):
        memory = last(continuous)[e]
        boxes = [house.star.floor.box, *(room.box for room in house.star.rooms)]
        boxes += [piece.box for room in house.star.rooms for piece in room.pieces]
        w, n, east, s = np.array(boxes).T
        sides = [
            np.stack(side, 1) for side in ((w, n, east, n), (w, s, east, s), (w, n, w, s), (east, n, east, s))
        ]
        sides, off = np.concatenate(sides), []
        for cells in (memory.occupied, (memory.seen_at > 0) & ~memory.occupied):
            middles = (np.argwhere(cells)[:, ::-1] + 128) % SIDE - 128 + 0.5
            at = in_house(continuous, e, middles)[:, None]
            gap = np.abs(at - np.clip(at, sides[:, :2], sides[:, 2:])).max(-1)
            off.append(gap.min(-1) / continuous.cell)
        assert (off[0] < 0.5 + 0.08).all()
        assert len(off[1]) > 500
        assert (off[1] < 0.4).mean() < 0.02


def last(walk: Walk) -> list[Any]:
    """Return the memories at a walk's end."""
    for inputs in walk.inputs:
        walk.planner.step(*inputs)
    return [walk.planner.memory(e) for e in range(walk.envs.num_envs)]


def test_bodies_that_fill_cells_have_a_wall_on_the_map_where_there_is_one(grid: Walk) -> None:
    """Walls lie between two seen cells: none that the house lacks, and nearly all that it has."""
    nodes, agree = 2 * np.argwhere(np.ones((120, 120)))[:, ::-1] - 120, []
    for e, memory in enumerate(last(grid)):
        turn = octant(grid.poses[0][e]) // 2 * 2
        for heading in range(0, 8, 2):
            way = np.array(HEADINGS[heading])
            about = [way * k - corner for k in (0, 2) for corner in SQUARE]
            seen = [memory.seen_at[tuple((nodes + place)[:, ::-1].T % SIDE)] > 0 for place in about]
            there = nodes[np.all(seen, axis=0)]
            can = abilities(grid, in_house(grid, e, there))
            solid = [memory.solid[tuple((there + k * way)[:, ::-1].T % SIDE)] for k in (0, 1, 2)]
            open_, stands, free = (
                can >> (heading + turn) % 8 & 1 == 1,
                can >> STANDS & 1 == 1,
                ~np.any(solid, axis=0),
            )
            assert stands.sum() > 100
            assert free[open_].all()
            agree.append((free == open_)[stands])
    assert np.concatenate(agree).mean() > 0.99


def abilities(walk: Walk, places: np.ndarray) -> np.ndarray:
    """Return what bodies can do at places (n, 2) m of the house: a bit per heading, and ``STANDS``."""
    bank = pack(walk.envs.houses, walk.envs.config)
    table = bank.indices.numpy()
    first, columns, rows = table[:3]
    at = (places - middle(bank.geometries[0], walk.envs.config.step)) / walk.envs.config.step
    column, row = np.rint(at).astype(int).T
    return table[first : first + columns * rows].reshape(rows, columns)[row, column]


def test_what_was_never_seen_is_not_on_the_map() -> None:
    """The room in the east, to which the body never turns, is small and empty, or large and furnished."""
    memories, table = [], Piece(8.5, 1.0, 0.5, 0.5, type="table")
    for depth, pieces in ((2.0, ()), (3.5, (table,))):
        hidden = StarRoom(6.0, 0.5, depth, 2.5, "hall", pieces, Rect(6.0, 1.0, 0.0, 0.762))
        near = StarRoom(0.0, 4.0, 4.0, 3.0, "hall", (), Rect(1.0, 4.0, 0.762, 0.0))
        envs = make_envs([House.of_star(Star(Rect(0, 0, 6.0, 4.0), (near, hidden)))], E, "main")
        options = {"house": [0] * E, "pose": [[3.0, 2.0, np.pi]] * E, "target": [[0.6, 0.6]] * E}
        turns = [LEFT, RIGHT, FORWARD, FORWARD, RIGHT, FORWARD, LEFT] * 4
        planner = Planner(envs.config, E)
        replay(planner, envs, turns, options)
        memories.append([array.numpy() for array in planner.tested.arrays.values()])
    assert all(np.array_equal(*pair) for pair in zip(*memories, strict=True))


def replay(planner: Planner, envs: HouseVectorEnv, actions: list[int], options: dict[str, Any]) -> None:
    """Play an episode of these actions in all environments."""
    observation, info = envs.reset(seed=0, options=options)
    blocked, begun = np.zeros(E, bool), np.ones(E, bool)
    for action in actions:
        planner.step(observation, blocked, np.full(E, action), begun)
        observation, _, _, _, info = envs.step(np.full(E, action))
        blocked, begun = info["blocked"], np.zeros(E, bool)
    planner.step(observation, blocked, np.full(E, actions[-1]), begun)


@pytest.mark.parametrize("slant", [0, 1])
def test_where_no_wall_is_in_sight_an_episode_begins_at_the_first_wall(continuous: Walk, slant: int) -> None:
    """A body in the middle of a hall of 20 m learns its angle to the walls only there."""
    room = StarRoom(0.0, 20.0, 4.0, 3.0, "hall", (), Rect(1.0, 20.0, 0.762, 0.0))
    envs = make_envs([House.of_star(Star(Rect(0, 0, 20.0, 20.0), (room,)))], E, "main")
    pose = [10.0, 10.0, slant * np.pi / 4]
    options = {"house": [0] * E, "pose": [pose] * E, "target": [[2.0, 18.0]] * E}
    assert (envs.reset(seed=0, options=options)[0][..., 0] == 1.0).all()
    replay(continuous.planner, envs, [RIGHT, LEFT] + [FORWARD] * 60, options)
    memory = continuous.planner.memory(0)
    assert memory.heading % 2 == slant
    assert memory.occupied.sum() > 20


def test_an_episode_depends_on_no_other_environment_and_on_none_before(continuous: Walk) -> None:
    """Environments in reverse order, after whatever the planner did before, or one alone: the same memory."""
    planner, memories, alone = continuous.planner, last(continuous), Planner(continuous.envs.config, 1)
    for inputs in continuous.inputs:
        planner.step(*(each[::-1].copy() for each in inputs))
        alone.step(*(each[:1].copy() for each in inputs))
    for e, memory in enumerate(memories):
        for name, value in planner.memory(E - 1 - e).arrays.items():
            assert np.array_equal(value, memory.arrays[name]), name
    for name, value in alone.memory(0).arrays.items():
        assert np.array_equal(value, memories[0].arrays[name]), name


def test_episodes_longer_than_a_cell_can_keep_are_refused() -> None:
    with pytest.raises(ValueError, match="8,18"):
        Planner(replace(DEFAULT, steps=20_000), 1)


def test_a_memory_of_another_revision_is_refused_before_anything_is_taken_up(continuous: Walk) -> None:
    planner = continuous.planner.tested
    before = planner.state
    with pytest.raises(RequestError, match="another revision"):
        planner.state = {name: torch.ones_like(value) for name, value in before.items() if name != "advice"}
    assert all(torch.equal(value, before[name]) for name, value in planner.state.items())
