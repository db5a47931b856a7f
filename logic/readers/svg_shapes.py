"""Shapes of an SVG picture in picture coordinates, after the ``transform`` of each group around (SVG 1.1)."""

import re
from collections.abc import Callable, Iterator, Sequence
from itertools import accumulate
from math import cos, radians, sin, tan
from xml.etree.ElementTree import Element

import numpy as np
import shapely
from shapely import Polygon, affinity

from vitruvius.logic.errors import RequestError

MAX_LETTERS = 1 << 10
"""Number of characters of a ``transform``."""

MAX_SCALE = 1e12
"""Greatest number in a matrix."""

NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")

STEPS = re.compile(r"([MmLlHhVvZz])([^A-Za-z]*+)")
"""A command of a path of straight lines, and its numbers."""

Matrix = np.ndarray
"""Transformation from the units of an element to those of the picture: (3, 3) float64."""


def placed(element: Element, at: Matrix | None = None) -> Iterator[tuple[Element, Matrix]]:
    """Yield all elements of a picture, each with its matrix.

    Raises ``RequestError`` for a ``transform`` that cannot be read.
    """
    here = np.eye(3) if at is None else at
    if element.get("transform"):
        with np.errstate(all="ignore"):
            here = np.clip(here @ _matrix(element), -MAX_SCALE, MAX_SCALE)
    yield element, here
    for child in element:
        yield from placed(child, here)


def kind(element: Element) -> str:
    """Return the name of an element without its namespace."""
    return element.tag.rpartition("}")[2]


def polygon_in(group: Element, at: Matrix) -> Polygon | None:
    """Return the first child of a group that is a polygon, a rectangle or a path of straight lines, or None.

    Raises ``RequestError`` if that shape cannot be read.
    """
    for child in group:
        if (corners := _corners(child)) is not None and len({*corners}) >= 3:
            try:
                with np.errstate(all="ignore"):
                    (a, c, e), (b, d, f), _ = (at @ _matrix(child)).tolist()
                    return affinity.affine_transform(Polygon(corners), (a, c, b, d, e, f))
            except RequestError:
                raise
            except (shapely.errors.ShapelyError, ValueError):
                raise RequestError(f"plan: the polygon of {_called(group)} is invalid") from None
    return None


def _corners(shape: Element) -> Sequence[tuple[float, float]] | None:
    """Return the corners of a shape in its own units; None for a curve and for an element without a shape."""
    if kind(shape) == "polygon":
        found = _numbers(shape.get("points", ""))
        return list(zip(found[::2], found[1::2], strict=False))
    if kind(shape) == "rect":
        x, y, width, height = (
            next(iter(_numbers(shape.get(name, "0"))), 0.0) for name in ("x", "y", "width", "height")
        )
        return [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]
    if kind(shape) == "path" and not re.search(r"[AaCcQqSsTt]", shape.get("d", "")):
        return list(_along(shape.get("d", "")))
    return None


def _along(path: str) -> Iterator[tuple[float, float]]:
    """Yield the corners of the first ring of a path of straight lines."""
    x = y = 0.0
    begun = False
    for command, text in STEPS.findall(path):
        if command in "Zz" or (command in "Mm" and begun):
            return
        begun, found = True, _numbers(text)
        from_here = command.islower()
        if command in "Hh":
            ends = [(number, None) for number in found]
        elif command in "Vv":
            ends = [(None, number) for number in found]
        else:
            ends = list(zip(found[::2], found[1::2], strict=False))
        for to_x, to_y in ends:
            x = x if to_x is None else to_x + (x if from_here else 0.0)
            y = y if to_y is None else to_y + (y if from_here else 0.0)
            yield x, y


def _matrix(element: Element) -> Matrix:
    """Return the matrix of an element's ``transform``, whose last function applies first."""
    text = element.get("transform", "")
    if not text.strip():
        return np.eye(3)
    with np.errstate(over="raise", invalid="raise"):
        return _read(element, text)


def _read(element: Element, text: str) -> Matrix:
    found = re.findall(r"(\w{1,9})\s{0,9}\(([^()]*+)\)", text) if len(text) <= MAX_LETTERS else []
    try:
        if not found or re.sub(r"\w{1,9}\s{0,9}\([^()]*+\)", "", text).strip(" ,\t\r\n"):
            raise KeyError
        *_, whole = accumulate((FUNCTIONS[name](*_numbers(given)) for name, given in found), np.matmul)
        if not (np.abs(whole) < MAX_SCALE).all():
            raise ValueError
        return whole
    except (KeyError, TypeError, ValueError, FloatingPointError):
        raise RequestError(
            f"plan: the transform of {_called(element)}, {text[:40]!r}, cannot be read: apply it in "
            "a drawing program, and save the file again"
        ) from None


def _called(element: Element) -> str:
    return f"{element.get('id') or kind(element)} {element.get('class') or ''}".strip()


def _numbers(text: str) -> list[float]:
    return [float(each) for each in NUMBER.findall(text)]


def _affine(a: float, b: float, c: float, d: float, e: float, f: float) -> Matrix:
    return np.array([[a, c, e], [b, d, f], [0.0, 0.0, 1.0]])


def _rotation(angle: float, x: float = 0.0, y: float = 0.0) -> Matrix:
    s, c = sin(radians(angle)), cos(radians(angle))
    return _affine(c, s, -s, c, x - c * x + s * y, y - s * x - c * y)


FUNCTIONS: dict[str, Callable[..., Matrix]] = {
    "matrix": _affine,
    "translate": lambda x, y=0.0: _affine(1.0, 0.0, 0.0, 1.0, x, y),
    "scale": lambda x, y=None: _affine(x, 0.0, 0.0, x if y is None else y, 0.0, 0.0),
    "rotate": _rotation,
    "skewX": lambda angle: _affine(1.0, 0.0, tan(radians(angle)), 1.0, 0.0, 0.0),
    "skewY": lambda angle: _affine(1.0, tan(radians(angle)), 0.0, 1.0, 0.0, 0.0),
}
"""Matrix of each function of a ``transform``, by SVG's name; angles in degrees, lengths in element units."""
