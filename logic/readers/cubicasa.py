"""CubiCasa5K (Kalervo and others, 2019): ``model.svg``, in pixels.

A group of the class ``Space Bedroom`` has the room's polygon, and in many files a label with its size, as in
``3.20 m x 4.05 m``; groups of the classes ``Door`` and ``Window`` have rectangles in the walls. The ids
repeat the classes until a drawing program replaces them.
"""

import re
from collections.abc import Container, Iterator
from itertools import islice
from math import log
from statistics import median
from typing import Any
from xml.etree.ElementTree import Element

from shapely import Polygon

from vitruvius.logic.errors import RequestError
from vitruvius.logic.opener import from_xml
from vitruvius.logic.readers.sketch import (
    Passage,
    Sketch,
    Space,
    chosen,
    polygons,
    require_none,
    require_plain,
)
from vitruvius.logic.readers.svg_shapes import Matrix, kind, placed, polygon_in

FORMAT = "a plan of CubiCasa5K"

PIXEL = 0.01
"""Metres per pixel if no label states it, since models are drawn in centimetres."""

METRES = re.compile(
    r"(?<![\d.,])(\d{1,4}(?:[.,]\d{1,9})?)\s{0,9}m\s{0,9}[x×]\s{0,9}(\d{1,4}(?:[.,]\d{1,9})?)\s{0,9}m"
)
FEET = re.compile(
    r"(?<!\d)(\d{1,4})'\s{0,9}(?:(\d{1,4})\")?\s{0,9}[x×]\s{0,9}(\d{1,4})'\s{0,9}(?:(\d{1,4})\")?"
)

FOOT = 0.3048

MAX_LABELS, MAX_PARTS, MAX_LETTERS = 64, 256, 1 << 10
"""Number of labels of a room that are read, of texts in a label, and of characters of a label."""


def is_cubicasa(content: bytes, _: Any) -> bool:
    """Return True if a file is a model of CubiCasa5K: an SVG picture with a class for each room."""
    return b"<svg" in content[:4096] and re.search(rb'class="Space ', content) is not None


def read_cubicasa(content: bytes, _: Any, storey: str | None) -> Sketch:
    """Return the rooms by their classes, with the unit from the sizes in labels."""
    try:
        tree = from_xml(content)
    except ValueError as error:
        raise RequestError(f"plan: {FORMAT} that is damaged: {error}") from None
    storeys = [each for each in _groups(tree) if "Floorplan" in each.get("class", "").split()]
    storeys = [each for each in storeys if any(_is_space(group) for group in _groups(each))]
    if not storeys:
        require_none(storey)
    one = chosen([each.get("id") or "" for each in storeys], storey) if storeys else 0
    groups = {*(storeys[one] if storeys[1:] else tree).iter()}
    drawn = [(group, shape) for group, at in _parts(tree, groups) if (shape := polygon_in(group, at))]
    require_plain([shape for _, shape in drawn])
    spaces, doors, windows, units = list[Space](), list[Passage](), list[Polygon](), list[float]()
    for group, shape in drawn:
        what, *words = _said(group)
        if (polygon := max(polygons(shape), key=lambda each: each.area, default=None)) is None:
            continue
        if what == "Door":
            doors.append(Passage(polygon))
        elif what == "Window":
            windows.append(polygon)
        elif words:
            spaces.append(Space(words[0], (" ".join(words), words[0]), polygon))
            units += _units(group, polygon)
    guessed = "" if units else f"no label states the size of a room: assuming {PIXEL:g} m per pixel"
    return Sketch(FORMAT, spaces, doors, list(windows), median(units) if units else PIXEL, guessed=guessed)


def _groups(tree: Element) -> Iterator[Element]:
    return (each for each in tree.iter() if kind(each) == "g")


def _parts(tree: Element, groups: Container[Element]) -> Iterator[tuple[Element, Matrix]]:
    """Yield the rooms, doors and windows among the groups of a storey, each with its matrix."""
    for group, at in placed(tree):
        if group in groups and kind(group) == "g" and _said(group)[0] in ("Space", "Door", "Window"):
            yield group, at


def _said(group: Element) -> list[str]:
    return (group.get("class") or group.get("id") or "").split() or [""]


def _is_space(group: Element) -> bool:
    return group.get("class", "").split()[:1] == ["Space"]


def _units(group: Element, polygon: Polygon) -> Iterator[float]:
    """Yield metres per pixel from the sizes in a room's label, in the order in which both sides agree."""
    west, north, east, south = polygon.bounds
    for label in islice((each for each in group.iter() if kind(each) == "text"), MAX_LABELS):
        text = "".join(islice(label.itertext(), MAX_PARTS))[:MAX_LETTERS]
        if found := METRES.search(text):
            one, other = (float(each.replace(",", ".")) for each in found.groups())
        elif found := FEET.search(text):
            one, inches, other, more = (float(each or 0) for each in found.groups())
            one, other = FOOT * (one + inches / 12), FOOT * (other + more / 12)
        else:
            continue
        if min(one, other) < 1.5 or min(east - west, south - north) <= 0:
            continue  # a label is rounded, which matters in a small room
        pairs = [(a / (east - west), b / (south - north)) for a, b in ((one, other), (other, one))]
        a, b = min(pairs, key=lambda pair: abs(log(pair[0] / pair[1])))
        if abs(log(a / b)) < 0.05:  # otherwise the room is no rectangle
            yield (a + b) / 2
