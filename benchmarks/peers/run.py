"""Environment steps a second of other simulators, each in a Python environment of its own.

``python benchmarks/peers/run.py FILE`` runs every peer's script by ``uv run``, which installs what the
script's head pins, 3 GB to download in all, kept in uv's cache. It writes FILE, JSON: ``rows``, one for
each peer, way to run it and number of environments (``rounds.py`` says what is in a row), and ``failures``,
one for each peer that could not be installed, failed or ran out of time, with its last words; its rows
until then stay. Standard library only. Ends with 1 if there are failures, 2 if nothing was measured.
"""

import json
import os
import platform
import shutil
import signal
import subprocess
import sys
import time
from argparse import ArgumentParser
from datetime import UTC, datetime
from pathlib import Path

HERE = Path(__file__).resolve().parent
PEERS = {
    "VMAS": "vmas_house.py",
    "JaxNav": "jaxnav.py",
    "NAVIX": "navix_rooms.py",
    "XLand-MiniGrid": "xland_rooms.py",
    "MiniGrid": "minigrid_rooms.py",
    "IR-SIM": "irsim_house.py",
}


def main() -> int:
    """Run the peers one after the other."""
    parser = ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("file", type=Path, help="where to write the results, JSON")
    parser.add_argument("--threads", type=int, default=1, help="processors that a peer may use")
    parser.add_argument("--only", nargs="+", choices=PEERS, default=list(PEERS), help="these peers alone")
    parser.add_argument("--limit", type=float, default=900, help="seconds for a peer to be measured")
    parser.add_argument("--install", type=float, default=1800, help="seconds for a peer to be installed")
    parser.add_argument("--rounds", type=int, default=7, help="timed rounds of a row, at least 5")
    parser.add_argument("--seconds", type=float, default=1.0, help="the least time of a round")
    parser.add_argument("--most", type=int, default=10**9, help="leave out more environments than this")
    args = parser.parse_args()
    uv = shutil.which("uv") or shutil.which("uv", path=HERE.parents[1] / ".local/uv/bin")
    if not uv:
        parser.error("uv is missing: ./run leaves one in .local/uv/bin, or see https://docs.astral.sh/uv")
    if not args.file.parent.is_dir():
        parser.error(f"no folder {args.file.parent}: make it first")
    if args.rounds < 5:
        parser.error("fewer than 5 rounds tell no spread")

    environment = os.environ | confine(args.threads, parser.error)
    options = [f"--rounds={args.rounds}", f"--seconds={args.seconds}", f"--most={args.most}"]
    rows, failures = [], []
    for peer in args.only:
        script, began = str(HERE / PEERS[peer]), time.monotonic()
        print(f"{peer}: installing", file=sys.stderr, flush=True)
        _, why = call([uv, "sync", "--quiet", "--script", script], environment, args.install)
        if why:
            failures.append({"peer": peer, "stage": "install", "why": why})
        else:
            command = [uv, "run", "--quiet", "--no-project", "--script", script, *options]
            lines, why = call(command, environment, args.limit)
            rows += [json.loads(line) for line in lines if line.startswith('{"peer"')]
            if why:
                failures.append({"peer": peer, "stage": "measure", "why": why})
        for row in rows:
            if row["peer"] == peer:
                print(f"{peer} {row['environments']}: {row['steps_per_second']:.0f}", file=sys.stderr)
        print(f"{peer}: {why or 'done'}, {time.monotonic() - began:.0f} s", file=sys.stderr, flush=True)
    write(args.file, {**conditions(args.threads), "rows": rows, "failures": failures})
    return 1 if failures else 0 if rows else 2


def confine(threads: int, refuse) -> dict[str, str]:
    """Keep this process and all it starts to so many processors; what libraries must be told beside that.

    The last ones are taken, as the first serves most interrupts. JAX and PyTorch size their pools by the
    processors that they may use; the variables are for the libraries below them.
    """
    if hasattr(os, "sched_setaffinity"):
        allowed = sorted(os.sched_getaffinity(0))
        if not 0 < threads <= len(allowed):
            refuse(f"--threads {threads}: this process may use {len(allowed)} processors")
        os.sched_setaffinity(0, allowed[-threads:])
    pools = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NPROC")
    told = dict.fromkeys(pools, str(threads))
    told |= {"JAX_PLATFORMS": "cpu", "CUDA_VISIBLE_DEVICES": "", "PYTHONHASHSEED": "0"}
    if threads == 1:
        told["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false"
    return told


def call(command: list[str], environment: dict[str, str], limit: float) -> tuple[list[str], str]:
    """Lines printed by a command, and why it failed or ``""``. Nothing it started outlives the limit."""
    with subprocess.Popen(
        command,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        stdin=subprocess.DEVNULL,
        text=True,
        start_new_session=True,
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
    """The last lines of what a process complained of, 500 letters at most."""
    return " | ".join(line.strip() for line in errors.strip().splitlines()[-4:])[-500:]


def conditions(threads: int) -> dict:
    """Where and when this was measured."""
    try:
        info = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        model = next(line.split(":")[1].strip() for line in info if line.startswith("model name"))
    except (OSError, StopIteration):
        model = platform.processor()
    when = datetime.now(UTC).isoformat(timespec="seconds")
    return {"when": when, "processor": model, "processors": os.cpu_count(), "threads": threads}


def write(path: Path, results: dict) -> None:
    """Beside it first, then renamed: never half a file."""
    beside = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        beside.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)


if __name__ == "__main__":
    sys.exit(main())
