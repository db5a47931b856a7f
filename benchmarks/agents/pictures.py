"""Pictures of the study of agents: scores, scores by rooms, effects of changes, learning curves."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure  # not pyplot, which keeps global state and may ask for a display

from benchmarks.agents.records import Study, TrainingEntry, by_seed, difference
from vitruvius.agent.evaluation.plots import COLOURS, plain, png
from vitruvius.agent.evaluation.result import HUMAN, HUMAN_RATIO, Result
from vitruvius.agent.evaluation.statistics import Estimate
from vitruvius.agent.evaluation.tables import WHERE

AGENTS = ("#1f5ea8", "#c0392b", "#4c9be8", "#7b5ea7", "#2d2d2d", "#8a6d3b")
"""Colours of agents, in the order of the study."""

SEEDS = ("#1f5ea8", "#c96a12", "#2f9c95", "#a5518e", "#7a9a3a")
"""Colours of training runs, in the order of their seeds."""

QUIET = "#8b8f96"

ELSEWHERE = "human of the paper, another house"


def pictures(study: Study) -> dict[str, bytes]:
    """Return PNG files by name, without those of modes that were not evaluated."""
    bases = [entry for entry in study.presets() if study.changes(entry.name)]
    drawn = {"agent-scores.png": _scores(study), "agent-curves.png": _curves(study)}
    if "secondary" in study.results:
        drawn["agent-rooms.png"] = _rooms(study)
    if bases:
        drawn["agent-parts.png"] = _parts(study, bases)
    return {name: png(figure) for name, figure in drawn.items()}


def _colours(study: Study) -> dict[str, str]:
    """Return the colours of all agents and baselines."""
    agents = (each.name for each in study.presets())
    return COLOURS | dict(zip(agents, AGENTS * len(study.entries), strict=False))


def _scores(study: Study) -> Figure:
    """Draw a panel for each mode: every policy's ratio, its interval and, if there are several, its runs."""
    agents = [each.name for each in study.presets()]
    learnt_for = {each.name: each.targets for each in study.entries}
    names = [*agents, *study.baselines()]
    figure = Figure(
        figsize=(4.3 * len(study.results) + 1.2, 0.42 * len(names) + 1.5), dpi=120, layout="constrained"
    )
    columns = figure.subplots(1, len(study.results), sharey=True, squeeze=False)[0]
    for axes, (mode, result) in zip(columns, study.results.items(), strict=True):
        for place, name in enumerate(names):
            filled = learnt_for.get(name, mode) == mode
            _score(axes, result, name, place, _colours(study).get(name, QUIET), filled)
        axes.axhline(len(agents) - 0.5, color=QUIET, linewidth=0.8)
        if mode in HUMAN:
            axes.axvline(HUMAN_RATIO, color="#555555", linestyle="--", linewidth=1)
            label = {"textcoords": "offset points", "size": 7, "color": "#555555"}
            axes.annotate(ELSEWHERE, (HUMAN_RATIO, len(names) - 0.45), (3, 0), **label)
        axes.set(title=f"targets in {WHERE[mode]}", xlabel="ratio to the oracle", xlim=(-0.03, 1.12))
        plain(axes, "x")
    columns[0].set_yticks(range(len(names)), names)
    columns[0].set_ylim(len(names) - 0.2, -0.7)
    for label, name in zip(columns[0].get_yticklabels(), names, strict=True):
        label.set_color(_colours(study).get(name, QUIET))
    words = "Above the line agents that learnt: filled where they learnt for such targets, hollow elsewhere."
    figure.suptitle(f"{words} Bars: 95 % intervals; ticks: single training runs.", size=9)
    return figure


def _score(axes: Axes, result: Result, name: str, place: int, colour: str, filled: bool) -> None:
    ratio, runs = result.ratio(name), by_seed(result, name)
    _interval(axes, ratio, runs if len(runs) > 1 else [], place, colour, filled)
    axes.annotate(f"{ratio.value:.2f}", (max(ratio.high, *runs), place), (7, 0),
                  textcoords="offset points", va="center", size=8, color=colour)  # fmt: skip


def _interval(
    axes: Axes, figure: Estimate, each: Sequence[float], place: int, colour: str, filled: bool = True
) -> None:
    """Draw a figure as a dot on the bar of its interval; each run or seed is a tick."""
    look: Any = {"color": colour, "linewidth": 6, "alpha": 0.3, "solid_capstyle": "butt"}
    axes.plot([figure.low, figure.high], [place, place], **look)
    axes.plot(figure.value, place, "o", color=colour, markerfacecolor=colour if filled else "white")
    axes.plot(each, [place] * len(each), "|", color=colour, markersize=9)


def _rooms(study: Study) -> Figure:
    """Draw the ratio against rooms for targets in secondary rooms, each line with its name at the right."""
    result, colours = study.results["secondary"], _colours(study)
    names = [*(entry.name for entry in study.presets()), *study.baselines()]
    figure = Figure(figsize=(7.5, 4.8), dpi=120, layout="constrained")
    axes = figure.subplots()
    lines = {name: result.by_rooms(name) for name in names if name != "oracle"}
    label = -1.0
    for name, line in sorted(lines.items(), key=lambda item: list(item[1].values())[-1].value):
        agent, x, y = name not in study.baselines(), list(line), [each.value for each in line.values()]
        colour = colours.get(name, QUIET)
        low, high = ([getattr(each, end) for each in line.values()] for end in ("low", "high"))
        axes.fill_between(x, low, high, color=colour, alpha=0.1, linewidth=0)
        axes.plot(x, y, "o-" if agent else "o--", color=colour, markersize=4, linewidth=2 if agent else 1.2)
        label = max(y[-1], label + 0.045)  # not over the label below it
        axes.text(x[-1] + 0.08, label, name, color=colour, va="center", size=9)
    axes.axhline(HUMAN_RATIO, color="#555555", linestyle=":", linewidth=1)
    axes.text(result.rooms.min(), HUMAN_RATIO + 0.01, ELSEWHERE, color="#555555", size=7)
    axes.set(xlabel="secondary rooms in the house", ylabel="ratio to the oracle", ylim=(-0.03, 1.03))
    axes.set(xlim=(result.rooms.min() - 0.1, result.rooms.max() + 1.1), xticks=np.unique(result.rooms))
    axes.set_title(
        "Targets in secondary rooms. Solid: agents that learnt; dashed: baselines",
        size=9,
    )
    plain(axes, "y")
    return figure


def _parts(study: Study, bases: list[TrainingEntry]) -> Figure:
    """Draw a panel for each agent: the effect of each change on its ratio."""
    rows = [study.changes(base.name) for base in bases]
    heights = [len(changes) + 1 for changes in rows]
    figure = Figure(figsize=(8, 0.42 * sum(heights) + 1.1 * len(bases)), dpi=120, layout="constrained")
    panels = figure.subplots(len(bases), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
    for axes, base, changes in zip(panels, bases, rows, strict=True):
        for place, entry in enumerate(changes):
            found = difference(study, entry)
            colour = QUIET if not found.clear else AGENTS[0] if found.all.value > 0 else AGENTS[1]
            _interval(axes, found.all, found.each, place, colour)
            ends = (found.all.low, found.all.high, *found.each)
            # On the side away from the line at 0.
            side, end, away = ("right", min(ends), -6) if found.all.value < 0 else ("left", max(ends), 6)
            axes.annotate(f"{found.all.value:+.2f}", (end, place), (away, 0), textcoords="offset points",
                          va="center", ha=side, size=8, color=colour)  # fmt: skip
        axes.axvline(0, color="#333333", linewidth=1)
        axes.set_yticks(range(len(changes)), [entry.shows for entry in changes])
        axes.set_ylim(len(changes) - 0.5, -0.8)
        ratio = study.results[base.targets].ratio(base.name).value
        axes.set_title(
            f"{base.name}, targets in {WHERE[base.targets]}: ratio {ratio:.2f} as it is", size=10, loc="left"
        )
        plain(axes, "x")
        axes.margins(x=0.1)
    panels[-1].set_xlabel("change of the ratio to the oracle")
    figure.suptitle(
        "What each change does. Grey: nothing clear. Bars: 95 % intervals; ticks: single seeds", size=9
    )
    return figure


def _curves(study: Study) -> Figure:
    """Draw a panel for each entry: targets during training against the fraction of the run, for each run."""
    columns = min(4, len(study.entries))
    rows = -(-len(study.entries) // columns)
    figure = Figure(figsize=(0.6 + 3 * columns, 0.7 + 2.3 * rows), dpi=120, layout="constrained")
    grid = np.ravel(figure.subplots(rows, columns, squeeze=False))
    seeds = sorted({run.seed for run in study.runs})
    tops: dict[str, float] = {}
    for run in study.runs:
        targets = study.entry(run.entry).targets
        tops[targets] = max(tops.get(targets, 1.0), *(count for _, count in run.curve), 1.0)
    for axes in grid[len(study.entries) :]:
        axes.remove()
    for axes, entry in zip(grid, study.entries, strict=False):
        if entry.beside:
            for run in study.runs:
                if run.entry == entry.beside:
                    _curve(axes, run.curve, study.entry(entry.beside).steps, color="#c9ccd1", linewidth=1)
        for run in study.runs:
            if run.entry == entry.name:
                colour = SEEDS[seeds.index(run.seed) % len(SEEDS)]
                _curve(axes, run.curve, entry.steps, color=colour, linewidth=1.3, alpha=0.9)
                if run.failed and run.curve:
                    end = (run.curve[-1][0] / entry.steps, run.curve[-1][1])
                    axes.plot(*end, "x", color="#c0392b", markersize=9, markeredgewidth=2.5)
        axes.set(xlim=(0, 1), ylim=(0, 1.05 * tops.get(entry.targets, 1.0)))
        axes.set_title(f"{entry.name}\n{entry.steps / 1e6:.3g} M steps, {entry.targets}", size=9)
        axes.tick_params(labelsize=7)
        plain(axes, "y")
    key: Any = [
        grid[0].plot([], [], color=SEEDS[k % len(SEEDS)], label=f"seed {seed}")[0]
        for k, seed in enumerate(seeds)
    ]
    key += grid[0].plot([], [], color="#c9ccd1", label="the agent that it is a change of")
    key += grid[0].plot([], [], "x", color="#c0392b", linestyle="", label="failed here")
    figure.legend(handles=key, loc="outside upper center", ncols=len(key), frameon=False, fontsize=8)
    figure.supxlabel("share of the run", size=9)
    figure.supylabel("targets per 1500 steps, while learning", size=9)
    return figure


def _curve(axes: Axes, curve: tuple[tuple[int, float], ...], steps: int, **look: Any) -> None:
    if curve:
        seen, targets = np.array(curve).T
        axes.plot(seen / steps, targets, **look)
