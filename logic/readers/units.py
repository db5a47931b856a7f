"""Units of plans, as people say them (``--plan-unit``), and degrees on the earth, made metres."""

import re
from collections.abc import Mapping, Sequence
from math import cos, radians, sin, sqrt
from typing import Any

import numpy as np
import shapely
from shapely import Geometry

from logic.errors import RequestError

UNITS = {"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001, "ft": 0.3048, "in": 0.0254}
"""Metres to a unit."""

MOST = 1e8
"""Metres to a unit, at most."""


EQUATOR, ECCENTRICITY = 6378137.0, 0.00669437999014
"""Of WGS 84: the radius, metres, and the square of the first eccentricity."""

WEB_MERCATOR = re.compile(r"(?:^|\D)(?:3857|3785|900913|102100|102113)$")
"""How the name of the projection of the web's maps ends: ``urn:ogc:def:crs:EPSG::3857``. Its metres grow with
the latitude.
"""


def metres_to(unit: str) -> float:
    """Metres to a unit of ``UNITS``, or as a number. Raises ``RequestError`` for another word."""
    if unit in UNITS:
        return UNITS[unit]
    try:
        metres = float(unit)
    except ValueError:
        metres = 0.0
    if not 0 < metres < MOST:
        raise RequestError(f"plan unit {unit}: one of {', '.join(UNITS)}, or metres to a unit, as in 0.02")
    return metres


def plane(shapes: Sequence[Geometry]) -> Any:
    """Return what makes metres east and north of the midst of shapes: exact to a millimetre within a house.

    Raises ``ValueError`` for what are no degrees.
    """
    lon, lat = shapely.union_all(shapes).centroid.coords[0]
    if not (abs(lon) <= 180 and abs(lat) < 89):
        raise ValueError(f"{lon:g}, {lat:g} are no degrees of longitude and latitude")
    curve = 1 - ECCENTRICITY * sin(radians(lat)) ** 2
    east = radians(1) * EQUATOR / sqrt(curve) * cos(radians(lat))
    north = radians(1) * EQUATOR * (1 - ECCENTRICITY) / curve**1.5
    return lambda points: (points - np.array([lon, lat])) * np.array([east, north])


def is_web_mercator(record: Mapping[str, Any]) -> bool:
    """Return True if the member ``crs`` of GeoJSON, as QGIS writes it, names the projection of the web."""
    crs = record.get("crs")
    properties = crs.get("properties") if isinstance(crs, Mapping) else None
    name = properties.get("name") if isinstance(properties, Mapping) else None
    return isinstance(name, str) and bool(WEB_MERCATOR.search(name))


def degrees_of(shape: Geometry) -> Any:
    """Return a geometry of ``WEB_MERCATOR`` in degrees of longitude and latitude."""
    return shapely.transform(
        shape,
        lambda points: np.degrees(
            np.stack([points[:, 0] / EQUATOR, np.arctan(np.sinh(points[:, 1] / EQUATOR))], 1)
        ),
    )
