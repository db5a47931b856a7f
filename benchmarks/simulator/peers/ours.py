"""The peers' house and robot in our simulator, so that our step is measured among the same lines."""

from dataclasses import replace

from benchmarks.simulator.peers.house import BOXES, DOOR, HALF, RADIUS, RANGE, SIGNS
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Door, Piece, Room
from vitruvius.sim.config import DEFAULT

ROBOT = replace(DEFAULT, range=RANGE, body=(2 * RADIUS, 2 * RADIUS))
"""Robot with 40 rays that are 3 degrees apart."""

NAMES = {sign: f"R{number}" for number, sign in enumerate(SIGNS)}


def peers_house() -> House:
    """Return the house: four rooms, a door between neighbours, 12 pieces of furniture.

    The origin is the north-western corner.
    """
    width, doors = DOOR[1] - DOOR[0], list[Door]()
    for side, begin in ((-1, HALF - DOOR[1]), (1, HALF + DOOR[0])):
        doors.append(Door(begin, HALF, width, 0.0, (NAMES[side, -1], NAMES[side, 1])))
        doors.append(Door(HALF, begin, 0.0, width, (NAMES[-1, side], NAMES[1, side])))
    return House(tuple(_room(*sign) for sign in SIGNS), tuple(doors), hub=NAMES[SIGNS[0]])


def _room(east: int, south: int) -> Room:
    """Return the room on these sides of the middle walls, with its furniture."""
    left, top = max(east, 0) * HALF, max(south, 0) * HALF
    pieces = tuple(
        Piece(x + HALF - left - width / 2, y + HALF - top - height / 2, width, height, "cupboard")
        for (x, y), (width, height) in BOXES
        if x * east > 0 and y * south > 0
    )
    return Room(left, top, HALF, HALF, NAMES[east, south], "living", pieces)
