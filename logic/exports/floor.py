"""The floor of rooms, and walls that stand by themselves, as shapes of shapely; metres, y growing south."""

from typing import Any

import shapely

from logic.house.house import House
from logic.house.occupancy import FREE
from logic.house.parts import FreeWall, Room


def floor(house: House, room: Room) -> Any:
    """Return where a room has floor: of a map all free cells, of a star's main room what the others leave."""
    if house.occupancy:
        return shapely.union_all([shapely.box(*box) for box in house.occupancy.blocks(FREE)])
    cut = shapely.union_all([shapely.box(*each.box) for each in house.cut_from(room)])
    return shapely.box(*room.box) - cut


def outline(wall: FreeWall) -> shapely.Polygon | shapely.LineString:
    """Return a wall at any angle as a polygon, or as a line where it has no thickness."""
    ends = (wall.x1, wall.y1), (wall.x2, wall.y2)
    return shapely.Polygon(wall.corners) if wall.thickness else shapely.LineString(ends)
