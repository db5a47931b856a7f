"""Signals that ask a process to end: Ctrl-C, SIGTERM of schedulers and ``kill``, SIGHUP of terminals."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
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


ENDS = {signal.SIGTERM: Terminated, signal.SIGHUP: Terminated, signal.SIGINT: KeyboardInterrupt}
"""What a signal raises."""


@contextmanager
def at_signals(act: Callable[[KeyboardInterrupt], object]) -> Iterator[None]:
    """Call ``act`` with what is to be raised at the first signal of a kind within the block. The second ends
    the process at once; of Ctrl-C it raises ``KeyboardInterrupt``.
    """
    with ExitStack() as stack:
        for number, kind in ENDS.items():
            then = signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL
            stack.enter_context(_at(number, partial(act, kind()), then))
        yield


@contextmanager
def heeded_after(seconds: float = 2.0) -> Iterator[None]:
    """Heed a signal that comes within the block after it: a line that is taken slowly is not cut. Where
    nobody takes it the signal is heeded after ``seconds``, and where another one comes at once.
    """
    before = {number: act for number in ENDS if callable(act := signal.getsignal(number))}
    if threading.current_thread() is not threading.main_thread() or not before:
        yield
        return
    came: list[int] = []

    def heed(number: int, frame: FrameType | None) -> None:
        if came:
            before[signal.Signals(came.pop())](number, frame)
        elif number != signal.SIGALRM:
            came.append(number)
            signal.setitimer(signal.ITIMER_REAL, seconds)

    alarm = signal.signal(signal.SIGALRM, heed)
    for number in before:
        signal.signal(number, heed)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        for number, act in {**before, signal.SIGALRM: alarm}.items():
            signal.signal(number, act)
        heed(signal.SIGALRM, None)


def end(by: KeyboardInterrupt) -> None:
    """Raise it."""
    raise by


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
