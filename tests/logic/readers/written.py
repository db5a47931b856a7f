"""Homes in other formats, after the published schemas, with noise and walls as in real plans.

HouseExpo: its README, "Data Format". ResPlan: ``resplan_utils.py`` and the paper. CubiCasa5K: ``house.py``
and ``svg_utils.py``. IMDF: OGC 20-094, Unit and Opening. IFC: ISO 16739-1, by IfcOpenShell.
"""

import io
import json
import zipfile
from collections import defaultdict
from collections.abc import Callable
from math import cos, radians, sin
from typing import Any

import ifcopenshell
import ifcopenshell.guid
import numpy as np
import shapely
from shapely import Polygon, affinity
from shapely.geometry import mapping

from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Rect

WALL = 0.12
"""Thickness of walls, metres."""

NOISE = 0.01
"""Largest error of corners, metres."""

WORDS = {
    "houseexpo": {
        "hall": "Entryway", "corridor": "Hallway", "living": "Living_Room", "dining": "Dining_Room",
        "kitchen": "Kitchen", "bedroom": "Bedroom", "bathroom": "Bathroom", "wc": "Toilet",
        "storage": "Storage", "study": "Office",
    },
    "resplan": {"living": "living", "kitchen": "kitchen", "bedroom": "bedroom", "bathroom": "bathroom",
                "storage": "storage"},
    "cubicasa": {
        "hall": "Entry Lobby", "corridor": "HallWay", "living": "LivingRoom", "dining": "Dining",
        "kitchen": "Kitchen", "bedroom": "Bedroom", "bathroom": "Bath Shower", "wc": "Bath WC",
        "storage": "Closet WalkIn", "study": "Office",
    },
    "imdf": {
        "hall": "lobby", "corridor": "walkway", "living": "lounge", "kitchen": "kitchen", "wc": "restroom",
        "storage": "storage", "study": "office",
    },
}  # fmt: skip
"""Names of our types in each format. ResPlan and IMDF have no words for some."""

Write = Callable[[House, np.random.Generator, float], bytes]


def inner(house: House, rng: np.random.Generator, noise: float = NOISE) -> list[Polygon]:
    """Return the rooms of a house from wall to wall, with noise at each corner."""
    found = []
    for room in house.rooms:
        west, north, east, south = room.box
        corners = np.array([[west, north], [east, north], [east, south], [west, south]])
        inset = WALL / 2 * np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
        found.append(Polygon(corners + inset + rng.uniform(-noise, noise, (4, 2))))
    return found


def opening(rect: Rect, rng: np.random.Generator, noise: float = NOISE) -> Polygon:
    """Return a door or window as a rectangle through its wall."""
    x, y = (0.0, WALL / 2) if rect.width else (WALL / 2, 0.0)
    west, north, east, south = rect.box
    corners = np.array(
        [[west - x, north - y], [east + x, north - y], [east + x, south + y], [west - x, south + y]]
    )
    return Polygon(corners + rng.uniform(-noise, noise, (4, 2)))


def houseexpo(house: House, rng: np.random.Generator, noise: float = NOISE) -> bytes:
    """Return a file with the outline of rooms and doors, and boxes of rooms by type."""
    rooms = inner(house, rng, noise)
    doors = [opening(door, rng, noise).buffer(0.02) for door in house.doors if not door.is_entrance]
    floor = shapely.union_all([*rooms, *doors])
    boxes = defaultdict(list)
    for room, shape in zip(house.rooms, rooms, strict=True):
        boxes[WORDS["houseexpo"][room.type]].append(list(shape.bounds))
    west, north, east, south = floor.bounds
    verts = [list(corner) for corner in floor.exterior.coords[:-1]]  # pyright: ignore[reportAttributeAccessIssue]
    record = {
        "verts": verts, "id": "0004d52d1aeeb8ae6de39d6bd993e992", "room_category": boxes,
        "room_num": len(rooms), "bbox": {"min": [west, north], "max": [east, south]},
    }  # fmt: skip
    return json.dumps(record).encode()


def resplan(house: House, rng: np.random.Generator, noise: float = NOISE) -> bytes:
    """Return geometries by type, 256 units wide, and the area in square metres."""
    return json.dumps(resplan_record(house, rng, noise), default=mapping).encode()


def resplan_record(house: House, rng: np.random.Generator, noise: float = NOISE) -> dict[str, Any]:
    """Return a record as in the data set's pickle, with shapely's geometries."""
    rooms = inner(house, rng, noise)
    walls = shapely.union_all([shapely.box(*room.box) for room in house.rooms]).buffer(
        WALL / 2, join_style="mitre"
    )
    factor = 256 / max(walls.bounds[2] - walls.bounds[0], walls.bounds[3] - walls.bounds[1])
    words, by_type = WORDS["resplan"], defaultdict(list)
    for room, shape in zip(house.rooms, rooms, strict=True):
        if room.type in words and room.type != "living":
            by_type[words[room.type]].append(shape)
    # Floor without a word, such as a hall, is open to the living room.
    others = [room for room in house.rooms if room.type not in words or room.type == "living"]
    one = shapely.union_all([shapely.box(*room.box) for room in others])
    for part in shapely.get_parts(one.buffer(-WALL / 2, join_style="mitre")):
        corners = np.array(part.exterior.coords[:-1])
        by_type["living"].append(Polygon(corners + rng.uniform(-noise, noise, corners.shape)))
    windows = [opening(window, rng, noise) for window in house.windows]
    doors = [opening(door, rng, noise) for door in house.doors if not door.is_entrance]
    front = [opening(door, rng, noise) for door in house.doors if door.is_entrance]
    record = {
        **by_type, "wall": [walls.difference(shapely.union_all(rooms))], "inner": [walls], "door": doors,
        "window": windows, "front_door": front, "balcony": [], "garden": [],
    }  # fmt: skip
    multi = {
        key: affinity.scale(
            shapely.MultiPolygon([p for each in value for p in shapely.get_parts(each)]),
            factor,
            factor,
            origin=(0, 0),
        )
        for key, value in record.items()
    }
    return {
        **multi,
        "id": 7,
        "unitType": "flat",
        "area": walls.area,
        "net_area": sum(each.area for each in rooms),
    }


def cubicasa(house: House, rng: np.random.Generator, noise: float = NOISE) -> bytes:
    """Return groups by class, in pixels of a centimetre, with labels of sizes."""
    groups = []
    for room, shape in zip(house.rooms, inner(house, rng, noise), strict=True):
        label = f"{room.width - WALL:.2f} m x {room.height - WALL:.2f} m"
        text = f'<g class="SpaceDimensionsLabel"><g class="TextLabel"><text>{label}</text></g></g>'
        groups.append(
            f'<g id="{room.name}" class="Space {WORDS["cubicasa"][room.type]}">'
            f'<polygon points="{_points(shape)}"/><g class="Dimension">{text}</g></g>'
        )
    kinds = (("Door", "Door Swing Beside", house.doors), ("Window", "Window Regular", house.windows))
    for word, kind, rects in kinds:
        for points in (_points(opening(rect, rng, noise)) for rect in rects):
            part = f'<g id="{word}" class="{kind}"><polygon points="{points}"/></g>'
            groups.append(f'<g id="Wall" class="Wall">{part}</g>')
    return (
        '<?xml version="1.0" encoding="utf-8"?>'
        '<svg xmlns="http://www.w3.org/2000/svg" width="1400" height="1000">'
        '<g id="Model" class="Model v1-1"><g class="Floor"><g id="Floor-1" class="Floorplan Floor-1">'
        f"{''.join(groups)}</g></g></g></svg>"
    ).encode()


def _points(shape: Polygon) -> str:
    return " ".join(f"{100 * x + 300:.2f},{100 * y + 200:.2f}" for x, y in shape.exterior.coords[:-1]) + " "


def imdf(house: House, rng: np.random.Generator, noise: float = NOISE) -> bytes:
    """Return an archive of units and openings, in degrees, of a house turned by 17 degrees."""

    def on_earth(shape: Any) -> Any:
        turned = affinity.rotate(affinity.scale(shape, 1, -1, origin=(0, 0)), 17, origin=(0, 0))
        east = 1 / (111_320 * cos(radians(48.1)))
        return mapping(
            affinity.translate(affinity.scale(turned, east, 1 / 111_194, origin=(0, 0)), 11.5, 48.1)
        )

    def feature(kind: str, number: int, shape: Any, **properties: Any) -> dict[str, Any]:
        return {
            "type": "Feature", "id": f"{kind}-{number}", "feature_type": kind, "geometry": on_earth(shape),
            "properties": {**properties, "level_id": "level-0"},
        }  # fmt: skip

    units = [
        feature(
            "unit",
            number,
            shape,
            category=WORDS["imdf"].get(room.type, "room"),
            name={"en": room.type.title()},
        )
        for number, (room, shape) in enumerate(zip(house.rooms, inner(house, rng, noise), strict=True))
    ]
    lines = [shapely.LineString([door.box[:2], door.box[2:]]) for door in house.doors]
    openings = [feature("opening", number, line, category="pedestrian") for number, line in enumerate(lines)]
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        archive.writestr("manifest.json", json.dumps({"version": "1.0.0", "language": "en"}))
        for name, features in (("unit", units), ("opening", openings)):
            archive.writestr(
                f"{name}.geojson", json.dumps({"type": "FeatureCollection", "features": features})
            )
    return content.getvalue()


def ifc(house: House, rng: np.random.Generator, noise: float = NOISE) -> bytes:
    """Return a storey of spaces and openings as extruded solids, in millimetres, turned by -8 degrees."""
    model = ifcopenshell.file(schema="IFC4")
    make, turn = model.create_entity, radians(-8)

    def point(*place: float) -> Any:
        return make("IfcCartesianPoint", [float(each) for each in place])

    def direction(*to: float) -> Any:
        return make("IfcDirection", [float(each) for each in to])

    origin = make("IfcAxis2Placement3D", point(0, 0, 0))
    turned = make(
        "IfcAxis2Placement3D", point(5e5, 2e5, 3000), direction(0, 0, 1), direction(cos(turn), sin(turn), 0)
    )
    placed = make("IfcLocalPlacement", None, turned)
    context = make("IfcGeometricRepresentationContext", None, "Model", 3, 1e-5, origin)
    unit = make("IfcSIUnit", UnitType="LENGTHUNIT", Prefix="MILLI", Name="METRE")
    make("IfcProject", ifcopenshell.guid.new(), RepresentationContexts=[context],
         UnitsInContext=make("IfcUnitAssignment", [unit]))  # fmt: skip
    storey = make("IfcBuildingStorey", ifcopenshell.guid.new(), Name="Ground floor", ObjectPlacement=placed)

    def product(kind: str, shape: Polygon, height: float, **names: str) -> Any:
        ring = make("IfcPolyline", [point(1000 * x, -1000 * y) for x, y in shape.exterior.coords])
        profile = make("IfcArbitraryClosedProfileDef", "AREA", None, ring)
        solid = make("IfcExtrudedAreaSolid", profile, origin, direction(0, 0, 1), height)
        body = make("IfcShapeRepresentation", context, "Body", "SweptSolid", [solid])
        shown = make("IfcProductDefinitionShape", Representations=[body])
        return make(kind, ifcopenshell.guid.new(), ObjectPlacement=placed, Representation=shown, **names)

    spaces = [
        product("IfcSpace", shape, 2500.0, Name=room.name, LongName=room.type.title())
        for room, shape in zip(house.rooms, inner(house, rng, noise), strict=True)
    ]
    make("IfcRelAggregates", ifcopenshell.guid.new(), RelatingObject=storey, RelatedObjects=spaces)
    for door in house.doors:
        product("IfcDoor", opening(door, rng, noise), 2000.0)
    for window in house.windows:
        product("IfcWindow", opening(window, rng, noise), 1200.0)
    return model.to_string().encode()


WRITERS: dict[str, Write] = {
    "houseexpo": houseexpo, "resplan": resplan, "cubicasa": cubicasa, "imdf": imdf, "ifc": ifc,
}  # fmt: skip
