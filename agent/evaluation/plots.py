"""Plots of an evaluation and of a training run, as PNG files."""

import io
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure  # not pyplot, which keeps global state and may ask for a display

from vitruvius.agent.evaluation.result import HUMAN_RATIO, Result
from vitruvius.agent.evaluation.tables import LABELS, capital, human_name
from vitruvius.agent.learning.learner import Progress

COLOURS = {
    "agent": "#1f5ea8",
    "map-completion": "#1f5ea8",
    "search": "#12356b",
    "pqn": "#4f93d8",
    "paper": "#b04a5a",
    "paper-original": "#7d2c3a",
    "random + avoidance": "#8b8f96",
    "script": "#7a9a3a",
    "explorer": "#2f9c95",
    "searcher": "#a5518e",
    "oracle": "#c96a12",
    "random drive": "#8b8f96",
    "pursuit": "#7a9a3a",
    "true path": "#b04a5a",
}
"""Colours of policies, by name."""

OTHER = "#333333"
"""Colour of all other policies."""


def ratio_plot(results: Sequence[Result]) -> bytes:
    """Return a plot of each policy's ratio to the yardstick with intervals, by target mode and rooms."""
    figure = Figure(figsize=(4.2 * len(results) + 1, 6), dpi=120, layout="constrained")
    axes = figure.subplots(2, len(results), squeeze=False, sharey="row")
    for column, result in enumerate(results):
        _ratios(axes[0, column], result)
        _by_rooms(axes[1, column], result)
    axes[1, 0].set_ylabel(f"ratio to the {results[0].yardstick}")
    return png(figure)


def learning_curve(history: Sequence[Progress], result: Result | None = None) -> bytes:
    """Return a plot of targets per 1500 steps in training against environment steps.

    The targets include those of random actions. The policies' targets in the result's houses are at the
    right, with their intervals.
    """
    figure = Figure(figsize=(8, 4), dpi=120, layout="constrained")
    axes = figure.subplots()
    millions = [progress.steps / 1e6 for progress in history]
    targets = [progress.targets for progress in history]
    axes.plot(millions, targets, color=COLOURS["agent"], linewidth=2)
    held_out = [(now.steps / 1e6, now.held_out) for now in history if now.held_out is not None]
    if held_out:
        axes.plot(*zip(*held_out, strict=True), "o-", color=OTHER, markersize=4, label="in held-out houses")
        axes.legend(loc="lower right", frameon=False)
    place = len(history) * 3 // 5
    axes.annotate(
        "while learning",
        (millions[place], targets[place]),
        (0, -18),
        textcoords="offset points",
        color=COLOURS["agent"],
    )
    estimates = {name: result.targets(name) for name in result.policies} if result else {}
    top = max([*targets, *(estimate.high for estimate in estimates.values())])
    label = -np.inf
    for name, estimate in sorted(estimates.items(), key=lambda item: item[1]):
        colour, at = COLOURS.get(name, OTHER), axes.get_yaxis_transform()
        label = max(estimate.value, label + 0.06 * top)  # not over the label below it
        axes.axhline(estimate.value, color=colour, linewidth=1, linestyle="--")
        interval = [estimate.low, estimate.high]
        axes.plot([1, 1], interval, color=colour, linewidth=6, alpha=0.4, transform=at, clip_on=False)
        axes.text(
            1.02,
            label,
            f"{LABELS.get(name, name)} {estimate.value:.1f}",
            color=colour,
            va="center",
            transform=at,
        )
    axes.set(xlabel="environment steps (millions)", ylabel="targets per 1500 steps")
    axes.set(xlim=(0, millions[-1]), ylim=(0, 1.1 * top + 1e-9))
    plain(axes, "y")
    return png(figure)


def _ratios(axes: Axes, result: Result) -> None:
    names = list(result.policies)[::-1]
    for place, name in enumerate(names):
        ratio, colour = result.ratio(name), COLOURS.get(name, OTHER)
        axes.plot([ratio.low, ratio.high], [place, place], color=colour, linewidth=6, alpha=0.35)
        axes.plot(ratio.value, place, "o", color=colour)
        axes.annotate(
            f"{ratio.value:.2f}", (ratio.value, place), (0, 7), textcoords="offset points", ha="center"
        )
    _human(axes.axvline, result)
    axes.set_yticks(range(len(names)), [LABELS.get(name, name) for name in names])
    for label, name in zip(axes.get_yticklabels(), names, strict=False):  # only the first mode has labels
        label.set_color(COLOURS.get(name, OTHER))
    axes.set(xlim=(-0.03, 1.06), ylim=(-0.6, len(names) - 0.4), xlabel=f"ratio to the {result.yardstick}")
    axes.set_title(capital(result.task))
    if result.human:
        axes.annotate(
            human_name(result.mode), (HUMAN_RATIO, -0.5), (3, 0), textcoords="offset points", size=7
        )
    plain(axes, "x")


def _by_rooms(axes: Axes, result: Result) -> None:
    for name in result.policies:
        ratios, colour = result.by_rooms(name), COLOURS.get(name, OTHER)
        if name != result.yardstick:
            low, high, value = (
                [getattr(each, end) for each in ratios.values()] for end in ("low", "high", "value")
            )
            axes.fill_between(list(ratios), low, high, color=colour, alpha=0.15, linewidth=0)
            axes.plot(list(ratios), value, "o-", color=colour, markersize=4)
    _human(axes.axhline, result)
    axes.set(xlabel="secondary rooms", ylim=(-0.03, 1.06))
    axes.set_xticks(np.unique(result.rooms))
    plain(axes, "y")


def _human(line: Any, result: Result) -> None:
    if result.human:
        line(HUMAN_RATIO, color="#555555", linestyle="--", linewidth=1)


def plain(axes: Axes, grid: Any) -> None:
    """Show axes without a frame, with a light grid along ``grid``."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis=grid, alpha=0.25)


def png(figure: Figure) -> bytes:
    """Return the figure as the bytes of a PNG file."""
    content = io.BytesIO()
    figure.savefig(content, format="png")
    return content.getvalue()
