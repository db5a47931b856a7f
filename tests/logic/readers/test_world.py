"""Plans with walls at any angle as houses to simulate: what bodies see and where they come, by shapely."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
import shapely
import shapely.affinity
import shapely.geometry
from shapely import LineString, Polygon

from logic import House, HouseFileError, load
from logic.exports.geojson import to_geojson
from sim import DEFAULT, HouseVectorEnv
from tests.plans import flat
from tests.thick import faces, thickened

Ring = Sequence[tuple[float, float]]

BENT: Ring = [(0, 0), (5, -1), (9, 2), (7, 3.5), (8, 6), (4, 5), (3.5, 3), (1, 4)]
"""A room without a right angle, y growing south."""


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


def centred(shape: Any) -> Any:
    west, north, east, south = shape.bounds
    return shapely.affinity.translate(shape, -(west + east) / 2, -(north + south) / 2)


def walked(house: House, steps: int = 200, **options: Any) -> tuple[np.ndarray, np.ndarray]:
    """Poses (T*E, 3) of bodies that drive about, and what they see there (T*E, R, C)."""
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
    """Those of rooms and doors; furniture is solid, too."""
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


@pytest.mark.parametrize(
    ("features", "said"),
    [
        ([feature(shapely.Point(0, 0))], "it has no polygon that is floor"),
        ([feature(shapely.box(0, 0, 1e-4, 1e-4))], "it is 0.0001 by 0.0001 m: project it to metres first"),
        (
            [feature(shapely.box(0, 0, 1e4, 1e4))],
            "in cells of 0.1 m it has 100,000 by 100,000 cells: at most",
        ),
        ([feature(shapely.box(0, 0, 4, 4)), {"type": "Feature"}], "features[1]: has no geometry"),
        ([feature(LineString([(0, 0), (1, 1)]), thickness="2")], "features[0]: thickness is metres, 0 to 10"),
        ([feature(shapely.box(0, 0, 1e300, 4))], "features[0]: numbers are too large"),
        ([{"type": "Feature", "geometry": {"type": "Polygon", "coordinates": [[[0]]]}}], "features[0]: "),
        ([], "GeoJSON is a FeatureCollection with a list of features"),
    ],
)
def test_what_is_no_world_is_refused_in_a_line(tmp_path: Path, features: list[Any], said: str) -> None:
    with pytest.raises(HouseFileError) as caught:
        world(tmp_path, *features)
    assert str(caught.value).startswith(f"{tmp_path / 'plan.geojson'}: {said}")
    assert "\n" not in str(caught.value)
