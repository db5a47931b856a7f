"""Plots as SVG text. The page's style sets the colours, so that they suit both themes and print well."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from vitruvius.agent.evaluation.statistics import Estimate
from vitruvius.agent.report.html import details, table
from vitruvius.logic.spelling import markup

SLOTS = {
    "oracle": 1,
    "explorer": 2,
    "script": 3,
    "searcher": 4,
    "paper": 5,
    "paper-original": 6,
    "random + avoidance": 7,
    "true path": 1,
    "pursuit": 3,
    "random drive": 7,
}
"""Colours of policies, by name: classes of ``page.css``."""

OTHERS = (0, 8, 9, 4, 6)
"""Colours of all other policies, in rotation."""

MAX_LISTED = 30
"""Largest number of points of a line in the table below its plot."""

MIN_POSITIVE = 1e-100
"""Bound on a logarithmic axis: values up to this bound count as 0."""

WIDTH, HEIGHT = 520, 300
LEFT, RIGHT, TOP, BOTTOM = 58, 24, 12, 44
"""Size of a plot, and margins around its area, in pixels."""


@dataclass(frozen=True)
class DataSeries:
    """Line of points (x, y), with intervals if given."""

    name: str
    x: Sequence[float]
    y: Sequence[float]
    low: Sequence[float] = ()
    high: Sequence[float] = ()
    slot: int = 0
    marked: bool = True
    """True if each point has a mark; false for many points."""


@dataclass(frozen=True)
class Axis:
    """Axis: its label, its scale, and the least and greatest value that it must show."""

    label: str
    log: bool = False
    least: float | None = None
    most: float | None = None
    ticks: Sequence[float] = ()
    """Values with a label; by default round numbers."""


def slots(names: Iterable[str]) -> dict[str, int]:
    """Return a colour for each policy: the same colour for the same name, if possible."""
    found, count = dict[str, int](), 0
    for name in names:
        if name not in SLOTS:
            found[name] = OTHERS[count % len(OTHERS)]
            count += 1
        else:
            found[name] = SLOTS[name]
    return found


class _Scale:
    """Map from values of an axis to pixels."""

    def __init__(self, axis: Axis, values: Iterable[float], start: float, end: float) -> None:
        shown = [each for each in (*values, axis.least, axis.most) if each is not None]
        if axis.log:
            shown = [each for each in shown if each > MIN_POSITIVE]
        self.log, self.start, self.end = axis.log, start, end
        low, high = min(shown, default=0.0), max(shown, default=1.0)
        if high <= low:
            low, high = (low / 2, low * 2) if axis.log else (low - 0.5, low + 0.5)
        self.ticks = list(axis.ticks) or (_decades(low, high) if axis.log else _round(low, high))
        low, high = min(low, *self.ticks), max(high, *self.ticks)
        self.low, self.high = self._of(low), self._of(high)

    def _of(self, value: float) -> float:
        return math.log10(value) if self.log else value

    def at(self, value: float) -> float:
        """Return the pixel of a value."""
        if self.log and value <= MIN_POSITIVE:
            return self.start
        share = (self._of(value) - self.low) / (self.high - self.low)
        return self.start + share * (self.end - self.start)


def line_plot(title: str, x: Axis, y: Axis, series: Sequence[DataSeries], note: str = "") -> str:
    """Return a figure of lines with shaded intervals, a legend, and a table of numbers.

    The table lists only some points of long lines.
    """
    across = _Scale(x, (v for each in series for v in each.x), LEFT, WIDTH - RIGHT)
    values = (v for each in series for v in (*each.y, *each.low, *each.high))
    up = _Scale(y, values, HEIGHT - BOTTOM, TOP)
    marks = "".join(_drawn(each, across, up) for each in series)
    picture = _svg(title, HEIGHT, _grid(x, y, across, up) + marks)
    rows = [
        [each.name, number(each.x[k]), number(each.y[k]), *_interval(each, k)]
        for each in series
        for k in some(len(each.x), MAX_LISTED)
    ]
    headings = ["line", x.label, y.label, *(["from", "to"] if any(each.low for each in series) else [])]
    return (
        f"<figure><figcaption>{markup(title)}</figcaption>{picture}{_legend(series)}"
        + (f"<p>{markup(note)}</p>" if note else "")
        + details("Numbers", table(title, headings, rows))
        + "</figure>"
    )


def interval_plot(
    title: str,
    label: str,
    rows: Sequence[tuple[str, Estimate, int]],
    mark: tuple[float, str] | None = None,
) -> str:
    """Return a figure with a row for each name, with its value and interval.

    ``mark`` is a line across all rows.
    """
    row, top = 30, 12
    left = 16 + 9.4 * max((len(name) for name, _, _ in rows), default=0)
    height = top + row * len(rows) + 44
    axis = Axis(label, least=0.0, most=1.0)
    scale = _Scale(axis, (v for _, each, _ in rows for v in each), left, WIDTH - 40)
    foot = height - 40
    parts = [_tick_x(scale.at(v), top, foot, number(v)) for v in scale.ticks]
    parts.append(_text((left + WIDTH - 40) / 2, height - 6, label, "middle"))
    if mark:
        at = scale.at(mark[0])
        parts.append(f'<line class="mark" x1="{at:.1f}" x2="{at:.1f}" y1="{top - 4}" y2="{foot}"/>')
        parts.append(_text(at + 4, foot - 4, mark[1], "start", "small"))
    for place, (name, each, slot) in enumerate(rows):
        y = top + row * (place + 0.5)
        low, value, high = (scale.at(v) for v in (each.low, each.value, each.high))
        parts.append(_text(left - 8, y + 4, name, "end", f"name c{slot}"))
        parts.append(
            f'<g class="c{slot}"><title>{markup(name)}: {each.text()}</title>'
            f'<line class="interval" x1="{low:.1f}" x2="{max(high, low + 1):.1f}" y1="{y}" y2="{y}"/>'
            f"{_point(value, y, slot)}</g>"
        )
        parts.append(_text(value, y - 9, f"{each.value:.2f}", "middle", "small"))
    return f"<figure><figcaption>{markup(title)}</figcaption>{_svg(title, height, ''.join(parts))}</figure>"


def some(count: int, most: int) -> range:
    """Return at most ``most`` indices below ``count``, evenly spaced, including the last."""
    every = -(-count // most) or 1
    return range((count - 1) % every, count, every)


def number(value: float) -> str:
    """Return a number in words, with three significant digits, or as an integer or in millions if large."""
    if value == 0:
        return "0"
    if abs(value) >= 1e6:
        return f"{value / 1e6:g} M"
    return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.3g}"


def _drawn(series: DataSeries, across: _Scale, up: _Scale) -> str:
    """Return a line, its interval and its marks."""
    points = [(across.at(x), up.at(y)) for x, y in zip(series.x, series.y, strict=True)]
    parts = [f'<g class="c{series.slot}">']
    if series.low:
        above = [(across.at(x), up.at(v)) for x, v in zip(series.x, series.high, strict=True)]
        below = [(across.at(x), up.at(v)) for x, v in zip(series.x, series.low, strict=True)]
        parts.append(f'<polygon class="band" points="{_listed(above + below[::-1])}"/>')
    parts.append(
        f'<polyline class="line" points="{_listed(points)}"><title>{markup(series.name)}</title></polyline>'
    )
    if series.marked:
        for k, (x, y) in enumerate(points):
            values = " ".join((number(series.y[k]), *_interval(series, k)))
            words = f"{series.name}, {number(series.x[k])}: {values}"
            parts.append(f"<g><title>{markup(words)}</title>{_point(x, y, series.slot)}</g>")
    return "".join(parts) + "</g>"


def _interval(series: DataSeries, k: int) -> list[str]:
    return [number(series.low[k]), number(series.high[k])] if series.low else []


def _point(x: float, y: float, slot: int) -> str:
    """Return a mark whose form goes with the colour, for readers in black and white."""
    forms = {
        0: f'<circle class="point" cx="{x:.1f}" cy="{y:.1f}" r="4"/>',
        1: f'<rect class="point" x="{x - 3.5:.1f}" y="{y - 3.5:.1f}" width="7" height="7"/>',
        2: f'<path class="point" d="M{x:.1f} {y - 4.8:.1f}l4.6 8.2h-9.2z"/>',
        3: f'<path class="point" d="M{x:.1f} {y - 5:.1f}l5 5l-5 5l-5 -5z"/>',
    }
    return forms[slot % len(forms)]


def _grid(x: Axis, y: Axis, across: _Scale, up: _Scale) -> str:
    """Return both axes with their lines, numbers and labels."""
    parts = [_tick_x(across.at(v), TOP, HEIGHT - BOTTOM, number(v)) for v in across.ticks]
    for value in up.ticks:
        at = up.at(value)
        parts.append(f'<line class="grid" x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{at:.1f}" y2="{at:.1f}"/>')
        parts.append(_text(LEFT - 7, at + 4, number(value), "end", "small"))
    parts.append(_text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 8, x.label, "middle"))
    middle = (TOP + HEIGHT - BOTTOM) / 2
    turned = f'text-anchor="middle" transform="rotate(-90 13 {middle})"'
    parts.append(f'<text x="13" y="{middle}" {turned}>{markup(y.label)}</text>')
    return "".join(parts)


def _tick_x(at: float, top: float, foot: float, words: str) -> str:
    line = f'<line class="grid" x1="{at:.1f}" x2="{at:.1f}" y1="{top}" y2="{foot}"/>'
    return line + _text(at, foot + 15, words, "middle", "small")


def _text(x: float, y: float, words: str, anchor: str, kind: str = "") -> str:
    named = f' class="{kind}"' if kind else ""
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{named}>{markup(words)}</text>'


def _legend(series: Sequence[DataSeries]) -> str:
    names = dict.fromkeys((each.name, each.slot) for each in series)
    items = "".join(
        f'<li class="c{slot}"><svg width="26" height="12" aria-hidden="true">'
        f'<line class="line" x1="1" x2="25" y1="6" y2="6"/>{_point(13, 6, slot)}</svg>{markup(name)}</li>'
        for name, slot in names
    )
    return f'<ul class="legend">{items}</ul>' if len(names) > 1 else ""


def _svg(title: str, height: float, content: str) -> str:
    named = f'role="img" aria-label="{markup(title)}"'
    return f'<svg class="plot" {named} viewBox="0 0 {WIDTH} {height}">{content}</svg>'


def _listed(points: Iterable[tuple[float, float]]) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)


def _round(low: float, high: float) -> list[float]:
    """Return about five round numbers from at most ``low`` to at most ``high``."""
    raw = (high - low) / 5
    size = 10 ** math.floor(math.log10(raw))
    step = next(size * factor for factor in (1, 2, 2.5, 5, 10) if size * factor >= raw * 0.999)
    first, last = math.floor(low / step + 1e-9), math.floor(high / step + 1e-9)
    return [round(k * step, 12) for k in range(first, last + 1)]


def _decades(low: float, high: float) -> list[float]:
    """Return powers of ten from at most ``low`` to at least ``high``; if few, with twos and fives."""
    first, last = math.floor(math.log10(low) + 1e-9), math.ceil(math.log10(high) - 1e-9)
    factors = (1, 2, 5) if last - first <= 2 else (1,)
    found = [factor * 10.0**k for k in range(first, last + 1) for factor in factors]
    start = max((k for k, v in enumerate(found) if v <= low * 1.0001), default=0)
    end = min((k for k, v in enumerate(found) if v >= high * 0.9999), default=len(found) - 1)
    return found[start : end + 1]
