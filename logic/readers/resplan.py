"""ResPlan (Abouagour and Garyfallidis, 2025): geometries by type, of one flat, with y as in pictures.

The data set is a pickle, which can run any code of its writer, so that this module does not read it.
``json.dump(plan, file, default=shapely.geometry.mapping)`` writes one plan of it as JSON. In Python
``generate`` takes the plan itself.
"""

from collections.abc import Mapping
from typing import Any

import shapely
from shapely import Geometry
from shapely.geometry import shape

from vitruvius.logic.errors import RequestError
from vitruvius.logic.readers.sketch import Passage, Sketch, Space, polygons, require_none, require_plain

FORMAT = "a plan of ResPlan"

PARTS = ("inner", "wall", "door", "window")
"""Keys of every plan in addition to its rooms."""

OTHERS = (*PARTS, "front_door", "land")
"""Keys of geometries that are no rooms."""


def is_resplan(_: bytes, record: Any) -> bool:
    """Return True if a value is a plan of ResPlan."""
    return isinstance(record, Mapping) and set(PARTS) <= record.keys()


def read_resplan(_: bytes, record: Any, storey: str | None) -> Sketch:
    """Return each polygon of a type as a room.

    A plan is 256 units wide. Its ``area`` in square metres determines the metres per unit.
    """
    require_none(storey)
    drawn = {
        key: _geometry(key, value)
        for key, value in record.items()
        if key not in ("wall", "land") and _is_geometry(value)
    }
    require_plain(list(drawn.values()))
    shapes = {key: list(polygons(each)) for key, each in drawn.items()}
    spaces = [Space(key, (key,), each) for key in shapes if key not in OTHERS for each in shapes[key]]
    doors = [
        Passage(each, key == "front_door") for key in ("door", "front_door") for each in shapes.get(key, [])
    ]
    inner, area = sum(each.area for each in shapes.get("inner", [])), record.get("area")
    found = Sketch(FORMAT, spaces, doors, list(shapes.get("window", [])), has_walls=True)
    if isinstance(area, int | float) and area > 0 and inner > 0:
        return found._replace(unit=(float(area) / inner) ** 0.5)
    return found._replace(guessed="it has no area that reveals its unit: assuming metres")


def _is_geometry(value: Any) -> bool:
    return hasattr(value, "__geo_interface__") or (isinstance(value, Mapping) and "type" in value)


def _geometry(key: str, value: Any) -> Geometry:
    try:
        return shape(value)
    except (shapely.errors.ShapelyError, ValueError, TypeError, KeyError, IndexError, AttributeError):
        raise RequestError(f"plan: {key} of {FORMAT} is not a GeoJSON geometry") from None
