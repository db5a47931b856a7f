"""Run a study that pytest-benchmark times, draw its report, and write its page."""

import json
import os
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from benchmarks.common.pages import ROOT, write
from benchmarks.common.plot import plot
from benchmarks.common.series import is_rate, law, series_of
from vitruvius.logic import VitruviusError

INTERRUPTED = 2
"""Exit code of pytest after Ctrl-C."""


class MeasurementFailed(VitruviusError):
    """A study did not finish."""

    exit_code = 1


def study(
    script: Path,
    out: Path,
    page: Callable[[dict[str, Any]], str] | None = None,
    *,
    needs: Sequence[str] = (),
    parts: Sequence[str] = (),
    publish: bool = False,
    **settings: str,
) -> None:
    """Time ``test_NAME.py``, write NAME.json, .csv, .png and, with ``page``, .md, and print the laws.

    ``settings`` become environment variables of the script. Its tests run if their names begin with ``test_``
    and one of the ``parts``, by default all. Measurements before Ctrl-C or a failure are written, too. Raises
    ``MeasurementFailed`` and ``KeyboardInterrupt``, and before anything runs ``ModuleNotFoundError`` if a
    module that the study ``needs`` is missing.
    """
    for module in ("pytest_benchmark", *needs):
        import_module(module)
    name = script.stem.removeprefix("test_")
    file = out / f"{name}.json"
    before = _written(file)
    stopped = measured(script, file, settings, parts)
    if _written(file) != before:
        report = json.loads(file.read_text())
        files = {f"{name}.png": plot(report)} if series_of(report) else {}
        files |= {f"{name}.md": marked(page(report), report).encode()} if page else {}
        write(files, out, publish=publish and page is not None and stopped is None)
        for title, points in series_of(report).items():
            print(f"{title}: {law(points, is_rate(report))}")
        print(", ".join(str(out / each) for each in (file.name, f"{name}.csv", *files)))
    if stopped:
        raise stopped


def _written(file: Path) -> int | None:
    """Return the time of the file's last change in nanoseconds, or None.

    An earlier report stays until a new one replaces it.
    """
    return file.stat().st_mtime_ns if file.exists() else None


def marked(page: str, report: dict[str, Any]) -> str:
    """Return the page, with a note below its title if measurements are missing."""
    title, rest = page.split("\n", 1)
    done, count = report["measured"], report["of"]
    return page if done == count else f"{title}\n\n**Partial: {done} of {count} measurements.**\n{rest}"


def measured(
    script: Path, file: Path, settings: Mapping[str, str], parts: Sequence[str] = ()
) -> BaseException | None:
    """Write the report of pytest-benchmark on a script as it runs (see ``record.py``).

    Return what stopped the script, or None. The tables of pytest-benchmark go to the terminal.
    """
    file.parent.mkdir(parents=True, exist_ok=True)
    command = [sys.executable, "-m", "pytest", "-q", str(script), f"--report={file.resolve()}"]
    command += ["-p", "benchmarks.common.record", "-k", " or ".join(f"test_{part}" for part in parts)]
    command += ["--benchmark-columns=median,iqr,rounds", f"--rootdir={ROOT}", "-p", "no:cacheprovider"]
    try:
        done = subprocess.run(command, env=os.environ | settings, check=False)
    except KeyboardInterrupt as stop:
        return stop
    if done.returncode == INTERRUPTED:
        return KeyboardInterrupt()
    return MeasurementFailed(f"the study {script.name} failed: see above") if done.returncode else None
