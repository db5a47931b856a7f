"""SIGTERM, by which schedulers and ``kill`` end a process: it ends a command as Ctrl-C does."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager


class Terminated(KeyboardInterrupt):
    """A signal asks the process to end: what is made is kept."""

    exit_code = 128 + signal.SIGTERM

    def __init__(self) -> None:
        """Say what it was."""
        super().__init__("terminated")


@contextmanager
def at_sigterm(act: Callable[[], object]) -> Iterator[None]:
    """Call ``act`` at the first SIGTERM within the block; the second ends the process at once.

    Does nothing outside of the main thread, the only one that signals reach, and where SIGTERM is ignored.
    """
    before = signal.getsignal(signal.SIGTERM)
    if threading.current_thread() is not threading.main_thread() or before == signal.SIG_IGN:
        yield
        return

    def heed(*_: object) -> None:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        act()

    signal.signal(signal.SIGTERM, heed)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def terminate() -> None:
    """Raise ``Terminated``."""
    raise Terminated
