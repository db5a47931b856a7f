"""Code that the scripts of all peers share: timed rounds, their median and spread, a row of JSON for each.

It uses only the standard library, because each peer's script has another Python environment.
"""

import json
import os
import time
from argparse import ArgumentParser
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from statistics import median

Play = Callable[[], int]
"""Function that makes some steps in all environments, waits for them, and returns their total number."""


@dataclass(frozen=True)
class Case:
    """One way to run a peer, at several numbers of environments."""

    what: str
    """Contents of a step."""

    note: str
    """Differences and similarities to a step of ours."""

    environments: Sequence[int]
    """Numbers of environments, ascending."""

    build: Callable[[int], Play]
    """Function that prepares the timed steps for a number of environments; its own time does not count."""


def threads() -> int:
    """Return the number of processors that this process may use, which ``run.py`` sets."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def measure(peer: str, package: str, cases: Sequence[Case], libraries: Sequence[str] = ()) -> None:
    """Print a row of JSON for each case and number of environments: steps per second of the median round.

    ``low`` and ``high`` are those of the slowest and the fastest round. ``processors`` is the number of
    processors that this process kept busy, less than 1 if it had to wait on a busy machine. ``libraries`` are
    those that the peer's speed depends on, by version. Two calls before the rounds are not timed.
    """
    parser = ArgumentParser(description=f"Environment steps per second of {peer}.")
    parser.add_argument("--rounds", type=int, default=7, help="timed rounds of a row")
    parser.add_argument("--seconds", type=float, default=1.0, help="the least time of a round")
    parser.add_argument("--most", type=int, default=10**9, help="leave out more environments than this")
    args = parser.parse_args()
    for case in cases:
        for environments in case.environments:
            if environments > args.most:
                continue
            play = case.build(environments)
            play()
            play()  # JAX compiles once more for the results of the first call
            speeds, shares = zip(*(timed(play, args.seconds) for _ in range(args.rounds)), strict=True)
            row = {
                "peer": peer,
                "version": version(package),
                "libraries": {name: version(name) for name in libraries},
                "environments": environments,
                "what": case.what,
                "steps_per_second": round(median(speeds), 1),
                "low": round(min(speeds), 1),
                "high": round(max(speeds), 1),
                "processors": round(median(shares), 2),
                "rounds": args.rounds,
                "threads": threads(),
                "note": case.note,
            }
            print(json.dumps(row), flush=True)


def timed(play: Play, seconds: float) -> tuple[float, float]:
    """Return steps per second, and processors kept busy, over as many plays as fill the seconds."""
    steps, began, busy = 0, time.perf_counter(), time.process_time()
    while (passed := time.perf_counter() - began) < seconds or not steps:
        steps += play()
    return steps / passed, (time.process_time() - busy) / passed
