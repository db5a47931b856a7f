"""Page of the study of the generator."""

from typing import Any

from benchmarks.common.pages import machine, median_ms, milliseconds, table_rows, versions
from benchmarks.common.series import law, name_of, series_of

STAGES = ("house", "layout", "place")
"""Measurements of the first table."""


def generator_page(report: dict[str, Any], command: str) -> str:
    """Return the page: machine, versions, command, tables, laws, and how to read them.

    A section is left out if its part of the study was not measured.
    """
    entries = {(name_of(entry), entry["extra_info"].get("rooms")): entry for entry in report["benchmarks"]}
    sizes = sorted({rooms for _, rooms in entries if rooms})
    info, infos = report["machine_info"], [entry["extra_info"] for entry in report["benchmarks"]]
    solvers = sorted({name for name, rooms in entries if rooms and name.startswith(("decide", "sample"))})
    staged = {rooms: entry["stats"]["rounds"] for (name, rooms), entry in entries.items() if name in STAGES}
    tables = {
        HOUSES: [_of_house(entries, rooms) for rooms in sorted(staged)],
        WORKERS: [
            [str(each["workers"]), str(each["worked"]), f"{each['houses_per_second']:.0f}"]
            for each in infos
            if "workers" in each
        ],
        REJECTED: [
            _of_rejection(entries["rejection", rooms]) for rooms in sizes if ("rejection", rooms) in entries
        ],
        SOLVED: [
            [str(rooms), *(median_ms(entries.get((name, rooms))) for name in solvers)]
            for rooms in sizes
            if any((name, rooms) in entries for name in solvers)
        ],
        LAWS: [[name, law(points, False)] for name, points in series_of(report).items()],
    }
    loading = entries.get(("loading", None))
    solver_versions = next((each["versions"] for each in infos if "versions" in each), {})
    words = {
        "command": command,
        "when": report["datetime"][:10],
        "machine": machine(info),
        "versions": versions("pyswip", "scipy", python=info["python_version"], **solver_versions),
        "loading": f" in {loading['stats']['median']:.2f} s" if loading else "",
        "rounds": max(staged.values(), default=0),
        "solvers": " | ".join(solvers),
        "dashes": "|".join("---" for _ in solvers),
    }
    sections = [section.format(rows=table_rows(rows), **words) for section, rows in tables.items() if rows]
    return "\n".join([HEAD.format(**words), *sections, TAIL])


def _of_house(entries: dict[tuple[str, int | None], Any], rooms: int) -> list[str]:
    """Return milliseconds of each stage and of the whole, and inferences; an empty text if not measured."""
    layout, place, house = (entries.get((name, rooms)) for name in ("layout", "place", "house"))
    whole, inferences = [""] * 4, ""
    if house:
        extra, median = house["extra_info"], house["stats"]["median"]
        p95, inferences = extra["p95"], f"{extra['inferences']:,.0f}"
        whole = [*map(milliseconds, (extra["mean"], median, p95)), f"{p95 / median:.2f}"]
    placing = f"{place['extra_info']['inferences']:,.0f}" if place else ""
    return [str(rooms), median_ms(layout), median_ms(place), *whole, placing, inferences]


def _of_rejection(entry: dict[str, Any]) -> list[str]:
    """Return milliseconds and tries of a plan by rejection; a censored quantile is a lower bound."""
    extra, rounds = entry["extra_info"], entry["stats"]["rounds"]
    late = extra["censored"]
    median = f"> {milliseconds(extra['limit'])}" if 2 * late >= rounds else median_ms(entry)
    p95 = f"> {milliseconds(extra['limit'])}" if 20 * late >= rounds else milliseconds(extra["p95"])
    tries = "" if 2 * late >= rounds else f"{extra['tries']:,.0f}"
    return [str(extra["rooms"]), median, p95, tries, f"{late} of {rounds}"]


HEAD = """# Time to generate a house

`{command}`, {when}. {machine}. {versions}.

![Solve time against rooms](generator.png)

The tables show CPU time of one core, in milliseconds. House `i` of each size has the random numbers of seed
0 and index `i`. One-time work is excluded: a grammar is loaded, checked and grounded{loading}. A few houses
are made before the measurement, because the first searches and conflicts of each program take up to 30 ms
more.
"""

HOUSES = """## A furnished house
| rooms | layout | place | both, mean | median | p95 | p95/median | inferences, place | inferences, both |
|---|---|---|---|---|---|---|---|---|
{rows}

`layout` is stage 1 (clingo) until its first answer. `place` is stage 2 (SWI-Prolog) for the layout of a
finished house. Both are medians of {rounds}. `both` is the whole time, including layouts that are
infeasible in stage 2. Prolog's inferences (medians) do not depend on the machine.
"""

WORKERS = """| processes | rooms | houses per second (wall clock) |
|---|---|---|
{rows}
"""

REJECTED = """## The original's method
`benchmarks/generator/rejection.pl` reimplements the method for rooms only, without furniture. It samples
all numbers of all rooms and of the main room and tests them. If a test fails, it samples everything again.

| rooms | median | p95 | tries, median | not done in time |
|---|---|---|---|---|
{rows}

A plan that exceeds its 20 s of wall clock is censored. `>` marks a lower bound; the plot has a hollow arrow
there, and the fit leaves the plan out. The original took 9, 69, 320 and 7,400 ms, with 7, 1,500, 4,350 and
54,000 tries, for 2, 4, 5 and 6 rooms. It did not finish 7 rooms in a minute.
"""

SOLVED = """## The same linear systems, another solver
The systems are those of all rooms of 5 houses, every size unknown, as `room.pl` states them. `decide` asks
whether each has a solution. `sample` fixes every unknown in turn within its projection; HiGHS needs two
linear programs for each. HiGHS is called through SciPy, with one program per room or one for all rooms
(`at once`).

| rooms | {solvers} |
|---|{dashes}|
{rows}

The generator itself solves less: it samples sizes first and asks CLP(R) whether all of them fit.
"""

LAWS = """## Fitted laws
Least squares on the logarithms of the medians from 4 rooms on, with 95 % intervals. A method that does not
finish in time follows no power law, so its row has the growth per room.

| | |
|---|---|
{rows}
"""

TAIL = """## Your own grammar
`vitruvius bench generator --grammar DIR --out runs/mine` writes such a page, its plot and the measurements
into `runs/mine`. A short form is `--rooms 1 4 16 --rounds 5 --part house`.
`./run bench generator --publish` makes the page in `docs`.
"""
