"""Plans on paper, to a scale: the millimetres of a page are those of the print."""

import math
import re

from vitruvius.logic.drawing.canvas import Drawing
from vitruvius.logic.drawing.draw import MILLIMETRE, Page, least_scale, plan
from vitruvius.logic.drawing.frame import drawn_extent
from vitruvius.logic.drawing.labels import title
from vitruvius.logic.drawing.measures import BLOCK, title_block
from vitruvius.logic.drawing.palettes import Style
from vitruvius.logic.errors import RequestError
from vitruvius.logic.house.house import House

SIZES = {"A4": (210, 297), "A3": (297, 420), "A2": (420, 594), "A1": (594, 841), "A0": (841, 1189)}
"""Sizes of paper by ISO 216, millimetres."""

USUAL = (20, 50, 100, 200, 500, 1000)
"""Usual scales of plans, as N in 1:N."""

BORDER = 10
"""Margin around the drawing that many printers leave blank, millimetres."""


def scale_of(text: str) -> int:
    """Return the scale in a text such as ``1:50``, here 50. Raises ``RequestError`` for another text."""
    found = re.fullmatch(r"1\s*:\s*([1-9]\d{0,3})", text.strip())
    if found is None:
        raise RequestError(f"--scale {text}: write it as 1:50, one metre on paper to 50 in the house")
    return int(found[1])


def page(house: House, look: Style, ratio: int, size: str | None = None, name: str = "the house") -> Page:
    """Return a house at 1 to ``ratio`` on a page, upright or lying as it fits.

    The default ``size`` is the smallest of ``SIZES`` that holds the house. Raises ``RequestError`` if the
    page, or the largest one, is too small; ``name`` is the name of the house in the message.
    """
    for each in [size] if size else SIZES:
        short, long = SIZES[each]
        for sides in ((short, long), (long, short)):
            if ratio >= _least_ratio(house, *sides):
                return _sheet(house, look, ratio, each, sides)
    west, north, east, south = drawn_extent(house)
    needed = " x ".join(f"{1000 * length / ratio:.0f}" for length in (east - west, south - north))
    last = size or [*SIZES][-1]
    least = min(_least_ratio(house, *sides) for sides in (SIZES[last], SIZES[last][::-1]))
    smaller = next((usual for usual in USUAL if usual >= least), math.ceil(least))
    larger = "" if last == [*SIZES][-1] else "a larger --paper, or "
    raise RequestError(
        f"{name} is {needed} mm at 1:{ratio}, too large for {last}: {larger}--scale 1:{smaller}"
    )


def _least_ratio(house: House, width: float, height: float) -> float:
    """Return the least ratio at which a house fits on a page of this size in millimetres."""
    across, down = ((side - 2 * BORDER) / MILLIMETRE for side in (width, height))
    return 1000 / MILLIMETRE / least_scale(house, across, down - BLOCK, paper=True)


def _sheet(house: House, look: Style, ratio: int, size: str, sides: tuple[int, int]) -> Page:
    """Draw a house with dimension lines above a title block, on a page of this size in millimetres."""
    width, height = ((side - 2 * BORDER) / MILLIMETRE for side in sides)
    scale = 1000 / ratio / MILLIMETRE
    drawing = plan(house, width, height - BLOCK, scale, look, measured=True, titled=False)
    cells = [("House", title(house, 0.7 * width)), ("Scale", f"1:{ratio} on {size}")]
    block = tuple(title_block(cells, (1, 1, width - 1, BLOCK - 1), look.inks))
    edge = BORDER / MILLIMETRE
    placed = [((edge, edge), drawing), ((edge, edge + height - BLOCK), Drawing(width, BLOCK, block))]
    return placed, sides[0] / MILLIMETRE, sides[1] / MILLIMETRE
