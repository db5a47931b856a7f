"""Signals that ask a process to end: Ctrl-C, SIGTERM of schedulers and ``kill``, SIGHUP of terminals."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from types import FrameType
from typing import Any

AGAIN = 0.2
"""Seconds after which a signal that came during an import is heeded again, if that has passed over it."""


class Terminated(KeyboardInterrupt):
    """A signal asks the process to end: what is made is kept."""

    exit_code = 128 + signal.SIGTERM

    def __init__(self) -> None:
        """Say what it was."""
        super().__init__("terminated")


@contextmanager
def at_sigterm(act: Callable[[], object]) -> Iterator[None]:
    """Call ``act`` at the first SIGTERM within the block; the second ends the process at once."""
    with _at(signal.SIGTERM, act, signal.SIG_DFL):
        yield


@contextmanager
def ended_by_signals() -> Iterator[None]:
    """Raise ``Terminated`` at SIGTERM and SIGHUP within the block, ``KeyboardInterrupt`` at Ctrl-C."""
    with ExitStack() as stack:
        for number in (signal.SIGTERM, signal.SIGHUP):
            stack.enter_context(_at(number, terminate, signal.SIG_DFL))
        stack.enter_context(_at(signal.SIGINT, interrupt, signal.default_int_handler))
        yield


def terminate() -> None:
    """Raise ``Terminated``."""
    raise Terminated


def interrupt() -> None:
    """Raise ``KeyboardInterrupt``."""
    raise KeyboardInterrupt


@contextmanager
def _at(number: signal.Signals, act: Callable[[], object], then: Any) -> Iterator[None]:
    """Call ``act`` at a signal within the block; ``then`` is what heeds a second one.

    While a module is imported, libraries may pass over what is raised, or raise something else for it: then
    ``act`` is called again. Does nothing outside of the main thread, the only one that signals reach, and
    where the signal is ignored.
    """
    before = signal.getsignal(number)
    if threading.current_thread() is not threading.main_thread() or before == signal.SIG_IGN:
        yield
        return

    def heed(_: int, frame: FrameType | None) -> None:
        nonlocal importing
        signal.signal(number, then)
        if importing := _imports(frame):
            signal.signal(signal.SIGALRM, heed)
            signal.setitimer(signal.ITIMER_REAL, AGAIN)
        act()

    importing = False
    signal.signal(number, heed)
    try:
        yield
    except Exception:
        if importing:
            act()
        raise
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(number, before)


def _imports(frame: FrameType | None) -> bool:
    """Whether a module is imported in this frame, or in one that waits for it."""
    while frame:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False
