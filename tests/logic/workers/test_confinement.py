"""A solver process can only solve: other attempts of its code are refused and leave no trace."""

import json
import os
import re
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import msgspec
import pytest

from tests.logic.workers import attempts
from tests.logic.workers.test_generate import children
from vitruvius.cli import main
from vitruvius.logic import generate
from vitruvius.logic.workers import confinement
from vitruvius.logic.workers.messages import Open

ROOT = Path(__file__).parents[3]
CONFINED = pytest.mark.skipif(not all(confinement.measures().values()), reason="this kernel confines less")


class Scene:
    """Targets of attempts: two files in a folder, a waiting process, and a server."""

    def __init__(self, folder: Path, victim: subprocess.Popen, server: socket.socket) -> None:
        (folder / "kept").write_text("kept\n")
        (folder / "moved").write_text("moved\n")
        self._folder, self._victim, self._server = folder, victim, server
        self._before = self._files()

    def tried(self, *measures: str) -> tuple[set[str], set[str]]:
        """Return the attempts that succeed in a solver process under these measures, and those that fail."""
        server, victim = str(self._server.getsockname()[1]), str(self._victim.pid)
        worker = subprocess.Popen(
            [sys.executable, "-m", attempts.__name__, ",".join(measures), self._folder, server, victim],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            cwd=ROOT,
            text=True,
            start_new_session=True,  # The process ends with its group.
        )
        assert worker.stdin
        assert worker.stdout
        worker.stdin.write(
            msgspec.json.encode(Open(grammar="family", errors=True, seconds=9)).decode() + "\n"
        )
        worker.stdin.flush()
        found = json.loads(worker.stdout.readline())["findings"]
        worker.communicate()
        done = {each["file"] for each in found if each["severity"] == "done"}
        return done, {each["file"] for each in found} - done

    def effects(self) -> set[str]:
        """Return the effects on the targets."""
        effects = {name for name, file in self._files().items() if self._before.get(name) != file}
        effects |= self._before.keys() - self._files().keys()
        self._server.setblocking(False)
        with suppress(BlockingIOError):
            self._server.accept()[0].close()
            effects.add("connection")
        if not self._sleeps():
            effects.add("signal")
        return effects

    def _sleeps(self) -> bool:
        """Return True if the victim sleeps and has no pending signal."""
        status = Path(f"/proc/{self._victim.pid}/status").read_text()
        pending = re.findall(r"^(?:Sig|Shd)Pnd:\s+(\w+)", status, re.M)
        return "State:\tS" in status and not any(int(signals, 16) for signals in pending)

    def _files(self) -> dict[str, tuple[object, ...]]:
        return {
            file.name: (file.lstat().st_mode, file.lstat().st_mtime_ns, file.is_file() and file.read_text())
            for file in self._folder.iterdir()
        }


@pytest.fixture
def scene(tmp_path: Path) -> Iterator[Scene]:
    with (
        socket.create_server(("127.0.0.1", 0)) as server,
        subprocess.Popen(["sleep", "600"], start_new_session=True) as victim,
    ):
        yield Scene(tmp_path, victim, server)
        victim.kill()


@CONFINED
def test_a_solver_process_writes_starts_connects_signals_and_reads_nothing(scene: Scene) -> None:
    assert scene.tried("limits", "seccomp", "landlock")[0] == set()
    assert scene.effects() == set()


@CONFINED
def test_system_calls_alone_leave_no_more_than_reading(scene: Scene) -> None:
    assert scene.tried("seccomp")[0] == {"read a file", "list a folder"}
    assert scene.effects() == set()


@CONFINED
def test_landlock_alone_keeps_files_programs_and_connections(scene: Scene) -> None:
    done, refused = scene.tried("landlock")
    kept = {name for name in done | refused if "file" in name or "folder" in name or "program" in name}
    assert kept - refused == {"change a file's mode", "change a file's times", "make a file in memory"}
    assert "open a connection" in refused


def test_unconfined_these_attempts_succeed(scene: Scene) -> None:
    """The confinement is therefore the reason for the refusals in the other tests."""
    _, refused = scene.tried()
    # The first depends on the file system, the second on permissions to trace.
    assert refused <= {"make a file without a name", "trace another process"}
    assert {"new", "kept", "moved", "shell", "started", "connection", "signal"} < scene.effects()


@CONFINED
def test_the_solvers_of_generate_are_confined() -> None:
    before = set(children(os.getpid()))
    next(generate(rooms=1, cell=0.36))
    (worker,) = set(children(os.getpid())) - before
    status = dict(line.split(":\t", 1) for line in Path(f"/proc/{worker}/status").read_text().splitlines())
    assert (status["NoNewPrivs"], status["Seccomp"]) == ("1", "2")
    limits = Path(f"/proc/{worker}/limits").read_text()
    assert re.search(rf"Max address space +{confinement.MEMORY} ", limits)
    assert re.search(r"Max file size +0 +0 ", limits)
    assert re.search(r"Max core file size +0 +0 ", limits)
    assert re.search(r"Max cpu time +\d+ ", limits)


def test_what_a_kernel_lacks_is_said_by_the_version(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for has in (False, True):
        monkeypatch.setattr(confinement, "measures", lambda has=has: {"limits": True, "seccomp": has})
        with pytest.raises(SystemExit):
            main(["--version"])
    first, second = capsys.readouterr().out.strip().split("\nvitruvius ")
    assert "under limits; this system lacks seccomp: see SECURITY.md" in first
    assert "under limits, seccomp" in second
    assert "lacks" not in second


def test_a_measure_that_fails_is_an_error_and_no_house(monkeypatch: pytest.MonkeyPatch) -> None:
    """The process must not run with less confinement than stated."""
    measures = dict.fromkeys(confinement.measures(), True)
    monkeypatch.setattr(confinement, "measures", lambda: measures)
    monkeypatch.setattr(confinement._libc, "prctl", lambda *_: -1)
    with pytest.raises(OSError, match="cannot be confined"):
        confinement.confine([])
