"""What the studies found: laws fitted to reports of pytest-benchmark, the page of results."""

from collections.abc import Iterable
from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import stdtrit

AXES = {"rooms": "secondary rooms", "environments": "environments"}
"""What a study varies: the key in a benchmark's ``extra_info``, and its name on the axis."""


def name_of(entry: dict[str, Any]) -> str:
    """A benchmark's name in words, without its size."""
    return entry["name"].split("[")[0].removeprefix("test_").replace("_", " ")


def machine(report: dict[str, Any]) -> str:
    """The processor, its cores and the system."""
    info = report["machine_info"]
    cpu = info.get("cpu", {})
    return f"{cpu.get('brand_raw', info['machine'])}, {cpu.get('count', '?')} cores, {info['system']}"


def series_of(report: dict[str, Any]) -> dict[str, np.ndarray]:
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
            values = [extra["limit"]] * 3 if censored else values
            rows.setdefault(name_of(entry), []).append([sizes[0], *values, censored])
    return {name: np.array(sorted(points)) for name, points in rows.items()}


def is_rate(report: dict[str, Any]) -> bool:
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


def law(points: np.ndarray, rate: bool) -> str:
    """What least squares on logarithms finds, with a 95 % interval: the exponent of a power law.

    From size 4 on: below it fixed costs rule. A series that runs into its limit grows faster than any power:
    of that the factor for each further room, from 2 on. Of rates, the best.
    """
    if rate:
        return f"{points[:, 1].max():,.0f} a second at best"
    late, first = points[:, 4].any(), 2 if points[:, 4].any() else 4
    tail = points[(points[:, 0] >= first) & (points[:, 4] == 0)]
    if len(tail) < 3:
        return "too few sizes for a fit"
    exponent, error = fitted_exponent(np.exp(tail[:, 0]) if late else tail[:, 0], tail[:, 1])
    margin = stdtrit(len(tail) - 2, 0.975) * error
    span = f"from {tail[0, 0]:.0f} to {tail[-1, 0]:.0f}"
    if late:
        low, factor, high = np.exp([exponent - margin, exponent, exponent + margin])
        return f"each room more takes {factor:.1f} times [{low:.1f}, {high:.1f}] as long, {span}"
    return f"time ~ size^{exponent:.2f} ± {margin:.2f} {span}"


def results_page(report: dict[str, Any], grammar: str) -> str:
    """The study of the generator as a page: machine, versions, command, tables, laws, how to read it."""
    entries = {(name_of(entry), entry["extra_info"].get("rooms")): entry for entry in report["benchmarks"]}
    sizes = sorted({rooms for _, rooms in entries if rooms})
    loading = entries["loading", None]
    versions = {"Python": report["machine_info"]["python_version"], **loading["extra_info"]["versions"]}
    versions |= {name: version(name) for name in ("pyswip", "scipy")}
    solvers = {name for name, rooms in entries if rooms and name.startswith(("decide", "draw"))}
    infos = [entry["extra_info"] for entry in report["benchmarks"]]
    laws = {name: law(points, False) for name, points in series_of(report).items()}
    return PAGE.format(
        grammar=grammar,
        when=report["datetime"][:10],
        machine=machine(report),
        versions=", ".join(f"{name} {number}" for name, number in versions.items()),
        loading=f"{loading['stats']['median']:.2f}",
        workers="\n".join(
            f"| {each['workers']} | {each['houses_per_second']:.0f} |" for each in infos if "workers" in each
        ),
        laws="\n".join(f"| {name} | {words} |" for name, words in laws.items()),
        houses=_rows(_of_house(entries, rooms) for rooms in sizes if ("house", rooms) in entries),
        rejected=_rows(
            _of_rejection(entries["rejection", rooms]) for rooms in sizes if ("rejection", rooms) in entries
        ),
        solvers=" | ".join(sorted(solvers)),
        dashes="|".join("---" for _ in solvers),
        solved=_rows(
            [str(rooms), *(_median(entries.get((name, rooms))) for name in sorted(solvers))]
            for rooms in sizes
            if any((name, rooms) in entries for name in solvers)
        ),
    )


def _of_house(entries: dict[tuple[str, int | None], Any], rooms: int) -> list[str]:
    """Milliseconds by stage, and of the whole; inferences."""
    house = entries["house", rooms]
    extra, median = house["extra_info"], house["stats"]["median"]
    stages = [_median(entries[stage, rooms]) for stage in ("layout", "place")]
    whole = [_ms(extra["mean"]), _ms(median), _ms(extra["p95"]), f"{extra['p95'] / median:.2f}"]
    placing = entries["place", rooms]["extra_info"]["inferences"]
    return [str(rooms), *stages, *whole, f"{placing:,.0f}", f"{extra['inferences']:,.0f}"]


def _of_rejection(entry: dict[str, Any]) -> list[str]:
    """Milliseconds and tries of a plan by rejection; a quantile among the censored is a lower bound."""
    extra, rounds = entry["extra_info"], entry["stats"]["rounds"]
    late = extra["censored"]
    median = f"> {_ms(extra['limit'])}" if 2 * late >= rounds else _median(entry)
    p95 = f"> {_ms(extra['limit'])}" if 20 * late >= rounds else _ms(extra["p95"])
    tries = "" if 2 * late >= rounds else f"{extra['tries']:,.0f}"
    return [str(extra["rooms"]), median, p95, tries, f"{late} of {rounds}"]


def _median(entry: dict[str, Any] | None) -> str:
    return _ms(entry["stats"]["median"]) if entry else ""


def _ms(seconds: float) -> str:
    return f"{1e3 * seconds:,.{0 if seconds >= 1 else 1 if seconds >= 1e-3 else 3}f}"


def _rows(rows: Iterable[list[str]]) -> str:
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


PAGE = """# How hard is a house?

`./run bench generator --grammar {grammar}`, {when}. {machine}. {versions}.

![Solve time against rooms](generator.png)

CPU time of one core, in milliseconds. House `i` of each size has the random numbers of seed 0 and index `i`.
What is done once is apart: a grammar is loaded, checked and grounded in {loading} s, and some houses are made
before any is timed, as the first searches and refutations of each program take up to 30 ms more.

## A furnished house
| rooms | layout | place | both, mean | median | p95 | p95/median | inferences, place | inferences, both |
|---|---|---|---|---|---|---|---|---|
{houses}

`layout` is stage 1 (clingo) until its first answer, `place` stage 2 (SWI-Prolog) for the layout of a finished
house: medians of 20. `both` is all that it takes, with the layouts that stage 2 refutes on the way. Prolog's
inferences (medians) do not depend on the machine.

| processes | houses of 8 rooms a second (wall clock) |
|---|---|
{workers}

## The original's method
Written anew in `benchmarks/rejection.pl`, rooms only, without furniture: all numbers of all rooms and of the
main room are drawn and tested, and if a test fails all are drawn again.

| rooms | median | p95 | tries, median | not done in time |
|---|---|---|---|---|
{rejected}

A plan that is not done when its time is up (20 s of wall clock) is censored: `>` marks what is a lower bound,
the plot has a hollow arrow there, and the fit leaves it out. The original took 9, 69, 320 and 7,400 ms, with
7, 1,500, 4,350 and 54,000 tries, for 2, 4, 5 and 6 rooms, and did not finish 7 in a minute.

## The same linear systems, another solver
The systems of all rooms of 5 houses, every size unknown, as `room.pl` states them. `decide` asks whether each
has a solution; `draw` fixes every unknown in turn within its projection, with HiGHS by two linear programs
each. HiGHS is called through SciPy: a program for each room, or one for all rooms (`at once`).

| rooms | {solvers} |
|---|{dashes}|
{solved}

The generator itself solves less: it draws sizes first and asks CLP(R) whether all can stand so.

## Fitted laws
Least squares on the logarithms of the medians from 4 rooms on, with 95 % intervals; a method that does not
end in time is no power law, so of that the growth with each room.

| | |
|---|---|
{laws}

## On a grammar of your own
`./run bench generator --grammar DIR --out runs/mine` writes such a page, its plot and the measurements into
`runs/mine`. The page in `docs` is made by `./run bench generator --publish`.
"""
