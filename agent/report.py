"""Reports: one table on the terminal and in Markdown, and the learning curve."""

import io
from collections.abc import Sequence

from matplotlib.figure import Figure  # not pyplot: it keeps global state and may ask for a display
from rich.table import Table

from agent.evaluate import Score
from agent.train import Progress

HUMAN = ("human of the paper", "27 (another house)", "0.48", "-", "-")
"""27 of the 56 that the oracle finds in the paper's house; the human saw the whole map."""

HEADINGS = ("player", "targets per 1500 steps", "ratio to the oracle", "blocked moves", "overruled")
NOTE = (
    "Interquartile means over the houses, with 95 % intervals from resampling the houses. "
    "Blocked moves and actions overruled by the avoidance layer per 1000 steps."
)

COLOURS = ("#1f6f8b", "#8a8f98", "#c8553d")


def rows(scores: Sequence[Score], oracle: Score) -> list[tuple[str, ...]]:
    """The table's rows, the paper's human last."""

    def per_thousand(score: Score, number: int) -> str:
        return "-" if score is oracle else f"{1000 * number / score.steps:.1f}"

    return [
        (
            score.player,
            score.count().text(1),
            "1" if score is oracle else score.ratio(oracle).text(2),
            per_thousand(score, score.blocked),
            per_thousand(score, score.interventions),
        )
        for score in scores
    ] + [HUMAN]


def table(lines: Sequence[Sequence[str]], title: str) -> Table:
    """The rows for a terminal."""
    result = Table(*HEADINGS, title=title, caption=NOTE, title_justify="left", caption_justify="left")
    for line in lines:
        result.add_row(*line)
    return result


def markdown(lines: Sequence[Sequence[str]]) -> str:
    """The rows as a Markdown table."""
    return "\n".join("| " + " | ".join(line) + " |" for line in (HEADINGS, ["---"] * len(HEADINGS), *lines))


def learning_curve(history: Sequence[Progress], scores: Sequence[Score] = ()) -> bytes:
    """A PNG: targets per 1500 steps while learning, against environment steps.

    Beside the curve stand the scores of players in held-out houses, with their intervals, as its scale.
    """
    figure = Figure(figsize=(7.5, 4.2), dpi=120, layout="constrained")
    axes = figure.subplots()
    millions = [progress.steps / 1e6 for progress in history]
    axes.plot(millions, [progress.targets for progress in history], color=COLOURS[0], linewidth=2)
    axes.set(xlabel="environment steps (millions)", ylabel="targets per 1500 steps", xlim=(0, millions[-1]))
    for score, colour in zip(scores, COLOURS, strict=False):
        count = score.count()
        axes.axhspan(count.low, count.high, color=colour, alpha=0.12, linewidth=0)
        axes.axhline(count.value, color=colour, linewidth=1, linestyle="--")
        axes.annotate(
            f" {score.player}",
            (1, count.value),
            xycoords=("axes fraction", "data"),
            color=colour,
            va="center",
        )
    axes.set_ylim(bottom=0)
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis="y", alpha=0.25)
    picture = io.BytesIO()
    figure.savefig(picture, format="png")
    return picture.getvalue()
