"""The studies' results: fitted laws, and the page that tells them."""

from typing import Any

import numpy as np
import pytest

from agent.bench import _plot
from agent.results.generator import generator_page
from agent.results.series import fitted_exponent, law, series_of
from agent.results.simulator import simulator_page

ROOMS = [4, 8, 16, 32]


def entry(name: str, seconds: float, **extra: Any) -> dict[str, Any]:
    stats = {"median": seconds, "q1": seconds, "q3": seconds, "rounds": 20}
    return {"name": f"test_{name}", "stats": stats, "extra_info": extra}


def report() -> dict[str, Any]:
    """A study as pytest-benchmark tells it: 2 ms a room; by rejection 7 rooms are not done in 20 s."""
    common = {"mean": 0.1, "p95": 0.2, "inferences": 5e4}
    benchmarks = [entry("loading", 1.5, versions={"clingo": "5.8"})]
    benchmarks += [entry(f"workers[{n}]", 1.0, workers=n, houses_per_second=50.0 * n) for n in (1, 2)]
    for stage in ("house", "layout", "place", "decide_with_highs"):
        benchmarks += [entry(f"{stage}[{n}]", 0.002 * n, rooms=n, **common) for n in ROOMS]
    for rooms, late in ((4, 0), (5, 0), (6, 2), (7, 20)):
        more = {"rooms": rooms, "censored": late, "limit": 20.0, "tries": 0.0 if late == 20 else 800.0}
        benchmarks.append(
            entry(f"rejection[{rooms}]", 20.0 if late == 20 else 10.0 ** (rooms - 6), **common, **more)
        )
    machine = {"python_version": "3.12", "machine": "x86_64", "system": "Linux"}
    return {"benchmarks": benchmarks, "machine_info": machine, "datetime": "2026-01-02T00:00:00"}


def test_a_power_law_is_fitted() -> None:
    exponent, error = fitted_exponent(ROOMS, [3 * n**1.25 for n in ROOMS])
    assert exponent == pytest.approx(1.25)
    assert error == pytest.approx(0, abs=1e-6)


def test_a_power_law_has_its_exponent_and_interval() -> None:
    """The interval against a textbook's formula, with Student's t for two degrees of freedom."""
    sizes, noise = np.array(ROOMS), np.exp([0.1, -0.1, -0.1, 0.1])
    points = np.stack([sizes, 3 * sizes**1.25 * noise, sizes, sizes, 0 * sizes], axis=1)
    x = np.log(sizes) - np.log(sizes).mean()
    margin = 4.303 * np.sqrt(0.04 / 2 / (x**2).sum())
    assert law(points, False) == f"time ~ size^1.25 ± {margin:.2f} from 4 to 32"


def test_what_runs_into_its_limit_is_fitted_by_its_growth_without_what_is_censored() -> None:
    points = series_of(report())["rejection"]
    assert points[:, 4].tolist() == [0, 0, 0, 1]
    assert points[3, 1] == 20
    assert law(points, False) == "each room more takes 10.0 times [10.0, 10.0] as long, from 4 to 6"


def test_fewer_than_half_late_leave_the_median_but_not_the_95th_percentile() -> None:
    page = generator_page(report(), "family")
    assert "| 6 | 1,000 | > 20,000 | 800 | 2 of 20 |" in page
    assert "| 7 | > 20,000 | > 20,000 |  | 20 of 20 |" in page


def test_the_page_names_machine_versions_grammar_and_what_is_measured() -> None:
    page = generator_page(report(), "mine")
    for words in (
        "--grammar mine",
        "x86_64",
        "Python 3.12",
        "clingo 5.8",
        "1.50 s",
        "| 1 | 50 |",
        "| 2 | 100 |",
    ):
        assert words in page
    assert "| 32 | 64.0 | 64.0 | 100.0 | 64.0 | 200.0 | 3.12 | 50,000 | 50,000 |" in page


def test_a_study_is_drawn() -> None:
    assert _plot(report()).startswith(b"\x89PNG")


@pytest.mark.parametrize("count", [1, 2])
def test_too_few_sizes_are_not_fitted(count: int) -> None:
    assert law(np.ones((count, 5)) * 4, False) == "too few sizes for a fit"


def simulator_report() -> dict[str, Any]:
    """A study of the simulator: a million steps a second by one launch of 1,000 environments."""
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
    benchmarks.append(entry("parts[launch]", 2e-5, part="a launch"))
    benchmarks.append(entry("packing", 0.064, packing="grid", packed=64))
    benchmarks.append(entry("first", 3.0, first="compiled", parts={"import": 0.5, "first step": 1.25}))
    machine = {"python_version": "3.12", "machine": "x86_64", "system": "Linux"}
    return {"benchmarks": benchmarks, "machine_info": machine, "datetime": "2026-01-02T00:00:00"}


def test_the_simulators_page_has_its_figures_and_the_ratio_to_c() -> None:
    page = simulator_page(simulator_report(), None)
    assert (
        "| 4,096 | 4.00 M [4.00 M, 4.00 M] | 3.00 M [3.00 M, 3.00 M] | 4.00 M [4.00 M, 4.00 M] | 0.75 |"
        in page
    )
    assert "| 2 | 2 | 5.00 M [5.00 M, 5.00 M] |" in page
    for words in (
        "| a launch | 0.020 |",
        "| grid | 1.0 |",
        "| compiled | 0.50 | 1.25 |",
        "clang 1",
        "meets 10",
    ):
        assert words in page
    assert "were not measured" in page
    assert _plot(simulator_report()).startswith(b"\x89PNG")


def test_a_peers_best_is_told_and_what_failed() -> None:
    row = {"peer": "P", "version": "1", "what": "a step", "note": "no rays", "low": 90.0, "high": 110.0}
    rows = [row | {"environments": n, "steps_per_second": rate} for n, rate in ((1, 50.0), (16, 100.0))]
    page = simulator_page(simulator_report(), {"rows": rows, "failures": [{"peer": "Q", "why": "no wheel"}]})
    assert "| P 1 | a step | 16 | 100 [90, 110] | no rays |" in page
    assert "Q could not be measured: no wheel" in page
