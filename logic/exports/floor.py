"""The floor of rooms as polygons."""

from typing import Any

import shapely

from logic.house.house import House
from logic.house.occupancy import FREE
from logic.house.parts import Room


def floor(house: House, room: Room) -> Any:
    """Return where a room has floor, metres, y growing south: of a map all free cells, of a star's main room
    what the others leave of it.
    """
    if house.occupancy:
        return shapely.union_all([shapely.box(*box) for box in house.occupancy.blocks(FREE)])
    cut = shapely.union_all([shapely.box(*each.box) for each in house.cut_from(room)])
    return shapely.box(*room.box) - cut
