"""What an evaluation looks like: tables for terminals and Markdown, a picture, a record for programs."""

import io
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure  # not pyplot, which keeps global state and may ask for a display
from rich.box import SIMPLE_HEAD
from rich.table import Table

from agent.protocol import DEFINITIONS, HUMAN, HUMAN_RATIO, SOON, Result

COLOURS = {
    "agent": "#1f5ea8",
    "pqn-map": "#1f5ea8",
    "pqn": "#4f93d8",
    "paper": "#b04a5a",
    "random + avoidance": "#8b8f96",
    "script": "#7a9a3a",
    "explorer": "#2f9c95",
    "searcher": "#a5518e",
    "oracle": "#c96a12",
}
OTHER = "#333333"

WHERE = {"main": "the main room", "secondary": "secondary rooms", "mixed": "all rooms"}

NOTE = (
    "Targets: picked up in an episode of 1500 steps. Ratio: to the oracle's in the same house. Both are "
    "interquartile means, with 95 % intervals over training runs and houses. Success: the first target "
    f"within {SOON} steps. SPL: that times the shortest way's length over the way taken. Seen: the share of "
    "the places where targets may lie that it had looked at by that step. Rooms: the share of the secondary "
    "rooms that it was in. Blocked moves, and actions that the avoidance layer overruled: per 1000 steps. "
    "The searcher knows the house but not the target, the oracle both. The human of the paper played in the "
    "paper's house, with the whole map in sight."
)


@dataclass(frozen=True)
class Sheet:
    """A table: its title, headings and rows, in words."""

    title: str
    headings: tuple[str, ...]
    rows: list[tuple[str, ...]]

    def table(self) -> Table:
        """For a terminal of 80 columns."""
        look: dict[str, Any] = {
            "title_justify": "left",
            "title_style": "bold",
            "show_edge": False,
            "pad_edge": False,
        }
        result = Table(title=f"\n{self.title}", box=SIMPLE_HEAD, padding=(0, 1, 0, 0), **look)
        for place, heading in enumerate(self.headings):
            result.add_column(heading, no_wrap=True, justify="right" if place else "left")
        for row in self.rows:
            result.add_row(*row)
        return result

    def markdown(self) -> str:
        """As a Markdown table under its title."""
        lines = (self.headings, ["---"] * len(self.headings), *self.rows)
        return f"**{self.title}**\n\n" + "\n".join("| " + " | ".join(line) + " |" for line in lines)


def sheets(result: Result) -> Iterator[Sheet]:
    """A mode's three tables: how well, how, and by number of rooms."""
    where, human = WHERE.get(result.targets, result.targets), HUMAN.get(result.targets)
    names = {name: _named(name, len(runs)) for name, runs in result.players.items()}
    figures = {name: result.figures(name) for name in names}
    well = [
        (
            names[name],
            each["targets"].text(1),
            each["ratio"].text(2),
            f"{each['success'].value:.2f}",
            f"{each['spl'].value:.2f}",
            *([f"{each['human'].value:.2f}"] if human else []),
        )
        for name, each in figures.items()
    ]
    if human:
        well.append(("human of the paper", str(human), f"{HUMAN_RATIO}", "", "", ""))
    headings = ("player", "targets", "ratio", "success", "SPL")
    yield Sheet(
        f"Targets in {where}, {len(result.rooms)} houses",
        (*headings, *([f"> {human}"] if human else [])),
        well,
    )
    yield Sheet(
        f"How they went about it, targets in {where}",
        ("player", "seen by 500", "by 1500", "rooms", "blocked", "overruled"),
        [
            (
                names[name],
                *(f"{each[key].value:.2f}" for key in ("coverage_500", "coverage_1500", "rooms")),
                *(f"{each[key].value:.1f}" for key in ("blocked", "interventions")),
            )
            for name, each in figures.items()
        ],
    )
    by_rooms = {name: result.by_rooms(name) for name in names if name != "oracle"}
    yield Sheet(
        f"Ratio by number of rooms, targets in {where}",
        ("player", *(f"{rooms} rooms" for rooms in by_rooms[next(iter(by_rooms))])),
        [(names[name], *(f"{each.value:.2f}" for each in row.values())) for name, row in by_rooms.items()],
    )


def picture(results: Sequence[Result]) -> bytes:
    """A PNG: for each mode every player's ratio to the oracle, with its interval, and that by rooms."""
    figure = Figure(figsize=(4.2 * len(results) + 1, 6), dpi=120, layout="constrained")
    axes = figure.subplots(2, len(results), squeeze=False, sharey="row")
    for column, result in enumerate(results):
        _players(axes[0, column], result)
        _by_rooms(axes[1, column], result)
    axes[1, 0].set_ylabel("ratio to the oracle")
    content = io.BytesIO()
    figure.savefig(content, format="png")
    return content.getvalue()


def record(results: Sequence[Result]) -> dict[str, Any]:
    """All of it for programs: each figure with its interval, each house's values for each training run."""
    return {"definitions": DEFINITIONS, "targets": {each.targets: _record(each) for each in results}}


def _record(result: Result) -> dict[str, Any]:
    players = {
        name: {
            "figures": {key: each._asdict() for key, each in result.figures(name).items()},
            "ratio_by_rooms": {rooms: each._asdict() for rooms, each in result.by_rooms(name).items()},
            "runs": [
                {
                    "targets": score.targets.astype(int).tolist(),
                    "first": [int(step) if np.isfinite(step) else None for step in score.first],
                    "coverage": score.coverage.round(4).tolist(),
                    "rooms": score.rooms.tolist(),
                    "steps": score.steps,
                    "blocked": score.blocked,
                    "interventions": score.interventions,
                }
                for score in runs
            ],
        }
        for name, runs in result.players.items()
    }
    shortest = [int(step) if np.isfinite(step) else None for step in result.shortest]
    return {"rooms": result.rooms.tolist(), "shortest": shortest, "players": players}


def _named(player: str, runs: int) -> str:
    return player if runs == 1 else f"{player}, {runs} runs"


def _players(axes: Axes, result: Result) -> None:
    names = list(result.players)[::-1]
    for place, name in enumerate(names):
        ratio, colour = result.ratio(name), COLOURS.get(name, OTHER)
        axes.plot([ratio.low, ratio.high], [place, place], color=colour, linewidth=6, alpha=0.35)
        axes.plot(ratio.value, place, "o", color=colour)
        axes.annotate(
            f"{ratio.value:.2f}", (ratio.value, place), (0, 7), textcoords="offset points", ha="center"
        )
    _human(axes.axvline, result)
    axes.set_yticks(range(len(names)), names)
    for label, name in zip(axes.get_yticklabels(), names, strict=False):  # only the first mode has labels
        label.set_color(COLOURS.get(name, OTHER))
    axes.set(xlim=(-0.03, 1.06), ylim=(-0.6, len(names) - 0.4), xlabel="ratio to the oracle")
    axes.set_title(f"Targets in {WHERE.get(result.targets, result.targets)}")
    if result.targets in HUMAN:
        axes.annotate("human of the paper", (HUMAN_RATIO, -0.5), (3, 0), textcoords="offset points", size=7)
    _plain(axes, "x")


def _by_rooms(axes: Axes, result: Result) -> None:
    for name in result.players:
        ratios, colour = result.by_rooms(name), COLOURS.get(name, OTHER)
        if name != "oracle":
            axes.fill_between(
                list(ratios), [each.low for each in ratios.values()], [each.high for each in ratios.values()],
                color=colour, alpha=0.15, linewidth=0,
            )  # fmt: skip
            axes.plot(
                list(ratios), [each.value for each in ratios.values()], "o-", color=colour, markersize=4
            )
    _human(axes.axhline, result)
    axes.set(xlabel="secondary rooms", ylim=(-0.03, 1.06))
    axes.set_xticks(np.unique(result.rooms))
    _plain(axes, "y")


def _human(line: Any, result: Result) -> None:
    if result.targets in HUMAN:
        line(HUMAN_RATIO, color="#555555", linestyle="--", linewidth=1)


def _plain(axes: Axes, grid: Any) -> None:
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis=grid, alpha=0.25)
