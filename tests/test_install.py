"""Abilities of an installed wheel without a checkout, with no more than what it asks for."""

import os
import re
import shlex
import shutil
import socket
import subprocess
import sys
import zipfile
from importlib.metadata import distributions
from pathlib import Path

import pytest

from benchmarks.common.installed import packages
from tests.programs import finished

pytestmark = pytest.mark.second_part("a wheel is built and its commands are run")

ROOT = Path(__file__).parents[1]


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


def environment(folder: Path, wheel: Path, extra: str = "") -> Path:
    """Return a new folder with the wheel's package, and with the packages that pip would install for it.

    These are links to those of this environment, so that nothing is fetched.
    """
    shutil.copytree(wheel, folder, ignore=shutil.ignore_patterns("__pycache__"))
    [ours] = distributions(path=[str(wheel)])
    for package in packages(ours, extra).values():
        for part in {file.parts[0] for file in package.files or ()} - {"..", "__pycache__"}:
            if not (folder / part).exists():
                (folder / part).symlink_to(str(package.locate_file(part)))
    return folder


@pytest.fixture(scope="module")
def base(installed: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return an environment without extras."""
    return environment(tmp_path_factory.mktemp("base") / "site", installed)


def alone(site: Path, folder: Path, *command: str) -> subprocess.CompletedProcess[str]:
    """Run Python in a folder with the packages of an environment, and with no others."""
    python = [Path(sys.executable).resolve(), "-S", *command]
    return finished(python, cwd=folder, env=os.environ | {"PYTHONPATH": str(site)})


@pytest.fixture
def own(tmp_path: Path) -> Path:
    """Return a folder of a user whose files have names of ours."""
    (tmp_path / "agent.py").write_text("raise SystemExit('the file of the user')")
    (tmp_path / "sim").mkdir()
    (tmp_path / "sim/__init__.py").write_text("raise SystemExit('the folder of the user')")
    return tmp_path


def test_the_base_runs_the_commands_of_the_first_page_beside_files_of_the_user(base: Path, own: Path) -> None:
    page = (ROOT / "docs/install.md").read_text()
    block = re.search(r"```sh\n(vitruvius generate.*?)```", page, re.DOTALL)
    assert block
    lines = [line.partition("#")[0].split()[1:] for line in block[1].splitlines()]
    assert {line[0] for line in lines} >= {"generate", "check", "explain", "lint", "draw", "watch"}
    for line in lines:
        if line[0] != "watch":
            ended = alone(base, own, "-m", "vitruvius.cli", *line)
            assert ended.returncode == 0, (line, ended.stderr)
    with socket.create_server(("127.0.0.1", 0)) as taken:  # so that watch ends when it would serve its page
        ended = alone(base, own, "-m", "vitruvius.cli", "watch", "--port", str(taken.getsockname()[1]))
        assert (ended.returncode, "is in use" in ended.stderr) == (2, True), ended.stderr


def test_the_extra_sim_makes_environments_without_torch(
    installed: Path, own: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    site = environment(tmp_path_factory.mktemp("sim") / "site", installed, "sim")
    page = (ROOT / "docs/install.md").read_text()
    block = re.search(r"```python\n(import gymnasium.*?)```\n```text\n(.*?)```", page, re.DOTALL)
    assert block
    (own / "first_step.py").write_text(block[1])
    ended = alone(site, own, "first_step.py")
    assert ended.stdout == block[2], ended.stderr
    assert not (site / "torch").exists()


@pytest.mark.parametrize(
    ("extra", "command"),
    [
        ("agent", '-c "import vitruvius.demo, vitruvius.commands.evaluate"'),
        ("pdf", "-m vitruvius.cli draw HOUSES --format pdf"),
        ("export", "-m vitruvius.cli convert HOUSES --to usd --out usd"),
        ("export", "-m vitruvius.cli convert HOUSES --to gltf --out gltf"),
        ("data", "-m vitruvius.cli generate --rooms 1 --count 1 --shard all/1 --out set"),
    ],
)
def test_an_extra_has_the_packages_of_its_part(
    installed: Path, own: Path, tmp_path_factory: pytest.TempPathFactory, extra: str, command: str
) -> None:
    site = environment(tmp_path_factory.mktemp(extra) / "site", installed, extra)
    words = shlex.split(command.replace("HOUSES", str(ROOT / "tests/fixtures/houses.jsonl")))
    ended = alone(site, own, *words)
    assert ended.returncode == 0, ended.stderr


def test_without_its_extra_a_part_of_the_package_names_what_adds_it(base: Path, own: Path) -> None:
    last = alone(base, own, "-c", "import vitruvius.sim").stderr.splitlines()[-1]
    assert last == 'ModuleNotFoundError: vitruvius.sim needs gymnasium: pip install "vitruvius[sim]"'


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
