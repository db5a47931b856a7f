"""Every format exports every kind of house and of name, and other tools read the files."""

# mujoco and usd-core have no type stubs.
# pyright: reportAttributeAccessIssue=false

import json
from collections.abc import Callable, Iterable
from itertools import product
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pygltflib
import pytest
import shapely
import shapely.affinity
import shapely.geometry
import trimesh
import yaml
from msgspec.structs import replace
from PIL import Image
from pxr import Usd, UsdGeom, UsdPhysics

from tests.sample_houses import ONE_ROOM, drawn
from tests.thick import thickened
from vitruvius.logic import Door, FreeWall, House, Piece, RequestError, Room, Window, load
from vitruvius.logic.exports import FORMATS, export
from vitruvius.logic.exports.mjcf import SEEN_THICKNESS_M
from vitruvius.logic.exports.solids import Solid, solids
from vitruvius.logic.house.parts import OUTSIDE, Provenance
from vitruvius.logic.house.promises import Promises


def own(*rooms: Room, doors: Iterable[Door] = (), topology: str = "own", **more: Any) -> House:
    """Return a house whose first room has the entrance and is the hub."""
    first = rooms[0]
    entrance = Door(first.x + 1.0, first.y, 0.9, 0.0, (first.name, OUTSIDE))
    return House(rooms, (entrance, *doors), hub=first.name, topology=topology, **more)


def grid(*extra: Room) -> House:
    """Return a map of 6 x 4 m with walls, an unknown part, furniture, and floor at its west edge."""
    cells = np.zeros((40, 60), int)
    cells[[0, -1]], cells[:, -1], cells[15:25, 15:25], cells[:10, 40:] = 100, 100, 100, -1
    house = House.from_grid(cells, 0.1, (0.0, 0.0))
    table = Piece(4.0, 2.0, 0.83, 0.6, "table")
    return replace(house, rooms=(replace(house.rooms[0], children=(table,)), *extra))


SOFA = Piece(0.0, 3.0, 0.9, 1.8, "sofa", "E")
HALL, LIVING = Room(0, 0, 3, 2, "R0", "hall"), Room(0, 2, 3, 4, "R1", "living", (SOFA,))
BETWEEN = Door(1.0, 2.0, 0.9, 0.0, ("R0", "R1"))
BAY = Room(3, 3, 2, 2, "R2", "bay", part_of="R1")
WALLS = FreeWall(0.7, 0.5, 2.6, 1.9, 0.12), FreeWall(0.5, 2.5, 1.5, 2.2, 0.0)
TERRACE = Provenance("mine", "", {}, 0, 0, {}, Promises(outdoor=("terrace",)))
PATIO = Room(0, 6, 3, 2, "R2", "terrace")
GAP, GATE = Door(1.0, 6.0, 0.9, 0.0, ("R1", "R2")), Door(3.0, 6.5, 0.0, 0.9, ("R2", OUTSIDE))
HOME = own(HALL, LIVING, doors=[BETWEEN], windows=(Window(0.5, 6.0, 1.2, 0.0, "R1"),))
UNITS = (
    Room(0, 0, 8, 1.5, "R0", "corridor"),
    Room(0, 1.5, 4, 3, "R1", "hall", (Piece(0.0, 3.0, 1.0, 0.5, "sofa", "N"),)),
    Room(4, 1.5, 4, 3, "R2", "hall"),
)
KINDS = {
    "star": drawn(ONE_ROOM),
    "original": replace(drawn(ONE_ROOM), topology="original"),
    "shared walls": HOME,
    "thick walls": thickened(HOME),
    "units": own(
        *UNITS,
        doors=[Door(x, 1.5, 0.9, 0.0, ("R0", name)) for x, name in ((1.0, "R1"), (5.0, "R2"))],
        topology="building",
    ),
    "parts": own(HALL, LIVING, BAY, doors=[BETWEEN, Door(3.0, 3.0, 0.0, 2.0, ("R1", "R2"), opening=True)]),
    "outdoor": own(
        HALL, replace(LIVING, type="terrace"), PATIO, doors=[BETWEEN, GAP, GATE], provenance=TERRACE
    ),
    "free walls": own(HALL, LIVING, doors=[BETWEEN], free_walls=WALLS),
    "map": grid(),
    "map with areas": grid(Room(0.2, 0.2, 1.0, 3.0, "R1", "kitchen")),
    "map with free walls": replace(grid(), free_walls=WALLS),
}
NAMES = {
    "space": ("Living room", "Bed room 2"),
    "hyphen": ("en-suite", "walk-in"),
    "digit first": ("1st", "2nd"),
    "quotes": ("Anna's", 'the "den" <b>'),
    "unicode": ("Küche", "客厅"),
    "emoji": ("🛋", "🛏"),
    "path": ("../a", "/b"),
    "mark": (".", "_"),
    "long": ("x" * 64, "x" * 63 + "y"),
    "but for a dot": ("a.b", "a_b"),
    "as other parts": ("wall_0", "floor"),
}
"""Pairs of names for the first two rooms."""


def named(house: House, names: tuple[str, ...]) -> House:
    """Return the house with other names for its first rooms, as ``vitruvius-2``."""
    new = dict(zip((room.name for room in house.rooms), names, strict=False))

    def of(name: str) -> str:
        return new.get(name, name)

    return replace(
        house.converted(),
        rooms=tuple(
            replace(room, name=of(room.name), part_of=of(room.part_of) if room.part_of else room.part_of)
            for room in house.rooms
        ),
        doors=tuple(replace(door, between=tuple(map(of, door.between))) for door in house.doors),
        windows=tuple(replace(window, room=of(window.room)) for window in house.windows),
        hub=of(house.hub),
    )


CORNERS = np.array([*product((-1, 1), repeat=3)])
"""Corners of a cube from -1 to 1: (8, 3)."""


def require_filled(solid: Solid, corners: np.ndarray) -> None:
    """Compare a solid with the corners (8, 3) of the box that a reader found: x east, y north, z up."""
    west, north, east, south = solid.box
    upright = shapely.box(west, -south, east, -north)
    expected = shapely.affinity.rotate(upright, solid.turn, use_radians=True)
    assert shapely.hausdorff_distance(shapely.MultiPoint(corners[:, :2]).convex_hull, expected) < 1e-5
    assert (corners[:, 2].min(), corners[:, 2].max()) == pytest.approx((solid.bottom, solid.top), abs=1e-5)


def is_usd(house: House, path: Path) -> None:
    """Check that all solids are prims with collisions, under their own names."""
    stage = Usd.Stage.Open(str(path))
    assert (UsdGeom.GetStageMetersPerUnit(stage), UsdGeom.GetStageUpAxis(stage)) == (1, "Z")
    cubes = [prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Cube)]
    found = {prim.GetDisplayName(): prim for prim in cubes}
    expected = solids(house)
    assert sorted(prim.GetDisplayName() for prim in cubes) == sorted(each.name for each in expected)
    for each in expected:
        prim = found[each.name]
        assert prim.GetParent().GetName() == f"{each.kind}s"
        assert prim.HasAPI(UsdPhysics.CollisionAPI)
        placed = np.array(UsdGeom.Cube(prim).ComputeLocalToWorldTransform(Usd.TimeCode.Default()))
        require_filled(each, CORNERS / 2 @ placed[:3, :3] + placed[3, :3])


def is_gltf(house: House, path: Path) -> None:
    """Check that all solids are nodes, under their names."""
    expected = {each.name: each for each in solids(house)}
    scene = trimesh.load_scene(path)
    assert {*scene.graph.nodes_geometry} == {*expected}
    for node in scene.graph.nodes_geometry:
        transform, geometry = scene.graph[node]
        corners = trimesh.transform_points(scene.geometry[geometry].vertices, transform)
        require_filled(expected[node], corners[:, [0, 2, 1]] * (1, -1, 1))  # y is up there, and z south


def is_mjcf(house: House, path: Path) -> None:
    """Check that all solids are geoms, and that the robot touches nothing and its range finders see."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    for each in solids(house, SEEN_THICKNESS_M):
        place, axes = data.geom(each.name).xpos, data.geom(each.name).xmat.reshape(3, 3)
        require_filled(each, place + CORNERS * model.geom(each.name).size @ axes.T)
    assert data.ncon == 0
    assert ((data.sensordata < 0) | (data.sensordata > 0.2)).all()


def is_geojson(house: House, path: Path) -> None:
    """Check that all parts are valid shapes, and that the room of a map is its free cells."""
    features = json.loads(path.read_bytes())["features"]
    shapes = [shapely.geometry.shape(each["geometry"]) for each in features]
    kinds = [each["properties"]["kind"] for each in features]
    assert all(shapely.is_valid(shapes))
    assert [each["properties"].get("name") for each in features][: len(house.rooms)] == [
        room.name for room in house.rooms
    ]
    if house.occupancy:
        grid = house.occupancy
        assert shapes[0].area == pytest.approx((grid.values == 0).sum() * grid.cell**2)
        assert kinds[1 : len(house.rooms)] == ["area"] * (len(house.rooms) - 1)
        assert all(
            ring.is_ccw == (k == 0) for k, ring in enumerate([shapes[0].exterior, *shapes[0].interiors])
        )
    else:
        for room, shape in zip(house.rooms, shapes, strict=False):
            west, north, east, south = room.box
            assert shape.bounds == pytest.approx((west, -south, east, -north))
    assert kinds.count("piece") == sum(len(room.pieces) for room in house.rooms)
    assert kinds.count("wall") == len(house.free_walls)


def is_ros(house: House, path: Path) -> None:
    """Check that cells in pieces are occupied, and cells amid openings and empty rooms free."""
    said = yaml.safe_load(path.read_bytes())
    with Image.open(path.parent / said["image"]) as picture:
        cells = np.asarray(picture)[::-1]

    def at(x: float, y: float) -> int:
        side, (west, south, _) = said["resolution"], said["origin"]
        return int(cells[int((-y - south) / side), int((x - west) / side)])

    for room in house.rooms:
        for piece in room.pieces:
            assert at(piece.x + piece.width / 2, piece.y + piece.height / 2) == 0
    for door in house.doors:
        if not door.is_entrance:
            assert at(door.x + door.width / 2, door.y + door.height / 2) == 254
    if house.occupancy:
        rows, columns = house.occupancy.shape
        assert cells.shape == (rows, columns)
        assert at(0.05, 0.25) == 254


READ: dict[str, Callable[[House, Path], None]] = {
    **{"usd": is_usd, "gltf": is_gltf, "mjcf": is_mjcf},
    **{"geojson": is_geojson, "ros": is_ros},
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("format", FORMATS)
def test_every_format_takes_every_kind_of_house_with_every_kind_of_name(
    format: str, kind: str, tmp_path: Path
) -> None:
    houses = [named(KINDS[kind], names) for names in NAMES.values()]
    houses = [House.from_dict(house.to_dict()) for house in houses]  # files may hold all of these
    for house, path in zip(houses, export(houses, tmp_path, format), strict=True):
        READ[format](house, path)


def test_a_second_reader_finds_the_nodes_of_a_glb(tmp_path: Path) -> None:
    house = named(KINDS["parts"], NAMES["unicode"])
    document = pygltflib.GLTF2().load(export([house], tmp_path, "gltf")[0])
    assert document
    assert {node.name for node in document.nodes if node.mesh is not None} == {
        each.name for each in solids(house)
    }


def test_solids_of_a_map_fill_what_is_not_free_and_close_its_edge() -> None:
    house = KINDS["map"]
    assert house.occupancy
    walls = shapely.union_all([shapely.box(*each.box) for each in solids(house, 0.1) if each.kind == "wall"])
    north, west = np.argwhere(house.occupancy.values != 0).T * 0.1
    shut = shapely.union_all(shapely.box(west, north, west + 0.1, north + 0.1))
    at_edge = shapely.box(-0.1, 0.1, 0.0, 3.9)
    assert shapely.symmetric_difference(walls, shut | at_edge).area == pytest.approx(0, abs=1e-6)


def test_solids_of_walls_at_an_angle_stand_where_the_walls_are() -> None:
    found = [each for each in solids(KINDS["free walls"], 0.1) if each.turn]
    for solid, wall in zip(found, WALLS, strict=True):
        expected = shapely.LineString([(wall.x1, -wall.y1), (wall.x2, -wall.y2)]).buffer(
            (wall.thickness or 0.1) / 2, cap_style="flat"
        )
        require_filled(
            solid, np.array([(*corner, z) for corner in expected.exterior.coords for z in (0, 2.5)])
        )


@pytest.mark.parametrize("thick", [False, True])
def test_walls_with_no_indoor_room_beside_them_are_parapets_with_a_gate(thick: bool) -> None:
    house = KINDS["outdoor"]
    if thick:
        house = replace(thickened(house, 0.15, 0.5), provenance=TERRACE)
    found = [each for each in solids(house) if each.kind in ("wall", "entrance")]
    boxes = {top: [shapely.box(*each.box) for each in found if each.top == top] for top in (1.0, 2.5)}
    low, tall = (shapely.union_all(boxes[top]) for top in (1.0, 2.5))
    hall, *outdoors = (shapely.box(*room.box) for room in house.rooms)
    beyond = 0.5 if thick else 0.05
    assert tall.within(hall.buffer(beyond + 1e-9, join_style="mitre"))
    around = [each.buffer(0.075 if thick else 0.05, join_style="mitre") for each in outdoors]
    parapets = shapely.union_all(around) - shapely.union_all([hall, *outdoors])
    gap = shapely.box(*house.doorway(house.doors[2]) if thick else house.doors[2].grown(0.05).box)
    assert (parapets - low - tall - gap).area < 1e-6
    assert shapely.intersection(low, hall).area < 1e-6
    [gate] = [each for each in found if each.kind == "entrance" and each.top == 1.0]
    west, north, east, south = house.doors[3].grown(1e-6).box
    assert shapely.box(west, north, east, south).intersects(shapely.box(*gate.box))


def test_a_part_has_the_colour_of_its_room() -> None:
    colours = {each.name: each.colour for each in solids(KINDS["parts"]) if each.kind == "floor"}
    assert colours["R2.floor"] == colours["R1.floor"] != colours["R0.floor"]


def test_geojson_of_a_map_has_the_walls_of_the_map_again(tmp_path: Path) -> None:
    house = replace(KINDS["map"], rooms=(replace(KINDS["map"].rooms[0], children=()),))
    [path] = export([house], tmp_path, "geojson")
    [again] = load(path)

    def walls(lines: Iterable[tuple[float, float, float, float]]) -> Any:
        return shapely.union_all([shapely.LineString([(a, b), (c, d)]) for a, b, c, d in lines])

    upright, level = house.walls
    of_cells = walls([(x, a, x, b) for x, a, b in upright] + [(a, y, b, y) for y, a, b in level])
    found = walls((each.x1, each.y1, each.x2, each.y2) for each in again.free_walls)
    west, north, east, south = of_cells.bounds
    there = shapely.affinity.translate(of_cells, -(west + east) / 2, -(north + south) / 2)
    assert shapely.hausdorff_distance(found, there) < 1e-6


def test_a_house_without_a_place_for_the_robot_is_refused_by_mjcf_in_a_line(tmp_path: Path) -> None:
    full = replace(HALL, children=(Piece(0.0, 0.0, 2.8, 2.0, "table"),))
    with pytest.raises(
        RequestError, match=r"^house 1: no room has a free place for the robot of mjcf, 0\.287 m"
    ):
        export([HOME, own(full)], tmp_path, "mjcf")


def test_names_that_pieces_and_rooms_have_in_common_stay_apart() -> None:
    bed = Piece(0.0, 0.0, 0.5, 0.5, "bed")
    pieces = (bed, replace(bed, x=1.0), replace(bed, x=2.0, type="bed_0"), replace(bed, y=1.0, type="b\x00d"))
    names = [each.name for each in solids(own(replace(HALL, children=pieces))) if each.kind == "piece"]
    assert names == ["R0.bed_1", "R0.bed_2", "R0.bed_0", "R0.b\\x00d"]
