"""Page of the study of the simulator."""

from typing import Any

import numpy as np

from benchmarks.common.pages import machine, milliseconds, table_rows, versions
from benchmarks.common.series import name_of

NAMES = ("kernel", "step torch", "gymnasium step", "kernel on one core", "C on one core")
"""Benchmarks by number of environments: the columns of the first table."""

VARIED = {
    "houses": ("houses", " ({mib:,.0f} MiB on the device)"),
    "segments": ("segments of a house", " (rooms: {of_rooms})"),
    "rays": ("rays", ""),
    "processors": ("processors", ""),
    "backend": ("backend", ""),
    "loop": ("loop", ""),
}
"""Rows of the table of varied quantities: title and addition of each value, by the key of its benchmarks."""


def simulator_page(report: dict[str, Any], peers: dict[str, Any] | None) -> str:
    """Return the page: tables, and the results of ``peers``."""
    entries = report["benchmarks"]
    rates = {
        (name_of(entry), entry["extra_info"]["environments"]): entry
        for entry in entries
        if "environments" in entry["extra_info"]
    }
    sizes = sorted({count for _, count in rates})
    names = [name for name in NAMES if any(name == known for known, _ in rates)]
    info = report["machine_info"]
    parts = {e["extra_info"]["part"]: e["stats"]["median"] for e in entries if "part" in e["extra_info"]}
    lines = next((e["extra_info"]["lines"] for e in entries if "lines" in e["extra_info"]), float("nan"))
    compilers = {e["extra_info"]["compiler"] for e in entries if "compiler" in e["extra_info"]}
    return PAGE.format(
        when=report["datetime"][:10],
        machine=machine(info),
        versions=versions("taichi", "numpy", "torch", "gymnasium", python=info["python_version"]),
        compiler=", ".join(compilers) or "no clang was at hand",
        lines=lines,
        operations=7 * 40 * lines,
        vectors=7 * 40 * lines / 8,
        names=" | ".join(names),
        dashes="|".join("---" for _ in names),
        rates=table_rows(
            [f"{count:,}", *(_rate(rates.get((name, count))) for name in names), _ratio(rates, count)]
            for count in sizes
        ),
        parts=table_rows([part, milliseconds(seconds)] for part, seconds in parts.items()),
        asked=table_rows(
            [e["extra_info"]["asked"], "{1:.2f} [{0:.2f}, {2:.2f}]".format(*e["extra_info"]["ratios"])]
            for e in entries
            if "asked" in e["extra_info"]
        ),
        varied="\n".join(
            rows for key, (what, more) in VARIED.items() if (rows := _by(entries, key, what, more))
        ),
        driven=_by(entries, "driven"),
        driven_ratio=_driven_ratio(entries),
        packing=table_rows(
            [e["extra_info"]["packing"], milliseconds(e["stats"]["median"] / e["extra_info"]["packed"])]
            for e in entries
            if "packing" in e["extra_info"]
        ),
        first=table_rows(
            [e["extra_info"]["first"], *(f"{seconds:.2f}" for seconds in e["extra_info"]["parts"].values())]
            for e in entries
            if "first" in e["extra_info"]
        ),
        compilers=_compilers(entries),
        peers=_peers(peers, entries) if peers else "They were not measured in this run.",
    )


def _rate(entry: dict[str, Any] | None) -> str:
    """Return the steps per second of the median round, with those of the quartiles in brackets."""
    if entry is None:
        return ""
    stats, rate = entry["stats"], entry["extra_info"]["steps_per_second"]
    low, high = (rate * stats["median"] / stats[quartile] for quartile in ("q3", "q1"))
    return f"{_short(rate)} [{_short(low)}, {_short(high)}]"


def _short(rate: float) -> str:
    return f"{rate / 1e6:.2f} M" if rate >= 1e5 else f"{rate:,.0f}"


def _ratio(rates: dict[tuple[str, int], Any], count: int) -> str:
    """Return the ratio of our rate to that of C, both on one core."""
    ours, bound = (rates.get((name, count)) for name in ("kernel on one core", "C on one core"))
    if ours is None or bound is None:
        return ""
    return f"{ours['extra_info']['steps_per_second'] / bound['extra_info']['steps_per_second']:.2f}"


def _driven_ratio(entries: list[dict[str, Any]]) -> str:
    """Return the ratio of our rate to that of C for bodies that drive, both on one core."""
    rates = {
        e["extra_info"]["driven"]: e["extra_info"]["steps_per_second"]
        for e in entries
        if "driven" in e["extra_info"]
    }
    ours, bound = rates.get("kernel on one core"), rates.get("C on one core")
    return f"{ours / bound:.2f}" if ours and bound else "not measured"


def _by(entries: list[dict[str, Any]], key: str, what: str = "", more: str = "") -> str:
    """Return the rows of the benchmarks that vary a quantity: its name if given, its value, the rate."""
    rows = []
    for entry in entries:
        extra = entry["extra_info"]
        if key in extra:
            value = extra[key] if isinstance(extra[key], str) else f"{extra[key]:,.0f}"
            rows.append(
                [
                    *([what] if what else []),
                    f"{value}{more.format(**extra, mib=extra.get('bytes', 0) / 2**20)}",
                    _rate(entry),
                ]
            )
    return table_rows(rows)


def _compilers(entries: list[dict[str, Any]]) -> str:
    """Return a row for each compiler, with its rates and if its results were the same."""
    found = [e["extra_info"] for e in entries if "runtime" in e["extra_info"]]
    rows = []
    for extra in found:
        low, median, high = (_short(rate) for rate in np.percentile(extra["rates"], [0, 50, 100]))
        same = "yes" if extra["outcome"] == found[0]["outcome"] else "no"
        rows.append([extra["runtime"], f"{median} [{low}, {high}]", f"{extra['compiling']:.1f}", same])
    return table_rows(rows)


OURS = {
    "continuous": "A square robot that takes steps and turns by 45 degrees; exact collisions of its way",
    "free": "A round robot with limits on speed and acceleration, which slides along what it touches",
}
"""Descriptions of our step among the peers' lines, by backend."""


def _peers(peers: dict[str, Any], entries: list[dict[str, Any]]) -> str:
    """Return a table of our step and of each way to run each peer, with its best number of environments.

    The table is followed by the peers that failed.
    """
    best: dict[tuple[str, str], dict[str, Any]] = {}
    for row in peers["rows"]:
        key = row["peer"], row["what"]
        if key not in best or row["steps_per_second"] > best[key]["steps_per_second"]:
            best[key] = row
    rows = [
        [
            f"**this one**, backend `{backend}`",
            "four rooms, 58 segments, one robot with 40 rays, collisions, reward, reset",
            "4,096",
            _rate(entry),
            f"{OURS[backend]}; exact rays, which distinguish the target; episodes end after 1500 steps",
        ]
        for entry in entries
        if (backend := entry["extra_info"].get("beside_peers"))
    ]
    rows += [
        [
            f"{row['peer']} {row['version']}",
            row["what"],
            f"{row['environments']:,}",
            f"{_short(row['steps_per_second'])} [{_short(row['low'])}, {_short(row['high'])}]",
            row["note"],
        ]
        for row in best.values()
    ]
    lines = [
        "| simulator | a step | environments | steps per second | comparable? |",
        "|---|---|---|---|---|",
        table_rows(rows),
    ]
    lines += [f"\n{each['peer']} could not be measured: {each['why']}" for each in peers["failures"]]
    return "\n".join(lines)


PAGE = """# Speed of the simulator

`./run bench simulator --peers`, {when}. {machine}. {versions}.

![Steps per second](simulator.png)

A step of an environment includes the action, the swept move with its collision, reaching a target and
placing the next one, reward and flags. It also includes 40 rays among walls, furniture and the target, the
(40, 2) float32 observation, and a new episode if one has ended. The houses are generated and furnished
(`family` grammar). Actions are random, 70 % forward. The tables show environment steps per second (SPS) of
the median round, with quartiles.

## Number of environments
64 houses of 4 rooms.

| environments | {names} | one core: kernel / C |
|---|{dashes}|---|
{rates}

- `kernel` is one launch of the compiled step. `step torch` is `step_torch`, which also checks the actions
  and shares all memory. `gymnasium step` is `VectorEnv.step`, with fresh arrays and the info.
- `C` is the same algorithm on the same arrays (`benchmarks/simulator/step.c`; {compiler},
  `-O3 -march=native`). The study first checks that its results are equal bit for bit. The gap between the
  kernel and C on one core is the overhead of Taichi. C needs no launch, which matters with few
  environments.
- Work per step: a step reads and writes 112 bytes of state, reads a few hundred bytes of lists, and writes
  an observation of 320 bytes. It tests 40 rays against {lines:.0f} lines (mean) at 7 operations:
  {operations:,.0f} operations, or {vectors:,.0f} vector instructions on 8 numbers.

## Parts of a step of 4,096 environments
Milliseconds.

| part | ms |
|---|---|
{parts}

The kernel of one environment is the cost of a launch. Beyond `step torch`, `gymnasium step` pays for the
copy of the observations, the info, and the memory pages of new arrays. A reset begins a new episode
everywhere; in `kernel`, the same launch starts the next episode. The last row is a baseline: the rays
alone, among the boxes of one house, in vectorised NumPy.

## Cost of each option
Processor time of 4,096 environments with the option, relative to the same environments without, in
alternating rounds. The last rows compare ways to step. Medians with quartiles.

| | times |
|---|---|
{asked}

The first steps are slow: an environment computes the distances to a target at its first use, 1 ms or more
each, and stores them. With random actions in 64 houses, about 60 million steps know few of the distances,
because targets cover the whole floor. With few houses, or a task with few places (such as one room), the
slow phase is short.

## Houses, segments, rays, processors and loops
4,096 environments; each episode draws a house. A field of view is about 120 degrees. Both backends run in
64 houses of 4 rooms on cells of 0.3 m. The loop for GPUs runs one task per environment and ray; on the CPU
it gives the same bits. [Speed on a GPU](gpu.md) has the figures for GPUs.

| varied | value | kernel |
|---|---|---|
{varied}

Packing a house lists what each square metre can see. These lists keep the cost of a step from growing with
the house.

## Bodies that drive
Backend `free` (continuous control), 4,096 environments in the 64 houses. A round robot has limits on speed,
slides along what it touches, and casts 40 rays from any heading. C is the same algorithm with results equal
bit for bit (`benchmarks/simulator/free.c`). On one core the kernel makes {driven_ratio} of the steps of C.

| | |
|---|---|
{driven}

`free` computes the 40 directions of an observation, with two divisions per ray, where the other backends
look them up. Its lists are by sectors of 45 degrees, so they hold the lines of a wider view.

## Two compilers
`VITRUVIUS_RUNTIME=quadrants` replaces Taichi by
[Quadrants](https://github.com/Genesis-Embodied-AI/quadrants), its maintained fork. The table has 4,096
environments among the package's houses: the median of three processes with the slowest and the fastest. It
also has the seconds until the first step with an empty cache. `the same` states whether 500 steps of 64
environments are equal bit for bit.

| compiler | kernel | first step | the same |
|---|---|---|---|
{compilers}

## Time before the first step
Packing a house, milliseconds:

| backend | ms a house |
|---|---|
{packing}

Seconds in a new process, 4,096 environments in one house:

| kernels | import | packing, first | the rest until the first step | packing again |
|---|---|---|---|---|
{first}

## Other simulators
Each simulator has its authors' recommended settings, the same processors, and the best number of
environments that was tried (`benchmarks/simulator/peers`).

{peers}

All figures are environment steps per second on the same processors, including resets. The work per step
differs. The grid simulators (NAVIX, XLand-MiniGrid, MiniGrid) cast no rays, have no continuous collision,
and see a few cells. VMAS solves forces between robots. JaxNav and IR-SIM move robots by their speeds, as
our backend `free` does.
"""
