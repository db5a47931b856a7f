"""Drawings as lists of shapes in CSS pixels, and their conversion to SVG text or a Pillow image."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from itertools import pairwise
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from vitruvius.logic.spelling import markup, printable

Box = tuple[float, float, float, float]
"""(left, top, right, bottom), CSS pixels."""
Point = tuple[float, float]

DENSITY = 2
"""Image pixels per CSS pixel."""
SMOOTHING = 2
"""Factor of oversampling: Pillow's shapes have hard edges, so they are drawn larger and scaled down."""
CURVE_STEPS = 12
"""Number of straight lines that approximate a cubic curve in images."""
ASCENT = 0.36
"""Half the height of a capital letter, in font sizes. Words are placed by their middle."""


@dataclass(frozen=True)
class Block:
    """Rectangle with round corners, filled and outlined in the given colours (``#rrggbb``)."""

    box: Box
    fill: str = ""
    stroke: str = ""
    width: float = 1.0
    radius: float = 0.0


@dataclass(frozen=True)
class Oval:
    """Ellipse that fills a box."""

    box: Box
    fill: str = ""
    stroke: str = ""
    width: float = 1.0


@dataclass(frozen=True)
class Line:
    """Line through points."""

    points: tuple[Point, ...]
    stroke: str
    width: float = 1.0
    dash: float = 0.0
    """Length of its dashes and of the gaps between them, or 0 for a solid line."""


@dataclass(frozen=True)
class Curve:
    """Cubic Bézier curves in sequence: the start of the first, then three points for each curve."""

    points: tuple[Point, ...]
    stroke: str
    width: float = 1.0


@dataclass(frozen=True)
class Strokes:
    """Separate straight strokes, which form a pattern."""

    ends: tuple[tuple[Point, Point], ...]
    stroke: str
    width: float = 1.0


@dataclass(frozen=True)
class Rings:
    """Area with borders along both axes: the points that an odd number of closed ``rings`` encloses."""

    rings: tuple[tuple[Point, ...], ...]
    fill: str


@dataclass(frozen=True)
class Text:
    """Words. ``at`` is a point at half their height; ``halo`` is the colour of a rim around the letters.

    ``anchor`` is the part of the words at that point: ``start``, ``middle`` or ``end``. Words that are
    ``turned`` read upwards.
    """

    at: Point
    text: str
    size: float
    fill: str
    anchor: str = "middle"
    halo: str = ""
    turned: bool = False


@dataclass(frozen=True)
class Part:
    """Shapes of a part of a house, with the name that ``explain --why`` takes: ``data-part`` in SVG."""

    name: str
    shapes: tuple["Shape", ...]


Plain = Block | Oval | Line | Curve | Strokes | Rings | Text
Shape = Plain | Part


def flat(shapes: Iterable[Shape]) -> Iterator[Plain]:
    """Yield all shapes, with those of parts, the lowest first."""
    for shape in shapes:
        if isinstance(shape, Part):
            yield from flat(shape.shapes)
        else:
            yield shape


@dataclass(frozen=True)
class Drawing:
    """Shapes on white, the lowest first."""

    width: float
    height: float
    shapes: tuple[Shape, ...]


def svg(
    cells: Iterable[tuple[Point, Drawing]], width: float, height: float, size: tuple[str, str] | None = None
) -> str:
    """Put drawings on one SVG, each with its top left corner at its point.

    ``size``: its width and height in another unit than the CSS pixel, as in ``("210mm", "297mm")``.
    """
    wide, high = size or (f"{width:g}", f"{height:g}")
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{wide}" height="{high}" '
        f'viewBox="0 0 {width:g} {height:g}" font-family="DejaVu Sans, Verdana, sans-serif">',
        f'<rect width="{width:g}" height="{height:g}" fill="#ffffff"/>',
    ]
    for (x, y), drawing in cells:
        lines += [f'<g transform="translate({x:g} {y:g})">', *map(_element, drawing.shapes), "</g>"]
    return "\n".join([*lines, "</svg>\n"])


def png(cells: Iterable[tuple[Point, Drawing]], width: float, height: float) -> Image.Image:
    """Put drawings on one image, ``DENSITY`` image pixels to a CSS pixel."""
    sheet = Image.new("RGB", (round(width * DENSITY), round(height * DENSITY)), "#ffffff")
    scale = DENSITY * SMOOTHING
    for (x, y), drawing in cells:
        large = Image.new("RGB", (round(drawing.width * scale), round(drawing.height * scale)), "#ffffff")
        pen = ImageDraw.Draw(large)
        for shape in flat(drawing.shapes):
            _ink(pen, shape, scale)
        sheet.paste(large.reduce(SMOOTHING), (round(x * DENSITY), round(y * DENSITY)))
    return sheet


def text_width(text: str, size: float) -> float:
    """Return the width of a text, CSS pixels."""
    return _ems(text) * size


@lru_cache(4096)
def _ems(text: str) -> float:
    """Return the width of a text in font sizes."""
    return _font(64).getlength(printable(text)) / 64


def _element(shape: Shape) -> str:
    """Return the SVG element of a shape."""
    match shape:
        case Part(name, shapes):
            return f'<g data-part="{markup(name)}">{"".join(map(_element, shapes))}</g>'
        case Block((left, top, right, bottom), fill, stroke, width, radius):
            size = f'width="{right - left:.1f}" height="{bottom - top:.1f}" rx="{radius:.1f}"'
            return f'<rect x="{left:.1f}" y="{top:.1f}" {size} {_paint(fill, stroke, width)}/>'
        case Oval((left, top, right, bottom), fill, stroke, width):
            middle = f'cx="{(left + right) / 2:.1f}" cy="{(top + bottom) / 2:.1f}"'
            size = f'rx="{(right - left) / 2:.1f}" ry="{(bottom - top) / 2:.1f}"'
            return f"<ellipse {middle} {size} {_paint(fill, stroke, width)}/>"
        case Line(points, stroke, width, dash):
            broken = f' stroke-dasharray="{dash:.1f}"' if dash else ""
            return f'<polyline points="{_listed(points)}" {_paint("", stroke, width)}{broken}/>'
        case Curve() | Strokes() | Rings():
            filled = isinstance(shape, Rings)
            paint = (
                f'fill="{shape.fill}" fill-rule="evenodd"'
                if filled
                else _paint("", shape.stroke, shape.width)
            )
            return f'<path d="{_path(shape)}" {paint}/>'
        case Text((x, y), text, size, fill, anchor, halo, turned):
            place = f'x="{x:.1f}" y="{y + ASCENT * size:.1f}" font-size="{size:g}" text-anchor="{anchor}"'
            place += f' transform="rotate(-90 {x:.1f} {y:.1f})"' if turned else ""
            rim = f'{_paint(fill, halo, size / 4)} paint-order="stroke" stroke-linejoin="round"'
            place += ' pointer-events="none"'  # A click on a room's name selects the room.
            return f"<text {place} {rim if halo else _paint(fill, '', 0)}>{markup(text)}</text>"


def _path(shape: Curve | Strokes | Rings) -> str:
    """Return the data of an SVG path."""
    if isinstance(shape, Rings):
        return "".join(f"M{_listed(ring)}Z" for ring in shape.rings)
    if isinstance(shape, Strokes):
        return "".join(f"M{_listed(ends)}" for ends in shape.ends)
    return f"M{_listed(shape.points[:1])}C{_listed(shape.points[1:])}"


def _listed(points: Iterable[Point]) -> str:
    """Return points in the notation of SVG."""
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)


def _ink(pen: ImageDraw.ImageDraw, shape: Plain, scale: int) -> None:
    """Draw a shape with Pillow, with ``scale`` image pixels per CSS pixel."""

    def length(value: float) -> int:
        return max(1, round(value * scale))

    match shape:
        case Block(box, fill, stroke, width, radius):
            around = _around(box, width if stroke else 0.0, scale)
            corner = radius + width / 2 if radius and stroke else radius
            # Pillow draws the straight parts between the corners too, and refuses those of less than a pixel.
            room = min(around[2] - around[0], around[3] - around[1]) - 3
            corner = max(0.0, min(corner * scale, room / 2))
            pen.rounded_rectangle(around, corner, fill or None, stroke or None, length(width))
        case Oval(box, fill, stroke, width):
            around = _around(box, width if stroke else 0.0, scale)
            pen.ellipse(around, fill or None, stroke or None, length(width))
        case Line(points, stroke, width, dash):
            for stretch in _dashes(points, dash) if dash else [points]:
                pen.line([(x * scale, y * scale) for x, y in stretch], stroke, length(width), joint="curve")
        case Curve(points, stroke, width):
            _ink(pen, Line(tuple(_bent(points)), stroke, width), scale)
        case Strokes(ends, stroke, width):
            for (x0, y0), (x1, y1) in ends:
                pen.line((x0 * scale, y0 * scale, x1 * scale, y1 * scale), stroke, length(width))
        case Rings(rings, fill):
            for box in boxes_of_rings(rings):
                pen.rectangle(_around(box, 0.0, scale), fill)
        case Text((x, y), text, size, fill, turned=True):
            font = _font(length(size))
            wide, high = round(font.getlength(printable(text))), length(1.4 * size)
            mask = Image.new("L", (wide, high))
            ImageDraw.Draw(mask).text((0, high / 2 + ASCENT * size * scale), printable(text), 255, font, "ls")
            corner = round(x * scale - high / 2), round(y * scale - wide / 2)
            pen.bitmap(corner, mask.transpose(Image.Transpose.ROTATE_90), fill)
        case Text((x, y), text, size, fill, anchor, halo):
            place = x * scale, (y + ASCENT * size) * scale
            rim = length(size / 8) if halo else 0
            pen.text(
                place,
                printable(text),
                fill,
                _font(length(size)),
                {"start": "ls", "middle": "ms", "end": "rs"}[anchor],
                stroke_width=rim,
                stroke_fill=halo or None,
            )


def boxes_of_rings(rings: Iterable[Sequence[Point]]) -> Iterator[Box]:
    """Cut an area with borders along both axes into boxes that do not overlap, and yield the boxes."""
    sides = [pair for ring in rings for pair in pairwise([*ring, ring[0]])]
    upright = np.array([(x0, *sorted((y0, y1))) for (x0, y0), (x1, y1) in sides if y0 != y1]).reshape(-1, 3)
    upright = upright[upright[:, 0].argsort()]
    for top, bottom in pairwise(np.unique(upright[:, 1:])):
        xs = upright[(upright[:, 1] <= top) & (upright[:, 2] >= bottom), 0]
        for left, right in zip(xs[::2], xs[1::2], strict=True):
            yield float(left), float(top), float(right), float(bottom)


def _bent(points: Sequence[Point]) -> Iterator[Point]:
    """Yield points along cubic Bézier curves."""
    yield points[0]
    for first in range(0, len(points) - 1, 3):
        corners = points[first : first + 4]
        for k in range(1, CURVE_STEPS + 1):
            t = k / CURVE_STEPS
            weights = (1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3
            x, y = (sum(w * p[axis] for w, p in zip(weights, corners, strict=True)) for axis in (0, 1))
            yield x, y


def _dashes(points: Sequence[Point], dash: float) -> Iterator[tuple[Point, Point]]:
    """Yield the dashes of a line; each straight part of the line begins with a dash."""
    for (x0, y0), (x1, y1) in pairwise(points):
        length = math.dist((x0, y0), (x1, y1))
        for start in range(0, math.ceil(length / dash), 2):
            t, u = start * dash / length, min(1.0, (start + 1) * dash / length)
            yield (x0 + t * (x1 - x0), y0 + t * (y1 - y0)), (x0 + u * (x1 - x0), y0 + u * (y1 - y0))


def _around(box: Box, width: float, scale: int) -> Box:
    """Return a box in image pixels, larger by half a stroke.

    Pillow draws the stroke inside the box, SVG on its edge.
    """
    left, top, right, bottom = box
    by = width / 2
    # To whole pixels by way of hundredths, so that edges on one line are drawn on one line.
    edges = (left - by, top - by, right + by, bottom + by)
    left, top, right, bottom = (float(round(round(edge * scale, 2))) for edge in edges)
    # Pillow's far corner is the last pixel inside.
    return left, top, max(left, right - 1), max(top, bottom - 1)


@cache
def _font(size: int) -> ImageFont.FreeTypeFont:
    """Return DejaVu Sans from our own file, so that drawings are equal on every machine."""
    return ImageFont.truetype(str(Path(__file__).parent / "fonts/DejaVuSans.ttf"), size)


def _paint(fill: str, stroke: str, width: float) -> str:
    edge = f' stroke="{stroke}" stroke-width="{width:.2g}"' if stroke else ""
    return f'fill="{fill or "none"}"{edge}'
