"""A drawing is a list of shapes in CSS pixels; here it becomes SVG text or a Pillow image."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from html import escape
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from logic.spelling import printable

Box = tuple[float, float, float, float]
"""(left, top, right, bottom), CSS pixels."""
Point = tuple[float, float]

DENSITY = 2
"""Image pixels to a CSS pixel."""
SMOOTHING = 2
"""Pillow's shapes have hard edges: they are drawn this many times larger, then scaled down."""
ASCENT = 0.36
"""Half the height of a capital letter, in font sizes: words are placed by their middle."""


@dataclass(frozen=True)
class Block:
    """A rectangle, filled and edged where it has these colours (``#rrggbb``), its corners round."""

    box: Box
    fill: str = ""
    stroke: str = ""
    width: float = 1.0
    radius: float = 0.0


@dataclass(frozen=True)
class Oval:
    """The ellipse that fills a box."""

    box: Box
    fill: str = ""
    stroke: str = ""
    width: float = 1.0


@dataclass(frozen=True)
class Line:
    """A line through points."""

    points: tuple[Point, ...]
    stroke: str
    width: float = 1.0


@dataclass(frozen=True)
class Text:
    """Words: ``at`` is the middle of its height, the halo a rim in another colour.

    ``anchor`` says which part of it is there: ``start``, ``middle`` or ``end``.
    """

    at: Point
    text: str
    size: float
    fill: str
    anchor: str = "middle"
    halo: str = ""


@dataclass(frozen=True)
class Part:
    """The shapes of a part of a house, by the name that ``explain --why`` takes: ``data-part`` in SVG."""

    name: str
    shapes: tuple["Shape", ...]


Shape = Block | Oval | Line | Text | Part


def flat(shapes: Iterable[Shape]) -> Iterator[Block | Oval | Line | Text]:
    """All shapes, those of parts among them, the lowest first."""
    for shape in shapes:
        if isinstance(shape, Part):
            yield from flat(shape.shapes)
        else:
            yield shape


@dataclass(frozen=True)
class Drawing:
    """Shapes on white, the first lowest."""

    width: int
    height: int
    shapes: tuple[Shape, ...]


def svg(cells: Iterable[tuple[Point, Drawing]], width: int, height: int) -> str:
    """Put drawings on one SVG, each with its top left corner at its point."""
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
        f'viewBox="0 0 {width} {height}" font-family="DejaVu Sans, Verdana, sans-serif">',
        f'<rect width="{width}" height="{height}" fill="#ffffff"/>',
    ]
    for (x, y), drawing in cells:
        lines += [f'<g transform="translate({x:g} {y:g})">', *map(_element, drawing.shapes), "</g>"]
    return "\n".join([*lines, "</svg>\n"])


def png(cells: Iterable[tuple[Point, Drawing]], width: int, height: int) -> Image.Image:
    """Put drawings on one image, ``DENSITY`` image pixels to a CSS pixel."""
    sheet = Image.new("RGB", (width * DENSITY, height * DENSITY), "#ffffff")
    scale = DENSITY * SMOOTHING
    for (x, y), drawing in cells:
        large = Image.new("RGB", (drawing.width * scale, drawing.height * scale), "#ffffff")
        pen = ImageDraw.Draw(large)
        for shape in flat(drawing.shapes):
            _ink(pen, shape, scale)
        sheet.paste(large.reduce(SMOOTHING), (round(x * DENSITY), round(y * DENSITY)))
    return sheet


def text_width(text: str, size: float) -> float:
    """Width of a text, CSS pixels."""
    return _font(64).getlength(printable(text)) * size / 64


def _element(shape: Shape) -> str:
    """The SVG element of a shape."""
    match shape:
        case Part(name, shapes):
            return f'<g data-part="{escape(printable(name))}">{"".join(map(_element, shapes))}</g>'
        case Block((left, top, right, bottom), fill, stroke, width, radius):
            size = f'width="{right - left:.1f}" height="{bottom - top:.1f}" rx="{radius:.1f}"'
            return f'<rect x="{left:.1f}" y="{top:.1f}" {size} {_paint(fill, stroke, width)}/>'
        case Oval((left, top, right, bottom), fill, stroke, width):
            middle = f'cx="{(left + right) / 2:.1f}" cy="{(top + bottom) / 2:.1f}"'
            size = f'rx="{(right - left) / 2:.1f}" ry="{(bottom - top) / 2:.1f}"'
            return f"<ellipse {middle} {size} {_paint(fill, stroke, width)}/>"
        case Line(points, stroke, width):
            listed = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
            return f'<polyline points="{listed}" {_paint("", stroke, width)}/>'
        case Text((x, y), text, size, fill, anchor, halo):
            place = f'x="{x:.1f}" y="{y + ASCENT * size:.1f}" font-size="{size:g}" text-anchor="{anchor}"'
            rim = f'{_paint(fill, halo, size / 4)} paint-order="stroke" stroke-linejoin="round"'
            place += ' pointer-events="none"'  # A click on a room's name is one on the room.
            return f"<text {place} {rim if halo else _paint(fill, '', 0)}>{escape(printable(text))}</text>"


def _ink(pen: ImageDraw.ImageDraw, shape: Block | Oval | Line | Text, scale: int) -> None:
    """Draw a shape with Pillow, ``scale`` image pixels to a CSS pixel."""

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
        case Line(points, stroke, width):
            pen.line([(x * scale, y * scale) for x, y in points], stroke, length(width), joint="curve")
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


def _around(box: Box, width: float, scale: int) -> Box:
    """A box in image pixels: Pillow strokes inside it and SVG on its edge, so it grows by half a stroke."""
    left, top, right, bottom = box
    by = width / 2
    left, top, right, bottom = ((v * scale) for v in (left - by, top - by, right + by, bottom + by))
    # Pillow's far corner is the last pixel inside.
    return left, top, max(left, right - 1), max(top, bottom - 1)


@cache
def _font(size: int) -> ImageFont.FreeTypeFont:
    """DejaVu Sans from matplotlib's own files, so that every machine draws alike."""
    import matplotlib

    return ImageFont.truetype(str(Path(matplotlib.get_data_path()) / "fonts/ttf/DejaVuSans.ttf"), size)


def _paint(fill: str, stroke: str, width: float) -> str:
    edge = f' stroke="{stroke}" stroke-width="{width:.2g}"' if stroke else ""
    return f'fill="{fill or "none"}"{edge}'
