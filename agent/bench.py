"""``vitruvius bench``: the studies in ``benchmarks/``, run by pytest-benchmark, drawn with fitted laws."""

import json
import subprocess
import sys
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import tyro
from numpy.typing import ArrayLike

from logic import VitruviusError
from logic.files import write_whole

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"
UNITS = {"rooms": "secondary rooms", "environments": "environments"}


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

    out: Path = Path("runs/bench")
    """Folder for the measurements (JSON) and the plots."""

    def run(self) -> int:
        """Run the studies, draw each, and print what was fitted."""
        studies = ["generator", "simulator", "learner"] if self.study == "all" else [self.study]
        self.out.mkdir(parents=True, exist_ok=True)
        for study in studies:
            report = _measured(study, self.out)
            series = _series(report)
            write_whole(self.out / f"{study}.png", _plot(series, report))
            for name, points in series.items():
                print(f"{name}: {_law(points)}")
            print(f"{self.out / study}.png, {self.out / study}.json")
        return 0


def _measured(study: str, out: Path) -> dict[str, Any]:
    """What pytest-benchmark reports of a study; its own tables go to the terminal."""
    script = BENCHMARKS / f"test_{study}.py"
    if not script.exists():
        raise NoCheckout(f"{script} is not there: the studies need a checkout of the project")
    beside = out / f".{study}.json"
    command = [sys.executable, "-m", "pytest", "-q", str(script), f"--benchmark-json={beside}"]
    columns = "--benchmark-columns=median,iqr,rounds"
    done = subprocess.run([*command, columns, "--rootdir", str(BENCHMARKS.parent)], check=False)
    if done.returncode:
        raise MeasurementFailed(f"the study {study} failed: see above")
    beside.replace(out / f"{study}.json")
    return json.loads((out / f"{study}.json").read_text())


def _series(report: dict[str, Any]) -> dict[str, np.ndarray]:
    """Each group as rows of size, median, lower and upper quartile, in seconds."""
    rows: dict[str, list[list[float]]] = {}
    for entry in report["benchmarks"]:
        sizes = [value for value in (entry["params"] or {}).values() if isinstance(value, int)]
        if len(sizes) == 1:
            stats, name = entry["stats"], entry["group"] or entry["name"].split("[")[0]
            rows.setdefault(name, []).append([sizes[0], stats["median"], stats["q1"], stats["q3"]])
    return {name: np.array(sorted(points)) for name, points in rows.items()}


def fitted_exponent(sizes: ArrayLike, seconds: ArrayLike) -> tuple[float, float]:
    """Least squares on logarithms: the exponent of ``seconds ~ sizes ** exponent``, its standard error."""
    x, y = np.log(sizes), np.log(seconds)
    design = np.stack([x, np.ones_like(x)], axis=1)
    solution, residual, *_ = np.linalg.lstsq(design, y, rcond=None)
    freedom = max(1, len(x) - 2)
    spread = float(residual[0]) / freedom / ((x - x.mean()) ** 2).sum() if len(residual) else 0.0
    return float(solution[0]), float(np.sqrt(spread))


def _law(points: np.ndarray) -> str:
    if len(points) < 3:
        return "too few sizes for a fit"
    # Fixed costs rule below four rooms or environments: the law is fitted from there on.
    tail = points[points[:, 0] >= 4] if (points[:, 0] >= 4).sum() >= 3 else points
    exponent, error = fitted_exponent(tail[:, 0], tail[:, 1])
    return f"time ~ size^{exponent:.2f} ± {1.96 * error:.2f} from {tail[0, 0]:.0f} to {tail[-1, 0]:.0f}"


def _plot(series: dict[str, np.ndarray], report: dict[str, Any]) -> bytes:
    """A PNG on logarithmic axes: medians, quartiles and the fitted law of each group."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.2, 4.6), dpi=150, layout="constrained")
    axes = figure.subplots()
    for name, points in series.items():
        size, median, low, high = points.T
        (line,) = axes.plot(size, 1e3 * median, "o-", label=f"{name}\n{_law(points)}", lw=1.6, ms=4)
        axes.fill_between(size, 1e3 * low, 1e3 * high, color=line.get_color(), alpha=0.2, lw=0)
    params = [entry["params"] for entry in report["benchmarks"] if entry["params"]]
    axis = next((name for name in UNITS if any(name in p for p in params)), "size")
    axes.set(xscale="log", yscale="log", xlabel=UNITS.get(axis, axis), ylabel="time, ms (median, quartiles)")
    sizes = sorted({size for points in series.values() for size in points[:, 0]})
    axes.set_xticks(sizes, [f"{size:g}" for size in sizes])
    axes.minorticks_off()
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8, frameon=False)
    machine = report["machine_info"]
    cpu = machine.get("cpu", {}).get("brand_raw", machine.get("machine", ""))
    axes.set_title(f"{cpu}, Python {machine['python_version']}, {report['datetime'][:10]}", fontsize=9)
    picture = BytesIO()
    figure.savefig(picture, format="png")
    return picture.getvalue()
