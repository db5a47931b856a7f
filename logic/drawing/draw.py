"""Plans of houses as SVG, PNG and PDF: single plans, sheets of many, or plans on paper to a scale."""

import math
from collections.abc import Iterable, Iterator, Sequence
from io import BytesIO
from pathlib import Path
from typing import Literal

from PIL import Image
from PIL.PngImagePlugin import PngInfo

from vitruvius.logic.drawing import palettes
from vitruvius.logic.drawing.canvas import DENSITY, Drawing, Point, Shape, Text, png, svg
from vitruvius.logic.drawing.door_leaves import door_leaves
from vitruvius.logic.drawing.frame import Frame, drawn_extent
from vitruvius.logic.drawing.furniture import unlabelled
from vitruvius.logic.drawing.labels import (
    SWATCH,
    abbreviations,
    entries,
    key,
    key_rows,
    legend,
    room_names,
    title,
    unnamed,
)
from vitruvius.logic.drawing.measures import DIMENSION, NORTH, dimensions, north_arrow
from vitruvius.logic.drawing.palettes import Style, style
from vitruvius.logic.drawing.plan import house_shapes
from vitruvius.logic.files.replacing import DRAWN_BY
from vitruvius.logic.files.writing import write_whole
from vitruvius.logic.house.house import House

TITLE, FOOT, MARGIN = 30, 22, 12
"""Space above a plan, below it and around it, CSS pixels."""
PLAN_PX, SHEET_PLAN_PX = 720, 300
"""Width of a plan, and of a plan on a sheet, CSS pixels."""

MIN_MEASURED_PX = 400
"""Least width of a plan with dimension lines, CSS pixels."""

Format = Literal["svg", "png", "pdf"]

Cells = list[tuple[Point, Drawing]]
"""Drawings, each with the place of its top left corner."""


def plan_svg(
    house: House, width: int = PLAN_PX, scale: float | None = None, palette: palettes.Name = "colour"
) -> str:
    """Draw a plan as the text of an SVG file of this width in CSS pixels. For ``scale`` see ``plan``.

    Each part has its name in ``data-part``, as ``explain_house`` takes it.
    """
    drawing = plan(house, width, scale=scale, look=style([house], palette), measured=width >= MIN_MEASURED_PX)
    return svg([((0, 0), drawing)], drawing.width, drawing.height)


def plan_png(
    house: House, width: int = PLAN_PX, scale: float | None = None, palette: palettes.Name = "colour"
) -> Image.Image:
    """Draw the same plan as an image, with two image pixels per CSS pixel."""
    drawing = plan(house, width, scale=scale, look=style([house], palette), measured=width >= MIN_MEASURED_PX)
    return png([((0, 0), drawing)], drawing.width, drawing.height)


def contact_sheet(
    houses: Sequence[House],
    columns: int | None = None,
    cell: int = SHEET_PLAN_PX,
    one_scale: bool = False,
    palette: palettes.Name = "colour",
) -> Image.Image:
    """Draw many plans on one image, each in a square of ``cell`` CSS pixels.

    Each plan is as large as its square permits. With ``one_scale`` all plans have the largest scale at which
    all fit.
    """
    return png(*_sheet(houses, columns, cell, one_scale, palette))


def contact_sheet_svg(
    houses: Sequence[House],
    columns: int | None = None,
    cell: int = SHEET_PLAN_PX,
    one_scale: bool = False,
    palette: palettes.Name = "colour",
) -> str:
    """Draw the same sheet as the text of an SVG file."""
    return svg(*_sheet(houses, columns, cell, one_scale, palette))


def draw(
    houses: Iterable[House],
    out_dir: str | Path,
    format: Format = "svg",
    one_scale: bool = False,
    palette: palettes.Name = "colour",
    grammar: str | Path | None = None,
) -> list[Path]:
    """Write a plan of each house, then the sheet of all plans. Return the paths of the files.

    The first plan is ``house-0``. A PDF is one file, ``plans.pdf``, with a page for each house. With
    ``one_scale`` all plans have the same scale, and so do all plans on the sheet. ``grammar`` is a shipped
    grammar or a folder, whose ``looks.json`` defines the looks of types. By default houses of shipped
    grammars have the looks of their grammar. Each file appears whole or not at all. Raises ``ValueError`` for
    another format or no house, and ``GrammarError`` for wrong looks.
    """
    houses = require_drawable(houses, out_dir, format)
    look = style(houses, palette, grammar)
    scale = min(_scale(house, PLAN_PX - DIMENSION) for house in houses) if one_scale else None
    pages: list[Page] = []
    for house in houses:
        drawing = plan(house, PLAN_PX, scale=scale, look=look, measured=True)
        pages.append(([((0, 0), drawing)], drawing.width, drawing.height))
    sheet = None if format == "pdf" else _sheet(houses, None, SHEET_PLAN_PX, one_scale, palette, look)
    return write_pages(pages, Path(out_dir), format, sheet)


Page = tuple[Cells, float, float]
"""Drawings, and the width and height of the page that they are on, CSS pixels."""


def require_drawable(houses: Iterable[House], out_dir: str | Path, format: str) -> list[House]:
    """Return the houses as a list.

    Raises ``ValueError`` for a format that plans do not have, and for no house.
    """
    houses = list(houses)
    if format not in Format.__args__:
        raise ValueError(f"a drawing is svg, png or pdf, not {format!r}")
    if not houses:
        raise ValueError(f"no house to draw in {out_dir}")
    return houses


def write_pages(
    pages: Sequence[Page], out: Path, format: Format, sheet: Page | None = None, unit: str = ""
) -> list[Path]:
    """Write each page as a file, or all of them as a PDF, then the sheet. Return the paths of the files.

    ``unit`` is ``mm`` if an SVG states its size in millimetres.
    """
    if format == "pdf":
        from vitruvius.logic.drawing.pdf import pdf

        write_whole(out / "plans.pdf", pdf(pages))
        return [out / "plans.pdf"]
    digits = len(str(len(pages) - 1))
    named = {out / f"house-{index:0{digits}}.{format}": page for index, page in enumerate(pages)}
    if sheet:
        named[out / f"contact-sheet.{format}"] = sheet
    for path, page in named.items():
        write_whole(path, encoded(page, format, unit))
    return [*named]


def encoded(page: Page, format: Literal["svg", "png"], unit: str = "") -> bytes:
    """Return a page as the content of a file."""
    cells, width, height = page
    if format == "svg":
        size = (f"{width * MILLIMETRE:g}mm", f"{height * MILLIMETRE:g}mm") if unit == "mm" else None
        return svg(cells, width, height, size).encode() + b"<!-- %s -->\n" % DRAWN_BY
    buffer, said = BytesIO(), PngInfo()
    said.add_text("Software", DRAWN_BY.decode())
    png(cells, width, height).save(buffer, "PNG", dpi=(96 * DENSITY, 96 * DENSITY), pnginfo=said)
    return buffer.getvalue()


MILLIMETRE = 25.4 / 96
"""Millimetres per CSS pixel."""


def plan(
    house: House,
    width: float,
    height: float | None = None,
    scale: float | None = None,
    look: Style | None = None,
    measured: bool = False,
    titled: bool = True,
) -> Drawing:
    """Draw a house into ``width`` by ``height`` CSS pixels, with a title, a scale bar and a key.

    The default ``height`` is what the house needs, at most about one and a half widths. The default
    ``scale``, CSS pixels per metre, is the largest that fits. With ``measured`` the plan has dimension lines;
    with ``titled`` it has the title and the north arrow above. The key explains the abbreviations of rooms
    and the numbers of pieces that are too small for their names.
    """
    look = look or style([house])
    leaves = door_leaves(house)
    every = abbreviations({*look.fills, *look.looks.rooms})
    keyed, numbers = set[str](), dict[str, str]()
    above, beside = TITLE if titled else MARGIN, DIMENSION if measured else 0
    while True:  # The key takes space, so that more names may not fit, which makes the key longer.
        short = {kind: every[kind] for kind in every if kind in keyed}
        rows = key_rows(entries(look, short, numbers), width - 2 * MARGIN)
        below = FOOT + SWATCH * len(rows)
        frame, tall = _frame(house, width, height, scale, (above, below, beside))
        names = room_names(house, frame, look, short, leaves=leaves)
        pieces = {*numbers, *unlabelled(house, frame, look)}
        if unnamed(house, names) <= keyed and pieces <= numbers.keys():
            break
        keyed |= unnamed(house, names)
        numbers = {kind: str(number) for number, kind in enumerate(sorted(pieces), start=1)}
    foot = tall - FOOT / 2 - SWATCH * len(rows)
    shapes = [
        *house_shapes(house, frame, look, leaves, numbers),
        *(word for name in names for word in name),
        *(_head(house, width, look) if titled else ()),
        *(dimensions(house, frame, look.inks) if measured else ()),
        *legend(house, look, frame.scale, MARGIN, foot),
        *key(rows, look, MARGIN, foot + SWATCH + 2),
    ]
    return Drawing(width, tall, tuple(shapes))


def _head(house: House, width: float, look: Style) -> Iterator[Shape]:
    """Draw the title of a plan, and the north arrow."""
    words = title(house, width - 2 * MARGIN - 2 * NORTH)
    yield Text((MARGIN, TITLE / 2), words, 11.5, look.inks.ink, "start")
    yield from north_arrow(width - MARGIN, TITLE / 2, look.inks)


def _frame(
    house: House,
    width: float,
    height: float | None,
    scale: float | None,
    around: tuple[float, float, float],
) -> tuple[Frame, float]:
    """Return the frame of a house in the middle of a picture, and the picture's height.

    ``around`` is the space above the house, below it, and of dimension lines beside and below it, CSS pixels.
    """
    above, below, beside = around
    west, north, east, south = drawn_extent(house)
    if height is None:
        scale = scale or _scale(house, width - beside)
        height = round(above + scale * (south - north) + MARGIN + beside + below)
    scale = scale or _scale(house, width - beside, height - above - MARGIN - beside - below)
    left = beside + (width - beside - scale * (east - west)) / 2 - scale * west
    top = above + (height - above - beside - below - scale * (south - north)) / 2 - scale * north
    return Frame(scale, left, top), height


def _scale(house: House, width: float, tall: float | None = None) -> float:
    """Return the scale, CSS pixels per metre, of a house in a picture with this width and height for it."""
    west, north, east, south = drawn_extent(house)
    return min((width - 2 * MARGIN) / (east - west), (tall or 1.5 * width) / (south - north))


def _sheet(
    houses: Sequence[House],
    columns: int | None,
    cell: int,
    one_scale: bool,
    palette: palettes.Name,
    look: Style | None = None,
) -> Page:
    """Return the cells of a sheet, row by row, and its width and height."""
    if not houses:
        raise ValueError("no house for the sheet")
    look = look or style(houses, palette)
    columns = columns or min(len(houses), max(1, math.isqrt(len(houses) * 3 // 2)))
    scale = min(least_scale(house, cell, cell) for house in houses) if one_scale else None
    cells = [
        ((index % columns * cell, index // columns * cell), plan(house, cell, cell, scale, look))
        for index, house in enumerate(houses)
    ]
    return [*cells], min(columns, len(houses)) * cell, -(-len(houses) // columns) * cell


def least_scale(house: House, width: float, height: float, paper: bool = False) -> float:
    """Return a scale, CSS pixels per metre, at which the house fits above the longest key that it may need.

    A plan on ``paper`` has dimension lines and no title.
    """
    above, beside = (MARGIN, DIMENSION) if paper else (TITLE, 0.0)
    look = style([house])
    pieces = {piece.type: "" for room in house.rooms for piece in room.pieces}
    strange = {kind: "" for kind in pieces if kind and look.looks.symbol(kind) is None}
    rows = key_rows(entries(look, dict.fromkeys(look.fills, ""), strange), width - 2 * MARGIN)
    high = height - above - MARGIN - FOOT - SWATCH * len(rows)
    return _scale(house, width - beside, high - beside)
