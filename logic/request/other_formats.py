"""Recognition of files that are not plans, by their first bytes whatever their names."""

import re
from collections.abc import Mapping
from typing import Any

from vitruvius.logic.opener import from_json

GEOJSON = "convert it to GeoJSON, a polygon for each room"
DRAW = "draw its rooms as polygons in a GIS or CAD, and export GeoJSON"

BEGINNINGS = (
    (re.compile(rb"\x89PNG\r\n\x1a\n"), "a PNG picture", DRAW),
    (re.compile(rb"\xff\xd8\xff"), "a JPEG picture", DRAW),
    (re.compile(rb"GIF8[79]a"), "a GIF picture", DRAW),
    (re.compile(rb"(II\*\0|MM\0\*)"), "a TIFF picture", DRAW),
    (re.compile(rb"%PDF-"), "a PDF", DRAW),
    (re.compile(rb"\0\0\x27\x0a"), "a shapefile", GEOJSON),
    (re.compile(rb"SQLite format 3\0"), "an SQLite file, such as a GeoPackage", GEOJSON),
    (re.compile(rb"AC10\d\d"), "a DWG drawing", GEOJSON),
    (
        re.compile(rb"AutoCAD Binary DXF|0[ \t]*+[\r\n]\s*+SECTION\b|999[\r\n]"),
        "a DXF drawing",
        GEOJSON,
    ),
    (re.compile(rb"ISO-10303-21;"), "a STEP model that is not IFC", GEOJSON),
    (re.compile(rb"glTF"), "a glTF model", "give the house file that it was made of"),
    (
        re.compile(rb"PK\x03\x04"),
        "a zip archive, such as KMZ or XLSX",
        "unpack it, and convert the plan to GeoJSON",
    ),
    (re.compile(rb"\x89HDF\r\n"), "an HDF5 file", GEOJSON),
    (
        re.compile(rb"\x80[\x02-\x05]"),
        "a Python pickle, which may run anything",
        "write one plan of it as JSON",
    ),
)
"""Beginning of the files of each format (a regular expression), the format in words, and a remedy."""

XML = {b"svg": "an SVG picture", b"kml": "KML", b"gml": "GML", b"mxfile": "a diagram", b"html": "HTML"}
"""Formats of XML, by the first element."""

JSON = {"Topology": "TopoJSON", "CityJSON": "CityJSON"}
"""Formats of JSON, by the value of ``type``."""

YAML = re.compile(rb"(?m)^(?:levels|floors|rooms|hallways)[ \t]*:[ \t]*(?:#.*)?\r?$")
"""A line of a floor plan in YAML."""

READ = "a plan is a house file of one house, GeoJSON, or of HouseExpo, ResPlan, CubiCasa5K, IMDF or IFC"


def named(content: bytes) -> str | None:
    """Return the format of a file and a remedy, in words; None for a format that is not known."""
    content = content.removeprefix(b"\xef\xbb\xbf").lstrip()
    found = next(((what, do) for begins, what, do in BEGINNINGS if begins.match(content)), None)
    found = found or _xml(content) or _json(content) or _yaml(content) or _table(content)
    return found and f"is {found[0]}, and {READ}: {found[1]}"


def _xml(content: bytes) -> tuple[str, str] | None:
    element = re.search(rb"<(?:\w+:)?([A-Za-z]+)", content[:4096])
    if not content.lstrip().startswith(b"<") or element is None:
        return None
    what = XML.get(element[1].lower(), "XML")
    return what, DRAW if what in (XML[b"svg"], "HTML", "a diagram") else GEOJSON


def _json(content: bytes) -> tuple[str, str] | None:
    try:
        record: Any = from_json(content)
    except ValueError:
        return None
    if not isinstance(record, Mapping):
        return None
    kind = record.get("type")
    if isinstance(kind, str) and kind in JSON:
        return JSON[kind], GEOJSON
    if isinstance(record.get("asset"), Mapping) and "version" in record["asset"]:
        return "a glTF model", "give the house file that it was made of"
    if {"rings", "spatialReference", "geometryType"} & record.keys():
        return "Esri JSON", GEOJSON
    return None


def _yaml(content: bytes) -> tuple[str, str] | None:
    """Return the format of YAML that names levels, floors or rooms, but no picture as a map of ROS does."""
    if YAML.search(content[:65536]) is None or re.search(rb"(?m)^image[ \t]*:", content[:65536]):
        return None
    return "a floor plan in YAML, as of Open-RMF, PyRoboSim or ESPresense", GEOJSON


def _table(content: bytes) -> tuple[str, str] | None:
    """Return the format of lines with equal numbers of commas, semicolons or tabs that are not JSON."""
    lines = content[:4096].splitlines()[:3]
    if len(lines) < 2 or lines[0].lstrip()[:1] in (b"{", b"["):
        return None
    for mark in (b",", b";", b"\t"):
        if lines[0].count(mark) and lines[0].count(mark) == lines[1].count(mark):
            return "a table (CSV)", "write each row as a polygon in GeoJSON"
    return None
