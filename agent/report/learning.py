"""Section of training runs: learning curves, progress and configuration of each run."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

from vitruvius.agent.learning.learner import Progress
from vitruvius.agent.report.html import Cell, ReportError, Section, details, inline, table
from vitruvius.agent.report.plots import Axis, DataSeries, line_plot, slots, some
from vitruvius.agent.runs.runs import MAX_METRICS_BYTES, Folder
from vitruvius.logic.opener import content_of, from_json, opened

MAX_CONFIG_BYTES = 1 << 20
"""Largest size of ``config.json``, in bytes."""

MAX_POINTS = 300
"""Largest number of points of a curve."""

CURVES = (
    ("targets", "Targets collected during training", "targets per 1500 steps", False),
    ("loss", "Loss", "mean loss", True),
    ("epsilon", "Random actions", "share of actions", False),
    ("overruled", "Actions changed by the action mask", "share of actions", False),
)
"""Fields of ``Progress`` that are drawn: title and label, and True for a logarithmic axis."""


class HousesOfRun(msgspec.Struct, frozen=True):
    """Number and hash of the houses that a run is trained on."""

    number: int | None = None
    hash: str = "?"


class AskedRun(msgspec.Struct, frozen=True):
    """Content of a run's ``config.json``: see ``agent.runs.runs``."""

    algorithm: str
    preset: str = "–"
    config: dict[str, Any] = {}
    houses: HousesOfRun = HousesOfRun()
    command: str = ""
    python: str = ""
    torch: str = ""
    machine: str = ""


@dataclass(frozen=True)
class TrainingRun:
    """Files of a run in its folder."""

    name: str
    config: "AskedRun | None"
    """Content of ``config.json``; None if the file is absent or another program wrote it."""
    history: list[Progress]

    @classmethod
    def of(cls, folder: Path, name: str) -> "TrainingRun":
        """Read a run. A kill may tear the last report, or leave a run without reports."""
        here = Folder(folder)
        try:
            config = _asked(content_of(here.config, MAX_CONFIG_BYTES)) if here.config.exists() else None
        except OSError as error:
            raise ReportError(f"{here.config}: cannot be read: {error.strerror}") from None
        except ValueError as error:
            raise ReportError(f"{here.config}: not the configuration of a run: {error}") from None
        history = []
        if here.metrics.exists():
            with opened(here.metrics, MAX_METRICS_BYTES, unpack=False) as file:
                for line in file.read(MAX_METRICS_BYTES).splitlines():
                    try:
                        history.append(from_json(line, Progress))
                    except (ValueError, RecursionError):
                        continue
        return cls(name, config, history)

    @property
    def thin(self) -> list[Progress]:
        """Some of the run's reports, including the last."""
        return [self.history[k] for k in some(len(self.history), MAX_POINTS)]

    @property
    def state(self) -> str:
        """Progress of the run, in words."""
        if not self.history:
            return "no report yet"
        done = self.history[-1].fraction
        return "finished" if done >= 1 else f"stopped at {done:.0%}: vitruvius train --resume continues it"


def _asked(content: bytes) -> AskedRun | None:
    """Return the run that a ``config.json`` describes, or None if another program wrote the file.

    Raises ``ValueError`` for a malformed file.
    """
    found = from_json(content, dict[str, Any])
    return msgspec.convert(found, AskedRun) if "algorithm" in found else None


def section(files: Sequence[Path], folder: Path) -> Section | None:
    """Return the section of the folders of these ``config.json`` or ``metrics.jsonl`` files.

    Other programs also write ``config.json``: their files are skipped.
    """
    folders = sorted({path.parent for path in files})
    found = [TrainingRun.of(each, _name(each, folder)) for each in folders]
    runs = [run for run in found if run.history or run.config]
    if not runs:
        return None
    shown = [run for run in runs if run.history]
    kinds = slots(dict.fromkeys(_kind(run) for run in shown))
    parts = []
    if shown:
        parts += ['<div class="figures-row">', *(_curve(shown, kinds, *each) for each in CURVES), "</div>"]
    rows = []
    for run in runs:
        last = run.history[-1] if run.history else None
        cells = [_cell(last, "steps", ",.0f"), _cell(last, "seconds", ",.0f"), _cell(last, "targets", ".1f")]
        speeds = [_cell(last, part, ",.0f") for part in ("simulator", "learner", "map")]
        preset = run.config.preset if run.config else "–"
        rows.append([run.name, preset, *cells, *speeds, run.state])
    headings = ("run", "agent", "steps", "seconds", "targets", "simulator", "learner", "map", "state")
    parts.append(
        table(
            "Runs: steps per second of the simulator, the learner and the map, each by itself", headings, rows
        )
    )
    parts += [_config(run.name, run.config) for run in runs if run.config]
    return Section("learning", "Learning curves", "\n".join(parts))


def _name(run: Path, folder: Path) -> str:
    return str(run.relative_to(folder)) if run != folder else folder.resolve().name


def _kind(run: TrainingRun) -> str:
    """Return the group of a run; runs of a group have one colour."""
    return run.config.preset if run.config else run.name


def _curve(
    runs: Sequence[TrainingRun], kinds: dict[str, int], field: str, title: str, label: str, log: bool
) -> str:
    """Return a plot of a field of all runs against steps."""
    series = [
        DataSeries(
            _kind(run),
            [each.steps / 1e6 for each in run.thin],
            [getattr(each, field) for each in run.thin],
            slot=kinds[_kind(run)],
            marked=len(run.history) == 1,
        )
        for run in runs
    ]
    x, y = Axis("environment steps, millions", least=0.0), Axis(label, log, None if log else 0.0)
    return line_plot(title, x, y, series)


def _cell(last: Progress | None, field: str, form: str) -> Cell:
    value = getattr(last, field) if last else None
    return Cell("–") if value is None else Cell(format(value, form), order=value)


def _config(name: str, asked: AskedRun) -> str:
    """Return the configuration of a run as HTML, with its houses and versions."""
    number = "?" if asked.houses.number is None else asked.houses.number
    words = f"{number} houses, hash {asked.houses.hash[:12]}. " + " ".join(
        f"{label} {value}."
        for label, value in (("python", asked.python), ("torch", asked.torch), ("machine", asked.machine))
        if value
    )
    fields = [[key, str(value)] for key, value in asked.config.items()]
    command = f"<p>{inline(f'`{asked.command}`')}</p>" if asked.command else ""
    listed = f'<div class="fields">{table("Configuration", ("field", "value"), fields)}</div>'
    shown = f"<p>{inline(words)}</p>{command}{listed}"
    return details(f"Configuration of {name}", shown)
