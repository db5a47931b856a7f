"""Drawings as pages of a PDF, with lines and letters, not pixels.

By matplotlib, the extra ``pdf``, which also has the plans' font.
"""

from collections.abc import Iterable, Sequence
from io import BytesIO
from itertools import chain

from matplotlib.axes import Axes
from matplotlib.backends.backend_pdf import PdfPages
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse, FancyBboxPatch, PathPatch
from matplotlib.path import Path
from matplotlib.patheffects import withStroke

from vitruvius.logic.drawing.canvas import (
    ASCENT,
    Block,
    Curve,
    Drawing,
    Line,
    Oval,
    Plain,
    Point,
    Rings,
    Strokes,
    flat,
)
from vitruvius.logic.files.replacing import DRAWN_BY
from vitruvius.logic.spelling import printable

POINT = 72 / 96
"""Points per CSS pixel. The point is matplotlib's unit of lines and letters."""


def pdf(pages: Iterable[tuple[Sequence[tuple[Point, Drawing]], float, float]]) -> bytes:
    """Return the content of a PDF with a page for each item.

    An item holds drawings, each with the place of its top left corner, and the page's width and height. All
    lengths are in CSS pixels, 96 per inch.
    """
    buffer = BytesIO()
    # Without dates the same pages give the same bytes.
    with PdfPages(buffer, metadata={"CreationDate": None, "Creator": DRAWN_BY.decode()}) as file:
        for cells, width, height in pages:
            figure = Figure((width / 96, height / 96))
            axes = figure.add_axes((0, 0, 1, 1), xlim=(0, width), ylim=(height, 0))
            axes.set_axis_off()
            for (x, y), drawing in cells:
                for order, shape in enumerate(flat(drawing.shapes)):
                    _add(axes, shape, x, y, order)
            file.savefig(figure)
    return buffer.getvalue()


def _add(axes: Axes, shape: Plain, x: float, y: float, order: int) -> None:
    """Draw a shape, moved by x and y, above those of a lower order."""
    common = {"zorder": order, "clip_on": False}
    if isinstance(shape, Strokes):
        ends = [[(a + x, b + y) for a, b in pair] for pair in shape.ends]
        axes.add_collection(
            LineCollection(ends, colors=shape.stroke, linewidths=POINT * shape.width, **common)
        )
        return
    if isinstance(shape, Rings):
        rings = [[(a + x, b + y) for a, b in (*ring, ring[0])] for ring in shape.rings]
        codes = [[Path.MOVETO, *[Path.LINETO] * (len(ring) - 2), Path.CLOSEPOLY] for ring in rings]
        path = Path([*chain(*rings)], [*chain(*codes)])
        axes.add_patch(PathPatch(path, facecolor=shape.fill, edgecolor="none", **common))
        return
    if isinstance(shape, Line | Curve):
        is_curve = isinstance(shape, Curve)
        codes = [Path.MOVETO, *([Path.CURVE4 if is_curve else Path.LINETO] * (len(shape.points) - 1))]
        dashes = (0, [shape.dash / shape.width]) if isinstance(shape, Line) and shape.dash else "-"
        path = Path([(a + x, b + y) for a, b in shape.points], codes)
        width = POINT * shape.width
        axes.add_patch(PathPatch(path, fill=False, edgecolor=shape.stroke, lw=width, ls=dashes, **common))
        return
    if isinstance(shape, Block | Oval):
        left, top, right, bottom = shape.box
        paint = {"facecolor": shape.fill or "none", "edgecolor": shape.stroke or "none", **common}
        paint["linewidth"] = POINT * shape.width if shape.stroke else 0
        wide, high = right - left, bottom - top
        if isinstance(shape, Oval):
            axes.add_patch(Ellipse((x + (left + right) / 2, y + (top + bottom) / 2), wide, high, **paint))
        else:
            corner = f"round,pad=0,rounding_size={shape.radius}" if shape.radius else "square,pad=0"
            axes.add_patch(FancyBboxPatch((x + left, y + top), wide, high, boxstyle=corner, **paint))
        return
    down = ASCENT * shape.size
    text = axes.text(
        x + shape.at[0] + (down if shape.turned else 0),
        y + shape.at[1] + (0 if shape.turned else down),
        printable(shape.text).replace("$", r"\$"),  # otherwise matplotlib reads a formula
        fontsize=POINT * shape.size,
        color=shape.fill,
        ha={"start": "left", "middle": "center", "end": "right"}[shape.anchor],
        va="baseline",
        rotation=90 if shape.turned else 0,
        rotation_mode="anchor",
        **common,
    )
    if shape.halo:
        text.set_path_effects([withStroke(linewidth=POINT * shape.size / 4, foreground=shape.halo)])
