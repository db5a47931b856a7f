"""Features of GeoJSON (RFC 7946) and of its sequences, one feature per line (RFC 8142)."""

import re
from codecs import BOM_UTF8
from collections.abc import Mapping
from typing import Any

import msgspec

from vitruvius.logic.errors import RequestError
from vitruvius.logic.house.promises import Thickness
from vitruvius.logic.opener import from_json

GEOJSON = "FeatureCollection"

SEPARATOR, MAX_LINES = b"\x1e", 1 << 16
"""Record separator before each text of a sequence, and number of lines."""

SEQUENCE = re.compile(rb"(?:\xef\xbb\xbf)?[\s\x1e]*+\{")
"""Beginning of a sequence."""

GEOMETRIES = ("Polygon", "MultiPolygon")
"""Types of geometry that may be a room."""


def is_geojson(record: object) -> bool:
    """Return True if a JSON value is GeoJSON: a collection of features, a feature, or a polygon."""
    kinds = (GEOJSON, "Feature", "GeometryCollection", *GEOMETRIES)
    return isinstance(record, Mapping) and record.get("type") in kinds and "format" not in record


def from_text(content: bytes) -> Any:
    """Return the value of a JSON text, or a sequence of GeoJSON as one collection.

    A sequence has one JSON text per line, with or without a record separator before it. Raises ``ValueError``
    if the text is neither.
    """
    try:
        return from_json(content)
    except ValueError:
        lines = content.removeprefix(BOM_UTF8).replace(SEPARATOR, b"\n").split(b"\n", MAX_LINES + 1)
        if not SEQUENCE.match(content) or len(lines) > MAX_LINES:
            raise
        found = []
        for text in filter(bytes.strip, lines):
            record = from_json(text)
            if not is_geojson(record):
                raise
            found += features(record)
        return {"type": GEOJSON, "features": found}


def features(record: Mapping[str, Any]) -> list[Any]:
    """Return the features of a collection, or the single one of a feature or a geometry."""
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
    """Return the thickness of walls between rooms, in the unit of the file."""
    try:
        return msgspec.convert(thick, Thickness).inner
    except msgspec.ValidationError as error:
        raise RequestError(f"plan: wall_thickness: {error}") from None
