"""Plot of a report of pytest-benchmark: medians, quartiles and fitted laws on logarithmic axes."""

from typing import Any

import numpy as np

from benchmarks.common.pages import machine, png
from benchmarks.common.series import AXES, is_rate, law, panels_of, series_of


def plot(report: dict[str, Any]) -> bytes:
    """Return a PNG on logarithmic axes: medians, quartiles and fitted laws, a panel for each kind."""
    from matplotlib.figure import Figure

    rate, series, panels = is_rate(report), series_of(report), panels_of(report)
    titles = list(dict.fromkeys(panels[name] for name in series))
    columns = min(3, len(titles))
    rows = -(-len(titles) // columns)
    figure = Figure(figsize=(1.2 + 6 * columns, 0.3 + 4.3 * rows), dpi=150, layout="constrained")
    grid = np.ravel(figure.subplots(rows, columns))
    for axes in grid[len(titles) :]:
        axes.remove()
    for axes, (title, axis) in zip(grid, titles, strict=False):
        shown = {name: points for name, points in series.items() if panels[name] == (title, axis)}
        for name, points in shown.items():
            _draw(axes, name, points, rate)
        axes.set(title=title, xscale="log", xlabel=AXES[axis])
        values = np.concatenate([points[:, 1] for points in shown.values()])
        if values.max() > 10 * values.min():
            axes.set_yscale("log")
        else:  # less than a decade has too few ticks on a logarithmic axis
            axes.set_ylim(bottom=0)
            if rate:
                axes.yaxis.set_major_formatter(lambda value, _: f"{value / 1e6:g} M")
        axes.set_ylabel("environment steps per second" if rate else "seconds")
        sizes = sorted({size for points in shown.values() for size in points[:, 0]})
        axes.set_xticks(sizes, [f"{size:,.0f}" for size in sizes])
        axes.minorticks_off()
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8, frameon=False)
    info = report["machine_info"]
    words = f"{machine(info)}, Python {info['python_version']}, {report['datetime'][:10]}"
    figure.suptitle(f"Medians and quartiles. {words}", fontsize=8)
    return png(figure)


def _draw(axes: Any, name: str, points: np.ndarray, rate: bool) -> None:
    """Draw one benchmark: a line with its quartiles, and hollow arrows at the limit for censored medians."""
    size, median, low, high, censored = points.T
    seen = censored == 0
    (line,) = axes.plot(size[seen], median[seen], "o-", label=f"{name}: {law(points, rate)}", lw=1.6, ms=4)
    colour = line.get_color()
    axes.fill_between(size[seen], low[seen], high[seen], color=colour, alpha=0.2, lw=0)
    if not seen.all():
        label = f"{name}: most not done in {median[~seen].max():g} s"
        axes.plot(size[~seen], median[~seen], "^", ms=7, mfc="none", mec=colour, label=label)
