"""Shapely geometries of a room's floor and of free-standing walls, in metres; y grows south."""

from typing import Any

import shapely

from vitruvius.logic.house.house import House
from vitruvius.logic.house.occupancy import FREE
from vitruvius.logic.house.parts import FreeWall, Room


def floor(house: House, room: Room) -> Any:
    """Return the floor of a room.

    The floor of a map is all of its free cells. The floor of a star's main room excludes the other rooms.
    """
    if house.occupancy:
        return shapely.union_all([shapely.box(*box) for box in house.occupancy.blocks(FREE)])
    cut = shapely.union_all([shapely.box(*each.box) for each in house.cut_from(room)])
    return shapely.box(*room.box) - cut


def outline(wall: FreeWall) -> shapely.Polygon | shapely.LineString:
    """Return a wall at any angle as a polygon, or as a line if the wall has no thickness."""
    ends = (wall.x1, wall.y1), (wall.x2, wall.y2)
    return shapely.Polygon(wall.corners) if wall.thickness else shapely.LineString(ends)
