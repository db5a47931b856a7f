"""Plans of houses as SVG and PNG: each alone, and many on a sheet."""

import math
from collections.abc import Iterable, Sequence
from io import BytesIO
from pathlib import Path
from typing import Literal

from PIL import Image

from logic.canvas import Drawing, Point, Text, png, svg
from logic.files import write_whole
from logic.house import House
from logic.labels import SWATCH, abbreviations, key, key_rows, legend, room_names, title
from logic.plan import INK, Frame, extent, house_shapes

TITLE, FOOT, MARGIN = 26, 22, 12
"""CSS pixels above a plan, below it and around it."""
WIDTH, CELL = 720, 300
"""CSS pixels: the width of a plan, and of a plan on a sheet."""


def plan_svg(house: House, width: int = WIDTH, scale: float | None = None) -> str:
    """Draw a plan as the text of an SVG file, of this width in CSS pixels; for ``scale`` see ``plan``."""
    drawing = plan(house, width, scale=scale)
    return svg([((0, 0), drawing)], drawing.width, drawing.height)


def plan_png(house: House, width: int = WIDTH, scale: float | None = None) -> Image.Image:
    """Draw the same plan as an image, two pixels to a CSS pixel."""
    drawing = plan(house, width, scale=scale)
    return png([((0, 0), drawing)], drawing.width, drawing.height)


def contact_sheet(
    houses: Sequence[House], columns: int | None = None, cell: int = CELL, one_scale: bool = False
) -> Image.Image:
    """Draw many plans on one image, each in a square of ``cell`` CSS pixels.

    Each is as large as it fits, or with ``one_scale`` as large as all of them fit.
    """
    return png(*_sheet(houses, columns, cell, one_scale))


def contact_sheet_svg(
    houses: Sequence[House], columns: int | None = None, cell: int = CELL, one_scale: bool = False
) -> str:
    """Draw the same sheet as the text of an SVG file."""
    return svg(*_sheet(houses, columns, cell, one_scale))


def draw(
    houses: Iterable[House],
    out_dir: str | Path,
    format: Literal["svg", "png"] = "svg",
    one_scale: bool = False,
) -> list[Path]:
    """Write a plan of each house, then the sheet of all; return the files' paths.

    Plan ``house-0`` is that of the first house. With ``one_scale`` a metre is as long on all plans, and as
    long on all of the sheet. Each file appears whole or not at all. Raises ``ValueError`` for another format
    or no house.
    """
    houses, out = list(houses), Path(out_dir)
    if format not in {"svg", "png"}:
        raise ValueError(f"plans are drawn as svg or png, not {format!r}")
    if not houses:
        raise ValueError(f"no house to draw in {out}")
    digits = len(str(len(houses) - 1))
    paths = [out / f"house-{index:0{digits}}.{format}" for index in range(len(houses))]
    scale = min(_scale(house, WIDTH) for house in houses) if one_scale else None
    for house, path in zip(houses, paths, strict=True):
        drawing = plan(house, WIDTH, scale=scale)
        _write(path, [((0, 0), drawing)], drawing.width, drawing.height)
    paths.append(out / f"contact-sheet.{format}")
    _write(paths[-1], *_sheet(houses, None, CELL, one_scale))
    return paths


def plan(house: House, width: int, height: int | None = None, scale: float | None = None) -> Drawing:
    """Draw a house into these CSS pixels, with its title, a scale and the meaning of its marks and colours.

    ``height``: by default as much as it needs, at most about one and a half widths. ``scale``: CSS pixels to
    a metre, by default as many as fit. Rooms too small for their names have abbreviations, and a key below.
    """
    short: dict[str, str] = {}
    frame, tall = _frame(house, width, height, scale, 0)
    names = room_names(house, frame, short)
    if None in names[: len(house.counted)]:
        short = abbreviations(room.type for room in house.counted)
    rows = key_rows(short, width - 2 * MARGIN)
    if rows:
        frame, tall = _frame(house, width, height, scale, len(rows))
        names = room_names(house, frame, short)
    foot = tall - FOOT / 2 - SWATCH * len(rows)
    shapes = [
        *house_shapes(house, frame),
        *(name for name in names if name is not None),
        Text((MARGIN, TITLE / 2 + 2), title(house, width - 2 * MARGIN), 11.5, INK, "start"),
        *legend(house, frame.scale, MARGIN, foot),
        *key(rows, short, MARGIN, foot + SWATCH + 2),
    ]
    return Drawing(width, tall, tuple(shapes))


def _frame(house: House, width: int, height: int | None, scale: float | None, rows: int) -> tuple[Frame, int]:
    """A house in the middle of a picture, above a key of so many rows; and the picture's height."""
    west, north, east, south = extent(house)
    below = FOOT + SWATCH * rows
    if height is None:
        scale = scale or _scale(house, width)
        height = round(TITLE + scale * (south - north) + MARGIN + below)
    scale = scale or _scale(house, width, height - TITLE - MARGIN - below)
    left = (width - scale * (east - west)) / 2 - scale * west
    top = TITLE + (height - TITLE - below - scale * (south - north)) / 2 - scale * north
    return Frame(scale, left, top), height


def _scale(house: House, width: int, tall: float | None = None) -> float:
    """CSS pixels to a metre, where a picture is so wide and so much of its height is for the house."""
    west, north, east, south = extent(house)
    return min((width - 2 * MARGIN) / (east - west), (tall or 1.5 * width) / (south - north))


def _sheet(
    houses: Sequence[House], columns: int | None, cell: int, one_scale: bool
) -> tuple[list[tuple[Point, Drawing]], int, int]:
    """The cells of a sheet, row by row, and its width and height."""
    if not houses:
        raise ValueError("no house for the sheet")
    columns = columns or min(len(houses), max(1, math.isqrt(len(houses) * 3 // 2)))
    scale = min(_least_scale(house, cell) for house in houses) if one_scale else None
    cells = [
        ((index % columns * cell, index // columns * cell), plan(house, cell, cell, scale))
        for index, house in enumerate(houses)
    ]
    return [*cells], min(columns, len(houses)) * cell, -(-len(houses) // columns) * cell


def _least_scale(house: House, cell: int) -> float:
    """CSS pixels to a metre in a square, above the key that the house may need."""
    rows = key_rows({room.type: "" for room in house.counted}, cell - 2 * MARGIN)
    return _scale(house, cell, cell - TITLE - MARGIN - FOOT - SWATCH * len(rows))


def _write(path: Path, cells: list[tuple[Point, Drawing]], width: int, height: int) -> None:
    """Write drawings as what the file's name says."""
    if path.suffix == ".svg":
        write_whole(path, svg(cells, width, height).encode())
    else:
        buffer = BytesIO()
        png(cells, width, height).save(buffer, "PNG")
        write_whole(path, buffer.getvalue())
