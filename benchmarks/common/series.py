"""Results of studies: series and fitted laws from reports of pytest-benchmark."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import stdtrit

AXES = {
    "rooms": "secondary rooms",
    "environments": "environments",
    "houses": "different houses",
    "segments": "segments in a house (mean)",
    "rays": "rays",
    "processors": "processors",
}
"""Quantities that studies vary: the key in a benchmark's ``extra_info``, and the name on the axis."""


def name_of(entry: dict[str, Any]) -> str:
    """Return a benchmark's name in words, without its size."""
    return entry["name"].split("[")[0].removeprefix("test_").replace("_", " ")


def axis_of(entry: dict[str, Any]) -> str | None:
    """Return the quantity that a benchmark varies, a key of ``AXES``; ``None`` if it has no size."""
    return next((axis for axis in AXES if axis in entry["extra_info"]), None)


def series_of(report: dict[str, Any]) -> dict[str, np.ndarray]:
    """Return each benchmark's rows: size, median, lower quartile, upper quartile, 1 for a censored median.

    Values are in seconds, or in steps per second. A study that ends runs at a limit records their number: if
    it is half of the runs or more, the median is only a lower bound.
    """
    rows: dict[str, list[list[float]]] = {}
    for entry in report["benchmarks"]:
        extra, stats = entry["extra_info"], entry["stats"]
        axis = axis_of(entry)
        if axis:
            # If a round is many steps, their rate counts; the quartiles then change places.
            work = extra["steps_per_second"] * stats["median"] if "steps_per_second" in extra else None
            times = [stats["median"], stats["q1"], stats["q3"]]
            values = [work / time for time in times] if work else times
            censored = 2 * extra.get("censored", 0) >= stats["rounds"]
            values = [extra["limit"]] * 3 if censored else values
            rows.setdefault(name_of(entry), []).append([extra[axis], *values, censored])
    return {name: np.array(sorted(points)) for name, points in rows.items()}


def panels_of(report: dict[str, Any]) -> dict[str, tuple[str, str]]:
    """Return for each benchmark's name the title of its panel, and the key of its axis."""
    return {
        name_of(entry): (entry["extra_info"].get("panel", ""), axis)
        for entry in report["benchmarks"]
        if (axis := axis_of(entry))
    }


def is_rate(report: dict[str, Any]) -> bool:
    """Return True if a study measures steps per second instead of seconds."""
    return any("steps_per_second" in entry["extra_info"] for entry in report["benchmarks"])


def fitted_exponent(sizes: ArrayLike, seconds: ArrayLike) -> tuple[float, float]:
    """Return the exponent of ``seconds ~ sizes ** exponent``, and its standard error.

    Both are from least squares on logarithms.
    """
    x, y = np.log(sizes), np.log(seconds)
    design = np.stack([x, np.ones_like(x)], axis=1)
    solution, residual, *_ = np.linalg.lstsq(design, y, rcond=None)
    freedom = max(1, len(x) - 2)
    spread = float(residual[0]) / freedom / ((x - x.mean()) ** 2).sum() if len(residual) else 0.0
    return float(solution[0]), float(np.sqrt(spread))


def law(points: np.ndarray, rate: bool) -> str:
    """Return the fitted law in words: the exponent of a power law, with a 95 % interval.

    Sizes below 4 do not count, because fixed costs dominate there. A series that runs into its limit grows
    faster than any power: its law is the factor for each further room, from 2 on. For rates, the result is
    the best rate.
    """
    if rate:
        return f"{points[:, 1].max():,.0f} a second at best"
    late, first = points[:, 4].any(), 2 if points[:, 4].any() else 4
    tail = points[(points[:, 0] >= first) & (points[:, 4] == 0)]
    if len(tail) < 3:
        return "too few sizes for a fit"
    exponent, error = fitted_exponent(np.exp(tail[:, 0]) if late else tail[:, 0], tail[:, 1])
    margin = stdtrit(len(tail) - 2, 0.975) * error
    span = f"from {tail[0, 0]:.0f} to {tail[-1, 0]:.0f}"
    if late:
        low, factor, high = np.exp([exponent - margin, exponent, exponent + margin])
        return f"each room more takes {factor:.1f} times [{low:.1f}, {high:.1f}] as long, {span}"
    return f"time ~ size^{exponent:.2f} ± {margin:.2f} {span}"
