"""Maps: ROS's are read as independent code reads them, arrays become houses, and other files are refused."""

import io
import struct
import zlib
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import example as example_of
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from PIL import Image

from tests.sample_houses import RANDOM, example
from vitruvius.agent.banks import benchmark
from vitruvius.cli import main
from vitruvius.logic import House, HouseFileError, check, load, save
from vitruvius.logic.exports import export
from vitruvius.logic.house import occupancy
from vitruvius.logic.house.occupancy import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

SHARED = Path(__file__).parents[4] / "shared" / "maps"
SAID = {
    **{"image": "map.png", "resolution": 0.05, "origin": [1.5, -2.25, 0.0]},
    **{"negate": 0, "occupied_thresh": 0.65, "free_thresh": 0.196},
}

grids = arrays.arrays(
    np.int8, arrays.array_shapes(min_dims=2, max_dims=2, max_side=12), elements=st.sampled_from([0, 100, -1])
).filter(lambda cells: (cells == FREE).any())


def read_plainly(path: Path) -> tuple[np.ndarray, dict[str, Any]]:
    """Return a map read by Pillow and PyYAML, pixel by pixel, after the text of ``src/map_io.cpp``."""
    said = yaml.safe_load(path.read_text())
    picture = Image.open(path.parent / said["image"])
    cells = np.zeros((picture.height, picture.width), int)
    alpha = picture.mode in ("RGBA", "LA")
    for y in range(picture.height):
        for x in range(picture.width):
            pixel: Any = picture.getpixel((x, y))
            values = [pixel] * 3 if isinstance(pixel, int) else [*pixel]
            colours = values[:1] * 3 + values[1:] if picture.mode == "LA" else values
            opaque = not alpha or colours[-1] == 255
            if alpha and said.get("mode", "trinary") != "trinary":
                colours = colours[:3]
            shade = sum(colours) / len(colours) / 255
            occ = shade if said["negate"] else 1 - shade
            cell = -1
            if said.get("mode") == "raw":
                number = round(shade * 255)
                cell = number if number <= 100 else -1
            elif said.get("mode") == "scale" and not opaque:
                cell = -1
            elif occ > said["occupied_thresh"]:
                cell = 100
            elif occ < said["free_thresh"]:
                cell = 0
            cells[y, x] = cell
    return cells, said


def write(folder: Path, picture: Image.Image, name: str = "map.png", **changes: Any) -> Path:
    picture.save(folder / name)
    path = folder / "map.yaml"
    path.write_text(yaml.safe_dump(SAID | {"image": name} | changes))
    return path


@settings(max_examples=60)
@given(
    st.data(),
    st.sampled_from(
        [("L", "map.pgm"), ("L", "map.png"), ("RGB", "map.png"), ("RGBA", "map.png"), ("LA", "map.png")]
    ),
    st.sampled_from([None, "trinary", "scale", "raw"]),
    st.sampled_from([0, 1, True, False]),
    st.sampled_from([(0.65, 0.196), (0.65, 0.25), (0.5, 0.5), (0.9, 0.1)]),
)
def test_maps_are_read_as_map_server_reads_them(
    tmp_path_factory: pytest.TempPathFactory, data, form, mode, negate, thresholds
) -> None:
    colours, name = form
    depth = {"L": (), "LA": (2,), "RGB": (3,), "RGBA": (4,)}[colours]
    values = st.one_of(st.integers(0, 255), st.sampled_from([0, 13, 100, 205, 206, 254, 255]))
    pixels = data.draw(arrays.arrays(np.uint8, (4, 5, *depth), elements=values))
    occupied, free = thresholds
    changes: dict[str, Any] = {"negate": negate, "occupied_thresh": occupied, "free_thresh": free}
    path = write(
        tmp_path_factory.mktemp("map"),
        Image.fromarray(pixels, colours),
        name,
        **changes | ({"mode": mode} if mode else {}),
    )
    cells, _ = read_plainly(path)
    if mode == "raw":  # map_server leaves it to others how occupied a cell must be.
        cells = np.where(
            cells < 0, -1, np.where(cells / 100 > occupied, 100, np.where(cells / 100 < free, 0, -1))
        )
    if not (cells == 0).any():
        with pytest.raises(HouseFileError, match="it has no free cell"):
            load(path)
        return
    (house,) = load(path)
    assert house.occupancy
    np.testing.assert_array_equal(house.occupancy.values, cells)
    assert house.rooms[0].box == pytest.approx((1.5, 2.25 - 4 * 0.05, 1.5 + 5 * 0.05, 2.25))


def test_a_picture_of_sixteen_bits_is_read_by_its_lightness(tmp_path: Path) -> None:
    light = np.array([[0, 65535, 52685], [60000, 20000, 54000]], np.uint16)
    (house,) = load(write(tmp_path, Image.fromarray(light)))
    assert house.occupancy
    np.testing.assert_array_equal(house.occupancy.values, [[100, 0, -1], [0, 100, 0]])


@settings(max_examples=40)
@given(grids, st.sampled_from([0.05, 0.1, 0.3, 1 / 3]), st.tuples(*[st.floats(-50, 50)] * 2))
@example_of(np.zeros((1, 1), np.int8), 0.05, (6e-8, 0.0))
def test_a_map_written_for_ros_is_the_same_map_cell_by_cell(
    tmp_path_factory: pytest.TempPathFactory, cells, cell, corner
) -> None:
    house = House.from_grid(cells, cell, corner)
    (path,) = export([house], tmp_path_factory.mktemp("ros"), "ros")
    plain, said = read_plainly(path)
    np.testing.assert_array_equal(plain, cells)
    west, north, _, south = house.rooms[0].box
    assert (said["resolution"], said["origin"]) == (cell, pytest.approx([west, -south, 0.0], abs=1e-8))
    (again,) = load(path)
    assert again.occupancy
    assert house.occupancy
    assert again.occupancy.rows == house.occupancy.rows
    assert (again.occupancy.x, again.occupancy.y) == pytest.approx((west, north), abs=1e-8)


@pytest.mark.parametrize(
    "house", [benchmark("home-test-v1")[3], RANDOM[0], example()], ids=["home", "star", "old"]
)
def test_the_map_of_a_house_is_read_back_as_a_house_cell_by_cell(house: House, tmp_path: Path) -> None:
    (path,) = export([house], tmp_path, "ros")
    cells, said = read_plainly(path)
    (again,) = load(path)
    assert again.occupancy
    np.testing.assert_array_equal(again.occupancy.values, cells)
    assert (again.occupancy.cell, again.occupancy.x) == (said["resolution"], pytest.approx(said["origin"][0]))
    x, y = ((low + high) / 2 for low, high in (house.rooms[0].box[::2], house.rooms[0].box[1::2]))
    column, row = int((x - again.occupancy.x) / 0.05), int((y - again.occupancy.y) / 0.05)
    assert again.occupancy.values[row, column] != UNKNOWN


@settings(max_examples=60)
@given(grids)
def test_blocks_are_all_that_is_not_free_and_walls_are_all_of_its_edges(cells) -> None:
    grid = OccupancyGrid.of(cells, 1.0, (0, 0))
    painted = np.zeros(cells.shape, int)
    for west, north, east, south in grid.blocks():
        painted[int(north) : int(south), int(west) : int(east)] += 1
    np.testing.assert_array_equal(painted, cells != FREE)
    around = np.pad(cells == FREE, 1)
    rows, columns = cells.shape
    edges = {
        (axis, row, column)
        for axis, (down, right) in enumerate([(0, 1), (1, 0)])
        for row in range(rows + 1)
        for column in range(columns + 1)
        if around[row + 1 - down, column + 1 - right] != around[row + 1, column + 1]
    }
    verticals, horizontals = grid.lines()
    walls = [(0, y, int(x)) for x, low, high in verticals for y in range(int(low), int(high))]
    walls += [(1, int(y), x) for y, low, high in horizontals for x in range(int(low), int(high))]
    assert len(walls) == len(set(walls))
    assert set(walls) == edges


@settings(max_examples=30)
@given(grids, st.integers(1, 3))
def test_a_coarser_map_is_free_where_all_its_cells_are(cells, times) -> None:
    rows, columns = (-(-size // times) for size in cells.shape)
    whole = np.full((rows * times, columns * times), UNKNOWN)
    whole[: cells.shape[0], : cells.shape[1]] = cells
    blocks = [
        [whole[times * i : times * (i + 1), times * j : times * (j + 1)] for j in range(columns)]
        for i in range(rows)
    ]
    expected = [[0 if (b == 0).all() else 100 if (b == 100).any() else -1 for b in row] for row in blocks]
    grid = OccupancyGrid.of(cells, 0.1, (-3, 2))
    if (np.array(expected) == FREE).any():
        coarse = grid.coarser(times)
        np.testing.assert_array_equal(coarse.values, expected)
        assert (coarse.cell, coarse.x, coarse.y) == (pytest.approx(times * 0.1), -3, 2)
    else:
        with pytest.raises(ValueError, match="no free cell"):
            grid.coarser(times)


@settings(max_examples=30)
@given(grids)
def test_a_house_file_gives_back_a_map(tmp_path_factory: pytest.TempPathFactory, cells) -> None:
    house, path = House.from_grid(cells, 0.3), tmp_path_factory.mktemp("map") / "map.jsonl"
    save([house], path)
    assert load(path) == [house]
    assert not check(house)
    west, north, east, south = house.rooms[0].box
    assert (west + east, north + south) == pytest.approx((0, 0))


def test_arrays_may_be_bool_or_of_any_whole_numbers() -> None:
    taken = np.array([[True, False], [False, True]])
    expected = House.from_grid(np.where(taken, OCCUPIED, FREE), 0.5)
    assert House.from_grid(taken, 0.5) == expected
    assert House.from_grid(np.where(taken, 100, 0).astype(np.uint8), 0.5) == expected
    assert House.from_grid([[100, 0], [0, 100]], 0.5) == expected


@pytest.mark.parametrize(
    ("array", "cell", "said"),
    [
        (np.zeros((3, 3, 3), bool), 0.1, r"shape \(3, 3, 3\)"),
        (np.zeros(9, bool), 0.1, r"shape \(9,\)"),
        (np.zeros((0, 4), bool), 0.1, r"shape \(0, 4\)"),
        (np.zeros((3, 3)), 0.1, "cells of float64: give bool"),
        (np.array([["a", "b"]]), 0.1, "cells of <U1: give bool"),
        (np.array([[0, 255]]), 0.1, "cells of 255: there are 0"),
        (np.ones((3, 3), bool), 0.1, "no free cell"),
        (np.full((3, 3), -1), 0.1, "no free cell"),
        (np.zeros((3, 3), bool), 0.0, "cells are 0.0 m wide"),
        (np.zeros((3, 3), bool), -1.0, "cells are -1.0 m wide"),
        (np.zeros((3, 3), bool), np.nan, "cells are nan m wide"),
        (np.zeros((3, 3), bool), 900.0, "beyond 1000 m"),
        (np.broadcast_to(np.bool_(False), (40_000, 25_000)), 0.1, "25,000 by 40,000 cells"),
    ],
)
def test_an_array_that_is_no_map_is_refused_in_a_line(array: Any, cell: float, said: str) -> None:
    with pytest.raises(ValueError, match=said) as error:
        House.from_grid(array, cell)
    assert "\n" not in str(error.value)


def bomb(width: int, height: int) -> bytes:
    """Return a PNG whose header promises this many pixels."""
    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    chunks = [(b"IHDR", head), (b"IDAT", zlib.compress(b"\0" * 64)), (b"IEND", b"")]
    packed = [struct.pack(">I", len(d)) + k + d + struct.pack(">I", zlib.crc32(k + d)) for k, d in chunks]
    return b"\x89PNG\r\n\x1a\n" + b"".join(packed)


def free_picture() -> bytes:
    content = io.BytesIO()
    Image.new("L", (4, 4), 254).save(content, "PNG")
    return content.getvalue()


ALIASES = "a: &a [x,x]\n" + "".join(f"{b}: &{b} [{f'*{a},' * 9}]\n" for a, b in pairwise("abcdefghijklm"))
ALIASES += "image: m\nresolution: *m\norigin: *m\nnegate: 0\noccupied_thresh: 0\nfree_thresh: 0\n"
"""YAML of 9 to the power of 12 words."""

WRONG: dict[str, tuple[dict[str, Any] | str, bytes | None, str]] = {
    "no image": ({"image": None}, b"", "it lacks image, as in image: map.png"),
    "absent picture": ({}, None, "there is no such file"),
    "empty image": ({"image": ""}, b"", "image is ''"),
    "device": ({"image": "/dev/zero"}, b"", "it must lie in the folder of this file"),
    "folder": ({"image": "."}, b"", "Is a directory"),
    "picture of another folder": ({"image": "../map.png"}, b"", "it must lie in the folder of this file"),
    "no picture": ({}, b"hello", "it is not a readable PNG, PGM or BMP"),
    "cut short": ({}, free_picture()[:-30], "it is not a readable PNG, PGM or BMP"),
    "a PGM of comments": ({}, b"P5\n#" + b"x" * (1 << 20) + b"\n4 4 255\n" + b"\xfe" * 16, "not a readable"),
    "a PNG of chunks": ({}, free_picture()[:33] + bytes(12 << 16) + free_picture()[33:], "not a readable"),
    "a thousand million cells": ({}, bomb(40_000, 25_000), "at most 33,554,432|more than 33,554,432"),
    "a hundred million cells": ({}, bomb(10_000, 10_000), "10,000 by 10,000 cells"),
    "more than a PNG can hold": ({}, bomb(2**31 - 1, 2**31 - 1), "33,554,432|no PNG"),
    "resolution 0": ({"resolution": 0}, b"", "resolution is 0"),
    "resolution in words": ({"resolution": "5 cm"}, b"", "resolution is '5 cm'"),
    "resolution nan": ({"resolution": float("nan")}, b"", r"resolution is '\.nan'"),
    "origin of two": ({"origin": [0, 0]}, b"", "origin has 2 numbers"),
    "turned": ({"origin": [0, 0, 0.3]}, b"", "origin rotates the map by"),
    "no thresholds": ({"free_thresh": None}, b"", "it lacks free_thresh"),
    "mode": ({"mode": "trinari"}, b"", "did you mean trinary"),
    "negate": ({"negate": 2}, b"", "negate is 2"),
    "no free floor": ({"free_thresh": 0.0}, free_picture(), "it has no free cell"),
    "far away": ({"origin": [5000.0, 0, 0]}, free_picture(), "beyond 1000 m"),
    "no YAML": ("image: [map.png\nresolution", b"", "it is not YAML with"),
    "a list": ("- 1\n- 2", b"", "it has no keys, such as"),
    "nothing": ("", b"", "it has no keys, such as"),
    "not text": ("\x00\x01", b"", "it is not YAML with"),
    "another floor plan": ("name: a\nlevels:\n  L1:\n    vertices:\n    - [0, 0]", b"", "it lacks image"),
    "deep": ("[" * 20_000, b"", "it is not YAML with"),
    "long": ("# " + "a" * (1 << 17), b"", "more than 64 KiB"),
    "aliases": (ALIASES, b"", "it is not YAML with plain values, in line 1"),
    "an alias": ("image: &a map.png\nmode: *a\n", b"", "it is not YAML with plain values, in line 1"),
    "a tag": ("image: !!python/name:os.system x", b"", "it is not YAML with plain values, in line 1"),
    "merge keys": ("<<: [{image: map.png}]", b"", "it is not YAML with plain values, in line 1"),
    "a number of 400 digits": ({"resolution": 10**400}, b"", "resolution is 1000"),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_a_map_that_is_none_is_refused_in_a_line(case: str, tmp_path: Path, capsys) -> None:
    said, picture, words = WRONG[case]
    path = tmp_path / "map.yaml"
    text = (
        said
        if isinstance(said, str)
        else yaml.safe_dump({k: v for k, v in (SAID | said).items() if v is not None})
    )
    path.write_text(text)
    if picture is not None:
        (tmp_path / "map.png").write_bytes(picture)
    with pytest.raises(HouseFileError, match=words) as error:
        load(path)
    assert len(str(error.value)) < 400
    for command in (["draw", str(path), "--out", str(tmp_path / "plans")],):
        with pytest.raises(SystemExit) as ended:
            main(command)
        assert ended.value.code == 5
        assert len(capsys.readouterr().err.strip().splitlines()) == 1
    assert not (tmp_path / "plans").exists()


@pytest.mark.parametrize("ending", [".yaml", ".yml", ".YAML", ".Yml"])
def test_the_ending_of_a_map_may_be_in_capitals(ending: str, tmp_path: Path) -> None:
    (tmp_path / "map.png").write_bytes(free_picture())
    (tmp_path / f"map{ending}").write_text(yaml.safe_dump(SAID))
    assert load(tmp_path / f"map{ending}")[0].occupancy


@pytest.mark.parametrize("name", ["map.pgm", "MAP.PGM"])
def test_a_picture_by_itself_is_no_map(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(free_picture())
    with pytest.raises(HouseFileError, match=r"for a map, give its \.yaml"):
        load(tmp_path / name)
    with pytest.raises(HouseFileError, match="there is no such file"):
        load(tmp_path / "other.yaml")


SEGMENT = {"x": 0, "y": 0, "width": 1, "height": 0}
CHANGES: dict[str, tuple[Callable[[dict[str, Any]], Any], str]] = {
    "row": (lambda house: house["occupancy"].update(rows=["3."]), "the first room of a map must cover"),
    "runs": (lambda house: house["occupancy"]["rows"].append("3"), "row 2 is not a row of"),
    "ragged": (lambda house: house["occupancy"]["rows"].append("4."), "row 2 has 4 cells, row 0 has 3"),
    "bomb": (lambda house: house["occupancy"]["rows"].append("99999999."), "99,999,999 by 3 cells"),
    "longer bomb": (lambda house: house["occupancy"]["rows"].append("9" * 99 + "."), "row 2 is not a row"),
    "shut": (lambda house: house["occupancy"].update(rows=["3#", "3?"]), "no free cell"),
    "cell": (lambda house: house["occupancy"].update(cell=0), "cells are 0.0 m wide"),
    "topology": (lambda house: house.update(topology="ring"), "a house of the topology map needs it, and no"),
    "no cells": (lambda house: house.pop("occupancy"), "a house of the topology map needs it, and no"),
    "door": (
        lambda house: house["doors"].append({"between": ["map", "outside"], **SEGMENT}),
        "a map has none",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CHANGES)
def test_a_house_file_with_a_map_that_is_none_is_refused(case: str) -> None:
    change, words = CHANGES[case]
    record = House.from_grid([[0, 0, 100], [0, -1, 100]], 1.0, (0, 0)).to_dict()
    record = {**record, "occupancy": {**record["occupancy"], "rows": [*record["occupancy"]["rows"]]}}
    record["doors"] = [*record["doors"]]
    change(record)
    with pytest.raises(ValueError, match=words):
        House.from_dict(record)


def test_a_map_has_no_rooms_for_plans_of_houses() -> None:
    from vitruvius.logic import RequestError, generate

    house = House.from_grid([[0, 0], [0, 0]], 2.0)
    with pytest.raises(RequestError, match="it is a map of cells"):
        next(iter(generate(plan=house, grammar="home")))
    with pytest.raises(ValueError, match="no rooms to keep"):
        house.only("map")


@pytest.mark.skipif(not SHARED.exists(), reason="the floors of real buildings are not here")
def test_floors_of_real_buildings_are_read(tmp_path: Path) -> None:
    for path in sorted(SHARED.glob("*.yaml")):
        (house,) = load(path)
        assert house.occupancy
        with Image.open(path.with_suffix(".png")) as picture:
            pixels = np.asarray(picture)
        values = np.select([pixels == 0, pixels == 254], [OCCUPIED, FREE], UNKNOWN)
        np.testing.assert_array_equal(house.occupancy.values, values)
        assert len(house.filled) < 4000 < occupancy.MOST_CELLS


@pytest.mark.parametrize("axis", [0, 1])
def test_a_map_whose_cells_change_too_often_is_refused(axis: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Drawing a chessboard of 39 KB took 4.5 GB; stripes have as many runs, but along one axis only."""
    monkeypatch.setattr(occupancy, "MAX_RUNS", 1 << 18)
    stripes = np.broadcast_to(np.arange(600) % 2 > 0, (600, 600))
    cells = stripes if axis else stripes.T
    with pytest.raises(ValueError, match="360,000 runs of equal cells: at most 262,144"):
        House.from_grid(cells, 0.1)
    row = "1.1#" * 300 if axis else ""
    rows = [row or f"600{letter}" for letter in ".#" * 300]
    assert "360,000 runs" in OccupancyGrid(0, 0, 0.1, tuple(rows)).fault()
