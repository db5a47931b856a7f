"""GeoJSON (RFC 7946), in metres instead of degrees: x east, y north, as ``generate --plan`` reads it.

Rooms come first. A feature's property ``kind`` is room, door, window, piece, wall (a free-standing one) or
area (a named part of a map). The room of a map consists of its free cells.
"""

from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import shapely
from shapely.geometry import mapping

from vitruvius.logic.exports.floor import floor
from vitruvius.logic.files.writing import write_whole
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import FreeWall, Rect


def write(house: House, path: Path) -> None:
    """Write a house as a feature collection."""
    write_whole(path.with_suffix(".geojson"), msgspec.json.encode(to_geojson(house)))


def to_geojson(house: House) -> dict[str, Any]:
    """Return a house as a feature collection."""
    features = []
    for room in house.rooms:
        part = {"part_of": room.part_of} if room.part_of else {}
        about = {"name": room.name, "type": room.type, **part}
        if house.occupancy and not features:
            features.append(_of_geometry(_cells(house), "room", **about))
        else:
            features.append(_feature(room, "area" if house.occupancy else "room", **about))
    for door in house.doors:
        leafless = {"opening": True} if door.opening else {}
        features.append(_feature(door, "door", between=door.between, **leafless))
    features += [_feature(window, "window", room=window.room) for window in house.windows]
    for room in house.rooms:
        for piece in room.pieces:
            properties = {"type": piece.type, "room": room.name, "orientation": piece.orientation}
            features.append(_feature(piece, "piece", **properties))
    for wall in house.free_walls:
        features.append(_of_geometry(_free_wall(wall), "wall"))
    thick = msgspec.to_builtins({"wall_thickness": house.wall_thickness} if house.wall_thickness else {})
    return {"type": "FeatureCollection", **thick, "features": features}


def _feature(rect: Rect, kind: str, **properties: Any) -> dict[str, Any]:
    """Return a polygon, anticlockwise as RFC 7946 requires, or a line if a side is zero."""
    # Edges are rounded, not sizes, so that shared edges stay shared. Adding 0.0 turns -0.0 into 0.0.
    edges = (rect.x, -rect.y, rect.x + rect.width, -rect.y - rect.height)
    west, north, east, south = (round(edge, 9) + 0.0 for edge in edges)
    if rect.width and rect.height:
        ring = [(west, south), (east, south), (east, north), (west, north), (west, south)]
        geometry = {"type": "Polygon", "coordinates": [ring]}
    else:
        geometry = {"type": "LineString", "coordinates": [(west, north), (east, south)]}
    return _of_geometry(geometry, kind, **properties)


def _cells(house: House) -> dict[str, Any]:
    """Return the free cells of a map, with outer rings anticlockwise and holes clockwise as in RFC 7946."""
    cells = shapely.simplify(floor(house, house.rooms[0]), 0)
    northward = shapely.transform(cells, lambda corners: np.round(corners * (1, -1), 9) + 0.0)
    return dict(mapping(shapely.orient_polygons(northward)))


def _free_wall(wall: FreeWall) -> dict[str, Any]:
    """Return a polygon, anticlockwise, or a line for a wall without a thickness."""
    if not wall.thickness:
        return {"type": "LineString", "coordinates": [(wall.x1, -wall.y1), (wall.x2, -wall.y2)]}
    ring = [(x, -y) for x, y in reversed(wall.corners)]
    return {"type": "Polygon", "coordinates": [[*ring, ring[0]]]}


def _of_geometry(geometry: dict[str, Any], kind: str, **properties: Any) -> dict[str, Any]:
    return {"type": "Feature", "properties": {"kind": kind, **properties}, "geometry": geometry}
