"""``vitruvius bench peers``: steps per second of other simulators, each in its own Python environment."""

import json
import os
import shutil
import signal
import subprocess
import time
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

from benchmarks.common.pages import ROOT, machine
from benchmarks.common.processes import say
from vitruvius.logic.errors import MissingProgram, RequestError
from vitruvius.logic.files.writing import write_whole
from vitruvius.logic.spelling import unknown

HERE = Path(__file__).resolve().parent
PEERS = {
    "VMAS": "vmas_house.py",
    "JaxNav": "jaxnav.py",
    "NAVIX": "navix_rooms.py",
    "XLand-MiniGrid": "xland_rooms.py",
    "MiniGrid": "minigrid_rooms.py",
    "IR-SIM": "irsim_house.py",
}


@dataclass(frozen=True)
class Peers:
    """Measure steps per second of other simulators; uv installs pinned packages (3 GB to download once)."""

    file: Path = Path("runs/bench/peers.json")
    """File for ``rows``, one for each peer, way to run it and number of environments (``rounds.py`` explains
    a row), and for ``failures``: the peers that could not be installed or measured, with the reasons."""

    processors: int | None = None
    """Number of processors that a peer may use; by default all."""

    only: tuple[str, ...] = tuple(PEERS)
    """Peers to measure."""

    limit: float = 900
    """Seconds for measuring a peer, and twice as many for installing it."""

    rounds: int = 7
    """Number of timed rounds of a row, at least 5."""

    seconds: float = 1.0
    """Shortest time of a round, in seconds."""

    most: int = 10**9
    """Largest number of environments."""

    def run(self) -> int:
        """Measure the peers one after the other. Return 1 if a peer failed."""
        return 1 if self.measured()["failures"] else 0

    def measured(self) -> dict[str, Any]:
        """Measure the peers, and return the contents of the file. Raises ``MissingProgram`` without uv."""
        allowed = sorted(os.sched_getaffinity(0))
        count = self.processors or len(allowed)
        if wrong := set(self.only) - set(PEERS):
            raise RequestError(f"--only: {unknown('peer', min(wrong), PEERS)}")
        if self.rounds < 5 or not 0 < count <= len(allowed):
            raise RequestError(f"--rounds must be 5 or more, --processors 1 to {len(allowed)}")
        uv = shutil.which("uv") or shutil.which("uv", path=ROOT / ".local/uv/bin")
        if not uv:
            raise MissingProgram(
                "uv is missing: ./run leaves one in .local/uv/bin, or see https://docs.astral.sh/uv"
            )
        chosen = allowed[-count:]  # the first processor serves most interrupts
        rows, failures = [], []
        for peer in self.only:
            script, began = str(HERE / PEERS[peer]), time.monotonic()
            say(f"{peer}: installing")
            _, why = call([uv, "sync", "--quiet", "--script", script], chosen, 2 * self.limit)
            stage = "install"
            if not why:
                options = (f"--{name}={getattr(self, name)}" for name in ("rounds", "seconds", "most"))
                command = [uv, "run", "--quiet", "--no-project", "--script", script, *options]
                lines, why = call(command, chosen, self.limit)
                found = [json.loads(line) for line in lines if line.startswith('{"peer"')]
                for row in found:
                    say(f"{peer} {row['environments']}: {row['steps_per_second']:.0f}")
                rows, stage = rows + found, "measure"
            if why:
                failures.append({"peer": peer, "stage": stage, "why": why})
            say(f"{peer}: {why or 'done'}, {time.monotonic() - began:.0f} s")
        when = datetime.now(UTC).isoformat(timespec="seconds")
        record = {"when": when, "machine": machine(), "threads": count, "rows": rows, "failures": failures}
        write_whole(self.file, (json.dumps(record, indent=1) + "\n").encode())
        return record


def settings(threads: int) -> dict[str, str]:
    """Return the environment variables, besides affinity, by which JAX and PyTorch size their pools."""
    pools = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NPROC")
    found = dict.fromkeys(pools, str(threads))
    found |= {"JAX_PLATFORMS": "cpu", "CUDA_VISIBLE_DEVICES": "", "PYTHONHASHSEED": "0"}
    if threads == 1:
        found["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false"
    return found


def call(command: list[str], processors: list[int], limit: float) -> tuple[list[str], str]:
    """Return the lines that a command prints on these processors, and the reason of a failure or ``""``.

    No process of the command outlives the limit.
    """
    with subprocess.Popen(
        command,
        env=os.environ | settings(len(processors)),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        stdin=subprocess.DEVNULL,
        text=True,
        start_new_session=True,
        preexec_fn=partial(os.sched_setaffinity, 0, processors),  # noqa: PLW1509 (no threads are at work here)
    ) as process:
        try:
            out, errors = process.communicate(timeout=limit)
            why = f"ended with {process.returncode}: {last(errors)}" if process.returncode else ""
        except BaseException as stop:
            os.killpg(process.pid, signal.SIGKILL)
            out, errors = process.communicate()
            if not isinstance(stop, subprocess.TimeoutExpired):
                raise
            why = f"not done after {limit:.0f} s: {last(errors)}".removesuffix(": ")
    return out.splitlines(), why


def last(errors: str) -> str:
    """Return the last lines of a process's error output, at most 500 characters."""
    return " | ".join(line.strip() for line in errors.strip().splitlines()[-4:])[-500:]
