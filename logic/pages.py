"""Plans on paper, to a scale: pages whose millimetres are those of the print."""

import re

from logic.draw import MILLIMETRE, Page, least_scale, plan
from logic.errors import RequestError
from logic.house import House
from logic.palettes import Style
from logic.plan import drawn_extent

SIZES = {"A4": (210, 297), "A3": (297, 420), "A2": (420, 594), "A1": (594, 841), "A0": (841, 1189)}
"""Millimetres: ISO 216."""

BORDER = 10
"""Millimetres around the drawing, where many printers do not print."""


def scale_of(text: str) -> int:
    """Metres in the house to a metre on paper, as in ``1:50``. Raises ``RequestError`` for another text."""
    found = re.fullmatch(r"1\s*:\s*([1-9]\d{0,3})", text.strip())
    if found is None:
        raise RequestError(f"--scale {text}: write it as 1:50, one metre on paper to 50 in the house")
    return int(found[1])


def page(house: House, look: Style, ratio: int, size: str | None = None, name: str = "the house") -> Page:
    """A house at 1 to ``ratio`` on a page of a ``size``, upright or lying as it fits; by default the smallest
    of
    ``SIZES`` that holds it.

    Raises ``RequestError`` where the page, or the largest one, is too small; ``name`` is the house's in it.
    """
    scale = 1000 / ratio / MILLIMETRE
    for each in [size] if size else SIZES:
        short, long = SIZES[each]
        for wide, high in ((short, long), (long, short)):
            width, height = ((side - 2 * BORDER) / MILLIMETRE for side in (wide, high))
            if scale <= least_scale(house, width, height):
                drawing = plan(house, width, height, scale, look, f"1:{ratio} on {each}")
                at = BORDER / MILLIMETRE, BORDER / MILLIMETRE
                return [(at, drawing)], wide / MILLIMETRE, high / MILLIMETRE
    west, north, east, south = drawn_extent(house)
    needed = " x ".join(f"{1000 * length / ratio:.0f}" for length in (east - west, south - north))
    larger = "a larger --paper, or " if size and size != [*SIZES][-1] else ""
    raise RequestError(
        f"{name} is {needed} mm at 1:{ratio}, too large for {size or [*SIZES][-1]}: "
        f"{larger}a smaller scale, as --scale 1:{2 * ratio}"
    )
