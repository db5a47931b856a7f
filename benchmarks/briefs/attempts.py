"""Our own attempts at briefs, each in its own process, with the time of each stage."""

import os
import resource
import select
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import process_time
from typing import Any

import msgspec
from msgspec import structs

from benchmarks.briefs.bank import BriefEntry
from benchmarks.briefs.score import Answer
from benchmarks.common.processes import LIBC
from vitruvius.logic.errors import LimitReached, Unsatisfiable
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.proofs.answer import house_or_proof
from vitruvius.logic.request.brief import Brief
from vitruvius.logic.request.house_request import HouseRequest

PATIENCE = 20
"""Clock seconds per second of processor time that an attempt may take, because the machine has other work."""

CLOCK_S = 0.1
"""Tolerance of processor time, in seconds."""

INTERRUPTED = "interrupted"
"""Limit of an attempt whose process ended without an answer."""

END = b"\n"
"""Last byte of a whole answer."""


class Attempt(msgspec.Struct, omit_defaults=True):
    """Outcome of a brief: houses, a proof, or neither.

    Times are in processor seconds, in all and by stage.
    """

    seconds: float
    """Time until the first house or the proof."""
    stages: dict[str, float] = {}
    """Times by the names of ``logic.layout.account``."""
    refuted: int = 0
    """Number of dissections that stage 2 refuted."""
    houses: tuple[dict[str, Any], ...] = ()
    because: tuple[str, ...] | None = None
    """Reasons of a proof that there is no house."""
    limit: str = ""

    def answer(self, entry: BriefEntry) -> Answer:
        """Return the attempt in the form of other generators' answers."""
        proved = self.because is not None
        return Answer(entry.name, self.houses, proved, self.because or (), round(self.seconds, 4))


class StageClock:
    """Processor seconds by stage of a builder's work."""

    def __init__(self) -> None:
        self.began = self._since = process_time()
        self.stages: dict[str, float] = {}
        self._stage = "reading"

    def at(self, stage: str) -> None:
        """Begin another stage."""
        now = process_time()
        self.stages[self._stage] = self.stages.get(self._stage, 0.0) + now - self._since
        self._stage, self._since = stage, now

    @contextmanager
    def of(self, builder: Builder) -> Iterator[None]:
        """Follow a builder's account."""
        account = builder.account
        said = account.at

        def at(stage: str, what: str) -> None:
            self.at(stage)
            said(stage, what)

        account.at = at
        try:
            yield
        finally:
            account.at = said
            self.at("")


def attempt(builder: Builder, brief: Brief, houses: int = 1, seed: int = 0) -> Attempt:
    """Return houses of a brief, or the proof that there is none."""
    return attempt_at(builder, HouseRequest(len(brief.rooms), brief=brief), houses, seed)


def attempt_at(builder: Builder, request: HouseRequest, houses: int = 1, seed: int = 0) -> Attempt:
    """Answer a request of any kind as ``attempt`` answers a brief."""
    clock, found, because, limit = StageClock(), [], None, ""
    with clock.of(builder):
        try:
            found.append(house_or_proof(builder, request, seed, 0))
        except Unsatisfiable as error:
            because = tuple(reason.text for reason in error.reasons)
        except LimitReached as error:
            limit = str(error)
    seconds, refuted = process_time() - clock.began, builder.account.tried[1]
    for index in range(1, houses if found else 0):
        found.append(builder.house(request, seed, index))
    records = tuple(structs.replace(house, provenance=None).to_dict() for house in found)
    return Attempt(seconds, clock.stages, refuted, records, because, limit)


def within(seconds: int, work: Callable[[], Attempt]) -> Attempt:
    """Run some work in its own process, so that each brief has a fresh solver, and return its attempt.

    If the work takes more processor time, the attempt has a limit. If the process ends without an answer, for
    example by a signal, the limit is ``INTERRUPTED``.
    """
    reading, writing = os.pipe()
    child = os.fork()
    if not child:
        _alone(seconds, writing, work)
    os.close(writing)
    content, more = b"", b"\0"
    with open(reading, "rb", buffering=0) as pipe:
        while more and select.select([pipe], [], [], seconds * PATIENCE)[0]:
            content += (more := pipe.read(1 << 20))
    os.kill(child, signal.SIGKILL)  # it has answered, or is late
    used = os.wait4(child, 0)[2]
    if content.endswith(END):
        return msgspec.json.decode(content, type=Attempt)
    took = used.ru_utime + used.ru_stime
    is_late = more or took > seconds - CLOCK_S
    return Attempt(took, limit=f"{seconds} s of processor time" if is_late else INTERRUPTED)


def _alone(seconds: int, writing: int, work: Callable[[], Attempt]) -> None:
    """Work in the new process, which ends at the latest with the study."""
    try:
        LIBC.prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))
        content = msgspec.json.encode(work()) + END
        with open(writing, "wb") as pipe:
            pipe.write(content)
    except Exception as error:
        print(f"an attempt failed: {error!r}", flush=True)
    finally:
        os._exit(0)
