"""Processes of a study: some run at a time, each on one processor, and the outcome of each is recorded."""

import ctypes
import fcntl
import os
import signal
import subprocess
import sys
import tempfile
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from time import sleep

from benchmarks.common.pages import ROOT
from vitruvius.logic.cluster import Cluster
from vitruvius.logic.errors import MissingProgram, VitruviusError
from vitruvius.logic.files.writing import write_whole

ONE_THREAD = {f"{library}_NUM_THREADS": "1" for library in ("OMP", "MKL", "OPENBLAS")}
"""Environment of a process whose libraries use one thread each."""

CLI = (sys.executable, "-P", "-m", "vitruvius.cli")


class StudyFailed(VitruviusError):
    """A part of the study that the rest depends on failed."""

    exit_code = 1


@dataclass(frozen=True)
class Job:
    """A process of the study: its command, and the folder for its outcome."""

    name: str
    command: tuple[str, ...]
    folder: Path

    def start(self, processor: int, orphaned: int = signal.SIGTERM) -> subprocess.Popen[bytes]:
        """Start the process on one processor, with its output in a file.

        It gets a signal when its parent ends.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        failure(self.folder).unlink(missing_ok=True)
        with (self.folder / "log.txt").open("wb") as log:
            return subprocess.Popen(
                self.command,
                stdout=log,
                stderr=log,
                stdin=subprocess.DEVNULL,
                cwd=ROOT,
                env=os.environ | ONE_THREAD,
                preexec_fn=partial(_keep_to, processor, orphaned),  # noqa: PLW1509 (no threads are at work here)
            )

    def run(self) -> int:
        """Run the process to its end on a processor that no other job here has. Return its exit code.

        Raises ``MissingProgram`` on a machine that does not share the checkout or the job's folder.
        """
        if not self.folder.is_dir():
            raise MissingProgram(f"{self.folder}: is not there: all nodes must share it, and the checkout")
        with own_processor() as processor:
            # At once, or a task that is repeated instead of a lost one finds it still at work.
            process = self.start(processor, orphaned=signal.SIGKILL)
            try:
                return process.wait()
            finally:
                process.terminate()

    def end(self, code: int) -> None:
        """Print the outcome, and record a failure."""
        words = "done"
        if code:
            lines = (self.folder / "log.txt").read_text(errors="replace").strip().splitlines()
            last = lines[-1] if lines else "it printed nothing"
            words = f"failed, exit code {code}: {last}" if code > 0 else f"failed, ended by signal {-code}"
            write_whole(failure(self.folder), words.encode())
        say(f"{self.name}: {words}")


def run_all(jobs: Iterable[Job], workers: int, cluster: Cluster | None = None) -> None:
    """Run jobs, ``workers`` at a time, each on its own processor as long as there are enough.

    With a cluster, jobs are tasks, as many at a time as the cluster can take.
    """
    if cluster:
        waiting = list(jobs)
        for job in waiting:
            job.folder.mkdir(parents=True, exist_ok=True)
        for place, code in cluster.each(Job.run, waiting):
            waiting[place].end(code)
        return
    processors = sorted(os.sched_getaffinity(0))
    free = [processors[number % len(processors)] for number in range(workers)]
    waiting, running = deque(jobs), dict[subprocess.Popen[bytes], tuple[Job, int]]()
    try:
        while waiting or running:
            while waiting and free:
                job, processor = waiting.popleft(), free.pop(0)
                say(f"{job.name}: started, {len(waiting)} waiting")
                running[job.start(processor)] = job, processor
            sleep(0.5)
            for process in [each for each in running if each.poll() is not None]:
                job, processor = running.pop(process)
                free.append(processor)
                job.end(process.returncode)
    finally:
        for process in running:
            process.terminate()
        for process in running:
            process.wait()


@contextmanager
def own_processor() -> Iterator[int]:
    """Reserve a processor of this machine that no other block here has, if there are enough."""
    processors = sorted(os.sched_getaffinity(0))
    for processor in processors:
        with Path(tempfile.gettempdir(), f"vitruvius-{os.getuid()}-processor-{processor}").open("w") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)  # released when the process ends
            except BlockingIOError:
                continue
            yield processor
            return
    yield processors[0]


def failure(folder: Path) -> Path:
    """Return the file with the reason why the last try failed."""
    return folder / "failed.txt"


def why(folder: Path) -> str:
    """Return the reason why the last try failed, or an empty text."""
    note = failure(folder)
    return note.read_text() if note.exists() else ""


def say(text: str) -> None:
    """Print a line with the time on standard error."""
    print(f"{datetime.now(UTC):%H:%M:%S} {text}", file=sys.stderr, flush=True)


def output(command: Sequence[str], **environment: str) -> str:
    """Return the output of a process with these additional variables.

    Raises ``StudyFailed`` if the process fails.
    """
    done = subprocess.run(
        command, stdout=subprocess.PIPE, env=os.environ | environment, text=True, check=False
    )
    if done.returncode:
        raise StudyFailed(f"{' '.join(command)}: exit code {done.returncode}, see above. Start again")
    return done.stdout


LIBC = ctypes.CDLL(None)


def _keep_to(processor: int, orphaned: int) -> None:
    """Keep a new process on one processor, or Taichi's workers share it, and end it with the study."""
    os.sched_setaffinity(0, {processor})
    LIBC.prctl(1, orphaned)  # PR_SET_PDEATHSIG
