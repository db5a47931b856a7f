"""Rooms of a plan from GeoJSON (RFC 7946): a rectangle along the axes for each, in metres."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from logic.boxes import TOLERANCE, Box
from logic.errors import RequestError
from logic.parts import Name, Room

GEOJSON = "FeatureCollection"

FAR = 1e8
"""Metres: as far from the origin as coordinates of maps are."""


class Geometry(msgspec.Struct, frozen=True):
    """A polygon without holes: x and y of its corners."""

    type: Literal["Polygon"]
    coordinates: tuple[Annotated[list[Annotated[list[float], Meta(min_length=2)]], Meta(min_length=4)]]


class Properties(msgspec.Struct, frozen=True):
    """What a feature says of its room."""

    name: Name | None = None
    type: str = ""


class Feature(msgspec.Struct, frozen=True):
    """A room in GeoJSON."""

    geometry: Geometry
    properties: Properties | None = None


def from_geojson(record: Mapping[str, Any]) -> Iterator[Room]:
    """The rooms of a feature collection. Its y grows north: the plan's north-west corner becomes (0, 0)."""
    features = (
        record.get("features") if isinstance(record, Mapping) and record.get("type") == GEOJSON else None
    )
    if not isinstance(features, list) or not features:
        raise RequestError(f"plan: GeoJSON is a {GEOJSON} with a list of features, a polygon for each room")
    found: list[tuple[str, str, Box]] = []
    for number, feature in enumerate(features):
        if _is_no_room(feature):
            continue
        try:
            read = msgspec.convert(feature, Feature)
        except msgspec.ValidationError as error:
            raise RequestError(
                f"plan: features[{number}]: {error}: a room is a polygon of one ring"
            ) from None
        properties = read.properties or Properties()
        found.append(
            (properties.name or f"R{number}", properties.type, _box(read, properties.name or number))
        )
    if not found:
        raise RequestError("plan: no feature is a room: each has a property kind that is another word")
    left, top = min(box[0] for *_, box in found), max(box[3] for *_, box in found)
    for name, type_, (west, south, east, north) in found:
        sizes = (round(m, 6) for m in (west - left, top - north, east - west, north - south))
        yield Room(*sizes, name=name, type=type_)


def _is_no_room(feature: Any) -> bool:
    """Whether a feature says that it is another part of a house, as ``exports/geojson.py`` writes it."""
    properties = feature.get("properties") if isinstance(feature, Mapping) else None
    return isinstance(properties, Mapping) and properties.get("kind", "room") != "room"


def _box(feature: Feature, name: str | int) -> Box:
    """The box of a feature: (west, south, east, north)."""
    points = [(point[0], point[1]) for point in feature.geometry.coordinates[0]]
    xs, ys = zip(*points, strict=True)
    box = min(xs), min(ys), max(xs), max(ys)
    if not all(abs(value) <= FAR for value in (*xs, *ys)) or not _is_rectangle(points, box):
        raise RequestError(
            f"plan: room {name!r} is no rectangle along the axes: cut it into rectangles, each a room"
        )
    return box


def _is_rectangle(points: Sequence[tuple[float, float]], box: Box) -> bool:
    """Whether the points go round the box, from any corner and either way; some may lie between corners."""
    west, south, east, north = box
    ring = [(x - west, y - south) for x, y in (*points, points[0])]
    steps = list(pairwise(ring))
    along = all(min(abs(a - b), abs(c - d)) <= TOLERANCE for (a, c), (b, d) in steps)
    area, length = 0.0, 0.0
    for (a, c), (b, d) in steps:
        area += (a * d - b * c) / 2
        length += abs(a - b) + abs(c - d)
    width, height = east - west, north - south
    fills = abs(abs(area) - width * height) + abs(length - 2 * (width + height)) <= TOLERANCE
    return along and fills
