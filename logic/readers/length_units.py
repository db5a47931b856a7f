"""Conversion of the units of plans (``--plan-unit``), and of degrees of longitude and latitude, to metres."""

import re
from collections.abc import Mapping, Sequence
from math import cos, radians, sin, sqrt
from typing import Any

import numpy as np
import shapely
from shapely import Geometry

from vitruvius.logic.errors import RequestError

UNITS = {"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001, "ft": 0.3048, "in": 0.0254}
"""Metres per unit."""

MAX_METRES_PER_UNIT = 1e8
"""Greatest number of metres per unit."""


EQUATOR, ECCENTRICITY = 6378137.0, 0.00669437999014
"""Equatorial radius, metres, and squared first eccentricity of the ellipsoid WGS 84."""

WEB_MERCATOR = re.compile(r"(?:^|\D)(?:3857|3785|900913|102100|102113)$")
"""Suffix of the name of Web Mercator, the projection of web maps: ``urn:ogc:def:crs:EPSG::3857``.

Its metres grow with the latitude.
"""


def metres_to(unit: str) -> float:
    """Return the metres per unit: one of ``UNITS`` or a number. Raises ``RequestError`` for other words."""
    if unit in UNITS:
        return UNITS[unit]
    try:
        metres = float(unit)
    except ValueError:
        metres = 0.0
    if not 0 < metres < MAX_METRES_PER_UNIT:
        raise RequestError(
            f"plan unit {unit}: give one of {', '.join(UNITS)}, or metres per unit, as in 0.02"
        )
    return metres


def plane(shapes: Sequence[Geometry]) -> Any:
    """Return a function that converts degrees to metres east and north of the centre of shapes.

    Within a house the error is below a millimetre. Raises ``ValueError`` if coordinates are not degrees.
    """
    lon, lat = shapely.union_all(shapes).centroid.coords[0]
    if not (abs(lon) <= 180 and abs(lat) < 89):
        raise ValueError(f"{lon:g}, {lat:g} are not degrees of longitude and latitude")
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
