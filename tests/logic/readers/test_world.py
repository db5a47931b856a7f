"""Plans with walls at any angle as houses to simulate: rays and reachable places, checked by shapely."""

import json
import warnings
from collections.abc import Sequence
from pathlib import Path
from time import process_time
from typing import Any

import msgspec
import numpy as np
import pytest
import shapely
import shapely.affinity
import shapely.geometry
from shapely import LineString, Polygon

from tests.logic.readers.test_geojson import on_earth
from tests.plans import flat
from tests.thick import faces, thickened
from vitruvius.info.descriptions import Houses
from vitruvius.info.reading import UnknownFileError
from vitruvius.info.recognise import recognised
from vitruvius.logic import House, HouseFileError, PlanWarning, load
from vitruvius.logic.exports.geojson import to_geojson
from vitruvius.logic.house.parts import MOST_WALLS
from vitruvius.logic.readers.world import CELL_M, _free
from vitruvius.sim import DEFAULT, HouseVectorEnv

Ring = Sequence[tuple[float, float]]

BENT: Ring = [(0, 0), (5, -1), (9, 2), (7, 3.5), (8, 6), (4, 5), (3.5, 3), (1, 4)]
"""Room without a right angle, y growing south."""


def turned(points: Ring, degrees: float = 30.0) -> Ring:
    angle = np.radians(degrees)
    way = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return [(x, y) for x, y in (np.array(points) @ way.T).tolist()]


def feature(shape: Any, **properties: Any) -> dict[str, Any]:
    return {"type": "Feature", "properties": properties, "geometry": shapely.geometry.mapping(shape)}


def world(folder: Path, *features: dict[str, Any], **more: Any) -> House:
    path = folder / "plan.geojson"
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features} | more))
    [house] = load(path)
    return house


def lines(house: House) -> Any:
    return shapely.union_all([LineString([(w.x1, w.y1), (w.x2, w.y2)]) for w in house.free_walls])


@pytest.mark.filterwarnings("ignore::logic.PlanWarning")
def test_a_plan_in_degrees_is_the_same_in_metres(tmp_path: Path) -> None:
    parts = [feature(Polygon(BENT)), feature(LineString(BENT[:2]), thickness=0.2)]
    plain = world(tmp_path, *parts)
    degrees = world(tmp_path, *on_earth({"features": parts}, -70.7, -33.4)["features"])
    assert lines(degrees).hausdorff_distance(lines(plain)) < 2e-3
    assert {wall.thickness for wall in degrees.free_walls} == {wall.thickness for wall in plain.free_walls}


def centred(shape: Any) -> Any:
    west, north, east, south = shape.bounds
    return shapely.affinity.translate(shape, -(west + east) / 2, -(north + south) / 2)


def walked(house: House, steps: int = 200, **options: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return poses (T*E, 3) of robots that drive about, and their observations there (T*E, R, C)."""
    envs = HouseVectorEnv([house], num_envs=32, backend="free", targets="all", **options)
    observation, info = envs.reset(seed=0)
    rng, poses, seen = np.random.default_rng(0), [info["pose"]], [observation]
    for _ in range(steps):
        actions = rng.uniform([0.3, -2.5], [0.7, 2.5], (32, 2)).astype(np.float32)
        observation, _, _, _, info = envs.step(actions)
        poses.append(info["pose"])
        seen.append(observation)
    return np.concatenate(poses), np.concatenate(seen)


def test_in_a_plan_of_houseexpo_rays_end_at_its_outline_and_no_body_leaves_it(tmp_path: Path) -> None:
    record = {"id": "x", "verts": BENT, "room_category": {}, "room_num": 1, "bbox": {}}
    (tmp_path / "plan.json").write_text(json.dumps(record))
    [house] = load(tmp_path / "plan.json")
    outline = centred(Polygon(BENT))
    assert shapely.hausdorff_distance(lines(house), outline.boundary) < 1e-6
    poses, seen = walked(house)
    inner = outline.buffer(-(max(DEFAULT.body) / 2 - 1e-3))
    assert shapely.contains_xy(inner, poses[:, 0], poses[:, 1]).all()
    assert shapely.area(shapely.MultiPoint(poses[:, :2]).convex_hull) > 0.5 * outline.area
    angles = np.radians(DEFAULT.first_ray - DEFAULT.ray_spacing * np.arange(DEFAULT.rays))
    chosen = np.random.default_rng(1).choice(len(poses), 300, replace=False)
    for (x, y, heading), rays in zip(poses[chosen], seen[chosen], strict=True):
        for angle, (share, is_target) in zip(heading + angles, rays, strict=True):
            far = LineString([(x, y), (x + 30 * np.cos(angle), y - 30 * np.sin(angle))])
            distance = min(shapely.distance(shapely.Point(x, y), far & outline.boundary), DEFAULT.range)
            assert is_target or abs(share * DEFAULT.range - distance) < 2e-3


@pytest.mark.filterwarnings("ignore::logic.PlanWarning")  # of the door out
def test_of_geojson_doors_join_two_rooms_and_what_is_solid_has_walls(tmp_path: Path) -> None:
    rooms = [[(0, 0), (4, 0), (4, 3), (0, 3)], [(4, 0), (7, 0), (7, 3), (4, 3)]]
    piece, stray = [(1, 1), (2, 1), (2, 2), (1, 2)], [(5.5, 0.5), (6.5, 2)]
    door, out = [(4, 1), (4, 2)], [(0, 1), (0, 2)]
    house = world(
        tmp_path,
        *(feature(Polygon(turned(each)), kind="room", name="hall") for each in rooms),
        feature(Polygon(turned(piece)), kind="piece"),
        feature(LineString(turned(door)), kind="door"),
        feature(LineString(turned(out)), kind="door"),
        feature(LineString([(5, 1), (5, 2)]), kind="window"),
        feature(LineString(turned(stray)), thickness=0.2),
        feature(shapely.Point(1, 1)),
    )
    thick = [wall for wall in house.free_walls if wall.thickness]
    assert [wall.thickness for wall in thick] == [0.2]
    found = lines(house)
    length = 2 * (7 + 3) + (3 - 1) + 4 + np.hypot(1, 1.5)
    assert found.length == pytest.approx(length, abs=0.01)
    poses, _ = walked(house, 400)
    shapes = [shapely.affinity.scale(Polygon(turned(ring)), 1, -1, origin=(0, 0)) for ring in (*rooms, piece)]
    west, north, east, south = shapely.union_all(shapes).bounds
    shapes = [shapely.affinity.translate(each, -(west + east) / 2, -(north + south) / 2) for each in shapes]
    beyond = shapely.contains_xy(shapes[1], poses[:, 0], poses[:, 1])
    assert beyond.any()
    assert not beyond.all()
    grid, middle = house.occupancy, shapes[2].centroid
    assert grid is not None
    assert grid.values[int((middle.y - grid.y) / grid.cell), int((middle.x - grid.x) / grid.cell)] != 0


@pytest.mark.parametrize("thick", [False, True])
def test_our_own_geojson_has_the_walls_of_the_house_again(tmp_path: Path, thick: bool) -> None:
    """The walls are those of rooms and doors; furniture is solid, too."""
    house = thickened(flat()) if thick else flat()
    empty = tuple(msgspec.structs.replace(room, children=()) for room in house.rooms)
    bare = msgspec.structs.replace(house, rooms=empty)
    made = world(tmp_path, *to_geojson(bare)["features"], **wall_thickness(bare))
    if thick:
        expected = faces(bare)
    else:
        upright, level = bare.walls
        expected = shapely.union_all(
            [LineString([(x, a), (x, b)]) for x, a, b in upright]
            + [LineString([(a, y), (b, y)]) for y, a, b in level]
        )
    assert shapely.hausdorff_distance(lines(made), centred(expected)) < 3e-3
    furnished = world(tmp_path, *to_geojson(house)["features"], **wall_thickness(house))
    assert len(furnished.free_walls) > len(made.free_walls)
    HouseVectorEnv([furnished], num_envs=2, backend="continuous").reset(
        seed=0
    )  # all of its walls are straight


def wall_thickness(house: House) -> dict[str, Any]:
    return {key: value for key, value in to_geojson(house).items() if key == "wall_thickness"}


def test_a_piece_whose_outline_crosses_itself_is_solid_on_both_sides(tmp_path: Path) -> None:
    crossed = feature(Polygon([(1, 1), (3, 3), (3, 1), (1, 3)]), kind="piece")
    house = world(tmp_path, feature(shapely.box(0, 0, 4, 4)), crossed, crossed)
    assert lines(house).length == pytest.approx(4 * 4 + 2 * 2 + 2 * np.hypot(2, 2))


def test_a_door_whose_outline_crosses_itself_has_all_of_its_jambs(tmp_path: Path) -> None:
    rooms = [feature(shapely.box(0, 0, 4, 4)), feature(shapely.box(4.2, 0, 8, 4))]
    house = world(tmp_path, *rooms, feature(Polygon([(4, 1), (4.2, 1), (4, 2), (4.2, 2)]), kind="door"))
    sides = 4 * 4 + 2 * (4 + 3.8)
    jambs = 2 * 0.2 + 2 * np.hypot(0.2, 1)
    assert lines(house).length == pytest.approx(sides + jambs, abs=0.1)


def test_a_fault_of_geometry_is_a_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: Any) -> None:
        raise shapely.errors.GEOSException("TopologyException: side location conflict at 1 1")

    monkeypatch.setattr(shapely, "line_merge", fails)
    with pytest.raises(
        HouseFileError, match=r"plan\.geojson: TopologyException: side location conflict at 1 1$"
    ):
        world(tmp_path, feature(shapely.box(0, 0, 4, 4)))


def test_walls_have_a_length_and_are_no_more_than_a_file_may_have(tmp_path: Path) -> None:
    room = feature(shapely.box(0, 0, 8, 4))
    near = [(0, 1), (1, 1), (1, 1), (2, 1), (2, 1), (2, 1e-20), (2, 2e-20)]
    house = world(tmp_path, room, feature(LineString(near), thickness=0.1))
    assert [round(wall.oriented[4] * 2, 6) for wall in house.free_walls if wall.thickness] == [1, 1, 1]
    many = feature(LineString([(8 * k / MOST_WALLS, k % 2) for k in range(MOST_WALLS - 2)]))
    with pytest.raises(HouseFileError, match=r"it has 65,537 walls: at most 65,536 are read"):
        world(tmp_path, room, many)


@pytest.mark.parametrize("name", ["plan.geojson", "plan.json"])
def test_an_outline_whose_sides_all_cross_each_other_is_refused_before_it_is_mended(
    name: str, tmp_path: Path
) -> None:
    """The 4,001 corners once had 8 million crossings, which took 4.7 GiB."""
    turns = 2 * np.pi * 2000 / 4001 * np.arange(4001)
    corners = np.stack([9 * np.cos(turns), 9 * np.sin(turns)], 1).tolist()
    geojson = {"type": "Polygon", "coordinates": [[*corners, corners[0]]]}
    record = geojson if name.endswith("geojson") else {"verts": corners, "room_category": {}}
    (tmp_path / name).write_text(json.dumps(record))
    with pytest.raises(HouseFileError, match="cross each other too often"):
        load(tmp_path / name)


def test_cells_beside_many_walls_are_found_soon() -> None:
    """Each cell was compared with all 8,000 walls of its row: 8 s, and minutes with more walls."""
    teeth = [(0.1 * k + x, y) for k in range(2000) for x, y in ((0, 5), (0, 11), (0.05, 11), (0.05, 5))]
    inside = shapely.Polygon([(0, 0), *teeth, (200, 5), (200, 0)])
    start = process_time()
    free = _free(inside, CELL_M * np.arange(2000), CELL_M * np.arange(110))
    assert process_time() - start < 4
    assert free.all()
    with pytest.raises(ValueError, match="cross more than a million cells"):
        _free(
            shapely.transform(inside, lambda corners: corners * 9),
            CELL_M * np.arange(9),
            CELL_M * np.arange(9),
        )


def test_cells_are_found_block_by_block_as_one_by_one() -> None:
    inside = shapely.union_all(
        [shapely.Point(3, 4).buffer(3), shapely.box(5, 0, 21, 7) - shapely.box(9, 1, 12, 6)]
    )
    left, top = 0.03 + CELL_M * np.arange(211), -0.02 + CELL_M * np.arange(75)
    west, north = np.meshgrid(left, top)
    one_by_one = shapely.intersects(inside, shapely.box(west, north, west + CELL_M, north + CELL_M))
    np.testing.assert_array_equal(_free(inside, left, top), one_by_one)


def test_info_shows_as_houses_what_is_no_plan_to_furnish(tmp_path: Path) -> None:
    bent = {"type": "Polygon", "coordinates": [[*BENT, BENT[0]]]}
    (tmp_path / "bent.geojson").write_text(json.dumps(bent))
    (tmp_path / "bare.json").write_text(json.dumps({"verts": BENT, "room_category": {}}))
    for name in ("bent.geojson", "bare.json"):
        [found] = recognised(str(tmp_path / name))
        assert isinstance(found, Houses)
        assert found.houses == 1
    (tmp_path / "bent").write_text(json.dumps(bent))  # a house needs another suffix
    with pytest.raises(UnknownFileError, match="R0 has an arc from"):
        recognised(str(tmp_path / "bent"))


def test_what_has_no_geometry_is_passed_over_and_the_files_name_may_be_in_capitals(tmp_path: Path) -> None:
    features = [feature(shapely.box(0, 0, 4, 4)), {"type": "Feature", "properties": {}, "geometry": None}]
    house = world(tmp_path, *features)
    assert len(house.free_walls) == 4
    assert load((tmp_path / "plan.geojson").rename(tmp_path / "PLAN.GEOJSON")) == [house]


def test_doors_that_are_shut_are_counted(tmp_path: Path) -> None:
    """Shut doors are in a gap wider than they are deep, or lead outside. Floor is on one side of them."""
    rooms = [feature(shapely.box(0, 0, 4, 4)), feature(shapely.box(4.2, 0, 8, 4))]
    gap, out = LineString([(4.1, 1), (4.1, 2)]), LineString([(0, 1), (0, 2)])
    midst, joins = LineString([(2, 1), (2, 2)]), shapely.box(4, 1, 4.2, 2)
    doors = [feature(each, kind="door") for each in (gap, out, midst, joins)]
    with pytest.warns(
        PlanWarning, match=r"^plan: 2 doors join no two polygons of floor, and are shut$"
    ) as said:
        world(tmp_path, *rooms, *doors)
    assert [each.filename for each in said] == [__file__]
    with pytest.warns(PlanWarning, match=r"^plan: 1 door joins no two polygons of floor, and is shut$"):
        world(tmp_path, *rooms, doors[0], doors[3])
    with warnings.catch_warnings():
        warnings.simplefilter("error", PlanWarning)
        world(tmp_path, *rooms, feature(out, kind="door", between=["R0", "outside"]), *doors[2:])
        world(tmp_path, *to_geojson(flat())["features"])


@pytest.mark.parametrize(
    ("features", "said"),
    [
        ([feature(shapely.Point(0, 0))], "it has no polygon of floor"),
        (
            [feature(shapely.box(0, 0, 1e-6, 1e-6))],
            "it is 0.11 by 0.11 m: write it in metres, or in degrees",
        ),
        (
            [feature(shapely.box(0, 0, 1e4, 1e4))],
            "in cells of 0.1 m it has 100,000 by 100,000 cells: at most",
        ),
        ([feature(shapely.box(0, 0, 4, 4)), {"type": "Feature"}], "features[1]: has no geometry"),
        ([feature(LineString([(0, 0), (1, 1)]), thickness="2")], "features[0]: thickness is metres, 0 to 10"),
        ([feature(shapely.box(0, 0, 1e90, 4))], "features[0]: numbers are too large"),
        ([{"type": "Feature", "geometry": {"type": "Polygon", "coordinates": [[[0]]]}}], "features[0]: "),
        ([], "GeoJSON is a FeatureCollection with a list of features"),
    ],
)
def test_what_is_no_world_is_refused_in_a_line(tmp_path: Path, features: list[Any], said: str) -> None:
    with pytest.raises(HouseFileError) as caught:
        world(tmp_path, *features)
    assert str(caught.value).startswith(f"{tmp_path / 'plan.geojson'}: {said}")
    assert "\n" not in str(caught.value)
