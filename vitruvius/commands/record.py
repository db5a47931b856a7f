"""Options and work of ``vitruvius record``. Cheap to import."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import tyro

from vitruvius.agent import banks
from vitruvius.agent.learning.config import MAX_SEED
from vitruvius.agent.runs.released import located
from vitruvius.commands.common import print_answer
from vitruvius.logic.errors import RequestError
from vitruvius.logic.request.counts import whole
from vitruvius.options import Streamed

MOST_CELLS = 64
"""Largest number of environments in a mosaic."""


@dataclass(frozen=True)
class Record:
    """Film an agent in a house: its rays, its trail and its targets, next to its map if it has one.

    The command can also write a trace of the episode, which the page of vitruvius report plays.
    """

    groups: ClassVar = {"house": "The episode", "out": "The film"}

    agent: tyro.conf.Positional[Path]
    """Checkpoint (vitruvius train makes one), or the name of an agent that comes with the project."""

    houses: tyro.conf.Positional[Streamed]
    """House file; or a held-out set, such as test-v1; or paper-house, the house of the paper."""

    house: int = 0
    """Index of the house in the file, from 0."""

    targets: str = "main"
    """Location of the targets: main, secondary, mixed, or another task, module:Class or JSON."""

    allow: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """Your own class, module:Class, that a file may name. Files may name no other class of yours. Vitruvius
    imports the module, which runs its code."""

    seed: int = 0
    """Seed of the start and the targets."""

    steps: int = 1500
    """Number of steps of the episode to film."""

    out: Path = Path("episode.gif")
    """Film: a GIF, or an MP4 by its name (extra film); or a trace, NAME.trace.json."""

    replace: bool = False
    """Overwrite a file that has other content."""

    mosaic: str | None = None
    """Columns and rows of environments that are filmed side by side, as in 4x3. The first is in the house of
    --house, the others in the houses after it, from the file's first again if there are fewer; without
    maps."""

    stride: int = 4
    """Steps between frames."""

    width: int | None = None
    """Length of the house's longer side, and of the map's, in pixels: 480. In a mosaic, of each house: 960
    divided by its columns, at least 120."""

    json: bool = False
    """Print one answer as JSON, for programs."""

    def run(self) -> int:
        """Write the film."""
        from vitruvius.agent.learning.simulator import allow_named, require_asked_task

        whole("--seed", self.seed, 0, MAX_SEED)
        located(self.agent)
        allow_named(self.allow)
        require_asked_task(self.targets)
        banks.require_places(self.targets, self.houses)
        from vitruvius.agent.progress import progress
        from vitruvius.agent.recording import trace
        from vitruvius.agent.recording.film import WIDTH, record, record_mosaic, watch
        from vitruvius.agent.recording.recorder import Recorder
        from vitruvius.agent.runs import checkpoint
        from vitruvius.answers.houses import Written
        from vitruvius.logic.files.replacing import require_free
        from vitruvius.logic.files.writing import require_file
        from vitruvius.sim.film import require_film

        shape, is_trace = self._mosaic(), self.out.name.endswith(trace.ENDING)
        if shape and is_trace:
            raise RequestError(f"--mosaic {self.mosaic}: a trace holds one environment: leave out --mosaic")
        try:
            if not is_trace:
                require_film(self.out)
        except ValueError as error:
            raise RequestError(f"--out {error}, or {trace.ENDING} for an episode to play") from None
        require_file(self.out, [self.out.suffix])
        require_free(self.out, self.replace)
        agent, houses = checkpoint.load(self.agent), banks.named(self.houses)
        if not 0 <= self.house < len(houses):
            raise RequestError(f"--house {self.house}: {self.houses} has houses 0 to {len(houses) - 1}")
        width = self.width if self.width is not None else max(120, 960 // shape[0]) if shape else WIDTH
        for name, value, least in (
            ("steps", self.steps, 1),
            ("stride", self.stride, 1),
            ("width", width, 100),
        ):
            if value < least:
                raise RequestError(f"--{name} must be {least} or more, not {value}")
        house, stride = houses[self.house], self.stride
        how: dict[str, Any] = {"targets": self.targets, "seed": self.seed, "steps": self.steps}
        with progress("filming") as report:
            if is_trace:
                recorder = Recorder(agent.name, self.targets, self.seed)
                watch(agent, house, [recorder], report=report, **how)
                trace.save(recorder.trace, self.out)
            elif shape:
                rest = [*houses[self.house :], *houses[: self.house]]
                record_mosaic(agent, rest, self.out, *shape, stride=stride, width=width, report=report, **how)
            else:
                record(agent, house, self.out, stride=stride, width=width, report=report, **how)
        if self.json:
            print_answer("record", Written([str(self.out)]))
        else:
            print(self.out)
        return 0

    def _mosaic(self) -> tuple[int, int] | None:
        """Return columns and rows of a mosaic, or None without one."""
        if self.mosaic is None:
            return None
        found = re.fullmatch(r"(\d{1,2})x(\d{1,2})", self.mosaic.strip())
        columns, rows = (int(found[1]), int(found[2])) if found else (0, 0)
        if not 1 <= columns * rows <= MOST_CELLS:
            raise RequestError(
                f"--mosaic {self.mosaic}: give columns and rows, as in 4x3, with at most {MOST_CELLS} "
                "environments"
            )
        return columns, rows
