"""The original's collision rule compared with one in whole pixels, in every reachable state."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pytest

from tests import sample_houses
from vitruvius.logic import House
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.config import PIXEL

pytestmark = pytest.mark.second_part("every collision that can be reached")

STATES = {"example1": ((185, 190), 74_882), "2019-2-15": ((198, 268), 98_703)}
"""For each house: the start of the body's north-west corner in pixels, and the number of reachable states."""

STEPS = [(2, 0), (2, -2), (0, -2), (-2, -2), (-2, 0), (-2, 2), (0, 2), (2, 2)]
"""Pixels east and south of a step forward at each heading; each next heading is an eighth of a turn to the
left."""

NORTH: int = 2
BATCH = 32_768

State = tuple[int, int, int]
"""Pixels of the body's north-west corner, and its heading."""


@dataclass(frozen=True)
class Box:
    """A rectangle in whole pixels, tested like pygame's Rect."""

    x: int
    y: int
    width: int
    height: int

    @classmethod
    def of(cls, box: tuple[float, float, float, float]) -> "Box":
        west, north, east, south = (round(length / PIXEL) for length in box)
        return cls(west, north, east - west, south - north)

    def overlaps(self, x: int, y: int, side: int) -> bool:
        return (
            self.x < x + side and x < self.x + self.width and self.y < y + side and y < self.y + self.height
        )

    def contains(self, x: int, y: int, side: int) -> bool:
        return self.spans(self.x, self.width, x, side) and self.spans(self.y, self.height, y, side)

    @staticmethod
    def spans(start: int, length: int, place: int, side: int) -> bool:
        return start <= place and place + side <= start + length


class Original:
    """The original's rule.

    A body that overlaps a room without being inside it must be within the span of the room's door. A body
    inside a room must not touch furniture. A body inside no room must be inside the main room's rectangle.
    """

    def __init__(self, house: House) -> None:
        self.floor = Box.of(house.main.box)
        self.rooms = [(Box.of(room.box), Box.of(room.door.box)) for room in house.star.rooms]
        self.pieces = [Box.of(piece.box) for room in house.rooms for piece in room.pieces]

    def collides(self, state: State) -> bool:
        body = (*state[:2], 11 if state[2] % 2 else 8)
        inside = False
        for room, door in self.rooms:
            if room.contains(*body):
                inside = True
            elif room.overlaps(*body) and not self.in_doorway(door, *body):
                return True
        if inside:
            return any(piece.overlaps(*body) for piece in self.pieces)
        return not self.floor.contains(*body)

    @staticmethod
    def in_doorway(door: Box, x: int, y: int, side: int) -> bool:
        return (
            Box.spans(door.x, door.width, x, side) if door.width else Box.spans(door.y, door.height, y, side)
        )

    def moves(self, corner: tuple[int, int]) -> dict[tuple[State, int], bool]:
        """Return for each action in each reachable state True if it collides."""
        first: State = (*corner, NORTH)
        found, waiting, moves = {first}, [first], {}
        while waiting:
            state = waiting.pop()
            for action, new in enumerate(successors(state)):
                moves[state, action] = self.collides(new)
                if not moves[state, action] and new not in found:
                    found.add(new)
                    waiting.append(new)
        return moves


def successors(state: State) -> Iterator[State]:
    x, y, heading = state
    yield x, y, (heading + 1) % 8
    yield x, y, (heading - 1) % 8
    yield x + STEPS[heading][0], y + STEPS[heading][1], heading


@pytest.mark.parametrize("name", STATES)
def test_every_reachable_collision_is_the_originals_and_no_other_is(name):
    house = sample_houses.example(whole_pixels=True, name=name)
    corner, states = STATES[name]
    moves = Original(house).moves(corner)
    expected = np.array(list(moves.values()))
    poses = np.array([state for state, _ in moves], float)
    eye = poses[:, :2] + np.where(poses[:, 2] % 2, 5, 4)[:, None]
    poses = np.column_stack([eye * PIXEL, poses[:, 2] * np.pi / 4])
    actions = np.array([action for _, action in moves])
    envs = HouseVectorEnv([house], num_envs=BATCH, preset="paper")
    target = np.tile(np.array(house.main.box[:2]) + house.main.width / 2, (BATCH, 1))
    found = []
    for start in range(0, len(actions), BATCH):
        rows = np.arange(start, start + BATCH).clip(max=len(actions) - 1)
        envs.reset(seed=0, options={"house": np.zeros(BATCH, int), "pose": poses[rows], "target": target})
        found.append(envs.step(actions[rows])[2])
    found = np.concatenate(found)[: len(actions)]
    np.testing.assert_array_equal(found, expected)
    assert len(moves) == 3 * states
