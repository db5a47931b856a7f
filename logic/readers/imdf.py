"""IMDF (OGC 20-094, Apple): GeoJSON in degrees, of units and openings; its archive, or one collection.

A unit has a category and names by language; an opening is a line in a wall.
"""

from collections.abc import Iterable, Mapping, Sequence
from math import cos, radians, sin, sqrt
from typing import Any
from zipfile import ZipFile

import numpy as np
import shapely
from shapely.geometry import shape

from logic.errors import RequestError
from logic.house.parts import MOST_OPENINGS, MOST_ROOMS
from logic.opener import archive_of, from_json, member_of
from logic.readers.sketch import Passage, Sketch, Space, polygons, require_plain

FORMAT = "IMDF"

ZIP = b"PK\x03\x04"

MEMBERS = ("unit.geojson", "opening.geojson")

MOST_BYTES = 1 << 24
"""Size of all files of an archive together, unpacked."""

EQUATOR, ECCENTRICITY = 6378137.0, 0.00669437999014
"""Of WGS 84: the radius, metres, and the square of the first eccentricity."""


def is_imdf(content: bytes, record: Any) -> bool:
    """Whether a file is an archive of IMDF or a collection of its features."""
    if content.startswith(ZIP):
        return any(name.endswith(MEMBERS[0]) for name in _archive(content).namelist())
    features = record.get("features") if isinstance(record, Mapping) else None
    return isinstance(features, list) and any(_kind(each) == "unit" for each in features)


def read_imdf(content: bytes, record: Any) -> Sketch:
    """Units are rooms and openings doors, on the plane that touches the earth in their midst."""
    features = _unpacked(content) if content.startswith(ZIP) else record["features"]
    units, openings = ([each for each in features if _kind(each) == kind] for kind in ("unit", "opening"))
    if len(units) > MOST_ROOMS or len(openings) > MOST_OPENINGS:
        raise RequestError(
            f"plan: it has {len(units):,} units and {len(openings):,} openings: at most {MOST_ROOMS:,} and "
            f"{MOST_OPENINGS:,} are read"
        )
    levels = {str(_properties(each).get("level_id")) for each in units}
    if len(levels) > 1:
        raise RequestError(
            f"plan: it has {len(levels)} levels ({', '.join(sorted(levels)[:4])}): keep the features of one "
            "level_id"
        )
    spaces = [space for each in units for space in _spaces(each)]
    doors = [Passage(_geometry(each)) for each in openings]
    if not spaces:
        raise RequestError("plan: IMDF has units with polygons: it has none")
    _require_plain(spaces)
    lon, lat = shapely.union_all([each.shape for each in spaces]).centroid.coords[0]
    if not (abs(lon) <= 180 and abs(lat) < 89):
        raise RequestError(f"plan: IMDF is in degrees of longitude and latitude: {lon:g}, {lat:g} are none")
    flat = _plane(lon, lat)
    spaces = [space._replace(shape=shapely.transform(space.shape, flat)) for space in spaces]
    return Sketch(
        FORMAT, spaces, [Passage(shapely.transform(each.shape, flat)) for each in doors], [], north_up=True
    )


def _require_plain(spaces: Sequence[Space]) -> None:
    try:
        require_plain([each.shape for each in spaces])
    except ValueError as error:
        raise RequestError(f"plan: {FORMAT}: {error}") from None


def _plane(lon: float, lat: float) -> Any:
    """From degrees to metres east and north of a point: exact to a millimetre within a house."""
    curve = 1 - ECCENTRICITY * sin(radians(lat)) ** 2
    east = radians(1) * EQUATOR / sqrt(curve) * cos(radians(lat))
    north = radians(1) * EQUATOR * (1 - ECCENTRICITY) / curve**1.5
    return lambda points: (points - np.array([lon, lat])) * np.array([east, north])


def _spaces(unit: Any) -> Iterable[Space]:
    """A room for each polygon of a unit."""
    properties = _properties(unit)
    labels = properties.get("name")
    named = [str(each) for each in labels.values() if each] if isinstance(labels, Mapping) else []
    category = str(properties.get("category") or "")
    for part in polygons(_geometry(unit)):
        yield Space((named or [category])[0], (*named, category), part)


def _geometry(feature: Any) -> Any:
    try:
        found = shape(feature["geometry"])
        list(polygons(found))  # whether it can be
    except (shapely.errors.ShapelyError, ValueError, TypeError, KeyError, IndexError, AttributeError):
        raise RequestError(f"plan: the geometry of {_kind(feature)} {feature.get('id')} is none") from None
    return found


def _kind(feature: Any) -> Any:
    return feature.get("feature_type") if isinstance(feature, Mapping) else None


def _properties(feature: Any) -> Mapping[str, Any]:
    found = feature.get("properties")
    return found if isinstance(found, Mapping) else {}


def _is_member(name: str) -> bool:
    return name.rpartition("/")[2] in MEMBERS


def _unpacked(content: bytes) -> list[Any]:
    """Return the features of all files of an archive. Raises ``RequestError`` for a file without features."""
    features = []
    with _archive(content) as archive:
        for name in filter(_is_member, archive.namelist()):
            try:
                found = from_json(member_of(archive, name))["features"]
            except (ValueError, KeyError, TypeError) as error:
                why = f": {error}" if isinstance(error, ValueError) else ""
                raise RequestError(f"plan: {name} of the archive is no collection of features{why}") from None
            features += found if isinstance(found, list) else []
    return features


def _archive(content: bytes) -> ZipFile:
    try:
        return archive_of(content, MOST_BYTES)
    except ValueError as error:
        raise RequestError(f"plan: {error}") from None
