"""Pictures of walks: the seen area along the path, and the paths on their maps."""

from collections.abc import Mapping

import numpy as np

from benchmarks.common.pages import png
from benchmarks.exploration.play import AGENTS, Walk
from vitruvius.logic import House
from vitruvius.logic.house.occupancy import FREE, OCCUPIED

Walks = Mapping[tuple[str, str, str], list[Walk]]
"""Walks by sensor, map and agent."""

COLOURS = dict(zip(AGENTS, ("#1f5ea8", "#c8552d"), strict=True))


def curves(walked: Walks, metres: float) -> bytes:
    """Draw the seen area over the distance, a panel for each sensor and map: the median, and all walks."""
    from matplotlib.figure import Figure

    sensors, names = (list(dict.fromkeys(key[k] for key in walked)) for k in (0, 1))
    figure = Figure(figsize=(0.5 + 2.7 * len(names), 0.4 + 2.5 * len(sensors)), dpi=130, layout="constrained")
    grid = figure.subplots(len(sensors), len(names), squeeze=False, sharex=True, sharey=True)
    at = np.linspace(0, metres, 301)
    for (sensor, name, agent), group in walked.items():
        axes, colour = grid[sensors.index(sensor)][names.index(name)], COLOURS[agent]
        shares = np.array([walk.at(at) for walk in group])
        axes.plot(at, shares.T, color=colour, lw=0.6, alpha=0.4)
        axes.plot(at, np.median(shares, axis=0), color=colour, lw=2, label=agent)
        axes.set(title=f"{name}, {sensor}", ylim=(0, 1))
        axes.title.set_fontsize(9)
        axes.grid(alpha=0.3)
    for axes in grid[-1]:
        axes.set_xlabel("metres")
    for row in grid:
        row[0].set_ylabel("share seen")
    grid[0][0].legend(fontsize=8, frameon=False)
    return png(figure)


def ways(houses: Mapping[str, House], walked: Walks, sensor: str) -> bytes:
    """Draw the first walk of each agent on each map, from the same start."""
    from matplotlib.figure import Figure

    sizes = [house.rooms[0].height / house.rooms[0].width for house in houses.values()]
    figure = Figure(figsize=(12, 0.4 * len(sizes) + 6 * sum(sizes)), dpi=130, layout="constrained")
    grid = figure.subplots(len(houses), len(AGENTS), squeeze=False, height_ratios=sizes)
    for row, (name, house) in zip(grid, houses.items(), strict=True):
        assert house.occupancy
        west, north, east, south = house.rooms[0].box
        shades = np.select(
            [house.occupancy.values == FREE, house.occupancy.values == OCCUPIED], [255, 40], 150
        )
        for axes, agent in zip(row, AGENTS, strict=True):
            walk = walked[sensor, name, agent][0]
            axes.imshow(shades, extent=(west, east, south, north), cmap="gray", vmin=0, vmax=255)
            axes.plot(*walk.way.T, color=COLOURS[agent], lw=1)
            axes.plot(*walk.way[0], "o", color=COLOURS[agent], ms=4)
            axes.set_title(f"{name}, {agent}: {walk.share[-1]:.0%} in {walk.metres[-1]:.0f} m", fontsize=8)
            axes.set_axis_off()
    return png(figure)
