"""Idle solver processes, kept for the next request."""

import atexit
import os
import threading
from typing import Any

from vitruvius.logic.workers.solver import Solver

MOST_IDLE = 2
"""Number of idle solver processes. Each saves the half second that it takes to start one."""


class Idle:
    """Idle solver processes, by the rules that they have loaded. Safe among threads."""

    def __init__(self) -> None:
        """Begin without processes."""
        self.forget()
        atexit.register(self.end)
        # A forked child copies the pipes, but the processes answer only its parent.
        os.register_at_fork(after_in_child=self.forget)

    def forget(self) -> None:
        """Begin again without processes, and leave the old ones running."""
        self._lock, self._workers = threading.Lock(), []

    def take(self, key: tuple[Any, ...]) -> Solver | None:
        """Remove and return a running process that has loaded exactly these rules, or None if none has."""
        with self._lock:
            places = [place for place, (loaded, _) in enumerate(self._workers) if loaded == key]
            worker = self._workers.pop(places[-1])[1] if places else None
        if worker is None or worker.is_alive():
            return worker
        worker.end()
        return self.take(key)

    def add(self, key: tuple[Any, ...], worker: Solver) -> None:
        """Add a process, and end the least recently used ones beyond ``MOST_IDLE``."""
        with self._lock:
            self._workers.append((key, worker))
            late = [self._workers.pop(0)[1] for _ in range(len(self._workers) - MOST_IDLE)]
        for unused in late:
            unused.end()

    def end(self) -> None:
        """End all processes."""
        while self._workers:
            self._workers.pop()[1].end()
