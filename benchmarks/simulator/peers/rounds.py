"""What the scripts of all peers share: timed rounds, their median and spread, a row of JSON for each.

Standard library only, as each peer's script has another Python environment. Called by those scripts.
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
"""Makes some steps in all environments, waits until they are done, and says how many that were in all."""


@dataclass(frozen=True)
class Case:
    """One way to run a peer, at several numbers of environments."""

    what: str
    """What a step contains."""

    note: str
    """What is and what is not comparable to a step of ours."""

    environments: Sequence[int]
    """How many environments, ascending."""

    build: Callable[[int], Play]
    """From how many environments to what is timed. Nothing of what it does itself is timed."""


def threads() -> int:
    """How many processors this process may use; ``run.py`` sees to that."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def measure(peer: str, package: str, cases: Sequence[Case], libraries: Sequence[str] = ()) -> None:
    """Print a row of JSON for each case and number of environments: steps a second of the median round.

    ``low`` and ``high`` are of the slowest and the quickest round; ``processors`` is how many this process
    kept busy, less than 1 where it had to wait, as on a machine that is not quiet. ``libraries`` are what
    the peer's speed depends on, by version. Two calls before the rounds are not timed.
    """
    parser = ArgumentParser(description=f"Environment steps a second of {peer}.")
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
            play()  # JAX compiles once more for what the first call gave back
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
    """Steps a second, and processors kept busy, over as many plays as fill these seconds."""
    steps, began, busy = 0, time.perf_counter(), time.process_time()
    while (passed := time.perf_counter() - began) < seconds or not steps:
        steps += play()
    return steps / passed, (time.process_time() - busy) / passed
