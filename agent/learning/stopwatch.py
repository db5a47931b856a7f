"""Timer of parts of a run, on the device that does the work."""

from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter

import torch


class Stopwatch:
    """Sum of the seconds of blocks of work.

    A GPU continues to work after a call has returned. There, the GPU's own clock is read before and after a
    block, and nothing waits until the sum is read.
    """

    def __init__(self, device: str = "cpu") -> None:
        """Measure work on ``device``, ``cpu`` or ``cuda``."""
        self.device, self._seconds = device, 0.0
        self._blocks: list[tuple[torch.cuda.Event, torch.cuda.Event]] = []

    @contextmanager
    def running(self) -> Iterator[None]:
        """Count the time of a block."""
        if self.device == "cpu":
            before = perf_counter()
            yield
            self._seconds += perf_counter() - before
            return
        begin, end = torch.cuda.Event(enable_timing=True), torch.cuda.Event(enable_timing=True)
        begin.record()
        yield
        end.record()
        self._blocks.append((begin, end))

    def take(self) -> float:
        """Return the seconds since the last call, and begin again at 0."""
        for begin, end in self._blocks:
            end.synchronize()
            self._seconds += begin.elapsed_time(end) / 1000
        seconds, self._seconds = self._seconds, 0.0
        self._blocks.clear()
        return seconds
