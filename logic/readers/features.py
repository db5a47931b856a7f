"""GeoJSON (RFC 7946): what is some, and the features of it."""

from collections.abc import Mapping
from typing import Any

import msgspec

from logic.errors import RequestError
from logic.house.promises import Thickness

GEOJSON = "FeatureCollection"

GEOMETRIES = ("Polygon", "MultiPolygon")
"""Those that may be a room."""


def is_geojson(record: object) -> bool:
    """Whether a JSON value is GeoJSON: a collection of features, a feature, or a polygon."""
    kinds = (GEOJSON, "Feature", "GeometryCollection", *GEOMETRIES)
    return isinstance(record, Mapping) and record.get("type") in kinds and "format" not in record


def features(record: Mapping[str, Any]) -> list[Any]:
    """The features of a collection, or the one that a feature or a geometry is."""
    kind = record.get("type") if isinstance(record, Mapping) else None
    if kind == GEOJSON and isinstance(record.get("features"), list) and record["features"]:
        return record["features"]
    if kind == "Feature":
        return [record]
    if kind in GEOMETRIES:
        return [{"type": "Feature", "properties": None, "geometry": record}]
    if kind == "GeometryCollection" and isinstance(record.get("geometries"), list):
        return [{"type": "Feature", "properties": None, "geometry": each} for each in record["geometries"]]
    raise RequestError(f"plan: GeoJSON is a {GEOJSON} with a list of features, a polygon for each room")


def inner_wall(thick: Any) -> float:
    """How thick walls between rooms are, in the unit of the file."""
    try:
        return msgspec.convert(thick, Thickness).inner
    except msgspec.ValidationError as error:
        raise RequestError(f"plan: wall_thickness: {error}") from None
