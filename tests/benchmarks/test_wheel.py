"""Abilities of an installed wheel without a checkout."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from tests.programs import finished

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a wheel's packages."""
    folder = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(build, cwd=ROOT, check=True, capture_output=True)
    [wheel] = folder.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:  # as an installer does for a wheel of Python files
        archive.extractall(folder / "site")
    return folder / "site"


def in_wheel(installed: Path, folder: Path, *command: str) -> subprocess.CompletedProcess[str]:
    # Otherwise pytest would take itself for one of several workers, and measure nothing.
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")}
    environment["PYTHONPATH"] = str(installed)
    return finished([sys.executable, *command], cwd=folder, env=environment)


def test_a_wheel_runs_the_complexity_study_on_a_users_grammar(installed: Path, tmp_path: Path) -> None:
    shutil.copytree(ROOT / "benchmarks" / "generator" / "plain", tmp_path / "mine")
    options = ["--grammar", "mine", "--rooms", "1", "2", "--rounds", "1", "--out", "found"]
    ended = in_wheel(installed, tmp_path, "-m", "vitruvius.cli", "bench", "generator", *options)
    assert ended.returncode == 0, ended.stdout + ended.stderr
    page = (tmp_path / "found" / "generator.md").read_text()
    assert "--grammar mine" in page
    assert "| 2 |" in page
    assert (tmp_path / "found" / "generator.png").stat().st_size


def test_a_wheel_has_the_houses_that_environments_begin_with(installed: Path, tmp_path: Path) -> None:
    code = "import vitruvius.sim.environment.arguments as a; print(a.__file__, len(a.house_list(a.BANK)))"
    ended = in_wheel(installed, tmp_path, "-c", code)
    path, houses = ended.stdout.splitlines()[-1].split()
    assert Path(path).is_relative_to(installed)
    assert houses == "32"


def test_a_wheel_has_the_frozen_banks(installed: Path, tmp_path: Path) -> None:
    code = "from vitruvius.agent.banks import *\n"
    code += "for name in BANKS: print(benchmark_path(name), len(benchmark(name)))"
    ended = in_wheel(installed, tmp_path, "-c", code)
    paths, houses = ended.stdout.split()[::2], ended.stdout.split()[1::2]
    assert len(paths) >= 4
    assert all(Path(path).is_relative_to(installed) for path in paths)
    assert set(houses) == {"256"}
