"""``vitruvius bench``: the studies in ``benchmarks/``, run by pytest-benchmark, drawn with fitted laws."""

import json
import os
import subprocess
import sys
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import tyro

from agent.results.generator import generator_page
from agent.results.series import AXES, axis_of, is_rate, law, machine, name_of, series_of
from agent.results.simulator import simulator_page
from logic import VitruviusError
from logic.files import write_whole

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"
DOCS = BENCHMARKS.parent / "docs"


class MeasurementFailed(VitruviusError):
    """A study did not run to its end."""

    exit_code = 1


class NoCheckout(VitruviusError):
    """The studies are not part of an installed wheel."""

    exit_code = 2


@dataclass(frozen=True)
class Bench:
    """Measure: solve time against rooms, simulator and learner throughput, with plots."""

    study: Annotated[Literal["generator", "simulator", "learner", "all"], tyro.conf.Positional] = "all"
    """Which study."""

    grammar: str = "family"
    """The grammar of the generator's study: a shipped one's name, or a directory of rules."""

    out: Path = Path("runs/bench")
    """Folder for the measurements (JSON), the plots and the pages of results (Markdown)."""

    peers: bool = False
    """Measure other simulators beside ours, each in an environment that uv makes (3 GB to download once)."""

    publish: bool = False
    """Put the pages and their plots into docs/ too."""

    def run(self) -> int:
        """Run the studies, draw each, and print what was fitted."""
        grammar = str(Path(self.grammar).resolve()) if Path(self.grammar).is_dir() else self.grammar
        studies = ["generator", "simulator", "learner"] if self.study == "all" else [self.study]
        self.out.mkdir(parents=True, exist_ok=True)
        for study in studies:
            report = _measured(study, self.out, grammar)
            series = series_of(report)
            files = {f"{study}.png": _plot(report)}
            if study == "generator":
                files["generator.md"] = generator_page(report, self.grammar).encode()
            if study == "simulator":
                peers = _peers(self.out / "peers.json") if self.peers else None
                files["simulator.md"] = simulator_page(report, peers).encode()
            for name, content in files.items():
                write_whole(self.out / name, content)
                if self.publish and f"{study}.md" in files:
                    write_whole(DOCS / name, content)
            for name, points in series.items():
                print(f"{name}: {law(points, is_rate(report))}")
            print(", ".join(str(self.out / name) for name in (f"{study}.json", *files)))
        return 0


def _measured(study: str, out: Path, grammar: str) -> dict[str, Any]:
    """What pytest-benchmark reports of a study; its own tables go to the terminal."""
    script = BENCHMARKS / f"test_{study}.py"
    if not script.exists():
        raise NoCheckout(f"{script} is not there: the studies need a checkout of the project")
    beside = out / f".{study}.json"
    command = [sys.executable, "-m", "pytest", "-q", str(script), f"--benchmark-json={beside}"]
    columns = "--benchmark-columns=median,iqr,rounds"
    environment = os.environ | {"VITRUVIUS_GRAMMAR": grammar}
    done = subprocess.run(
        [*command, columns, "--rootdir", str(BENCHMARKS.parent)], env=environment, check=False
    )
    if done.returncode:
        raise MeasurementFailed(f"the study {study} failed: see above")
    beside.replace(out / f"{study}.json")
    return json.loads((out / f"{study}.json").read_text())


def _peers(file: Path) -> dict[str, Any]:
    """What ``benchmarks/peers/run.py`` measures on all processors; a peer that fails is told in its place."""
    script = str(BENCHMARKS / "peers" / "run.py")
    processors = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    done = subprocess.run([sys.executable, script, str(file), f"--threads={processors}"], check=False)
    if done.returncode not in (0, 1):
        raise MeasurementFailed("no peer could be measured: see above")
    return json.loads(file.read_text())


def _plot(report: dict[str, Any]) -> bytes:
    """A PNG on logarithmic axes: medians, quartiles and the fitted law of each benchmark, a panel a kind."""
    from matplotlib.figure import Figure

    rate, series = is_rate(report), series_of(report)
    panels = {
        name_of(entry): (entry["extra_info"].get("panel", ""), axis)
        for entry in report["benchmarks"]
        if (axis := axis_of(entry))
    }
    titles = list(dict.fromkeys(panels[name] for name in series))
    columns = min(3, len(titles))
    rows = -(-len(titles) // columns)
    figure = Figure(figsize=(1.2 + 6 * columns, 0.3 + 4.3 * rows), dpi=150, layout="constrained")
    grid = np.ravel(figure.subplots(rows, columns))
    for axes in grid[len(titles) :]:
        axes.remove()
    for axes, (title, axis) in zip(grid, titles, strict=False):
        shown = {name: points for name, points in series.items() if panels[name] == (title, axis)}
        for name, points in shown.items():
            _draw(axes, name, points, rate)
        axes.set(title=title, xscale="log", xlabel=AXES[axis])
        values = np.concatenate([points[:, 1] for points in shown.values()])
        if values.max() > 10 * values.min():
            axes.set_yscale("log")
        else:  # less than a decade has too few ticks on a logarithmic axis
            axes.set_ylim(bottom=0)
            if rate:
                axes.yaxis.set_major_formatter(lambda value, _: f"{value / 1e6:g} M")
        axes.set_ylabel("environment steps a second" if rate else "seconds")
        sizes = sorted({size for points in shown.values() for size in points[:, 0]})
        axes.set_xticks(sizes, [f"{size:,.0f}" for size in sizes])
        axes.minorticks_off()
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8, frameon=False)
    python = report["machine_info"]["python_version"]
    words = f"Medians and quartiles. {machine(report)}, Python {python}, {report['datetime'][:10]}"
    figure.suptitle(words, fontsize=8)
    picture = BytesIO()
    figure.savefig(picture, format="png")
    return picture.getvalue()


def _draw(axes: Any, name: str, points: np.ndarray, rate: bool) -> None:
    """One benchmark: a line with its quartiles, hollow arrows at the limit where the median is censored."""
    size, median, low, high, censored = points.T
    seen = censored == 0
    (line,) = axes.plot(size[seen], median[seen], "o-", label=f"{name}: {law(points, rate)}", lw=1.6, ms=4)
    colour = line.get_color()
    axes.fill_between(size[seen], low[seen], high[seen], color=colour, alpha=0.2, lw=0)
    if not seen.all():
        label = f"{name}: most not done in {median[~seen].max():g} s"
        axes.plot(size[~seen], median[~seen], "^", ms=7, mfc="none", mec=colour, label=label)
