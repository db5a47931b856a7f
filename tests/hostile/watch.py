"""Effects of an input besides the answer: files, processes, connections, memory."""

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path

Files = dict[str, tuple[int, int, int]]


def files(root: Path, but: Path) -> Files:
    """Return mode, size and time of all files beneath a folder, except for one folder."""
    found = {}
    for folder, names, leaves in os.walk(root):
        for name in (*names, *leaves):
            path = os.path.join(folder, name)
            if not Path(path).is_relative_to(but):
                state = os.lstat(path)
                found[path] = (state.st_mode, state.st_size, state.st_mtime_ns)
    return found


def descendants(ancestor: int) -> set[int]:
    """Return the numbers of all descendants of a process."""
    found, waiting = set[int](), [ancestor]
    while waiting:
        for children in Path(f"/proc/{waiting.pop()}/task").glob("*/children"):
            with suppress(FileNotFoundError, ProcessLookupError):
                waiting += map(int, children.read_text().split())
        found.update(waiting)
    return found


def children_reaped(process: int) -> int:
    """Return the page faults of the children that a process has waited for: 0 without such children."""
    return int(Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[8])


def sockets(process: int) -> int:
    """Return the number of sockets that a process has open."""
    folder, number = f"/proc/{process}/fd", 0
    for descriptor in os.listdir(folder):
        try:
            number += os.readlink(f"{folder}/{descriptor}").startswith("socket:")
        except FileNotFoundError:
            continue
    return number


def peak(process: int) -> int:
    """Return the largest memory that a process had since ``forget_peak``, bytes."""
    for line in Path(f"/proc/{process}/status").read_text().splitlines():
        if line.startswith("VmHWM"):
            return int(line.split()[1]) << 10
    return 0


def forget_peak(process: int) -> None:
    """Restart the measurement of the peak."""
    Path(f"/proc/{process}/clear_refs").write_text("5")


class Ear:
    """Server of this machine that should get no connection."""

    def __init__(self) -> None:
        """Listen on a free port."""
        self.server = socket.create_server(("127.0.0.1", 0))
        self.server.setblocking(False)
        self.port: int = self.server.getsockname()[1]

    def heard(self) -> int:
        """Return the number of connections since the last call."""
        number = 0
        while True:
            try:
                self.server.accept()[0].close()
            except BlockingIOError:
                return number
            number += 1


@dataclass
class Effects:
    """Effects of an input, one line each."""

    found: list[str] = field(default_factory=list)

    def add(self, what: str, number: int) -> None:
        """Add a line if ``number`` is not 0."""
        if number:
            self.found.append(f"{number} {what}")


@contextmanager
def watched(root: Path, out: Path, ear: Ear, process: int) -> Iterator[Effects]:
    """Yield the effects of a block on a folder except ``out``, and what a process starts and opens."""
    effects = Effects()
    before = files(root, out), descendants(process), children_reaped(process), sockets(process)
    yield effects
    after = files(root, out)
    changed = {path for path in before[0].keys() | after.keys() if before[0].get(path) != after.get(path)}
    effects.found += [f"changed {path}" for path in sorted(changed)]
    effects.add("connections", ear.heard())
    if Path(f"/proc/{process}/stat").exists() and os.listdir(f"/proc/{process}/task"):
        left = descendants(process) - before[1]
        effects.add("processes left", len(left))
        effects.add("page faults of processes that ended", children_reaped(process) - before[2])
        effects.add("sockets", sockets(process) - before[3])
