"""Abilities of an installed wheel without a checkout."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from tests.programs import finished

pytestmark = pytest.mark.second_part("each study is run in small")

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


def files_in(folder: Path) -> set[str]:
    """Return the names of the files in the only wheel of `folder`."""
    [wheel] = folder.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        return {name for name in archive.namelist() if not name.endswith("/")}


def in_wheel(installed: Path, folder: Path, *command: str) -> subprocess.CompletedProcess[str]:
    # Otherwise pytest would take itself for one of several workers, and measure nothing.
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")}
    environment["PYTHONPATH"] = str(installed)
    return finished([sys.executable, *command], cwd=folder, env=environment)


def test_a_wheel_has_one_package_and_says_where_the_studies_are(installed: Path, tmp_path: Path) -> None:
    [package] = [each.name for each in installed.iterdir() if not each.name.endswith(".dist-info")]
    assert package == "vitruvius"
    ended = in_wheel(installed, tmp_path, "-m", "vitruvius.cli", "bench", "generator")
    assert (ended.returncode, len(ended.stderr.splitlines())) == (69, 1)
    assert "a checkout" in ended.stderr


def test_a_wheel_of_an_archive_of_the_sources_is_the_same(installed: Path, tmp_path: Path) -> None:
    build = [sys.executable, "-m", "hatchling", "build", "-d", str(tmp_path), "-t"]
    subprocess.run([*build, "sdist"], cwd=ROOT, check=True, capture_output=True)
    [archive] = tmp_path.glob("*.tar.gz")
    shutil.unpack_archive(archive, tmp_path, filter="data")
    unpacked = tmp_path / archive.name.removesuffix(".tar.gz")
    subprocess.run([*build, "wheel"], cwd=unpacked, check=True, capture_output=True)
    assert files_in(tmp_path) == files_in(installed.parent)  # Python adds files to `installed` as it runs


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
