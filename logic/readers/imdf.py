"""IMDF (OGC 20-094, Apple): GeoJSON in degrees, of units and openings; its archive, or one collection.

A unit has a category and names by language; an opening is a line in a wall.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any
from zipfile import ZipFile

import shapely
from shapely import Geometry
from shapely.geometry import shape

from vitruvius.logic.errors import RequestError
from vitruvius.logic.opener import ZIPPED, archive_of, from_json, member_of
from vitruvius.logic.readers.length_units import plane
from vitruvius.logic.readers.sketch import (
    Passage,
    Sketch,
    Space,
    chosen,
    polygons,
    require_few,
    require_plain,
)

FORMAT = "IMDF"

MEMBERS = ("unit.geojson", "opening.geojson", "level.geojson")

MOST_BYTES = 1 << 24
"""Largest size of all files of an archive together, unpacked, in bytes."""


def is_imdf(content: bytes, record: Any) -> bool:
    """Return True if a file is an archive of IMDF or a collection of its features."""
    if content.startswith(ZIPPED):
        return any(name.endswith(MEMBERS[0]) for name in _archive(content).namelist())
    features = record.get("features") if isinstance(record, Mapping) else None
    return isinstance(features, list) and any(_kind(each) == "unit" for each in features)


def read_imdf(content: bytes, record: Any, storey: str | None) -> Sketch:
    """Return units as rooms and openings as doors, on the plane that touches the earth at their centre."""
    features = _of_level(_unpacked(content) if content.startswith(ZIPPED) else record["features"], storey)
    units, openings = ([each for each in features if _kind(each) == kind] for kind in ("unit", "opening"))
    require_few(len(units), len(openings))
    shapes, doors = (list(map(_geometry, each)) for each in (units, openings))
    require_plain([*shapes, *doors])
    spaces = [space for each, shape in zip(units, shapes, strict=True) for space in _spaces(each, shape)]
    if not spaces:
        raise RequestError("plan: IMDF has units with polygons: it has none")
    try:
        flat = plane([each.shape for each in spaces])
    except ValueError as error:
        raise RequestError(f"plan: {FORMAT}: {error}") from None
    spaces = [space._replace(shape=shapely.transform(space.shape, flat)) for space in spaces]
    return Sketch(
        FORMAT, spaces, [Passage(shapely.transform(each, flat)) for each in doors], [], north_up=True
    )


def _of_level(features: Sequence[Any], storey: str | None) -> Sequence[Any]:
    """Return the features of one level: the level that the user names, or the only level with units."""
    levels = list(
        dict.fromkeys(str(_properties(each).get("level_id")) for each in features if _kind(each) == "unit")
    )
    if not levels:
        return features
    about = {str(each.get("id")): _properties(each) for each in features if _kind(each) == "level"}
    said: dict[str, Any] = {level: about.get(level, {}).get("ordinal") for level in levels}
    levels.sort(key=lambda level: said[level] if isinstance(said[level], int) else 0)
    names = [next(_names(about.get(level, {})), level) for level in levels]
    one = levels[chosen(names, storey)]
    return [each for each in features if str(_properties(each).get("level_id")) == one]


def _names(properties: Mapping[str, Any]) -> Iterator[str]:
    """Yield the names of a feature, one for each language."""
    labels = properties.get("name")
    yield from (str(each) for each in labels.values() if each) if isinstance(labels, Mapping) else ()


def _spaces(unit: Any, shape: Geometry) -> Iterable[Space]:
    """Yield a room for each polygon of a unit."""
    properties = _properties(unit)
    named = list(_names(properties))
    category = str(properties.get("category") or "")
    for part in polygons(shape):
        yield Space((named or [category])[0], (*named, category), part)


def _geometry(feature: Any) -> Geometry:
    try:
        return shape(feature["geometry"])
    except (shapely.errors.ShapelyError, ValueError, TypeError, KeyError, IndexError, AttributeError):
        raise RequestError(f"plan: the geometry of {_kind(feature)} {feature.get('id')} is invalid") from None


def _kind(feature: Any) -> Any:
    return feature.get("feature_type") if isinstance(feature, Mapping) else None


def _properties(feature: Any) -> Mapping[str, Any]:
    found = feature.get("properties") if isinstance(feature, Mapping) else None
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
                raise RequestError(f"plan: {name} of the archive is not a feature collection{why}") from None
            features += found if isinstance(found, list) else []
    return features


def _archive(content: bytes) -> ZipFile:
    try:
        return archive_of(content, MOST_BYTES)
    except ValueError as error:
        raise RequestError(f"plan: {error}") from None
