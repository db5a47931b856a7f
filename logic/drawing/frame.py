"""Where a house lies on a picture: metres become CSS pixels."""

from dataclasses import dataclass

from logic.drawing.canvas import Box, Point
from logic.house.house import House
from logic.house.parts import Rect

OUTER, INNER = 0.2, 0.1
"""Metres: how thick walls are drawn. In our houses they have no thickness: half of an inner wall lies on each
side of where it stands, and as much of an outer one within, so that both have one face where they go on in
each other.
"""

BEYOND = OUTER - INNER / 2
"""Metres: how much of an outer wall lies outside of the rooms."""


@dataclass(frozen=True)
class Frame:
    """Where a house lies on a picture."""

    scale: float
    """CSS pixels to a metre."""
    left: float
    """CSS pixels: where x is 0."""
    top: float
    """CSS pixels: where y is 0."""

    def at(self, x: float, y: float) -> Point:
        """A point, given in metres."""
        return self.left + self.scale * x, self.top + self.scale * y

    def box(self, rect: Rect) -> Box:
        """A rectangle, given in metres."""
        return self.place(rect.box)

    def place(self, box: Box) -> Box:
        """A box (west, north, east, south), given in metres."""
        return *self.at(*box[:2]), *self.at(*box[2:])


def thickness(house: House) -> tuple[float, float]:
    """Half of an inner wall, and how far beyond its middle an outer one would reach: metres."""
    if thick := house.wall_thickness:
        return house.half_wall, thick.outer - house.half_wall
    return INNER / 2, BEYOND


def extent(house: House) -> Box:
    """The box around the rooms of a house: (west, north, east, south), metres."""
    boxes = [room.box for room in house.rooms]
    west, north, _, _ = (min(values) for values in zip(*boxes, strict=True))
    _, _, east, south = (max(values) for values in zip(*boxes, strict=True))
    return west, north, east, south


def drawn_extent(house: House) -> Box:
    """The same with the outer walls."""
    return grown(extent(house), house.half_wall + thickness(house)[1])


def grown(box: Box, by: float) -> Box:
    """A box with so much more on each side."""
    return box[0] - by, box[1] - by, box[2] + by, box[3] + by
