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
from logic import VitruviusError


class MeasurementFailed(VitruviusError):
    """A study did not run to its end."""

    exit_code = 1


def study(
    script: Path,
    out: Path,
    page: Callable[[dict[str, Any]], str] | None = None,
    *,
    needs: Sequence[str] = (),
    publish: bool = False,
    **settings: str,
) -> None:
    """Time ``test_NAME.py``; write NAME.json, NAME.png and, by ``page``, NAME.md; print the fitted laws.

    ``settings`` reach the script as environment variables. Raises ``MeasurementFailed``, and
    ``ModuleNotFoundError`` before anything runs where a module that it ``needs`` is absent.
    """
    for module in ("pytest_benchmark", *needs):
        import_module(module)
    name = script.stem.removeprefix("test_")
    report = measured(script, out / f"{name}.json", settings)
    files = {f"{name}.png": plot(report)} | ({f"{name}.md": page(report).encode()} if page else {})
    write(files, out, publish=publish and page is not None)
    for title, points in series_of(report).items():
        print(f"{title}: {law(points, is_rate(report))}")
    print(", ".join(str(out / file) for file in (f"{name}.json", *files)))


def measured(script: Path, file: Path, settings: Mapping[str, str]) -> dict[str, Any]:
    """What pytest-benchmark reports of a script, kept in a file; its own tables go to the terminal."""
    file.parent.mkdir(parents=True, exist_ok=True)
    beside = file.with_name(f".{file.name}").resolve()
    command = [sys.executable, "-m", "pytest", "-q", str(script), f"--benchmark-json={beside}"]
    command += ["--benchmark-columns=median,iqr,rounds", f"--rootdir={ROOT}", "-p", "no:cacheprovider"]
    done = subprocess.run(command, env=os.environ | settings, check=False)
    if done.returncode:
        raise MeasurementFailed(f"the study {script.name} failed: see above")
    beside.replace(file)
    return json.loads(file.read_text())
