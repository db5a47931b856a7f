"""Shards as tasks of Ray: the set is the same as without Ray, whatever is lost or stopped on the way."""

import os
import pickle
import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.logic.dataset.sets import command, content
from tests.programs import PATIENCE, finished
from vitruvius.logic import cluster
from vitruvius.logic.errors import GrammarError, MissingProgram, Reason, Unsatisfiable, to_record
from vitruvius.logic.installation import install_command

ROOT = Path(__file__).parents[3]

MARK = "VITRUVIUS_TEST_ENGINE"

LOCAL = re.compile(r"^vitruvius (generate .+) --engine ray --workers 2 --out homes$", re.MULTILINE)
"""Command of docs/scale.md that generates a set by Ray on one machine."""

[COMMAND] = LOCAL.findall((ROOT / "docs" / "scale.md").read_text())
ALL = COMMAND.split()

TASKS = """
import importlib, os, sys, threading, time, warnings
from pathlib import Path
from benchmarks.common.pages import machine
from benchmarks.paper.complexity import StudyCell, measured
from vitruvius.logic import cluster
from vitruvius.logic.grammar import find

warnings.showwarning = lambda message, *_: print(message)
cluster.MAX_RETRIES = 1
with cluster.connected(sys.argv[1]) as nodes:
    print(nodes.map(abs, range(-40, 0)) == [*range(40, 0, -1)])
    nodes.map(warnings.warn, ["twice"] * 2)
    began = time.monotonic()
    [*nodes.each(time.sleep, [0.5, 0.5], alone=True)]
    print(time.monotonic() - began >= 1)
    [cell] = nodes.map(measured, [StudyCell("ours", 1, 1, 10**8)])
    print(cell["made"] == 1 and cell["machine"] == machine())
    for function, item in (
        (find, "nobodys"),
        (Path.read_bytes, Path("/nowhere")),
        (importlib.import_module, "nothing"),
        (threading.Semaphore, 1),
        (os._exit, 1),
    ):
        try:
            nodes.map(function, [item])
        except Exception as error:
            print(f"{type(error).__name__}: {error}")
"""
"""Tasks that fail in each way."""

ONCE = """
import os, pathlib, signal, sys
first = pathlib.Path(sys.argv[1], "first")
if first.exists():
    there = pathlib.Path("/proc", first.read_text(), "stat")
    print(there.exists() and ") Z " not in there.read_text(), len(os.sched_getaffinity(0)))
else:
    first.write_text(str(os.getpid()))
    os.kill(os.getppid(), signal.SIGKILL)
    signal.pause()
"""
"""Program that kills its parent; a second process then prints if the parent exists, and its processors."""

STUDY = """
import sys
from pathlib import Path
from vitruvius.agent.evaluation import protocol
from vitruvius.agent.evaluation.scores import modes_of
from benchmarks.common.processes import Job, run_all
from vitruvius.logic import cluster
from tests.logic.dataset.test_engine import ONCE
from tests.sample_houses import random_house

folder, houses = Path(sys.argv[2]), [random_house(seed) for seed in range(3)]
scripts = {"once": ONCE, "wrong": "raise SystemExit('no good')"}
jobs = [
    Job(name, (sys.executable, "-c", script, str(folder / name)), folder / name)
    for name, script in scripts.items()
]
how = {"modes": ("main",), "baselines": ("script", "oracle"), "episodes": 2}
protocol.PART_HOUSES = 2
with cluster.connected(sys.argv[1]) as nodes:
    alone, tasks = (modes_of(protocol.measure({}, houses, **how, cluster=each)) for each in (None, nodes))
    print(alone == tasks)
    run_all(jobs, 1, nodes)
print((folder / "once" / "log.txt").read_text(), (folder / "wrong" / "failed.txt").read_text(), sep="")
"""
"""An evaluation, and jobs of a study."""


def start(folder: Path, *words: str) -> subprocess.Popen[str]:
    """Start the command in a session of its own. All processes that it starts have its folder in ``MARK``."""
    return subprocess.Popen(
        [sys.executable, "-m", "vitruvius.cli", *ALL, "--out", str(folder), *words],
        cwd=ROOT,
        env=os.environ | {MARK: str(folder)},
        start_new_session=True,
        stderr=subprocess.PIPE,
        text=True,
    )


def started_for(folder: Path) -> dict[int, str]:
    """Return the processes that have a folder in their environment, with their commands."""
    found = {}
    for process in Path("/proc").glob("[0-9]*"):
        try:
            if f"{MARK}={folder}".encode() in (process / "environ").read_bytes().split(b"\0"):
                found[int(process.name)] = (process / "cmdline").read_text()
        except OSError:  # it has ended
            continue
    return found


def left_of(folder: Path) -> list[str]:
    """Return the commands of processes that still run after some seconds."""
    end = time.monotonic() + 10
    while (found := started_for(folder)) and time.monotonic() < end:
        time.sleep(0.1)
    return [*found.values()]


def wait(process: subprocess.Popen[str], until: Callable[[], bool]) -> None:
    """Wait until a condition of a running command holds."""
    end = time.monotonic() + PATIENCE
    while not until():
        assert process.poll() is None, process.communicate()[1]
        assert time.monotonic() < end
        time.sleep(0.02)


def shards_of(folder: Path) -> list[Path]:
    return [*folder.glob("data/t*")]


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Generate the set without an engine."""
    folder = tmp_path_factory.mktemp("plain") / "set"
    assert command(*ALL, "--out", folder) == 0
    return folder


@pytest.fixture(scope="module")
def nodes() -> Iterator[Any]:
    """Yield a cluster of one node with two processors, to which other nodes can be added."""
    pytest.importorskip("ray")
    from ray.cluster_utils import Cluster

    soon = {"health_check_initial_delay_ms": 0, "health_check_period_ms": 300, "health_check_timeout_ms": 300}
    head = {"num_cpus": 2, "object_store_memory": cluster.STORE, "_system_config": soon}
    found = Cluster(initialize_head=True, head_node_args=head | {"include_dashboard": False})
    yield found
    found.shutdown()


@pytest.mark.second_part("Ray is started, on two nodes")
@pytest.mark.skipif(sys.platform != "linux", reason="looks for processes in /proc")
def test_a_node_that_is_killed_is_made_up_for_by_the_others(nodes: Any, plain: Path, tmp_path: Path) -> None:
    """The test kills the node's raylet and all processes there.

    The set has each row once and the same bytes.
    """
    folder, there = tmp_path / "set", tmp_path / "lost"
    node = nodes.add_node(num_cpus=1, object_store_memory=cluster.STORE, env_vars={MARK: str(there)})
    process = start(folder, "--engine", "ray", "--address", nodes.address)
    wait(process, lambda: len(shards_of(folder)) >= 3)
    wait(process, lambda: any("_called" in each for each in started_for(there).values()))
    for each in started_for(there):
        os.kill(each, signal.SIGKILL)
    nodes.remove_node(node, allow_graceful=False)
    said = process.communicate(timeout=PATIENCE)[1]
    assert process.returncode == 0, said
    *lost, last = said.splitlines()
    assert last == f"{folder}: 15 shards made. The set is complete: 300 houses, 0 limits."
    assert all(line.startswith("Ray: ") for line in lost), said
    assert content(folder) == content(plain)


@pytest.mark.second_part("Ray is started")
def test_what_goes_wrong_in_tasks_is_raised_here_with_the_node_that_is_at_fault(
    nodes: Any, tmp_path: Path
) -> None:
    (tmp_path / "logic.py").write_text("raise ImportError('a file in the current folder')\n")
    ended = finished([sys.executable, "-P", "-c", TASKS, nodes.address], cwd=tmp_path)
    where = f"(node {nodes.head_node.node_ip_address})"
    right, warned, alone, cell, grammar, file, module, result, lost = ended.stdout.splitlines()
    assert (right, warned, alone, cell) == ("True", "twice", "True", "True")
    assert grammar.startswith("GrammarError: ")
    assert file == f"FileNotFoundError: [Errno 2] No such file or directory: '/nowhere {where}'"
    assert module == f"MissingProgram: No module named 'nothing' {where}"
    why = "TypeError: cannot pickle '_thread.lock' object: see docs/scale.md"
    assert result == f"MissingProgram: a node cannot run a task or return its result: {why}"
    assert lost.startswith("Killed: the process or node of a task was lost 2 times: ")
    assert {line.partition(":")[0] for line in ended.stderr.splitlines()} == {"Ray"}


@pytest.mark.second_part("Ray is started")
@pytest.mark.skipif(sys.platform != "linux", reason="looks for processes in /proc")
def test_evaluations_and_jobs_of_studies_are_tasks_with_the_same_results(nodes: Any, tmp_path: Path) -> None:
    """A job ends with the process of its task, and is started again."""
    ended = finished([sys.executable, "-c", STUDY, nodes.address, str(tmp_path)], cwd=ROOT)
    assert ended.stdout.splitlines() == ["True", "False 1", "failed, exit code 1: no good"], ended.stderr


@pytest.mark.second_part("Ray is started")
@pytest.mark.skipif(sys.platform != "linux", reason="looks for processes in /proc")
def test_ctrl_c_keeps_what_is_done_and_ends_all_that_was_started(plain: Path, tmp_path: Path) -> None:
    pytest.importorskip("ray")
    folder = tmp_path / "set"
    process = start(folder, "--engine", "ray", "--workers", "1")  # so that seconds are left for the signal
    wait(process, lambda: len(shards_of(folder)) >= 1)
    os.killpg(process.pid, signal.SIGINT)
    assert process.communicate(timeout=PATIENCE)[1] == "interrupted\n"
    assert process.returncode == 130
    assert left_of(folder) == []
    done = {path: path.stat().st_mtime_ns for path in shards_of(folder)}
    assert len(done) < 15
    assert command(*ALL, "--out", folder) == 0
    assert content(folder) == content(plain)
    assert done == {path: path.stat().st_mtime_ns for path in done}


WRONG = {
    "--engine ray --address ray://127.0.0.1:10001": (2, ": name a Ray cluster as HOST:PORT, or auto for"),
    "--engine ray --workers 0": (2, "workers must be a whole number, 1 or more, not 0"),
    "--address auto": (2, "--address needs --engine ray: add it"),
    "--engine ray --address 127.0.0.1:{closed}": (69, "cannot connect to a Ray cluster: Connection refused"),
    "--engine ray --address a..b:6379": (69, "--address a..b:6379: cannot connect to a Ray cluster: "),
    f"--engine ray --address {64 * 'a'}:6379": (69, "a:6379: cannot connect to a Ray cluster: "),
    "--engine ray --address 127.0.0.1:{silent}": (
        69,
        "cannot connect to a Ray cluster: none answered in 1 s",
    ),
}


@pytest.mark.parametrize("words", WRONG)
def test_what_is_no_engine_is_one_line_before_anything_is_written(
    words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("ray")
    monkeypatch.setattr(cluster, "ANSWERS", 1.0)
    with socket.create_server(("127.0.0.1", 0)) as silent, socket.create_server(("127.0.0.1", 0)) as closed:
        ports = {"silent": silent.getsockname()[1], "closed": closed.getsockname()[1]}
        closed.close()
        code, line = WRONG[words]
        assert command(*ALL, "--out", tmp_path / "set", *words.format(**ports).split()) == code
    assert line in (said := capsys.readouterr().err)
    assert said.count("\n") == 1
    assert not (tmp_path / "set").exists()


def test_a_probe_that_fails_and_says_nothing_is_no_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("ray")
    monkeypatch.setattr(cluster, "TRY", "raise SystemExit(3)")
    says = r"cannot connect to a Ray cluster: exit code 3$"
    with pytest.raises(MissingProgram, match=says), cluster.connected("auto"):
        pass


def test_without_ray_it_is_said_how_to_install_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "ray", None)
    assert command(*ALL, "--out", tmp_path / "set", "--engine", "ray") == 69
    said = f"error: vitruvius generate needs ray: {install_command('cluster')}\n"
    assert capsys.readouterr().err == said


def test_errors_cross_processes_whole() -> None:
    for error in (
        GrammarError("no such rule", "rooms.lp", 8, 1),
        Unsatisfiable(
            "family", "4 rooms", (Reason("a :- b.", "rooms.lp", 8, 1),), "Try --rooms 5", ("bath",)
        ),
    ):
        again = pickle.loads(pickle.dumps(error))
        assert (str(again), to_record(again)) == (str(error), to_record(error))


LISTENING = """
import contextlib, os, sys
from pathlib import Path
from vitruvius.logic import cluster
from tests.hostile.watch import descendants

with cluster.connected(workers=1):
    sockets = set()
    for each in (os.getpid(), *descendants(os.getpid())):
        with contextlib.suppress(OSError):  # of a process that has ended
            for descriptor in os.listdir(f"/proc/{each}/fd"):
                with contextlib.suppress(FileNotFoundError):
                    sockets.add(os.readlink(f"/proc/{each}/fd/{descriptor}"))
    tables = "".join(Path("/proc/net", name).read_text() for name in ("tcp", "tcp6"))
    table = [line.split() for line in tables.splitlines()]
    print(*(line[1] for line in table if line[3] == "0A" and f"socket:[{line[9]}]" in sockets))
"""
"""Program that starts Ray and prints the addresses on which its processes listen."""


@pytest.mark.second_part("Ray is started")
def test_a_cluster_here_listens_on_the_loopback_interface_alone() -> None:
    """The test uses a process of its own, since another test may have left Ray's sockets in this one."""
    ended = subprocess.run(
        [sys.executable, "-c", LISTENING], cwd=ROOT, capture_output=True, text=True, check=True, timeout=300
    )
    listening = ended.stdout.splitlines()[-1].split()
    assert listening
    assert all(address.partition(":")[0].endswith("0100007F") for address in listening), listening
