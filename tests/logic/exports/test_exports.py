"""Houses in the formats of other tools, read back by those tools' own readers."""

# usd-core has no type stubs.
# pyright: reportAttributeAccessIssue=false

import json
import re
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
import shapely
import shapely.geometry
import trimesh
import yaml
from PIL import Image
from pxr import Usd, UsdGeom

from tests.plans import PLANS
from tests.sample_houses import RANDOM, example
from vitruvius.agent.banks import benchmark
from vitruvius.cli import main
from vitruvius.logic import FreeWall, House, Room, save
from vitruvius.logic.exports import FORMATS, export
from vitruvius.logic.exports.solids import HEAD, SILL, WALL_HEIGHT, solids
from vitruvius.logic.request.given_plan import read_plan

PAGE = Path(__file__).parents[3] / "docs" / "house-file.md"
HOME, STAR, ORIGINAL = benchmark("home-test-v1")[3], RANDOM[0], example()
HOUSES = pytest.mark.parametrize("house", [HOME, STAR, ORIGINAL], ids=["home", "star", "original"])


def only(house: House, path: Path, format: str) -> Path:
    """Return the file of one house in a format."""
    (written,) = export([house], path, format)
    return written


def wall_area(house: House) -> float:
    """Return the area of all walls from floor to top, seen from one side, without doorways, m²."""
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


def boxes_of_glb(path: Path) -> np.ndarray:
    """Return all boxes of a binary glTF by trimesh: (n, 6), x, z, y from and to; y grows upwards."""
    scene = trimesh.load_scene(path)
    placed = [(scene.graph[node], scene.geometry) for node in scene.graph.nodes_geometry]
    return np.array(
        [(geometry[name].bounds + place[:3, 3])[:, [0, 2, 1]].ravel() for (place, name), geometry in placed]
    )


def boxes_of_usd(path: Path) -> np.ndarray:
    """Return the bounds of all cubes of a stage by OpenUSD: (n, 6), x, y, z from and to; y grows south."""
    stage = Usd.Stage.Open(str(path))
    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), [UsdGeom.Tokens.default_])
    cubes = [prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Cube)]
    bounds = [cache.ComputeWorldBound(cube).ComputeAlignedRange() for cube in cubes]
    low, high = np.array([(each.GetMin(), each.GetMax()) for each in bounds]).transpose(1, 0, 2)
    return np.column_stack([low[:, 0], -high[:, 1], low[:, 2], high[:, 0], -low[:, 1], high[:, 2]])


@HOUSES
@pytest.mark.parametrize(("format", "read"), [("gltf", boxes_of_glb), ("usd", boxes_of_usd)])
def test_readers_find_walls_of_2_5_m_and_doorways_that_are_open_to_2_m(
    house: House, format: str, read: Callable[[Path], np.ndarray], tmp_path: Path
) -> None:
    """The test examines the solids over the middle of each wall, door and entrance, upwards."""
    boxes = read(only(house, tmp_path, format))
    boxes = boxes[boxes[:, 5] > 0.01]  # without floors

    def heights(x: float, y: float) -> set[tuple[float, float]]:
        over = (boxes[:, :2] < (x, y)).all(axis=1) & (boxes[:, 3:5] > (x, y)).all(axis=1)
        return {(round(low, 4), round(high, 4)) for low, high in boxes[over][:, [2, 5]].tolist()}

    assert boxes[:, 5].max() == pytest.approx(2.5)
    verticals, horizontals = house.walls
    middles = [(at, (low + high) / 2) for at, low, high in verticals]
    middles += [((low + high) / 2, at) for at, low, high in horizontals]
    wall, window, entrance = {(0.0, 2.5)}, {(0.0, 0.9), (0.9, 2.1), (2.1, 2.5)}, {(0.0, 2.0), (2.0, 2.5)}
    # Furniture that stands against a wall is over its middle, too.
    assert all(any(heights(*middle) >= each for each in (wall, window, entrance)) for middle in middles)
    for door in house.doors:
        middle = door.x + door.width / 2, door.y + door.height / 2
        assert heights(*middle) == (entrance if door.is_entrance else {(2.0, 2.5)})
    for pane in house.windows:
        assert heights(pane.x + pane.width / 2, pane.y + pane.height / 2) >= window


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


class OccupancyGrid(NamedTuple):
    """Map in the form of ROS: nav_msgs/OccupancyGrid."""

    cells: np.ndarray
    """(H, W) int8: 100 occupied, 0 free, -1 unknown. Row 0 is the southernmost."""
    resolution: float
    west: float
    south: float


def occupancy_grid(path: Path) -> OccupancyGrid:
    """Return a map by the rules of ``loadMapYaml`` and ``loadMapFromFile`` of nav2_map_server 1.5.0.

    The source is src/map_io.cpp. The map must be trinary, without rotation and transparency, as ours are.
    """
    description = yaml.safe_load(path.read_text())
    assert description["mode"] == "trinary"
    with Image.open(path.parent / description["image"]) as picture:
        assert picture.mode == "L"
        shade = np.asarray(picture, np.float32) / 255
    occupied = shade if description["negate"] else 1 - shade
    cells = np.full(shade.shape, -1, np.int8)
    cells[occupied >= description["occupied_thresh"]] = 100
    cells[occupied <= description["free_thresh"]] = 0
    west, south, yaw = description["origin"]
    assert yaw == 0
    return OccupancyGrid(cells[::-1], description["resolution"], west, south)


@HOUSES
def test_each_cell_of_the_map_of_ros_is_occupied_free_or_unknown_as_the_house_says(
    house: House, tmp_path: Path
) -> None:
    """Cells are occupied at walls and pieces, free within rooms, and unknown outside.

    Cells that are only touched may be either. Each door is open, and each wall is without a gap.
    """
    found = occupancy_grid(only(house, tmp_path, "ros"))
    rows, columns = np.indices(found.cells.shape)
    x, y = found.west + columns * found.resolution, -(found.south + rows * found.resolution)

    def cells(margin: float) -> np.ndarray:
        side = found.resolution
        return np.asarray(shapely.box(x - margin, y - side - margin, x + side + margin, y + margin))

    verticals, horizontals = house.walls
    walls = [((at, low), (at, high)) for at, low, high in verticals]
    walls += [((low, at), (high, at)) for at, low, high in horizontals]
    pieces = [shapely.box(*piece.box) for room in house.rooms for piece in room.pieces]
    solid = shapely.union_all([*shapely.linestrings(walls), *pieces])
    rooms = shapely.union_all([shapely.box(*room.box) for room in house.rooms])
    for each in (solid, rooms):
        shapely.prepare(each)
    filled, touched = (shapely.intersects(solid, cells(margin)) for margin in (-1e-4, 1e-4))
    assert (found.cells[filled] == 100).all()
    assert (found.cells[~touched & shapely.covers(rooms, cells(0))] == 0).all()
    assert (found.cells[~touched & ~shapely.intersects(rooms, cells(0))] == -1).all()
    assert {*np.unique(found.cells[~touched]).tolist()} == {-1, 0}

    def at(points: np.ndarray) -> np.ndarray:
        east, north = points[:, 0] - found.west, -points[:, 1] - found.south
        return found.cells[(north / found.resolution).astype(int), (east / found.resolution).astype(int)]

    for line in shapely.linestrings(walls):
        points = shapely.get_coordinates(shapely.segmentize(line, 0.01))
        assert (np.maximum(at(points - 1e-4), at(points + 1e-4)) == 100).all()
    for door in house.doors:
        if not door.is_entrance:
            middle = np.array([[door.x + door.width / 2, door.y + door.height / 2]])
            assert at(middle) == 0


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


def test_the_page_of_house_files_has_a_row_for_each_format() -> None:
    table = PAGE.read_text().partition("| `--to` |")[2].partition("\n\n")[0]
    assert re.findall(r"^\| `(\w+)` \|", table, re.MULTILINE) == [*FORMATS]


SLANTED = FreeWall(0.7, 0.5, 2.6, 1.9, 0.12), FreeWall(0.5, 2.5, 1.5, 2.2, 0.0)
WITH_WALLS = House((Room(0, 0, 4, 3, "R0", "hall"),), hub="R0", topology="own", free_walls=SLANTED)


def test_walls_at_an_angle_are_in_maps_of_ros_and_in_geojson(tmp_path: Path) -> None:
    lines = [shapely.LineString([(each.x1, each.y1), (each.x2, each.y2)]) for each in SLANTED]
    halves = [each.thickness / 2 or 1e-9 for each in SLANTED]
    solid = shapely.union_all(shapely.buffer(lines, halves, cap_style="flat"))
    found = occupancy_grid(only(WITH_WALLS, tmp_path, "ros"))
    rows, columns = np.indices(found.cells.shape)
    side = found.resolution
    x, y = found.west + columns * side, -(found.south + rows * side)
    inside = shapely.intersects(solid, shapely.box(x + 1e-4, y - side + 1e-4, x + side - 1e-4, y - 1e-4))
    floor = (x > 0.1) & (x < 3.8) & (y > 0.2) & (y < 2.9)
    assert inside.sum() > 60
    assert (found.cells[inside] == 100).all()
    assert (found.cells[~inside & floor] == 0).all()
    features = json.loads(only(WITH_WALLS, tmp_path, "geojson").read_text())["features"]
    thick, thin = (
        shapely.geometry.shape(each["geometry"]) for each in features if each["properties"]["kind"] == "wall"
    )
    assert thick.area == pytest.approx(0.12 * np.hypot(1.9, 1.4))
    assert thick.exterior.is_ccw
    assert thin.length == pytest.approx(np.hypot(1, 0.3))
    assert len(read_plan(only(WITH_WALLS, tmp_path, "geojson")).rooms) == 1


def test_solids_ask_a_house_for_its_walls_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """The walls of 1,024 rooms were once built again for each room."""
    asked, walls = [], House.walls.fget
    assert walls
    monkeypatch.setattr(House, "walls", property(lambda house: asked.append(1) or walls(house)))
    assert solids(PLANS["flat"])
    assert len(asked) == 1
