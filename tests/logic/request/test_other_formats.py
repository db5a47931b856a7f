"""A file in another format than a plan's is recognised whatever its name; each was written by its program."""

import csv
import gzip
import io
import json
import sqlite3
import struct
import zipfile
from pathlib import Path

import pytest
from matplotlib.figure import Figure
from PIL import Image

from vitruvius.logic import HouseFileError, load
from vitruvius.logic.exports import export
from vitruvius.logic.request.given_plan import read_plan

FIXTURES = Path(__file__).parents[2] / "fixtures"


def picture(format: str) -> bytes:
    """Return a picture by Pillow."""
    content = io.BytesIO()
    Image.new("RGB", (8, 8)).save(content, format)
    return content.getvalue()


def figure(format: str) -> bytes:
    """Return a drawing by matplotlib."""
    content = io.BytesIO()
    Figure((1, 1)).savefig(content, format=format)
    return content.getvalue()


def table(mark: str) -> bytes:
    content = io.StringIO()
    csv.writer(content, delimiter=mark).writerows([["room", "x", "y"], ["hall", 0, 1], ["bath", 2, 1]])
    return content.getvalue().encode()


def archive() -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as file:
        file.writestr("doc.kml", "<kml/>")
    return content.getvalue()


def database(folder: Path) -> bytes:
    with sqlite3.connect(folder / "plan.gpkg") as file:
        file.execute("create table rooms (name text)")
    return (folder / "plan.gpkg").read_bytes()


def model(folder: Path, format: str) -> bytes:
    return export(load(FIXTURES / "plans.jsonl")[:1], folder, format)[0].read_bytes()


TOPOLOGY = {
    "type": "Topology",
    "arcs": [[[0, 0], [1, 0]]],
    "objects": {"rooms": {"type": "Polygon", "arcs": [[0]]}},
}
ESRI = {"geometryType": "esriGeometryPolygon", "features": []}

PLANS = {
    "TopoJSON": lambda _: json.dumps(TOPOLOGY).encode(),
    "TopoJSON indented": lambda _: json.dumps(TOPOLOGY, indent=2).encode(),
    "Esri JSON": lambda _: json.dumps(ESRI).encode(),
    "CityJSON": lambda _: b'{"type": "CityJSON", "version": "2.0", "CityObjects": {}, "vertices": []}',
    "PNG": lambda _: picture("PNG"),
    "JPEG": lambda _: picture("JPEG"),
    "GIF": lambda _: picture("GIF"),
    "TIFF": lambda _: picture("TIFF"),
    "SVG": lambda _: figure("svg"),
    "PDF": lambda _: figure("pdf"),
    "CSV": lambda _: table(","),
    "CSV ;": lambda _: table(";"),
    "CSV tab": lambda _: table("\t"),
    "zip": lambda _: archive(),
    "SQLite": database,
    "glTF": lambda folder: model(folder, "gltf"),
    "XML": lambda folder: model(folder, "mjcf"),
    "DXF": lambda _: b"  0\r\nSECTION\r\n  2\r\nHEADER\r\n",
    "DXF with a comment": lambda _: b"999\nby hand\n0\nSECTION\n",
    "DWG": lambda _: b"AC1032" + bytes(20),
    "STEP": lambda _: b"ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\n",
    "shapefile": lambda _: struct.pack(">7i", 9994, 0, 0, 0, 0, 0, 50),
    "YAML of Open-RMF": lambda _: b"name: flat\nlevels:\n  L1:\n    vertices:\n      - [0, 0, 0, a]\n",
    "YAML of PyRoboSim": lambda _: (
        b"params:\n  name: w\nrooms:\n  - name: kitchen\n    footprint: {type: polygon}\n"
    ),
    "YAML of ESPresense": lambda _: (
        b"mqtt:\n  host: a\nfloors: # metres\n  - id: f\n    bounds: [[0, 0, 0], [1, 1, 2]]\n"
    ),
    "KML": lambda _: b'<?xml version="1.0"?>\n<kml xmlns="http://www.opengis.net/kml/2.2"></kml>',
}


@pytest.mark.parametrize("name", ["plan.json", "plan.geojson", "plan.jsonl", "plan", "plan.yaml"])
@pytest.mark.parametrize("kind", PLANS)
def test_another_format_is_named_with_what_to_do(kind: str, name: str, tmp_path: Path) -> None:
    content = PLANS[kind](tmp_path)
    (tmp_path / name).write_bytes(content)
    with pytest.raises(HouseFileError) as refused:
        read_plan(tmp_path / name)
    said = str(refused.value)
    assert kind.split(maxsplit=1)[0] in said
    assert "a plan is a house file of one house, GeoJSON, or of HouseExpo" in said
    assert "\n" not in said


def test_what_is_packed_is_named_too(tmp_path: Path) -> None:
    (tmp_path / "plan").write_bytes(gzip.compress(PLANS["TopoJSON"](tmp_path)))
    with pytest.raises(HouseFileError, match="TopoJSON"):
        read_plan(tmp_path / "plan")


@pytest.mark.parametrize("name", ["flat.geojson", "flat.json", "flat.jsonl"])
def test_text_that_is_not_utf_8_says_where_and_what_to_save(name: str, tmp_path: Path) -> None:
    plan = {"type": "Polygon", "properties": {"name": "Küche"}, "coordinates": []}
    (tmp_path / name).write_bytes(json.dumps(plan, ensure_ascii=False).encode("latin-1"))
    with pytest.raises(
        HouseFileError, match="line 1, column 46: not UTF-8: byte 0xfc, ü in Latin-1: save as UTF-8"
    ):
        read_plan(tmp_path / name)


def test_an_empty_plan_and_a_damaged_one_are_named_as_such(tmp_path: Path) -> None:
    (tmp_path / "plan.geojson").touch()
    with pytest.raises(HouseFileError, match="holds no house, and a plan is a house file"):
        read_plan(tmp_path / "plan.geojson")
    (tmp_path / "plan.geojson").write_text('{"type": "Polygon", ')
    with pytest.raises(HouseFileError, match="is not GeoJSON: Expecting property name"):
        read_plan(tmp_path / "plan.geojson")
