"""Claims about machines that lack a home or open streams, as containers do."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.programs import PATIENCE, finished
from vitruvius.logic import RequestError, generate, load, save
from vitruvius.logic.dataset.splits import TEST
from vitruvius.logic.grammar import SHIPPED
from vitruvius.logic.request.counts import whole
from vitruvius.logic.request.house_request import HouseRequest

pytestmark = pytest.mark.second_part("processes of their own without a home, files, streams, memory")

STEP = """
import numpy as np
from vitruvius import sim
from vitruvius.sim import tracing
envs = sim.HouseVectorEnv(num_envs=2)
envs.reset(seed=0)
print(envs.step(np.array([2, 2]))[0].shape, tracing.KEEPS_KERNELS)
"""

START = """
import numpy as np
from vitruvius.sim import runtime, tracing
runtime.start()
print(runtime.constants(np.ones(3, np.float32)).to_numpy().sum(), tracing.KEEPS_KERNELS)
"""
"""Smallest program that compiles a kernel. The simulator's own kernels take ten times as long."""

HOMES = {
    "no home": {},
    "a home that is no folder": {"HOME": "/dev/null"},
    "a home where nothing can be made": {"HOME": "/proc"},
    "a cache where nothing can be made": {"XDG_CACHE_HOME": "/proc/cache"},
}


@pytest.mark.parametrize("name", HOMES)
@pytest.mark.skipif(not Path("/proc/self").exists(), reason="a folder in which nobody can write")
def test_the_simulator_runs_without_a_home_that_can_be_written(name: str, tmp_path: Path) -> None:
    plain = {key: value for key, value in os.environ.items() if key not in {"HOME", "XDG_CACHE_HOME"}}
    environment = plain | {"TMPDIR": str(tmp_path)} | HOMES[name]
    program, shown = (STEP, "(2, 40, 2)") if name == "no home" else (START, "3.0")
    made = finished([sys.executable, "-c", program], env=environment)
    assert (made.returncode, made.stdout) == (0, f"{shown} True\n"), made.stderr
    assert any(tmp_path.rglob("*.lock")) or any(tmp_path.rglob("ticache"))


NOTHING_WRITTEN = {
    "neither cache nor temporary files": ({"HOME": "/proc"}, False),
    "a cache that only looks as if": ({}, False),
}


@pytest.mark.parametrize("name", NOTHING_WRITTEN)
@pytest.mark.skipif(not Path("/proc/self").exists(), reason="a folder in which nobody can write")
def test_the_simulator_runs_where_no_file_can_be_written(name: str, tmp_path: Path) -> None:
    """Examples are a container with read-only file systems, and a full disk."""
    own, keeps = NOTHING_WRITTEN[name]
    environment = os.environ | {"HOME": str(tmp_path)} | own
    environment.pop("XDG_CACHE_HOME", None)
    made = finished(["bash", "-c", 'ulimit -f 0; exec "$0" -c "$1"', sys.executable, START], env=environment)
    assert (made.returncode, made.stdout) == (0, f"3.0 {keeps}\n"), made.stderr


def command(words: str, streams: str, folder: Path) -> tuple[int, str]:
    """Run a command with streams as in a shell; return its exit code and its stderr."""
    line = f'exec "$0" -m vitruvius.cli {words} {streams}'
    made = finished(["bash", "-c", line, sys.executable], cwd=folder)
    return made.returncode, made.stderr


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("machine")
    save(generate(rooms=1), made / "houses.jsonl")
    return made


CLOSED = {
    "generate --rooms 1 --out new.jsonl": (">&-", 0),
    "generate --rooms 1": (">&-", 5),
    "check houses.jsonl": ("<&- 2>&-", 0),
    "check houses.jsonl --json": (">&- <&-", 5),
    "help check": (">&- 2>&-", 5),
}


@pytest.mark.parametrize("words", CLOSED)
def test_a_closed_stream_is_an_error_where_an_answer_is_lost(words: str, folder: Path) -> None:
    streams, expected = CLOSED[words]
    code, said = command(words, streams, folder)
    assert code == expected
    if code and "2>" not in streams:
        assert said == "error: the standard output: it is closed\n"
    if "new.jsonl" in words:
        assert load(folder / "new.jsonl") == load(folder / "houses.jsonl")


@pytest.mark.parametrize("words", ["generate --rooms 1", "check houses.jsonl --json", "--version"])
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device that is always full")
def test_an_output_that_is_full_is_one_line(words: str, folder: Path) -> None:
    code, said = command(words, ">/dev/full", folder)
    assert code == 5
    assert said == "error: the standard output: No space left on device\n"


@pytest.mark.parametrize(
    ("words", "code"), [("check houses.jsonl", 0), ("check absent.jsonl --json >/dev/full", 5), ("chek", 2)]
)
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device that is always full")
def test_an_error_output_that_is_full_changes_no_exit_code(words: str, code: int, folder: Path) -> None:
    assert command(words, "2>/dev/full", folder) == (code, "")


def test_a_reader_that_ends_early_is_no_error(folder: Path) -> None:
    assert command("rules", "| head -1 >&2; exit ${PIPESTATUS[0]}", folder)[1] == "# The rules of a grammar\n"


SCARCE = {
    "no folder": ("mkdir gone; cd gone; rmdir ../gone", 5, "the current folder was deleted"),
    "few files": (
        "ulimit -n 13",
        4,
        "13 files may be open at once, the solvers need 16: raise it by ulimit -n",
    ),
    "no files": ("ulimit -n 6", 4, "a solver process cannot be started: Too many open files"),
}


@pytest.mark.parametrize("name", SCARCE)
def test_what_a_shell_lacks_is_said_and_no_rule_is_blamed(name: str, folder: Path) -> None:
    shell, code, reason = SCARCE[name]
    line = f'{shell}; exec "$0" -m vitruvius.cli generate --rooms 1'
    made = finished(
        ["bash", "-c", line, sys.executable],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(Path(__file__).parents[1])},
    )
    assert (made.returncode, made.stderr.count("\n")) == (code, 1), made.stderr
    assert made.stderr.startswith(f"error: {reason}")


def test_too_little_memory_is_no_fault_of_ours(folder: Path) -> None:
    line = 'ulimit -v 1500000; exec "$0" -m vitruvius.cli evaluate pqn'
    made = finished(["bash", "-c", line, sys.executable], cwd=folder)
    assert made.returncode == 4
    assert made.stderr.startswith("error: out of memory (this machine, or ulimit -v): ")
    assert made.stderr.count("\n") == 1


BOUNDED = """
import resource
from vitruvius.logic.workers import confinement
resource.setrlimit(resource.RLIMIT_CPU, (50, 50))
confinement.allow_seconds(100)
print(resource.getrlimit(resource.RLIMIT_CPU))
try:
    confinement.require_seconds()
except confinement.LimitReached as error:
    print(error)
"""


def test_a_bound_of_processor_time_is_no_rules_fault() -> None:
    made = subprocess.run([sys.executable, "-c", BOUNDED], capture_output=True, text=True, check=True)
    assert made.stdout.startswith("(50, 50)\na solver process has 50 s of processor time here")


ASCII = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
"""Environment in which Python takes names of files and its output for ASCII."""


def test_names_are_read_and_written_without_a_locale(folder: Path) -> None:
    shutil.copytree(SHIPPED / "family", folder / "Küche")
    words = ["generate", "--grammar", "Küche", "--rooms", "1", "--out", "Häuser.jsonl"]
    made = subprocess.run(
        [sys.executable, "-m", "vitruvius.cli", *words],
        cwd=folder,
        env=os.environ | ASCII,
        capture_output=True,
        timeout=PATIENCE,
        check=False,
    )
    assert made.stderr.decode() == "Häuser.jsonl: 1 made. Next: vitruvius draw Häuser.jsonl\n"
    assert len(load(folder / "Häuser.jsonl")) == 1


def test_names_that_are_no_utf_8_are_said_and_answered(folder: Path) -> None:
    name = b"K\xfcche"
    shutil.copytree(SHIPPED / "family", os.fsdecode(os.fsencode(folder) + b"/" + name))
    for words in (["check", name + b".jsonl"], ["generate", "--rooms", "4", "--grammar", name]):
        made = subprocess.run(
            [sys.executable, "-m", "vitruvius.cli", *words, "--json"],
            cwd=folder,
            capture_output=True,
            timeout=PATIENCE,
            check=False,
        )
        assert made.returncode == 5, made.stderr
        assert b"K\\udcfcche" in made.stderr
        assert "dcfcche" in str(json.loads(made.stdout)["error"])


def test_numbers_of_numpy_are_numbers() -> None:
    ours = list(generate(rooms=2, types={"bedroom": 1}, furniture={"bed": (1, 2)}, seed=3, count=2, start=1))
    asked: dict[str, Any] = {
        "rooms": np.int64(2),
        "types": {"bedroom": np.uint8(1)},
        "furniture": {"bed": (np.int32(1), np.int16(2))},
        "seed": np.uint64(3),
        "count": np.int32(2),
        "start": np.int8(1),
        "inferences": np.int64(10**8),
        "seconds": np.float32(60),
    }
    theirs = generate(**asked)
    assert [house.rooms for house in theirs] == [house.rooms for house in ours]


@pytest.mark.parametrize(
    ("asked", "reason"),
    [
        ({"rooms": 2.0}, r"rooms must be a whole number, 1 or more, not 2\.0"),
        ({"rooms": np.float64(2)}, "rooms must be a whole number, 1 or more, not"),
        ({"rooms": True}, "rooms must be a whole number, 1 or more, not True"),
        ({"rooms": 129}, "rooms must be at most 128, not 129"),
        ({"rooms": 2, "seed": 2**31}, "seed must be at most 2147483647, not 2147483648"),
        ({"rooms": 2, "seed": -1}, "seed must be a whole number, 0 or more, not -1"),
        (
            {"rooms": 2, "start": 2**31 - 1, "count": 2},
            "the index of the last house must be at most 2147483647",
        ),
    ],
)
def test_a_number_that_is_refused_is_told_the_bound_that_it_breaks(asked: dict, reason: str) -> None:
    with pytest.raises(RequestError, match=reason):
        generate(**asked)


def test_every_seed_of_the_banks_is_one_that_the_generator_takes() -> None:
    assert whole("seed", TEST.stop - 1, 0) == TEST.stop - 1
    assert HouseRequest.read({"rooms": 1, "types": {"bedroom": np.int64(1)}}).to_dict()["types"] == {
        "bedroom": 1
    }
