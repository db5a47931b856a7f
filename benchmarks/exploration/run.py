"""``vitruvius bench exploration``: the part of a map that agents have seen, over the distance walked."""

import hashlib
import inspect
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Literal

import numpy as np
import tyro

from benchmarks.common.pages import machine, table_rows, versions, write, write_arrays
from benchmarks.common.processes import say
from benchmarks.exploration import frontier, pictures, play, seen
from benchmarks.exploration.play import AGENTS, EXPLORER, FRONTIER, Walk
from vitruvius.agent import planner
from vitruvius.agent.banks import bank_hash
from vitruvius.agent.policies import policies
from vitruvius.logic import House, RequestError, load

PARTS = 6
"""Number of distances for which the seen area is listed."""

PAGE = """# Exploration of maps

Each map has {starts} starts, sampled with seed {seed}. A robot of 0.287 m moves 0.072 m per step along an
axis or 0.101 m on a diagonal, or turns by 45 degrees. The share is that of the free cells connected to the
start. A cell counts as seen if beams of 0.144 degrees from the robot would have met it, within the sensor's
field and range. The tables have medians over starts, with the smallest and the largest value.

{tables}
{machine}. {versions}.
"""

TABLE = """## Sensor: {sensor}
| map | agent | {places} | area, metres | area, steps | went |
|---|---|{lines}---|---|---|
{rows}

Area is the mean share up to {metres:g} m, and up to {steps:,} steps. Explorer over nearest frontier, start
by start: area over metres {by_metres}, over steps {by_steps}.
"""


@dataclass(frozen=True)
class Exploration:
    """Let the explorer and a nearest-frontier baseline explore maps of ROS, and write exploration.md."""

    maps: tyro.conf.UseAppendAction[tuple[Path, ...]] = ()
    """YAML file of a map. Repeat for several."""

    resolution: float | None = None
    """Side of a cell in metres, instead of the maps' own."""

    coarser: int = 1
    """Number of cells along each side that are merged into one cell, which is free if all of them are."""

    sensors: tuple[Literal["laser", "own"], ...] = ("laser", "own")
    """laser: all around, 360 rays of 20 m; own: the sensor of the released agents, 40 rays of 7.9 m over 120
    degrees."""

    starts: int = 4
    """Number of walks of each agent on each map."""

    metres: float = 300.0
    """Length of a walk, in metres."""

    steps: int = 6000
    """Largest number of steps of a walk; turns are steps, too."""

    seed: int = 0
    """Seed of the starts."""

    out: Path = Path("runs/bench")
    """Folder for exploration.md, its pictures, and the walks."""

    replace: bool = False
    """Write into the folder even if it holds other files."""

    def run(self) -> None:
        """Run the walks that are missing, write the page and the pictures, and print the page."""
        if not self.maps:
            raise RequestError("name a map of ROS: --maps FILE.yaml, and again for others")
        if self.starts < 1 or self.coarser < 1 or not (0 < self.metres < 1e6 and 1 <= self.steps <= 8000):
            raise RequestError("--starts, --coarser and --metres are 1 or more, --steps 1 to 8,000")
        walked = {
            (sensor, name, agent): self.walks(sensor, name, agent)
            for sensor in self.sensors
            for name in self.houses
            for agent in AGENTS
        }
        tables = [self._table(sensor, walked) for sensor in self.sensors]
        page = PAGE.format(
            starts=self.starts, seed=self.seed, tables="\n".join(tables), machine=machine(),
            versions=versions("vitruvius", "numpy", "scipy", "taichi", "torch"),
        )  # fmt: skip
        files = {
            "exploration.md": page.encode(),
            "exploration.png": pictures.curves(walked, self.metres),
            "exploration-ways.png": pictures.ways(self.houses, walked, self.sensors[0]),
        }
        write(files, self.out)
        print(page)

    @cached_property
    def houses(self) -> dict[str, House]:
        """Maps by the names of their files, each with its middle at (0, 0)."""
        found = {}
        for path in self.maps:
            grid = load(path)[0].occupancy
            if not grid:
                raise RequestError(f"--maps {path}: a house file: name a map of ROS, FILE.yaml")
            try:
                whole = House.from_grid(grid.values, self.resolution or grid.cell).occupancy
                assert whole
                coarse = whole.coarser(self.coarser)
                found[path.stem] = House.from_grid(coarse.values, coarse.cell)
            except ValueError as error:
                raise RequestError(f"--maps {path}: {error}") from None
        return found

    def walks(self, sensor: str, name: str, agent: str) -> list[Walk]:
        """Return the walks of an agent on a map, kept from an earlier run of the same sources."""
        house, known = self.houses[name], (self.starts, self.seed, self.metres, self.steps, sensor)
        sources = [planner, policies] if agent == EXPLORER else [frontier]
        texts = [inspect.getsource(module) for module in (play, seen, *sources)]
        key = hashlib.sha256(repr((bank_hash([house]), known, texts)).encode()).hexdigest()
        path = self.out / f"{name}-{sensor}-{agent.replace(' ', '-')}-{key[:12]}.npz"
        if not path.exists():
            found = play.walks(house, sensor, agent, self.starts, self.seed, self.metres, self.steps)
            rows = {
                f"walk-{k}": np.column_stack([w.metres, w.steps, w.share, w.way]) for k, w in enumerate(found)
            }
            write_arrays(path, **rows)
            say(f"{name}, {sensor}, {agent}: {np.median([w.share[-1] for w in found]):.2f} seen")
        with np.load(path) as kept:
            return [Walk(*rows.T[:3], rows[:, 3:]) for rows in kept.values()]

    def _table(self, sensor: str, walked: dict[tuple[str, str, str], list[Walk]]) -> str:
        places = np.arange(1, PARTS + 1) * self.metres / PARTS
        area = {}
        for agent in AGENTS:
            of_all = [walk for name in self.houses for walk in walked[sensor, name, agent]]
            area[agent] = np.array(
                [(w.mean_share(self.metres), w.mean_share(self.steps, "steps")) for w in of_all]
            )
        by_metres, by_steps = (area[EXPLORER] / area[FRONTIER]).T
        return TABLE.format(
            sensor=f"{sensor}, {_words(sensor)}",
            places=" | ".join(f"{place:g} m" for place in places),
            lines="---|" * PARTS,
            rows=table_rows(self._rows(sensor, walked, places)),
            metres=self.metres,
            steps=self.steps,
            by_metres=_spread(by_metres),
            by_steps=_spread(by_steps),
        )

    def _rows(
        self, sensor: str, walked: dict[tuple[str, str, str], list[Walk]], places: np.ndarray
    ) -> Iterator[list[str]]:
        for name in (*self.houses, "all"):
            names = self.houses if name == "all" else [name]
            for agent in AGENTS:
                group = [walk for each in names for walk in walked[sensor, each, agent]]
                shares = np.array([walk.at(places) for walk in group])
                yield [
                    name,
                    agent,
                    *(f"{share:.2f}" for share in np.median(shares, axis=0)),
                    _spread(np.array([walk.mean_share(self.metres) for walk in group])),
                    _spread(np.array([walk.mean_share(self.steps, "steps") for walk in group])),
                    f"{np.median([walk.metres[-1] for walk in group]):.0f} m",
                ]


def _words(sensor: str) -> str:
    config = play.configuration(sensor, 1)
    return f"{config.rays} rays over {config.rays * config.ray_spacing} degrees, {config.range:.1f} m"


def _spread(values: np.ndarray) -> str:
    """Return a median, with the smallest and the largest value."""
    return f"{np.median(values):.2f} ({values.min():.2f} to {values.max():.2f})"
