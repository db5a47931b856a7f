"""The study of the generator as a page."""

from typing import Any

from benchmarks.common.pages import machine, median_ms, milliseconds, table_rows, versions
from benchmarks.common.series import law, name_of, series_of


def generator_page(report: dict[str, Any], grammar: str) -> str:
    """The study of the generator as a page: machine, versions, command, tables, laws, how to read it."""
    entries = {(name_of(entry), entry["extra_info"].get("rooms")): entry for entry in report["benchmarks"]}
    sizes = sorted({rooms for _, rooms in entries if rooms})
    loading = entries["loading", None]
    info = report["machine_info"]
    solvers = {name for name, rooms in entries if rooms and name.startswith(("decide", "sample"))}
    infos = [entry["extra_info"] for entry in report["benchmarks"]]
    laws = {name: law(points, False) for name, points in series_of(report).items()}
    return PAGE.format(
        grammar=grammar,
        when=report["datetime"][:10],
        machine=machine(info),
        versions=versions(
            "pyswip", "scipy", python=info["python_version"], **loading["extra_info"]["versions"]
        ),
        loading=f"{loading['stats']['median']:.2f}",
        workers=table_rows(
            [str(each["workers"]), str(each["worked"]), f"{each['houses_per_second']:.0f}"]
            for each in infos
            if "workers" in each
        ),
        laws=table_rows(laws.items()),
        rounds=next(entry["stats"]["rounds"] for (name, _), entry in entries.items() if name == "house"),
        houses=table_rows(_of_house(entries, rooms) for rooms in sizes if ("house", rooms) in entries),
        rejected=table_rows(
            _of_rejection(entries["rejection", rooms]) for rooms in sizes if ("rejection", rooms) in entries
        ),
        solvers=" | ".join(sorted(solvers)),
        dashes="|".join("---" for _ in solvers),
        solved=table_rows(
            [str(rooms), *(median_ms(entries.get((name, rooms))) for name in sorted(solvers))]
            for rooms in sizes
            if any((name, rooms) in entries for name in solvers)
        ),
    )


def _of_house(entries: dict[tuple[str, int | None], Any], rooms: int) -> list[str]:
    """Milliseconds by stage, and of the whole; inferences."""
    house = entries["house", rooms]
    extra, median = house["extra_info"], house["stats"]["median"]
    stages = [median_ms(entries[stage, rooms]) for stage in ("layout", "place")]
    whole = [
        milliseconds(extra["mean"]),
        milliseconds(median),
        milliseconds(extra["p95"]),
        f"{extra['p95'] / median:.2f}",
    ]
    placing = entries["place", rooms]["extra_info"]["inferences"]
    return [str(rooms), *stages, *whole, f"{placing:,.0f}", f"{extra['inferences']:,.0f}"]


def _of_rejection(entry: dict[str, Any]) -> list[str]:
    """Milliseconds and tries of a plan by rejection; a quantile among the censored is a lower bound."""
    extra, rounds = entry["extra_info"], entry["stats"]["rounds"]
    late = extra["censored"]
    median = f"> {milliseconds(extra['limit'])}" if 2 * late >= rounds else median_ms(entry)
    p95 = f"> {milliseconds(extra['limit'])}" if 20 * late >= rounds else milliseconds(extra["p95"])
    tries = "" if 2 * late >= rounds else f"{extra['tries']:,.0f}"
    return [str(extra["rooms"]), median, p95, tries, f"{late} of {rounds}"]


PAGE = """# How hard is a house?

`./run bench generator --grammar {grammar}`, {when}. {machine}. {versions}.

![Solve time against rooms](generator.png)

CPU time of one core, in milliseconds. House `i` of each size has the random numbers of seed 0 and index `i`.
What is done once is apart: a grammar is loaded, checked and grounded in {loading} s, and some houses are made
before any is timed, as the first searches and conflicts of each program take up to 30 ms more.

## A furnished house
| rooms | layout | place | both, mean | median | p95 | p95/median | inferences, place | inferences, both |
|---|---|---|---|---|---|---|---|---|
{houses}

`layout` is stage 1 (clingo) until its first answer, `place` stage 2 (SWI-Prolog) for the layout of a finished
house: medians of {rounds}. `both` is all that it takes, with the layouts that are infeasible in stage 2.
Prolog's inferences (medians) do not depend on the machine.

| processes | rooms | houses a second (wall clock) |
|---|---|---|
{workers}

## The original's method
Rewritten in `benchmarks/generator/rejection.pl`, rooms only, without furniture: all numbers of all rooms and
of the main room are sampled and tested, and if a test fails all are sampled again.

| rooms | median | p95 | tries, median | not done in time |
|---|---|---|---|---|
{rejected}

A plan that is not done when its time is up (20 s of wall clock) is censored: `>` marks what is a lower bound,
the plot has a hollow arrow there, and the fit leaves it out. The original took 9, 69, 320 and 7,400 ms, with
7, 1,500, 4,350 and 54,000 tries, for 2, 4, 5 and 6 rooms, and did not finish 7 in a minute.

## The same linear systems, another solver
The systems of all rooms of 5 houses, every size unknown, as `room.pl` states them. `decide` asks whether each
has a solution; `sample` fixes every unknown in turn within its projection, with HiGHS by two linear programs
each. HiGHS is called through SciPy: a program for each room, or one for all rooms (`at once`).

| rooms | {solvers} |
|---|{dashes}|
{solved}

The generator itself solves less: it samples sizes first and asks CLP(R) whether all can stand so.

## Fitted laws
Least squares on the logarithms of the medians from 4 rooms on, with 95 % intervals; a method that does not
end in time is no power law, so of that the growth with each room.

| | |
|---|---|
{laws}

## On your grammar
`vitruvius bench generator --grammar DIR --out runs/mine` writes such a page, its plot and the measurements
into `runs/mine`; `--rooms 1 2 4 --rounds 5` is a short form of it. The page in `docs` is made by
`./run bench generator --publish`.
"""
