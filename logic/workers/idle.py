"""Solver processes that are kept for the next request."""

import atexit
import os
import threading
from typing import Any

from logic.workers.solver import Solver

MOST_IDLE = 2
"""Solver processes kept for the next request for the same rules: to start one takes half a second."""


class Idle:
    """Solver processes that have answered everything, by what they have loaded; safe among threads."""

    def __init__(self) -> None:
        """Begin with none."""
        self.forget()
        atexit.register(self.end)
        # A forked child has copies of the pipes, but the processes answer its parent.
        os.register_at_fork(after_in_child=self.forget)

    def forget(self) -> None:
        """Begin with none."""
        self._lock, self._workers = threading.Lock(), []

    def take(self, key: tuple[Any, ...]) -> Solver | None:
        """One that has loaded just these rules and still runs, if there is one."""
        with self._lock:
            places = [place for place, (loaded, _) in enumerate(self._workers) if loaded == key]
            worker = self._workers.pop(places[-1])[1] if places else None
        if worker is None or worker.is_alive():
            return worker
        worker.end()
        return self.take(key)

    def add(self, key: tuple[Any, ...], worker: Solver) -> None:
        """Keep one, and end those beyond ``MOST_IDLE`` that were used the longest time ago."""
        with self._lock:
            self._workers.append((key, worker))
            late = [self._workers.pop(0)[1] for _ in range(len(self._workers) - MOST_IDLE)]
        for unused in late:
            unused.end()

    def end(self) -> None:
        """End all."""
        while self._workers:
            self._workers.pop()[1].end()
