"""Attempts that no rule may achieve in a solver process: by Python, by the C library, by Prolog."""

import ctypes
import os
import resource
import signal
import socket
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from vitruvius.logic.errors import Finding
from vitruvius.logic.language import linter
from vitruvius.logic.workers import confinement
from vitruvius.logic.workers.worker import main

_libc = ctypes.CDLL(None, use_errno=True)


def attempts(folder: Path, port: int, victim: int) -> dict[str, Callable[[], object]]:
    """Return attempts by name. The folder has the files ``kept`` and ``moved``.

    A server listens at the port, and the victim is a waiting process.
    """
    kept, new = folder / "kept", folder / "new"
    return {
        "read a file": kept.read_text,
        "list a folder": lambda: list(folder.iterdir()),
        "write a file": lambda: new.write_text("x"),
        "write over a file": lambda: kept.write_text("x"),
        "make a file without a name": lambda: os.close(os.open(folder, os.O_TMPFILE | os.O_RDWR)),
        "make a folder": (folder / "folder").mkdir,
        "make a link": lambda: (folder / "link").symlink_to(kept),
        "make a FIFO": lambda: os.mkfifo(folder / "fifo"),
        "empty a file": lambda: os.truncate(kept, 0),
        "change a file's mode": lambda: kept.chmod(0o777),
        "change a file's times": lambda: os.utime(kept, (0, 0)),
        "rename a file": lambda: (folder / "moved").rename(folder / "away"),
        "remove a file": kept.unlink,
        "write a file by Prolog": lambda: prolog(f"open('{folder}/prolog',write,S),close(S)"),
        "start a process": start,
        "start a program": lambda: subprocess.run(["/bin/sh", "-c", f": > {folder}/started"], check=True),
        "start a program by Prolog": lambda: (
            prolog(f"shell(': > {folder}/shell',0)"),
            os.stat(folder / "shell"),
        ),
        "start a program by the C library": lambda: done(-_libc.system(f": > {folder}/system".encode())),
        "open a connection": lambda: socket.create_connection(("127.0.0.1", port)).close(),
        "make a socket for the network": lambda: socket.socket(socket.AF_INET, socket.SOCK_DGRAM).close(),
        "make a socket of the machine": lambda: socket.socket(socket.AF_UNIX).close(),
        "make a file in memory": lambda: os.close(os.memfd_create("x")),
        "limit another process": lambda: resource.prlimit(victim, resource.RLIMIT_NOFILE, (9, 9)),
        "trace another process": lambda: done(_libc.ptrace(0x4206, victim, 0, 0)),  # PTRACE_SEIZE
        "signal another process": lambda: os.kill(victim, signal.SIGTERM),
        "signal another process by its thread": lambda: done(_libc.tgkill(victim, victim, signal.SIGTERM)),
        "signal a group of processes": lambda: os.killpg(os.getpgid(victim), signal.SIGTERM),
    }


def start() -> None:
    """Start a process that ends at once."""
    if not os.fork():
        os._exit(0)


def done(result: int) -> None:
    """Raise the error of the C library, if any."""
    if result < 0:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))


def prolog(goal: str) -> None:
    """Run a goal, which must hold."""
    from pyswip import Prolog

    (_,) = Prolog.query(goal)


def tried(folder: Path, port: int, victim: int) -> list[Finding]:
    """Return the attempts, each with its outcome."""
    findings = []
    for name, attempt in attempts(folder, port, victim).items():
        try:
            attempt()
            outcome = "done"
        except Exception as error:
            outcome = str(error)
        findings.append(Finding(outcome, name, 1, 1, ""))
    return findings


if __name__ == "__main__":
    measures, folder, port, victim = sys.argv[1:]
    has = {each: each in measures.split(",") for each in confinement.measures()}
    confinement.measures = lambda: has
    if not has["limits"]:
        confinement.limit = lambda: None
    linter.errors = lambda *_: tried(Path(folder), int(port), int(victim))
    main()
