"""What a planner makes of its rays and moves, against the NumPy reference and against the true houses."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch

from agent.learning.environments import make_envs
from logic import House, Piece, Rect, Star, StarRoom
from logic.errors import RequestError
from sim import DEFAULT, HouseVectorEnv
from sim.actions import FORWARD, LEFT, RIGHT
from sim.backends.grid.cells import STANDS, middle
from sim.backends.grid.pack import pack
from tests.agent.planner import planning, reference
from tests.agent.planner.adapter import Planner
from tests.agent.planner.conftest import STEPS, E, Walk
from tests.agent.planner.reference import SIDE, SQUARE, WAYS


def octant(pose: np.ndarray) -> int:
    return round(pose[2] / (np.pi / 4)) % 8


def in_house(walk: Walk, e: int, points: np.ndarray) -> np.ndarray:
    """Points (n, 2) in cells of a planner's frame as metres in the house, by the pose where it began."""
    start = walk.poses[0][e]
    turn = octant(start) // 2 * np.pi / 2
    x, y = points.T * walk.body.cell
    east, south = x * np.cos(turn) + y * np.sin(turn), y * np.cos(turn) - x * np.sin(turn)
    return np.stack([start[0] + east, start[1] + south], axis=-1)


def test_a_planner_knows_its_pose_from_its_own_moves(walk: Walk) -> None:
    """Exactly, by the reference; and by the simulator's poses in the house."""
    for number, (e, _, blocked, action, before, after) in enumerate(walk):
        if after.time > 1:
            assert (after.x, after.y, after.heading) == reference.moved(walk.body, before, action, blocked)
        start, pose = walk.poses[0][e], walk.poses[number // walk.envs.num_envs][e]
        place = in_house(walk, e, np.array([[after.x, after.y]]) / 2)
        np.testing.assert_allclose(place[0], pose[:2], atol=1e-4)
        assert after.heading == (octant(pose) - octant(start) + octant(start) % 2) % 8


def test_rays_show_floor_and_walls_where_the_reference_has_them(walk: Walk) -> None:
    """Cells that rays pass are seen, and those that they end on are occupied. While a body goes straight on,
    rays pass over floor that they showed before: next to none is missed.
    """
    body, nothing = walk.body, np.zeros((SIDE, SIDE), bool)
    whole, straight = np.zeros(walk.envs.num_envs), np.zeros(walk.envs.num_envs, bool)
    passed, missed, shown, left_out, poses = *np.zeros((3, STEPS + 1)), np.zeros(2), set()
    for e, observation, _, action, before, after in walk:
        time, pose = after.time, (after.x, after.y, after.heading)
        straight[e] &= time > 1 and action == 2
        known, new, was = (before.known, before.new, before.occupied) if time > 1 else (0, 0, nothing)
        due = bool(new or time % (4 if known else 2) == 1 or not (straight[e] or known))
        left_out[known] += not due
        poses.add((after.heading, after.x % 2, after.y % 2))
        least = most = hit = may_hit = nothing
        if due:  # a part of a cell each way for rounding
            least, most = (reference.shown(body, observation, *pose, slack) for slack in (-2e-3, 2e-3))
            hit, may_hit = (
                reference.occupied(reference.walls(body, observation, *pose, slack), slack)
                for slack in (-1e-3, 1e-3)
            )
        now, under = after.seen_at == time, reference.under(after.x, after.y)
        assert now[under | hit].all()
        assert not (now & ~(most | may_hit | under)).any()
        assert after.occupied[was | hit].all()
        assert not (after.occupied & ~(was | may_hit)).any()
        if straight[e] and not (body.touching and after.heading % 2):
            shown[time] += least.sum()
            passed[time] += (least & ~now).sum()
            missed[time] += (least & (after.seen_at < whole[e])).sum()
        elif due:
            assert now[least].all()
            whole[e], straight[e] = time, True
        straight[e] &= time == 1 or before.since == after.since  # else all must be shown again
    assert len(poses) >= (8 if body.touching else 24)  # of 8 headings by 4
    assert left_out.min() > 50  # where no target was known, and where one was
    assert passed.sum() > 0.4 * shown.sum()
    assert missed[:161].sum() < 1e-4 * shown[:161].sum()
    assert missed.sum() < 4e-4 * shown.sum()


def test_bodies_have_no_room_at_walls(walk: Walk) -> None:
    """Nodes close at the corners of cells that are newly occupied, or on the line of a wall that bodies
    touch; they open where a body stands.
    """
    body = walk.body
    for _, observation, blocked, action, before, after in walk:
        if after.time == 1:
            continue
        pose, new = (after.x, after.y, after.heading), after.occupied & ~before.occupied
        due = reference.due(before, action)
        least, most = (
            reference.closed(body, reference.walls(body, observation, *pose, slack), new, slack) & due
            for slack in (-1e-3, 1e-3)
        )
        must, may = before.solid | least, before.solid | most
        if pose[0] % 2 == pose[1] % 2 == 0:
            at = pose[1] // 2 % SIDE, pose[0] // 2 % SIDE
            must[at] = may[at] = False
        halted = blocked or (due and not body.may_go(observation, after.heading % 2))
        ahead = planning.stopped(body, after, must) if halted else None
        if ahead:
            must[ahead] = may[ahead] = True
        assert (after.solid | ~must).all()
        assert not (after.solid & ~may).any()


def test_what_stops_a_body_closes_the_node_ahead_and_where_it_stands_is_room(walk: Walk) -> None:
    """Something between two rays, that only a blocked move shows; and a wall that seemed to be nearer."""
    body, number, stopped = walk.body, walk.envs.num_envs, 0
    for time, inputs in enumerate(walk.inputs[:100]):
        walk.planner.step(*inputs)
        if time % 10 == 9:
            before = [walk.planner.memory(e) for e in range(number)]
            for e, memory in enumerate(before):
                memory.solid[memory.y // 2 % SIDE, memory.x // 2 % SIDE] = True
                walk.planner.write(e, memory, new=0, known=1, time=301)  # so that it does not look
            no = np.zeros(number, bool)
            walk.planner.step(inputs[0], ~no, np.full(number, 2), no)
            for e, was in enumerate(before):
                now, stands = walk.planner.memory(e), was.x % 2 == was.y % 2 == 0
                assert (now.x, now.y, now.heading) == (was.x, was.y, was.heading)
                was.solid[was.y // 2 % SIDE, was.x // 2 % SIDE] &= not stands
                ahead = planning.stopped(body, was, was.solid)
                if ahead:
                    stopped += 1
                    was.solid[ahead] = True
                assert np.array_equal(now.solid, was.solid)
    assert stopped > 10


def test_paths_may_lead_near_what_was_seen(walk: Walk) -> None:
    """At a distance along one of eight directions."""
    for step in walk:
        if step.after.time % 50 == 0:
            seen, far = step.after.seen_at > 0, [(8 * x, 8 * y) for x, y in WAYS]
            assert seen.sum() > 200
            assert np.array_equal(step.after.near, reference.grown(seen, far))
            assert 0.8 * seen.sum() < step.after.seen <= seen.sum()


def test_floor_on_the_map_is_floor_of_the_house(continuous: Walk) -> None:
    """Every wall is in its cell or within a centimetre of it; hardly a free cell has one in its midst."""
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
            off.append(gap.min(-1) / continuous.body.cell)
        assert (off[0] < 0.5 + 0.08).all()
        assert len(off[1]) > 500
        assert (off[1] < 0.4).mean() < 0.02


def last(walk: Walk) -> list[Any]:
    """The memories at a walk's end."""
    for inputs in walk.inputs:
        walk.planner.step(*inputs)
    return [walk.planner.memory(e) for e in range(walk.envs.num_envs)]


def test_bodies_that_fill_cells_have_a_wall_on_the_map_where_there_is_one(grid: Walk) -> None:
    """Between two cells that were seen: never one that is not in the house, and nearly always one that is."""
    nodes, agree = 2 * np.argwhere(np.ones((120, 120)))[:, ::-1] - 120, []
    for e, memory in enumerate(last(grid)):
        turn = octant(grid.poses[0][e]) // 2 * 2
        for heading in range(0, 8, 2):
            way = np.array(WAYS[heading])
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
    """What bodies can do at places (n, 2) m of the grid's house: a bit for each heading, and ``STANDS``."""
    bank = pack(walk.envs.houses, walk.envs.config)
    table = bank.indices.numpy()
    first, columns, rows = table[:3]
    at = (places - middle(bank.geometries[0], walk.envs.config.step)) / walk.envs.config.step
    column, row = np.rint(at).astype(int).T
    return table[first : first + columns * rows].reshape(rows, columns)[row, column]


def test_what_was_never_seen_is_not_on_the_map() -> None:
    """A room in the east that the body never turns to: small and empty, or large and furnished."""
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
    """An episode of these actions in all environments."""
    observation, info = envs.reset(seed=0, options=options)
    blocked, begun = np.zeros(E, bool), np.ones(E, bool)
    for action in actions:
        planner.step(observation, blocked, np.full(E, action), begun)
        observation, _, _, _, info = envs.step(np.full(E, action))
        blocked, begun = info["blocked"], np.zeros(E, bool)
    planner.step(observation, blocked, np.full(E, actions[-1]), begun)


@pytest.mark.parametrize("slant", [0, 1])
def test_where_no_wall_is_in_sight_an_episode_begins_at_the_first_wall(continuous: Walk, slant: int) -> None:
    """In the midst of a hall of 20 m, straight and diagonal: only there does it know how it lies to the
    walls.
    """
    room = StarRoom(0.0, 20.0, 4.0, 3.0, "hall", (), Rect(1.0, 20.0, 0.762, 0.0))
    envs = make_envs([House.of_star(Star(Rect(0, 0, 20.0, 20.0), (room,)))], E, "main")
    pose = [10.0, 10.0, slant * np.pi / 4]
    options = {"house": [0] * E, "pose": [pose] * E, "target": [[2.0, 18.0]] * E}
    assert (envs.reset(seed=0, options=options)[0][..., 0] == 1.0).all()
    replay(continuous.planner, envs, [RIGHT, LEFT] + [FORWARD] * 60, options)
    memory = continuous.planner.memory(0)
    assert memory.heading % 2 == slant
    assert memory.occupied.sum() > 20


def test_a_heading_begins_straight_or_diagonal_as_walls_show(walk: Walk) -> None:
    for _, observation, _, _, _, after in walk:
        if after.time == 1:
            assert after.heading == (reference.diagonal(walk.body, observation) or 0)


def test_an_episode_depends_on_no_other_environment_and_on_none_before(continuous: Walk) -> None:
    """Environments in reverse order, after whatever the planner did before: the same memory."""
    planner, memories = continuous.planner, last(continuous)
    for inputs in continuous.inputs:
        planner.step(*(each[::-1].copy() for each in inputs))
    for e, memory in enumerate(memories):
        for name, value in planner.memory(E - 1 - e).arrays.items():
            assert np.array_equal(value, memory.arrays[name]), name


def test_episodes_longer_than_a_cell_can_keep_are_refused() -> None:
    with pytest.raises(ValueError, match="8,18"):
        Planner(replace(DEFAULT, steps=20_000), 1)


def test_a_memory_of_another_revision_is_refused_before_anything_is_taken_up(continuous: Walk) -> None:
    planner = continuous.planner.tested
    before = planner.state
    with pytest.raises(RequestError, match="another revision"):
        planner.state = {name: torch.ones_like(value) for name, value in before.items() if name != "advice"}
    assert all(torch.equal(value, before[name]) for name, value in planner.state.items())
