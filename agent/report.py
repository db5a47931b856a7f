"""What a run looks like: one table for the terminal and for Markdown, the learning curve, the page."""

import io
from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure  # not pyplot, which keeps global state and may ask for a display
from rich.box import SIMPLE_HEAD
from rich.table import Table

from agent.evaluate import Scores
from agent.learner import Progress

HEADINGS = ("player", "targets", "ratio to oracle", "blocked", "overruled")

HUMAN = {"main": "27 (of 56)", "secondary": "10 (of 21)"}
"""What the paper's human picked up in the paper's own house, and the oracle; the human saw the whole map."""

NOTE = (
    "Targets: in an episode of 1500 steps. Interquartile means over the houses, with 95 % intervals from "
    "resampling the houses. Blocked moves, and actions overruled by the avoidance layer: per 1000 steps. "
    "The human: in the paper's own house, with the whole map in sight."
)

COLOURS = ("#1f5ea8", "#8b8f96", "#c96a12")
"""Agent, random walk, oracle."""


def rows(scores: Scores, targets: str = "main") -> list[tuple[str, ...]]:
    """The table's rows (player, targets, ratio, blocked, overruled), the paper's human last; ``targets`` is
    where they lay.
    """
    players = [
        (
            score.player,
            score.count().text(1),
            score.ratio(scores.oracle).text(2),
            f"{1000 * score.blocked / score.steps:.1f}",
            f"{1000 * score.interventions / score.steps:.1f}",
        )
        for score in (scores.agent, scores.walk)
    ]
    oracle = (scores.oracle.player, scores.oracle.count().text(1), "1", "", "")
    return [*players, oracle, ("human of the paper", HUMAN[targets], "0.48", "", "")]


def table(lines: Sequence[Sequence[str]], title: str) -> Table:
    """The rows for a terminal of 80 columns."""
    result = Table(
        title=title,
        caption=NOTE,
        title_justify="left",
        caption_justify="left",
        box=SIMPLE_HEAD,
        show_edge=False,
        padding=(0, 1, 0, 0),
        pad_edge=False,
    )
    for heading in HEADINGS:
        result.add_column(heading, no_wrap=True)
    for line in lines:
        result.add_row(*line)
    return result


def markdown(lines: Sequence[Sequence[str]]) -> str:
    """The rows as a Markdown table."""
    return "\n".join("| " + " | ".join(line) + " |" for line in (HEADINGS, ["---"] * len(HEADINGS), *lines))


def learning_curve(history: Sequence[Progress], scores: Scores | None = None) -> bytes:
    """A PNG: targets per 1500 steps while learning, against environment steps.

    The curve holds the random actions of its time. At its right stand the players' scores in held-out
    houses, with their intervals.
    """
    figure = Figure(figsize=(8, 4), dpi=120, layout="constrained")
    axes = figure.subplots()
    millions = [progress.steps / 1e6 for progress in history]
    targets = [progress.targets for progress in history]
    axes.plot(millions, targets, color=COLOURS[0], linewidth=2)
    place = len(history) * 3 // 5
    axes.annotate(
        "while learning",
        (millions[place], targets[place]),
        (0, -18),
        textcoords="offset points",
        color=COLOURS[0],
    )
    top = max(targets)
    label = -np.inf
    for score, colour in sorted(zip(scores or (), COLOURS, strict=False), key=lambda pair: pair[0].count()):
        count = score.count()
        top = max(top, count.high)
        label = max(count.value, label + 0.07 * top)  # not over the label below it
        axes.axhline(count.value, color=colour, linewidth=1, linestyle="--")
        at = axes.get_yaxis_transform()
        axes.plot(
            [1, 1], [count.low, count.high], color=colour, linewidth=6, alpha=0.4, transform=at, clip_on=False
        )
        axes.text(1.02, label, f"{score.player} {count.value:.1f}", color=colour, va="center", transform=at)
    axes.set(xlabel="environment steps (millions)", ylabel="targets per 1500 steps")
    axes.set(xlim=(0, millions[-1]), ylim=(0, 1.1 * top + 1e-9))
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis="y", alpha=0.25)
    picture = io.BytesIO()
    figure.savefig(picture, format="png")
    return picture.getvalue()
