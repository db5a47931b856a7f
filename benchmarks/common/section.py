"""Section of a report about time: medians and quartiles of studies that pytest-benchmark timed."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.common.pages import machine
from benchmarks.common.series import AXES, is_rate, law, panels_of, series_of
from vitruvius.agent.report.html import ReportError, Section, inline, table
from vitruvius.agent.report.plots import Axis, DataSeries, line_plot

COLOURS = 10
"""Number of line colours: classes of a report's style."""


def timings(files: Sequence[Path], folder: Path) -> Section:
    """Return the section of some reports of pytest-benchmark.

    Raises ``ReportError`` for a file that is no report.
    """
    parts = []
    for path in files:
        try:
            parts.append(_study(json.loads(path.read_bytes())))
        except (ValueError, KeyError, TypeError) as error:
            raise ReportError(f"{path}: not a report of a study: {type(error).__name__}: {error}") from None
    return Section("scaling", "Growth of time", "\n".join(parts))


def _study(report: dict[str, Any]) -> str:
    """Return a plot for each kind of benchmark, and the fitted laws."""
    rate, series, panels = is_rate(report), series_of(report), panels_of(report)
    slots = {name: place % COLOURS for place, name in enumerate(series)}
    info = report["machine_info"]
    words = f"{machine(info)}, Python {info['python_version']}, {report['datetime'][:10]}."
    parts = [f"<p>{inline(f'Medians and quartiles. {words}')}</p>", '<div class="figures-row">']
    for panel in dict.fromkeys(panels[name] for name in series):
        shown = [_line(name, series[name], slots[name]) for name in series if panels[name] == panel]
        title, axis = panel
        label = "environment steps per second" if rate else "seconds"
        late = [f"{name}: most not done in {limit:g} s" for name, limit in _late(series).items()]
        x = Axis(AXES[axis], log=True, ticks=sorted({size for each in shown for size in each.x}))
        parts.append(line_plot(title or label.capitalize(), x, Axis(label, log=True), shown, "; ".join(late)))
    laws = [[name, law(points, rate)] for name, points in series.items()]
    return "\n".join([*parts, "</div>", table("Fitted laws", ("of", "by least squares on logarithms"), laws)])


def _line(name: str, points: np.ndarray, slot: int) -> DataSeries:
    """Return a benchmark's medians and quartiles, without those that ran into the limit."""
    size, median, low, high, _ = points[points[:, 4] == 0].T.tolist() or [[]] * 5
    return DataSeries(name, size, median, low, high, slot)


def _late(series: dict[str, np.ndarray]) -> dict[str, float]:
    """Return for each benchmark the limit that most runs of some size reached."""
    return {name: points[points[:, 4] == 1, 1].max() for name, points in series.items() if points[:, 4].any()}
