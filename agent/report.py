"""What a run looks like: one table for the terminal and for Markdown, the learning curve, the page."""

import io
from collections.abc import Sequence

from matplotlib.figure import Figure  # not pyplot, which keeps global state and may ask for a display
from rich.table import Table

from agent.evaluate import Scores
from agent.train import Progress

HEADINGS = ("player", "targets per 1500 steps", "ratio to the oracle", "blocked", "overruled")

HUMAN = ("human of the paper", "27 (of 56, in another house)", "0.48", "", "")
"""The paper's human saw the whole map; 56 is what the oracle picks up in that house."""

NOTE = (
    "Interquartile means over the houses, with 95 % intervals from resampling the houses. Blocked moves, and "
    "actions overruled by the avoidance layer, per 1000 steps."
)

COLOURS = ("#1f5ea8", "#8b8f96", "#c96a12")
"""Agent, random walk, oracle."""


def rows(scores: Scores) -> list[tuple[str, ...]]:
    """The table's rows (player, targets, ratio, blocked, overruled), the paper's human last."""
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
    return [*players, oracle, HUMAN]


def table(lines: Sequence[Sequence[str]], title: str) -> Table:
    """The rows for a terminal."""
    result = Table(*HEADINGS, title=title, caption=NOTE, title_justify="left", caption_justify="left")
    for line in lines:
        result.add_row(*line)
    return result


def markdown(lines: Sequence[Sequence[str]]) -> str:
    """The rows as a Markdown table."""
    return "\n".join("| " + " | ".join(line) + " |" for line in (HEADINGS, ["---"] * len(HEADINGS), *lines))


def learning_curve(history: Sequence[Progress], scores: Scores | None = None) -> bytes:
    """A PNG: targets per 1500 steps while learning, against environment steps.

    Beside the curve, which holds the random actions of its time, stand the players' scores in held-out
    houses with their intervals.
    """
    figure = Figure(figsize=(8, 4), dpi=120, layout="constrained")
    axes = figure.subplots()
    millions = [progress.steps / 1e6 for progress in history]
    axes.plot(millions, [progress.targets for progress in history], color=COLOURS[0], linewidth=2)
    axes.annotate("while learning", (millions[-1] * 0.2, 1), color=COLOURS[0])
    for score, colour in zip(scores or (), COLOURS, strict=False):
        count = score.count()
        axes.axhspan(count.low, count.high, color=colour, alpha=0.12, linewidth=0)
        axes.axhline(count.value, color=colour, linewidth=1, linestyle="--")
        axes.annotate(
            f" {score.player}\n {count.value:.1f}",
            (1, count.value),
            xycoords=("axes fraction", "data"),
            color=colour,
            va="center",
        )
    axes.set(xlabel="environment steps (millions)", ylabel="targets per 1500 steps", xlim=(0, millions[-1]))
    axes.set_ylim(bottom=0)
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis="y", alpha=0.25)
    picture = io.BytesIO()
    figure.savefig(picture, format="png")
    return picture.getvalue()
