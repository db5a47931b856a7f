"""Conversion from metres in a house to CSS pixels in a picture."""

from dataclasses import dataclass

from vitruvius.logic.drawing.canvas import Box, Point
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Rect

OUTER_WALL_M, INNER_WALL_M = 0.2, 0.1
"""Drawn thickness of walls, metres, in houses whose walls have none.

An inner wall is centred on its line. An outer wall reaches half an inner wall into the rooms, so that its
face continues the face of an inner wall.
"""

BEYOND_OUTLINE_M = OUTER_WALL_M - INNER_WALL_M / 2
"""Width of an outer wall outside the rooms, metres."""


@dataclass(frozen=True)
class Frame:
    """Scale and origin of a house in a picture."""

    scale: float
    """CSS pixels per metre."""
    left: float
    """Position of x = 0, CSS pixels."""
    top: float
    """Position of y = 0, CSS pixels."""

    def at(self, x: float, y: float) -> Point:
        """Return a point, given in metres, in CSS pixels."""
        return self.left + self.scale * x, self.top + self.scale * y

    def box(self, rect: Rect) -> Box:
        """Return the box of a rectangle, given in metres, in CSS pixels."""
        return self.place(rect.box)

    def place(self, box: Box) -> Box:
        """Return a box (west, north, east, south), given in metres, in CSS pixels."""
        return *self.at(*box[:2]), *self.at(*box[2:])


def thickness(house: House) -> tuple[float, float]:
    """Return half an inner wall's thickness, and how far an outer wall reaches beyond that, metres."""
    if thick := house.wall_thickness:
        return house.half_wall, thick.outer - house.half_wall
    return INNER_WALL_M / 2, BEYOND_OUTLINE_M


def extent(house: House) -> Box:
    """Return the box around the rooms of a house: (west, north, east, south), metres."""
    boxes = [room.box for room in house.rooms]
    west, north, _, _ = (min(values) for values in zip(*boxes, strict=True))
    _, _, east, south = (max(values) for values in zip(*boxes, strict=True))
    return west, north, east, south


def drawn_extent(house: House) -> Box:
    """Return the box around the rooms and outer walls of a house, metres."""
    return grown(extent(house), house.half_wall + thickness(house)[1])


def grown(box: Box, by: float) -> Box:
    """Return a box that is larger by this margin on each side."""
    return box[0] - by, box[1] - by, box[2] + by, box[3] + by
