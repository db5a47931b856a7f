"""Houses in the formats of other tools, read back by those tools' own readers."""

# usd-core has no type stubs.
# pyright: reportAttributeAccessIssue=false

import json
from collections import Counter
from pathlib import Path

import numpy as np
import pygltflib
import pytest
import shapely
import trimesh
import yaml
from PIL import Image
from pxr import Usd, UsdGeom

from agent.banks import benchmark
from agent.cli import main
from logic import House, save
from logic.exports import FORMATS, export
from logic.exports.ros import RESOLUTION
from logic.own_plan import read_plan
from logic.solids import HEAD, SILL, WALL_HEIGHT, solids
from tests.sample_houses import RANDOM, example

HOME, STAR, ORIGINAL = benchmark("home-test-v1")[3], RANDOM[0], example()
HOUSES = pytest.mark.parametrize("house", [HOME, STAR, ORIGINAL], ids=["home", "star", "original"])


def only(house: House, path: Path, format: str) -> Path:
    """The file of one house in a format."""
    (written,) = export([house], path, format)
    return written


def wall_area(house: House) -> float:
    """Square metres of all walls from floor to top, seen from one side, doorways cut out."""
    length = sum(high - low for lines in house.walls for _, low, high in lines)
    return length * WALL_HEIGHT


@HOUSES
def test_solids_fill_where_walls_stand_and_nothing_stands_in_a_doorway(
    house: House,
) -> None:
    thickness = 1e-4
    found = solids(house, thickness)
    assert len({each.name for each in found}) == len(found)

    def area(*kinds: str) -> float:
        boxes = [(each.box, each.top - each.bottom) for each in found if each.kind in kinds]
        return sum(max(b[2] - b[0], b[3] - b[1]) * tall for b, tall in boxes)

    lintels = sum(door.length for door in house.doors if not door.is_entrance) * 0.5
    assert area("wall", "window", "entrance") == pytest.approx(wall_area(house) + lintels, abs=0.05)
    panes = sum(window.length for window in house.windows) * (HEAD - SILL)
    assert area("window") == pytest.approx(panes, abs=0.01)
    doorways = shapely.union_all([shapely.box(*door.box) for door in house.doors if not door.is_entrance])
    low = [shapely.box(*each.box) for each in found if each.bottom < 1.9 and each.kind != "floor"]
    assert doorways.intersection(shapely.union_all(low)).length < 10 * thickness


def test_thick_walls_close_their_corners_and_leave_doorways_as_wide_as_they_are() -> None:
    low = [shapely.box(*each.box) for each in solids(HOME, 0.1) if each.bottom == 0 and each.kind != "piece"]
    walls = shapely.union_all(low)
    for room in HOME.rooms:
        for corner in shapely.get_coordinates(shapely.box(*room.box)):
            assert walls.contains(shapely.Point(corner).buffer(0.04))
    for door in HOME.doors:
        if not door.is_entrance:
            assert walls.intersection(shapely.box(*door.box)).length < 1e-6


@HOUSES
def test_glb_is_read_by_other_readers_and_every_solid_is_where_it_stands(
    house: House, tmp_path: Path
) -> None:
    path = only(house, tmp_path, "gltf")
    document = pygltflib.GLTF2().load(path)
    assert document
    nodes = {node.name for node in document.nodes}
    scene = trimesh.load_scene(path)
    for solid in solids(house):
        assert solid.name in nodes
        transform, geometry = scene.graph[solid.name]
        low, high = scene.geometry[geometry].bounds + transform[:3, 3]
        west, north, east, south = solid.box
        np.testing.assert_allclose(
            [*low, *high], [west, solid.bottom, north, east, solid.top, south], atol=1e-5
        )


@HOUSES
def test_usd_is_read_by_openusd_in_metres_with_z_up_and_the_same_bounds(house: House, tmp_path: Path) -> None:
    stage = Usd.Stage.Open(str(only(house, tmp_path, "usd")))
    assert (UsdGeom.GetStageMetersPerUnit(stage), UsdGeom.GetStageUpAxis(stage)) == (1, "Z")
    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), [UsdGeom.Tokens.default_])
    for solid in solids(house):
        prim = stage.GetPrimAtPath(f"/house/{solid.kind}s/{solid.name.replace('.', '_')}")
        bound = cache.ComputeWorldBound(prim).ComputeAlignedRange()
        west, north, east, south = solid.box
        expected = [west, -south, solid.bottom, east, -north, solid.top]
        np.testing.assert_allclose([*bound.GetMin(), *bound.GetMax()], expected, atol=1e-5)


@HOUSES
def test_geojson_is_read_by_geos_and_its_rooms_have_their_areas(house: House, tmp_path: Path) -> None:
    text = only(house, tmp_path, "geojson").read_text()
    shapes = shapely.get_parts(shapely.from_geojson(text))
    features = json.loads(text)["features"]
    assert len(shapes) == len(features)
    for feature, shape, room in zip(features, shapes, house.rooms, strict=False):
        assert feature["properties"] == {"kind": "room", "name": room.name, "type": room.type}
        west, north, east, south = room.box
        assert shape.bounds == pytest.approx((west, -south, east, -north))
        assert shape.area == pytest.approx(room.area)
        assert shape.exterior.is_ccw
    kinds = Counter(feature["properties"]["kind"] for feature in features)
    pieces = sum(len(room.pieces) for room in house.rooms)
    expected = {"door": len(house.doors), "window": len(house.windows), "piece": pieces}
    assert kinds == Counter(expected | {"room": len(house.rooms)})


def test_geojson_of_a_home_is_a_plan_to_generate_in(tmp_path: Path) -> None:
    rooms = read_plan(only(HOME, tmp_path, "geojson")).rooms
    west, north = min(room.x for room in HOME.rooms), min(room.y for room in HOME.rooms)
    for room, given in zip(HOME.rooms, rooms, strict=True):
        assert (given.name, given.type) == (room.name, room.type)
        assert given.box == pytest.approx(
            (room.x - west, room.y - north, room.box[2] - west, room.box[3] - north)
        )


@HOUSES
def test_the_map_of_ros_is_occupied_at_walls_and_pieces_free_in_rooms_unknown_outside(
    house: House, tmp_path: Path
) -> None:
    """As map_server reads it: p = (255 - value) / 255, and the origin is the south-west cell's corner."""
    description = yaml.safe_load(only(house, tmp_path, "ros").read_text())
    occupancy = (255 - np.asarray(Image.open(tmp_path / description["image"]), float)) / 255
    west, south, yaw = description["origin"]
    assert (description["resolution"], description["negate"], yaw) == (RESOLUTION, 0, 0)

    def at(x: float, y: float) -> float:
        row = len(occupancy) - 1 - int((-y - south) / RESOLUTION)
        return occupancy[row, int((x - west) / RESOLUTION)]

    for room in house.rooms:
        for piece in room.pieces:
            assert at(piece.x + piece.width / 2, piece.y + piece.height / 2) > description["occupied_thresh"]
    for x, low, high in house.walls[0]:
        assert (
            max(at(x - 1e-4, (low + high) / 2), at(x + 1e-4, (low + high) / 2))
            > description["occupied_thresh"]
        )
    for door in house.doors:
        if not door.is_entrance:
            assert at(door.x + door.width / 2, door.y + door.height / 2) < description["free_thresh"]
    assert description["free_thresh"] < at(west + 0.01, -south - 0.01) < description["occupied_thresh"]


def test_a_folder_of_files_is_written_by_a_command(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    save([HOME] * 11, tmp_path / "homes.jsonl")
    with pytest.raises(SystemExit) as end:
        main(["convert", str(tmp_path / "homes.jsonl"), "--to", "geojson", "--out", str(tmp_path / "maps")])
    assert not end.value.code
    assert sorted(path.name for path in (tmp_path / "maps").iterdir())[9:] == [
        "house-09.geojson",
        "house-10.geojson",
    ]
    assert "11 converted" in capsys.readouterr().err


def test_formats_and_files_that_are_not_are_named(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"no format gltv: did you mean gltf\?"):
        export([HOME], tmp_path, "gltv")
    with pytest.raises(ValueError, match="no house to write"):
        export([], tmp_path, "gltf")
    assert set(FORMATS) == {"geojson", "gltf", "mjcf", "ros", "usd"}
