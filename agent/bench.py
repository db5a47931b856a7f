"""``vitruvius bench``: the studies in ``benchmarks/``, run by pytest-benchmark, drawn with fitted laws."""

import json
import os
import subprocess
import sys
from dataclasses import dataclass
from importlib.metadata import version
from io import BytesIO
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import tyro
from numpy.typing import ArrayLike
from scipy.special import stdtrit

from logic import VitruviusError
from logic.files import write_whole

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"
AXES = {"rooms": "secondary rooms", "environments": "environments"}
"""What a study varies: the key in a benchmark's ``extra_info``, and its name on the axis."""


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
    """Folder for the measurements (JSON), the plots and, of the generator, a page of results (Markdown)."""

    def run(self) -> int:
        """Run the studies, draw each, and print what was fitted."""
        grammar = str(Path(self.grammar).resolve()) if Path(self.grammar).is_dir() else self.grammar
        studies = ["generator", "simulator", "learner"] if self.study == "all" else [self.study]
        self.out.mkdir(parents=True, exist_ok=True)
        for study in studies:
            report = _measured(study, self.out, grammar)
            series = _series(report)
            write_whole(self.out / f"{study}.png", _plot(series, report))
            for name, points in series.items():
                print(f"{name}: {_law(points, _is_rate(report))}")
            print(f"{self.out / study}.png, {self.out / study}.json")
            if study == "generator":
                write_whole(self.out / "generator.md", results_page(report, self.grammar).encode())
                print(self.out / "generator.md")
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


def _series(report: dict[str, Any]) -> dict[str, np.ndarray]:
    """Each benchmark's rows of size, median, lower and upper quartile, and whether the median is censored.

    Seconds, or steps a second. A study that ends runs at a limit notes how many: where it is half of them or
    more, the median is no more than a lower bound.
    """
    rows: dict[str, list[list[float]]] = {}
    for entry in report["benchmarks"]:
        extra, stats = entry["extra_info"], entry["stats"]
        sizes = [extra[axis] for axis in AXES if axis in extra]
        if sizes:
            # Where a round is many steps, what counts is their rate; the quartiles then change places.
            work = extra["steps_per_second"] * stats["median"] if "steps_per_second" in extra else None
            times = [stats["median"], stats["q1"], stats["q3"]]
            values = [work / time for time in times] if work else times
            censored = 2 * extra.get("censored", 0) >= stats["rounds"]
            name = entry["name"].split("[")[0].removeprefix("test_")
            rows.setdefault(name, []).append([sizes[0], *values, censored])
    return {name: np.array(sorted(points)) for name, points in rows.items()}


def _is_rate(report: dict[str, Any]) -> bool:
    """Whether a study measures steps a second rather than seconds."""
    return any("steps_per_second" in entry["extra_info"] for entry in report["benchmarks"])


def fitted_exponent(sizes: ArrayLike, seconds: ArrayLike) -> tuple[float, float]:
    """Least squares on logarithms: the exponent of ``seconds ~ sizes ** exponent``, its standard error."""
    x, y = np.log(sizes), np.log(seconds)
    design = np.stack([x, np.ones_like(x)], axis=1)
    solution, residual, *_ = np.linalg.lstsq(design, y, rcond=None)
    freedom = max(1, len(x) - 2)
    spread = float(residual[0]) / freedom / ((x - x.mean()) ** 2).sum() if len(residual) else 0.0
    return float(solution[0]), float(np.sqrt(spread))


def _law(points: np.ndarray, rate: bool) -> str:
    """The fitted power law with a 95 % interval, from size 4: below it fixed costs rule. Or the best rate."""
    if rate:
        return f"{points[:, 1].max():,.0f} a second at best"
    tail = points[(points[:, 0] >= 4) & (points[:, 4] == 0)]
    if len(tail) < 3:
        return "too few sizes for a fit"
    exponent, error = fitted_exponent(tail[:, 0], tail[:, 1])
    margin = stdtrit(len(tail) - 2, 0.975) * error
    return f"time ~ size^{exponent:.2f} ± {margin:.2f} from {tail[0, 0]:.0f} to {tail[-1, 0]:.0f}"


def results_page(report: dict[str, Any], grammar: str) -> str:
    """The study of the generator as a page: machine, versions, command, table, laws, how to read it."""
    machine, versions = report["machine_info"], [f"{name} {version(name)}" for name in ("clingo", "pyswip")]
    series = _series(report)
    rows = []
    for entry in report["benchmarks"]:
        extra, stats = entry["extra_info"], entry["stats"]
        if "rooms" not in extra:
            continue
        late = extra.get("censored", 0)
        numbers = [f"{1e3 * extra['mean']:.1f}", f"{1e3 * stats['median']:.1f}", f"{1e3 * extra['p95']:.1f}"]
        numbers.append(f"{extra['p95'] / stats['median']:.2f}")
        more = f"{extra['inferences']:,.0f} inferences" if "inferences" in extra else ""
        more = f"{late} of {stats['rounds']} not done" if late else more
        name = entry["name"].split("[")[0].removeprefix("test_").replace("_", " ")
        rows.append(f"| {name} | {extra['rooms']} | {' | '.join(numbers)} | {more} |")
    laws = [f"- {name.replace('_', ' ')}: {_law(points, False)}" for name, points in series.items()]
    once = [e for e in report["benchmarks"] if "rooms" not in e["extra_info"]]
    others = [
        f"- {entry['group']}{''.join(f', {k} {v}' for k, v in entry['extra_info'].items())}: "
        f"{entry['stats']['median']:.2f} s"
        for entry in once
    ]
    cpu = machine.get("cpu", {}).get("brand_raw", machine.get("machine", ""))
    return RESULTS.format(
        grammar=grammar,
        when=report["datetime"][:10],
        cpu=f"{cpu}, {machine.get('cpu', {}).get('count', '?')} cores, {machine['system']}",
        versions=", ".join([f"Python {machine['python_version']}", *versions]),
        rows="\n".join(rows),
        laws="\n".join(laws),
        others="\n".join(others),
    )


RESULTS = """# How hard is a house?

`vitruvius bench generator --grammar {grammar}`, {when}. {cpu}; {versions}.

![Solve time against rooms](generator.png)

Times of one core in milliseconds; 20 houses of each size, each with random numbers of its own. One-off
costs are apart, below. `house` is both stages, with whatever stage 2 refutes on the way; `layout` is
stage 1 (clingo), `place` stage 2 (CLP(R)) for layouts that it does not refute. `rejection` is the
original's method written anew, for rooms without furniture: draw all numbers, test, begin again; a plan
that is not done in 20 s is censored, and the fit leaves it out. `decide` asks CLP(R), and HiGHS through
SciPy, whether the same linear systems, those of all rooms of a house with every size unknown, have a
solution.

| what | rooms | mean | median | p95 | p95/median | |
|---|---|---|---|---|---|---|
{rows}

Least squares on logarithms, with 95 % intervals:
{laws}

Apart:
{others}

On a grammar of your own: `vitruvius bench generator --grammar DIR --out runs/mine`.
"""


def _plot(series: dict[str, np.ndarray], report: dict[str, Any]) -> bytes:
    """A PNG on logarithmic axes: medians, quartiles and the fitted law of each benchmark."""
    from matplotlib.figure import Figure

    extra, rate = [entry["extra_info"] for entry in report["benchmarks"]], _is_rate(report)
    figure = Figure(figsize=(7.2, 4.6), dpi=150, layout="constrained")
    axes = figure.subplots()
    for name, points in series.items():
        size, median, low, high, censored = points.T
        seen = censored == 0
        label = f"{name.replace('_', ' ')}: {_law(points, rate)}"
        (line,) = axes.plot(size[seen], median[seen], "o-", label=label, lw=1.6, ms=4)
        colour = line.get_color()
        axes.fill_between(size[seen], low[seen], high[seen], color=colour, alpha=0.2, lw=0)
        if not seen.all():
            label = f"{name.replace('_', ' ')}: not done in {median[~seen].max():.0f} s"
            axes.plot(size[~seen], median[~seen], "^", mfc="none", mec=colour, label=label)
    axes.set(
        xscale="log",
        yscale="log",
        xlabel=next((words for axis, words in AXES.items() if any(axis in one for one in extra)), "size"),
        ylabel="environment steps a second" if rate else "seconds",
    )
    sizes = sorted({size for points in series.values() for size in points[:, 0]})
    axes.set_xticks(sizes, [f"{size:g}" for size in sizes])
    axes.minorticks_off()
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8, frameon=False)
    machine = report["machine_info"]
    cpu = machine.get("cpu", {}).get("brand_raw", machine.get("machine", ""))
    title = f"Medians and quartiles. {cpu}, Python {machine['python_version']}, {report['datetime'][:10]}"
    axes.set_title(title, fontsize=8)
    picture = BytesIO()
    figure.savefig(picture, format="png")
    return picture.getvalue()
