"""Small made-up reports in the format of pytest-benchmark."""

from typing import Any

ROOMS = [4, 8, 16, 32]


def entry(name: str, seconds: float, **extra: Any) -> dict[str, Any]:
    stats = {"median": seconds, "q1": seconds, "q3": seconds, "rounds": 20}
    return {"name": f"test_{name}", "stats": stats, "extra_info": extra}


def report() -> dict[str, Any]:
    """Return a study of the generator: 2 ms per room; by rejection, 7 rooms are not done in 20 s."""
    common = {"mean": 0.1, "p95": 0.2, "inferences": 5e4}
    benchmarks = [entry("loading", 1.5, versions={"clingo": "5.8"})]
    benchmarks += [
        entry(f"workers[{n}]", 1.0, workers=n, worked=8, houses_per_second=50.0 * n) for n in (1, 2)
    ]
    for stage in ("house", "layout", "place", "decide_with_highs"):
        benchmarks += [entry(f"{stage}[{n}]", 0.002 * n, rooms=n, **common) for n in ROOMS]
    for rooms, late in ((4, 0), (5, 0), (6, 2), (7, 20)):
        more = {"rooms": rooms, "censored": late, "limit": 20.0, "tries": 0.0 if late == 20 else 800.0}
        benchmarks.append(
            entry(f"rejection[{rooms}]", 20.0 if late == 20 else 10.0 ** (rooms - 6), **common, **more)
        )
    machine = {"python_version": "3.12", "machine": "x86_64", "system": "Linux"}
    return {"benchmarks": benchmarks, "machine_info": machine, "datetime": "2026-01-02T00:00:00"}


def simulator_report() -> dict[str, Any]:
    """Return a study of the simulator: a million steps per second by one launch of 1,000 environments."""
    rates = {"kernel": 4e6, "C_on_one_core": 4e6, "kernel_on_one_core": 3e6}
    benchmarks = [
        entry(f"{name}[{n}]", 0.001, environments=n, steps_per_second=rate, panel="P", compiler="clang 1")
        for name, rate in rates.items()
        for n in (1, 4096)
    ]
    benchmarks[0]["extra_info"]["lines"] = 10.0
    varied = {"houses": {"bytes": 2**21}, "segments": {"of_rooms": 4}, "rays": {}, "processors": {}}
    varied |= {"backend": {}, "loop": {}}
    for key, more in varied.items():
        value = "that" if key in ("backend", "loop") else 2
        benchmarks.append(entry(f"by_{key}", 0.001, steps_per_second=5e6, panel="Q", **{key: value}, **more))
    for how, rate in (("kernel on one core", 3e6), ("C on one core", 2e6)):
        benchmarks.append(entry(f"driven[{how}]", 0.001, steps_per_second=rate, driven=how))
    benchmarks.append(entry("peers[free]", 0.001, steps_per_second=3e6, beside_peers="free"))
    benchmarks.append(entry("parts[launch]", 2e-5, part="a launch"))
    benchmarks.append(entry("asked[goal]", 0.1, asked="goal", ratios=[1.0, 1.25, 1.5]))
    benchmarks.append(entry("packing", 0.064, packing="grid", packed=64))
    for name, outcome in (("taichi", "a"), ("quadrants", "a"), ("another", "b")):
        more = {"rates": [2e6, 1e6, 3e6], "compiling": 4.0, "outcome": outcome}
        benchmarks.append(entry(f"compilers[{name}]", 9.0, runtime=name, **more))
    benchmarks.append(entry("first", 3.0, first="compiled", parts={"import": 0.5, "first step": 1.25}))
    machine = {"python_version": "3.12", "machine": "x86_64", "system": "Linux"}
    return {"benchmarks": benchmarks, "machine_info": machine, "datetime": "2026-01-02T00:00:00"}
